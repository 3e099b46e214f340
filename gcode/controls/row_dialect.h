// A dialect that is a row of its family's table: values, and which of the known rules holds.
#pragma once

#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <string_view>

#include "gcode/control/target_table.h"
#include "gcode/controls/arc_rules.h"

namespace batten::gcode {

// Which bytes of a line a control has to keep.
enum class LineCount : std::uint8_t {
  kAll,
  kWithoutComments,
  kWithoutBlanksAndComments,
};

// A G word that the reader takes for something else.
struct OtherMeaning {
  int g_code = 0;  // in tenths
  std::string_view text;
};

struct TargetRow {
  TargetTable table;
  LineCount line_count = LineCount::kAll;
  std::string_view not_in_comments = {};  // bytes that the control obeys there too
  ArcRule arc_rule = &strictest_arc_rule;
  std::span<const OtherMeaning> other_meanings = {};
  std::span<const std::string_view> smoothing_words = {};
  SourceMarks known_marks = 0;
  // Words that most others take: "M6 G43 T", a letter alone for any number behind it.
  std::string_view refused = {};
  DwellUnit dwell_unit = DwellUnit::kByPoint;
  DwellForm dwell_form = DwellForm::kUnknown;
  bool units_by_g70 = false;  // G70 inches, G71 millimetres, known for certain
  bool may_imply_decimals = false;
  const CurveFormat* curves = nullptr;
};

class RowDialect final : public TableValues {
 public:
  explicit RowDialect(TargetRow row);

  [[nodiscard]] std::size_t line_length(std::string_view line) const override;
  [[nodiscard]] std::string_view arc_complaint(const geometry::Arc& printed,
                                               Units units) const override;
  [[nodiscard]] std::string_view other_meaning(int g_code) const override;
  [[nodiscard]] std::string comment(std::string_view text) const override;

  [[nodiscard]] std::span<const std::string_view> smoothing_words() const override {
    return row_.smoothing_words;
  }

  [[nodiscard]] SourceMarks known_marks() const override { return row_.known_marks; }
  [[nodiscard]] bool cannot_say(char letter, int number) const override;

  // A table that writes X5 says that it is 5 mm.
  [[nodiscard]] bool may_imply_decimals() const override {
    return row_.may_imply_decimals && table().decimal_point;
  }
  [[nodiscard]] DwellUnit dwell_unit() const override { return row_.dwell_unit; }
  [[nodiscard]] std::string_view unit_word(Units units) const override {
    if (!row_.units_by_g70) return Dialect::unit_word(units);
    return units == Units::kInch ? "G70" : "G71";
  }
  [[nodiscard]] DwellForm dwell_form() const override { return row_.dwell_form; }
  [[nodiscard]] const CurveFormat* curves() const override { return row_.curves; }

  // A row with the same rules: they are asked about the new values.
  [[nodiscard]] std::unique_ptr<const Dialect> with_values(const TargetTable& table) const override;

 private:
  TargetRow row_;  // its table is TableValues::table()
};

// The bytes of a line, counted so. An unclosed parenthesis is a comment to the end of the line.
[[nodiscard]] std::size_t counted_bytes(std::string_view line, LineCount count);

}  // namespace batten::gcode
