// A dialect with some of its values changed, as a user's profile says: its rules and its curves
// stay.
#pragma once

#include <string>
#include <string_view>

#include "gcode/control/target_table.h"

namespace batten::gcode {

// Everything that is no value of the table is asked of `base`, which must outlive this object.
class ProfiledDialect final : public TableValues {
 public:
  ProfiledDialect(const Dialect& base, TargetTable table);

  [[nodiscard]] Language language() const override { return base_.language(); }
  [[nodiscard]] std::size_t line_length(std::string_view line) const override;
  [[nodiscard]] std::string_view arc_complaint(const geometry::Arc& printed,
                                               Units units) const override;
  [[nodiscard]] std::string_view other_meaning(int g_code) const override;
  [[nodiscard]] const CurveFormat* curves() const override;
  [[nodiscard]] SourceMarks known_marks() const override;
  [[nodiscard]] bool cannot_say(char letter, int number) const override;
  [[nodiscard]] std::span<const std::string_view> smoothing_words() const override;
  [[nodiscard]] const BlockSpelling& spelling() const override { return base_.spelling(); }
  // A profile that writes X5 says that it is 5 mm.
  [[nodiscard]] bool may_imply_decimals() const override {
    return base_.may_imply_decimals() && table().decimal_point;
  }
  [[nodiscard]] DwellUnit dwell_unit() const override { return base_.dwell_unit(); }
  [[nodiscard]] std::string_view unit_word(Units units) const override {
    return base_.unit_word(units);
  }
  [[nodiscard]] DwellForm dwell_form() const override { return base_.dwell_form(); }

  // The base's own comment while the style is the base's; what the base cannot say in a comment is
  // not said in another style either.
  [[nodiscard]] std::string comment(std::string_view text) const override;

 private:
  const Dialect& base_;
  CommentStyle base_style_;
};

}  // namespace batten::gcode
