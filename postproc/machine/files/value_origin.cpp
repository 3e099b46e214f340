#include "postproc/machine/files/value_origin.h"

#include <fmt/format.h>

#include <algorithm>

namespace batten::postproc {

std::string ValueOrigins::sentence(const MachineProblem& problem) const {
  const auto found = places_.find(problem.key);
  if (found == places_.end()) {
    return fmt::format("{}: {}: {:g}, expected {}", file_, problem.key, problem.value,
                       problem.expected);
  }
  const ValueOrigin& origin = found->second;
  const std::string column = origin.column > 0 ? fmt::format(":{}", origin.column) : "";
  return fmt::format("{}:{}{}: {}: {:g}, expected {}", origin.file.empty() ? file_ : origin.file,
                     origin.line, column, origin.name, problem.value, problem.expected);
}

void ValueOrigins::add_problems_of(const Machine& machine,
                                   std::vector<std::string>& problems) const {
  for (const MachineProblem& problem : problems_of(machine)) {
    std::string text = sentence(problem);
    if (std::ranges::find(problems, text) == problems.end()) problems.push_back(std::move(text));
  }
}

}  // namespace batten::postproc
