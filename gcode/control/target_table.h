// What a control takes, as plain values: a row of a family of dialects, and what a user's profile
// may change of any dialect. Rules that are no values (which radii agree, which bytes of a line
// count) stay with the dialect.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>

#include "gcode/control/dialect.h"

namespace batten::gcode {

// Digits after the point in millimetre and in inch programs.
struct DecimalsByUnit {
  int mm = 3;
  int inch = 4;
  bool operator==(const DecimalsByUnit&) const = default;
};

enum class CommentStyle : std::uint8_t {
  kNone,
  kParentheses,  // (text)
  kSemicolon,    // ;text
};

struct TargetTable {
  std::string name;
  std::string description;  // one line, for `batten targets`
  DecimalsByUnit places;    // vertices of lines
  DecimalsByUnit arc_ends;  // as many as places, or more
  DecimalsByUnit centers;   // I J K R
  int feed_decimals = 6;
  bool decimal_point = false;  // X5. rather than X5
  bool trailing_zeros = false;
  std::size_t max_line_length = 255;  // bytes, as the dialect counts them
  bool blanks = true;                 // between words
  CommentStyle comments = CommentStyle::kParentheses;
  std::array<bool, 3> planes = {true, true, true};  // arcs in G17, G18, G19
  bool helices = true;
  bool arc_distance_mode = false;  // G90.1, G91.1
  ArcForm arc_form = ArcForm::kCenters;
  double max_sweep_deg = 180;
  bool single_quadrants = false;
  double min_radius = 0.1;   // mm
  double max_radius = 1000;  // mm
  ArcChords chords;
  bool repeats_words = false;
  std::string machine = "mill";  // built-in machine model when none is given
  bool operator==(const TargetTable&) const = default;
};

// The values of any dialect. Its own forms of comments count as none of these styles.
[[nodiscard]] TargetTable table_of(const Dialect& dialect);

// The comment in this style; empty where the text cannot be said so. Never text that a control of
// the RS-274 family would act on ("MSG,", "DEBUG,", ..).
[[nodiscard]] std::string comment_in(CommentStyle style, std::string_view text);

// A dialect whose values are those of a table.
class TableValues : public Dialect {
 public:
  explicit TableValues(TargetTable table);

  [[nodiscard]] const TargetTable& table() const { return table_; }

  [[nodiscard]] std::string_view name() const override { return table_.name; }
  [[nodiscard]] std::string_view description() const override { return table_.description; }
  [[nodiscard]] NumberFormat coordinates(Units units) const override;
  [[nodiscard]] NumberFormat arc_offsets(Units units) const override;
  [[nodiscard]] NumberFormat feeds(Units units) const override;
  [[nodiscard]] NumberFormat arc_ends(Units units) const override;
  [[nodiscard]] std::size_t max_line_length() const override { return table_.max_line_length; }
  [[nodiscard]] bool takes_arcs_in(Plane plane) const override;
  [[nodiscard]] bool takes_helices() const override { return table_.helices; }
  [[nodiscard]] bool takes_arc_distance_mode() const override { return table_.arc_distance_mode; }
  [[nodiscard]] bool blanks_between_words() const override { return table_.blanks; }
  [[nodiscard]] ArcForm arc_form() const override { return table_.arc_form; }
  [[nodiscard]] double max_arc_sweep() const override;
  [[nodiscard]] bool needs_single_quadrants() const override { return table_.single_quadrants; }
  [[nodiscard]] ArcChords arc_chords() const override { return table_.chords; }
  [[nodiscard]] bool repeats_words() const override { return table_.repeats_words; }
  [[nodiscard]] double min_arc_radius() const override { return table_.min_radius; }
  [[nodiscard]] double max_arc_radius() const override { return table_.max_radius; }
  [[nodiscard]] std::string comment(std::string_view text) const override;
  [[nodiscard]] std::string_view default_machine() const override { return table_.machine; }

 private:
  TargetTable table_;
};

}  // namespace batten::gcode
