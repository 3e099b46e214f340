#include "postproc/commands/files.h"

#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <limits>
#include <system_error>
#include <utility>

#include "gcode/reading/dropped_words.h"
#include "postproc/stream/unit_evidence.h"
#include "postproc/system/exit_code.h"
#include "postproc/system/interrupt.h"
#include "postproc/system/other_program.h"
#include "postproc/system/terminal_colour.h"

namespace batten::postproc {

namespace {

// More notes and warnings than this hide what matters; the JSON report has them all.
constexpr std::size_t kMostRemarks = 20;

// Positions in a source are 32 bits wide (gcode/text/source_text.h).
constexpr std::size_t kMostBytes = std::numeric_limits<std::uint32_t>::max();

constexpr const char* kWasChanged = ": was changed while it was read; nothing was written";
constexpr const char* kWasReplaced =
    ": was replaced or removed while it was read; nothing was written";

// More than this of standard input goes to a file, so that it takes no memory.
constexpr std::size_t kMostBytesInMemory = std::size_t{1} << 23;

// What is read of standard input: in memory while it is short, then in a file.
class InputBuffer {
 public:
  // False: it cannot be kept; the reason was said.
  bool append(std::string_view part) {
    bytes_ += part.size();
    if (bytes_ > kMostBytes) {
      say(fmt::format("<stdin>: more than {} bytes", kMostBytes));
      return false;
    }
    text_ += part;
    return text_.size() <= kMostBytesInMemory || spool();
  }

  std::optional<gcode::SourceText> take() {
    if (!file_) return gcode::SourceText("<stdin>", std::move(text_));
    if (!spool()) return std::nullopt;
    auto text = file_->as_text("<stdin>");
    if (!text) say(file_->error());
    return text;
  }

 private:
  bool spool() {
    std::string error;
    if (!file_) {
      if (auto made = SpoolFile::make(error)) file_.emplace(std::move(*made));
    }
    if (file_ && !file_->append(text_)) error = file_->error();
    if (!error.empty()) say("<stdin>: cannot be kept: " + error);
    text_.clear();
    return error.empty();
  }

  std::size_t bytes_ = 0;
  std::string text_;
  std::optional<SpoolFile> file_;
};

std::optional<gcode::SourceText> read_standard_input() {
  InputBuffer buffer;
  std::array<char, 1 << 16> part;
  for (;;) {
    const ssize_t count = ::read(STDIN_FILENO, part.data(), part.size());
    if (count == 0) return buffer.take();
    if (count < 0 && errno == EINTR && !interrupted()) continue;
    if (count < 0) {
      say("<stdin>: cannot be read: " + std::generic_category().message(errno));
      return std::nullopt;
    }
    if (!buffer.append({part.data(), static_cast<std::size_t>(count)})) return std::nullopt;
  }
}

int write_as_is(const WriteRequest& request) {
  return exit_code_of(request.target == "-"
                          ? write_request_to_descriptor(STDOUT_FILENO, "<stdout>", request)
                          : write_file(request));
}

// The severity, the least level that it is said at, its word, and the colour of that.
struct Remark {
  gcode::Severity severity;
  LogLevel level;
  std::string_view word;
  Ink ink;
};
constexpr std::array kRemarks = {
    Remark{gcode::Severity::kNote, LogLevel::kInfo, "note", Ink::kNote},
    Remark{gcode::Severity::kWarning, LogLevel::kWarning, "warning", Ink::kWarning},
    Remark{gcode::Severity::kError, LogLevel::kError, "error", Ink::kError}};

// The severity in colour, after the place: part.nc:2:6: warning: ..
std::string with_colour(std::string text, const Remark& remark) {
  const std::size_t at = text.find(fmt::format(": {}: ", remark.word));
  if (at == std::string::npos) return text;
  return text.replace(at + 2, remark.word.size(), inked(remark.word, remark.ink, true));
}

}  // namespace

std::optional<gcode::SourceText> read_program(const std::string& name) {
  if (name == "-") return read_standard_input();
  std::string error;
  auto source = gcode::SourceText::map_file(name, error);
  if (!source) say(error);
  return source;
}

PartReading reading_of(const gcode::SourceText& source, const ReadingCommand& command,
                       gcode::SourceKind kind, std::optional<gcode::Language> fallback,
                       gcode::DwellForm dwells) {
  PartReading reading;
  reading.source = kind;
  const auto found = gcode::source_language(source, kind, fallback, reading.of_language);
  reading.text.language = found.value_or(gcode::Language::kRs274);
  reading.text.decimals =
      gcode::decimals_read(kind, command.target, reading.text.language, command.decimals);
  reading.text.units = command.units;
  reading.text.dwells = dwells;
  reading.options = {.units = command.units,
                     .calls_keep_modes = calls_keep_modes(command.allowed),
                     .asked = asked_modes(command.allowed),
                     .usual_caller_modes = usual_caller_modes(command.allowed),
                     .stated_tolerances = !command.one_tolerance,
                     .own_words = command.own_words};
  read_as(command.target, kind, reading.options);
  return reading;
}

std::optional<gcode::SourceText> read_program(const std::string& name,
                                              const std::vector<std::string>& drop,
                                              std::size_t& dropped) {
  auto source = read_program(name);
  if (!source || drop.empty()) return source;
  return gcode::without_words(*source, drop, dropped);
}

// A long computation should not end with "exists already" or "no such folder".
bool may_be_written(const std::string& file, bool replace_existing) {
  namespace fs = std::filesystem;
  if (file.empty() || file == "-") return true;
  std::error_code error;
  if (!replace_existing && fs::is_regular_file(file, error)) {
    say(file + ": exists already and was left as it is; --force replaces it");
    return false;
  }
  // Of a link, what it leads to is written.
  const bool is_link = fs::is_symlink(file, error);
  const fs::path path = is_link ? fs::weakly_canonical(file, error) : fs::path(file);
  if (is_link && error) return true;
  const fs::path folder = path.has_parent_path() ? path.parent_path() : fs::path(".");
  const bool is_device = fs::exists(path, error) && !fs::is_regular_file(path, error);
  std::string why;
  if (fs::is_directory(path, error)) {
    why = "it is a folder";
  } else if (fs::exists(folder, error) && !fs::is_directory(folder, error)) {
    why = folder.string() + " is no folder";
  } else if (!is_device && ::access(folder.c_str(), W_OK) != 0) {
    why = folder.string() + ": " + std::generic_category().message(errno);
  }
  if (why.empty()) return true;
  say(fmt::format("{}: cannot be written: {}; nothing was done", file, why));
  return false;
}

bool may_write_reports(const ReadingCommand& command) {
  return can_show(command.page) && may_be_written(command.json_file, command.force) &&
         may_be_written(command.page.file, command.force);
}

bool changed_while_read(const WatchedFile& file) {
  if (file.now() != FileNow::kChanged) return false;
  say(file.path().string() + kWasChanged);
  return true;
}

bool can_show(const PageRequest& request) {
  const std::string objection = request.open ? objection_to_showing() : "";
  if (!objection.empty()) say(objection);
  return objection.empty();
}

bool changed_while_read(const CalledFiles& called) {
  bool changed = false;
  for (const WatchedFile& file : called.watched) changed |= changed_while_read(file);
  return changed;
}

int end_interrupted() {
  say("interrupted; nothing was written");
  return interrupt_exit_code();
}

int write_result(const std::string& name, std::string_view bytes, bool replace_existing) {
  return write({.target = name, .bytes = bytes, .replace_existing = replace_existing});
}

int end_command(int code, const std::vector<std::string>& arguments) {
  const auto answer = last_answer(code, arguments);
  if (!answer) return code;
  WriteRequest request{
      .target = answer->file, .bytes = answer->text, .replace_existing = answer->replace_existing};
  // The signal that has ended the work does not end this.
  if (!interrupted()) request.stop = interrupted;
  const int written = write_as_is(request);
  return code != 0 ? code : written;
}

int write_page(const PageRequest& request, bool replace_existing, const std::string& program,
               std::string_view page) {
  if (!request.is_wanted()) return 0;
  std::string file = request.file;
  if (file.empty()) {
    namespace fs = std::filesystem;
    std::string folder = (fs::temp_directory_path() / "batten-XXXXXX").string();
    if (::mkdtemp(folder.data()) == nullptr) {
      say(folder + ": cannot be made: " + std::generic_category().message(errno));
      return static_cast<int>(ExitCode::kFileError);
    }
    const std::string name = program == "-" ? "stdin" : fs::path(program).filename().string();
    file = (fs::path(folder) / (name + ".html")).string();
  }
  if (const int code = write_result(file, page, replace_existing); code != 0) return code;
  if (!request.open) return 0;
  const std::string problem = show_file(file);
  if (!problem.empty()) say(problem);
  return static_cast<int>(problem.empty() ? ExitCode::kDone : ExitCode::kFileError);
}

int write(WriteRequest request) {
  request.stop = interrupted;
  return write_as_is(request);
}

int exit_code_of(const WriteResult& result) {
  if (result.status == WriteStatus::kWritten) return static_cast<int>(ExitCode::kDone);
  say(result.message);
  if (result.status == WriteStatus::kInterrupted) return interrupt_exit_code();
  return static_cast<int>(ExitCode::kFileError);
}

std::string objection_to_place_of(const WatchedFile& input) {
  switch (input.now()) {
    case FileNow::kChanged:
      return input.path().string() + kWasChanged;
    case FileNow::kReplaced:
      return input.path().string() + kWasReplaced;
    case FileNow::kSame:
      break;
  }
  return "";
}

void print(const gcode::Diagnostics& diagnostics, const gcode::SourceText& source, LogLevel level) {
  answer_with(diagnostics, source);
  const bool colour = shows_colour();
  std::size_t remarks = 0;
  for (const gcode::Diagnostic& diagnostic : diagnostics) {
    const Remark& remark = *std::ranges::find(kRemarks, diagnostic.severity, &Remark::severity);
    if (remark.level > level) continue;
    if (remark.level != LogLevel::kError && ++remarks > kMostRemarks) continue;
    std::string text = gcode::to_text(diagnostic, source);
    if (colour) text = with_colour(std::move(text), remark);
    say_lines(text + "\n");
  }
  if (remarks > kMostRemarks) {
    say(fmt::format("{} more notes and warnings, see --json", remarks - kMostRemarks));
  }
}

void print(gcode::Diagnostics& diagnostics, const gcode::SourceText& source, LogLevel level,
           std::string_view command_line) {
  const bool is_missing = tell_unit_evidence(source.text(), diagnostics);
  print(std::as_const(diagnostics), source, level);
  if (is_missing && !command_line.empty()) {
    say_lines(commands_with_units(command_line, unit_evidence(source.text()).likely));
  }
}

void say(std::string_view message) {
  answer_with(message);
  say_lines(fmt::format("batten: {}\n", message));
}

void say_lines(std::string_view text) { std::fputs(as_valid_utf8(text).c_str(), stderr); }

}  // namespace batten::postproc
