#include "postproc/profile/target_words.h"

#include <fmt/format.h>

#include <algorithm>
#include <string>
#include <string_view>
#include <vector>

#include "postproc/options/profile_words.h"

namespace batten::postproc {

void tell_of_other_meanings(const gcode::Program& program, const gcode::Dialect& target,
                            gcode::Diagnostics& found) {
  std::vector<int> told;
  for (const gcode::Word& word : program.words) {
    if (word.letter != 'G' || !word.is_number) continue;
    const int code = tenths_of(word);
    const std::string_view meaning = target.other_meaning(code);
    if (meaning.empty() || std::ranges::find(told, code) != told.end()) continue;
    told.push_back(code);
    found.push_back({gcode::Severity::kError, "word-means-other", word.span,
                     fmt::format("{} for target {}: {}", program.source.text(word.span),
                                 target.name(), meaning)});
  }
}

}  // namespace batten::postproc
