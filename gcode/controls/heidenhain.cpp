// Heidenhain TNC controls in Klartext. Facts: docs/controllers/heidenhain.md.
#include <array>
#include <cmath>
#include <memory>
#include <utility>

#include "gcode/control/target_table.h"
#include "gcode/controls/arc_rules.h"
#include "gcode/controls/built_in.h"
#include "gcode/controls/rs274_family.h"
#include "gcode/curves/heidenhain_spl.h"
#include "gcode/curves/klartext_words.h"

namespace batten::gcode {
namespace {

constexpr std::array kSmoothingWords = {
    std::string_view{"CYCL DEF 32.0 TOLERANCE, CYCL DEF 32.1 T0.02, CYCL DEF 32.2 HSC-MODE:0 "
                     "TA0.5: how far the control may round corners (0 finish, 1 rough); its T adds "
                     "to the deviation"},
};

class Heidenhain final : public TableValues {
 public:
  Heidenhain(TargetTable table, const CurveFormat* curves)
      : TableValues(std::move(table)), curves_(curves) {}

  Language language() const override { return Language::kKlartext; }
  const BlockSpelling& spelling() const override { return klartext_spelling(); }
  const CurveFormat* curves() const override { return curves_; }

  std::size_t line_length(std::string_view line) const override { return line.size(); }

  std::string_view arc_complaint(const geometry::Arc& printed, Units units) const override {
    if (std::abs(printed.axis.z()) < 0.5) return "CC and C are written in the plane of X and Y";
    if (end_radii(printed).mismatch() > kKlartextRadiusMismatch) {
      return "radii at the ends of the arc differ";
    }
    return strictest_arc_rule(printed, units, table());
  }

  // The marks are words of other languages.
  SourceMarks known_marks() const override { return kAllMarks; }

  std::span<const std::string_view> smoothing_words() const override { return kSmoothingWords; }

  DwellUnit dwell_unit() const override { return DwellUnit::kSeconds; }

  // The same rules with other values.
  std::unique_ptr<const Dialect> with_values(const TargetTable& table) const override {
    return std::make_unique<Heidenhain>(table, curves_);
  }

 private:
  const CurveFormat* curves_;
};

TargetTable klartext_table(std::string name, std::string description) {
  TargetTable table;
  table.name = std::move(name);
  table.description = std::move(description);
  table.places = {.mm = 4, .inch = 5};
  table.arc_ends = table.places;
  table.centers = table.places;
  table.comments = CommentStyle::kSemicolon;
  table.planes = {true, false, false};
  table.helices = false;  // CP IPA IZ, not written
  table.repeats_words = true;
  table.max_line_length = 255;
  return table;
}

}  // namespace

std::span<const Dialect* const> heidenhain_family() {
  static const Heidenhain kTnc(
      klartext_table("heidenhain", "Heidenhain TNC 640, 620, 320, iTNC: Klartext, L, CC and C"),
      nullptr);
  static const Heidenhain kSpline(
      klartext_table("itnc530", "Heidenhain iTNC 530, TNC 426, 430: as heidenhain; SPL"),
      &heidenhain_spl());
  static const std::array<const Dialect*, 2> kFamily = {&kTnc, &kSpline};
  return kFamily;
}

}  // namespace batten::gcode
