#include "postproc/convert/tool_in_spindle.h"

#include <cmath>
#include <utility>

#include "postproc/convert/portable_words.h"

namespace batten::postproc {
namespace {

constexpr std::string_view kOfNoTool = "names the length of a tool that no M6 has put in";

}  // namespace

bool ToolInSpindle::is_number(double number) {
  constexpr double kGreatest = 1e6;
  return number >= 1 && number < kGreatest && number == std::floor(number);
}

void ToolInSpindle::put_in(double tool) {
  *this = {};
  number = tool;
}

void ToolInSpindle::leave_length(gcode::SourceSpan where) {
  without_length = where;
  length = LengthSaid::kCountsNot;
}

bool ToolInSpindle::count_length() {
  without_length.reset();
  return std::exchange(length, LengthSaid::kCounts) != LengthSaid::kCounts;
}

std::string_view ToolInSpindle::why_not_length(std::span<const gcode::Word> words) const {
  const gcode::Word* h = first_word(words, 'H');
  const std::optional<double> tool = behind(words);
  if (!tool) return kOfNoTool;
  if (h != nullptr && h->value != *tool) return "names the length of another tool";
  return why_too_late(words);
}

std::string_view ToolInSpindle::why_not_edge(const gcode::Word& d,
                                             std::span<const gcode::Word> words) const {
  if (d.value == 0) return {};
  if (d.value != 1) return "is another edge of the tool";
  if (!behind(words)) return kOfNoTool;
  return why_too_late(words);
}

// The tool in the spindle once the block's M6 is done.
std::optional<double> ToolInSpindle::behind(std::span<const gcode::Word> words) const {
  if (coded_word(words, 'M', word_code::kToolChange) == nullptr) return number;
  if (const gcode::Word* t = first_word(words, 'T')) return t->value;
  return fetched ? std::optional(fetched->number) : std::nullopt;
}

std::string_view ToolInSpindle::why_too_late(std::span<const gcode::Word> words) const {
  const bool changes = coded_word(words, 'M', word_code::kToolChange) != nullptr;
  return moved_along && !changes ? "comes behind a motion without the length of the tool" : "";
}

}  // namespace batten::postproc
