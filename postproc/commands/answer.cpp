#include "postproc/commands/answer.h"

#include <algorithm>
#include <nlohmann/json.hpp>
#include <optional>
#include <utility>

#include "postproc/system/exit_code.h"
#include "postproc/text/json_values.h"

namespace batten::postproc {
namespace {

struct Answer {
  std::vector<std::string> messages;
  Json diagnostics = Json::array();
  std::optional<AnswerReport> report;
};

Answer& answer() {
  static Answer of_the_program;
  return of_the_program;
}

struct CodeMeaning {
  ExitCode code;
  std::string_view meaning;
  std::string_view advice;
};
constexpr CodeMeaning kCodes[] = {
    {ExitCode::kUsage, "wrong options; no file was touched",
     "Give the options that the messages name; `batten COMMAND --help` lists them."},
    {ExitCode::kNotUnderstood, "the input is not understood; nothing was written",
     "Do what the diagnostics and messages advise; `batten inspect FILE` shows what is "
     "understood."},
    {ExitCode::kNotProved, "not proved", "Do what the messages advise."},
    {ExitCode::kFileError, "a file could not be read or written",
     "See to the file that the messages name; --force replaces one that exists."},
    {ExitCode::kInternalError, "internal error; nothing was written",
     "Give it more memory, or --threads 1. If that is not it, please report it with the program "
     "and the options."},
};
constexpr CodeMeaning kInterrupted = {
    ExitCode::kInternalError, "a signal ended the work; nothing is half written", "Call it again."};

// The first word, if it is none of the options.
std::string command_of(const std::vector<std::string>& arguments) {
  const bool has_one = !arguments.empty() && !arguments.front().starts_with('-');
  return has_one ? arguments.front() : std::string();
}

std::string failure_text(int code, const std::vector<std::string>& arguments) {
  const auto* known = std::ranges::find(kCodes, static_cast<ExitCode>(code), &CodeMeaning::code);
  const CodeMeaning& meaning = known != std::end(kCodes) ? *known : kInterrupted;
  return json_text(as_report("failure", {{"command", command_of(arguments)},
                                         {"meaning", meaning.meaning},
                                         {"advice", meaning.advice},
                                         {"diagnostics", std::move(answer().diagnostics)}}));
}

}  // namespace

void answer_with(std::string_view message) { answer().messages.emplace_back(message); }

void answer_with(const gcode::Diagnostics& diagnostics, const gcode::SourceText& source) {
  for (Json& each : diagnostics_json(diagnostics, source)) {
    each["file"] = source.name();
    answer().diagnostics.push_back(std::move(each));
  }
}

void answer_with(AnswerReport report) { answer().report = std::move(report); }

bool wants_json(const std::vector<std::string>& arguments) {
  for (std::size_t i = 0; i < arguments.size(); ++i) {
    const bool next = arguments[i] == "--json" && i + 1 < arguments.size();
    if (arguments[i] == "--json=-" || (next && arguments[i + 1] == "-")) return true;
  }
  return false;
}

std::optional<AnswerReport> last_answer(int code, const std::vector<std::string>& arguments) {
  auto& report = answer().report;
  if (!report && (code == 0 || !wants_json(arguments))) return std::nullopt;
  if (!report) report = {"-", false, failure_text(code, arguments)};
  report->text = ended_report(std::move(report->text), code, answer().messages);
  return std::move(report);
}

}  // namespace batten::postproc
