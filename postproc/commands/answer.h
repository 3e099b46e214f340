// What a command answers in JSON: its report, or why there is none. One for the program, as
// standard error is: what is said goes into it, too.
//
// With `--json -` there is one object on standard output whatever the exit code is. It is written
// when the command has ended, since only then it is known how. Its form: docs/report.schema.json.
#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "gcode/text/diagnostic.h"
#include "gcode/text/source_text.h"

namespace batten::postproc {

// What `say` says, and what `print` prints or would print on another log level.
void answer_with(std::string_view message);
void answer_with(const gcode::Diagnostics& diagnostics, const gcode::SourceText& source);

struct AnswerReport {
  std::string file;  // "-" is standard output
  bool replace_existing = false;
  std::string text;  // json_text
};
void answer_with(AnswerReport report);

// Whether these words of a command line ask for JSON on standard output, be they right or wrong.
[[nodiscard]] bool wants_json(const std::vector<std::string>& arguments);

// What is to be written when the command has ended with `code`: the report with the exit code and
// the messages; without a report, where `code` is none of success and the words of the command line
// ask for JSON on standard output, why there is none. Else nothing.
[[nodiscard]] std::optional<AnswerReport> last_answer(int code,
                                                      const std::vector<std::string>& arguments);

}  // namespace batten::postproc
