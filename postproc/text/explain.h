// `batten explain ID`: what a reason, a message or a violation means, and what to do about it.
#pragma once

#include <string>
#include <string_view>
#include <vector>

namespace batten::postproc {

// docs/diagnostics.md, which is built into the program.
[[nodiscard]] std::string_view diagnostics_page();

// All ids that can be asked for, sorted, each once: reasons why runs are kept, messages about a
// program, violations. Some are both a reason and a violation.
[[nodiscard]] std::vector<std::string_view> explained_ids();

// Some lines of text for a terminal; empty where there is no such id.
[[nodiscard]] std::string explanation_of(std::string_view id);

// What to do about a message of this id, as one line; empty where there is no such message.
[[nodiscard]] std::string_view advice_on(std::string_view id);

// A line for each id.
[[nodiscard]] std::string all_explanations();

}  // namespace batten::postproc
