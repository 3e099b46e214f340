// The reports for a browser: one page that needs nothing else, neither network nor library. Its
// template, postproc/report/page/, is part of the program. All figures are those of the JSON
// report; the path is drawn from the texts (postproc/report/page_path.h). The same input and
// options give the same bytes.
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "postproc/report/page_path.h"
#include "postproc/report/smooth_report.h"
#include "postproc/text/json_values.h"

namespace batten::postproc {

// `command`: as it was called, for the reader; may be empty.
[[nodiscard]] std::string html_report(const SmoothReport& report, const std::string& command);

// {"kind": "smooth", "report": .., "command": "", "units": "mm", "path": ..}, as
// postproc/report/page/page.js reads it. `report` is that of json_report, its runs as one list per
// field.
[[nodiscard]] Json page_data(const SmoothReport& report, const std::string& command);

// --- of the commands that write no program ---------------------------------------------------

struct PageOf {
  std::string_view kind;   // of KINDS in postproc/report/page/kinds.js: its name
  const Json& report;      // that of --json
  std::string_view title;  // name of the program
  const std::string& command;
  std::vector<PageLines> rows;  // of the page's table, in the order of the program
};

// `machine`: whose speeds are predicted; may be null.
[[nodiscard]] std::string html_report(const PageOf& page, const ReadProgram& program,
                                      const Machine* machine);

// Of two programs that were compared.
[[nodiscard]] std::string html_report(const PageOf& page, const ReadProgram& before,
                                      const ReadProgram& after, const Promise& promise);

}  // namespace batten::postproc
