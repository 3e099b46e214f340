// What the report's page is told: the JSON report, and the path in columns.
#pragma once

#include "postproc/report/html_report.h"
#include "postproc/report/page_path.h"
#include "postproc/text/json_values.h"

namespace batten::postproc {

// {"report": .., "command": "", "path": ..}, as postproc/report/page/data.js reads it. `report` is
// that of json_report, its runs as one list per field.
[[nodiscard]] Json page_data(const SmoothReport& report, const HtmlReportOptions& options);

// {"count": n, "unit_mm": 0.0001, .. and a text per column (postproc/report/compact_numbers.h)}
[[nodiscard]] Json path_columns(const PagePath& path);

}  // namespace batten::postproc
