// Parts that every JSON report of the program has in common.
#pragma once

#include <nlohmann/json_fwd.hpp>
#include <string>
#include <string_view>
#include <vector>

#include "gcode/text/diagnostic.h"
#include "gcode/text/source_text.h"

namespace batten::postproc {

// Keeps its fields in the order in which they were set. Who looks into one includes
// <nlohmann/json.hpp>.
using Json = nlohmann::ordered_json;

// A list of what `make` gives for each item. Who calls it includes <nlohmann/json.hpp>.
template <typename Items, typename Make, typename List = Json>
[[nodiscard]] List json_list(const Items& items, const Make& make) {
  List list = List::array();
  for (const auto& item : items) list.push_back(make(item));
  return list;
}

// What the reports look like (docs/report.schema.json): the number goes up where a field goes, or
// means something else.
inline constexpr std::string_view kReportSchema = "batten-report/1";

// With the first fields of every report: {"schema": "batten-report/1", "kind": "", "batten": "",
// ..}
[[nodiscard]] Json as_report(std::string_view kind, Json fields);

// The text of a report (json_text) with its last fields, how the command ended and what it said:
// {.., "exit_code": 0, "messages": [""]}
[[nodiscard]] std::string ended_report(std::string text, int exit_code,
                                       const std::vector<std::string>& messages);

// [{"severity": "warning", "id": "", "line": 1, "column": 1, "message": "", "advice": ""}]
[[nodiscard]] Json diagnostics_json(const gcode::Diagnostics& diagnostics,
                                    const gcode::SourceText& source);

// Indented text with a last newline; bytes that are not UTF-8 are replaced.
[[nodiscard]] std::string json_text(const Json& json);

}  // namespace batten::postproc
