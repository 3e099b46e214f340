#include "gcode/control/profiled_dialect.h"

#include <memory>
#include <utility>

namespace batten::gcode {

std::unique_ptr<const Dialect> Dialect::with_values(const TargetTable& table) const {
  return std::make_unique<ProfiledDialect>(*this, table);
}

ProfiledDialect::ProfiledDialect(const Dialect& base, TargetTable table)
    : TableValues(std::move(table)), base_(base), base_style_(table_of(base).comments) {}

std::size_t ProfiledDialect::line_length(std::string_view line) const {
  return base_.line_length(line);
}

std::string_view ProfiledDialect::arc_complaint(const geometry::Arc& printed, Units units) const {
  return base_.arc_complaint(printed, units);
}

std::string_view ProfiledDialect::other_meaning(int g_code) const {
  return base_.other_meaning(g_code);
}

const CurveFormat* ProfiledDialect::curves() const { return base_.curves(); }

SourceMarks ProfiledDialect::known_marks() const { return base_.known_marks(); }

bool ProfiledDialect::cannot_say(char letter, int number) const {
  return base_.cannot_say(letter, number);
}

std::span<const std::string_view> ProfiledDialect::smoothing_words() const {
  return base_.smoothing_words();
}

std::string ProfiledDialect::comment(std::string_view text) const {
  std::string said = base_.comment(text);
  const bool can_say = base_style_ == CommentStyle::kNone || !said.empty();
  if (!can_say) return {};
  if (table().comments != base_style_) return TableValues::comment(text);
  if (line_length(said) > max_line_length()) return {};
  return said;
}

}  // namespace batten::gcode
