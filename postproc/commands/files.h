// Reading and writing as all commands do it: "-" for the standard streams, messages on standard
// error.
#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "gcode/text/diagnostic.h"
#include "gcode/text/source_text.h"
#include "postproc/commands/answer.h"
#include "postproc/commands/commands.h"
#include "postproc/options/options.h"
#include "postproc/stream/called_files.h"
#include "postproc/stream/part_reader.h"
#include "postproc/system/output_file.h"

namespace batten::postproc {

// Reads a file, or standard input to its end. On failure says why and returns nothing.
[[nodiscard]] std::optional<gcode::SourceText> read_program(const std::string& name);

// The same without the words that the user drops (--drop; gcode/reading/dropped_words.h), `dropped`
// of them.
[[nodiscard]] std::optional<gcode::SourceText> read_program(const std::string& name,
                                                            const std::vector<std::string>& drop,
                                                            std::size_t& dropped);

// Asked before the work: false, and it was said why, where this output (empty: none; "-": standard
// output) exists and may not be replaced, or cannot be written where it is to be.
[[nodiscard]] bool may_be_written(const std::string& file, bool replace_existing);

// The same of the JSON report and the page of a command that writes no program, and whether the
// page can be shown.
[[nodiscard]] bool may_write_reports(const ReadingCommand& command);

// How a command that writes no program reads this one. `kind`: the control that it was written for;
// `fallback`: what a text without certain marks is read in; `dwells`: what its G4 means.
// `of_language` of the result has an error where the language is not certain.
[[nodiscard]] PartReading reading_of(const gcode::SourceText& source, const ReadingCommand& command,
                                     gcode::SourceKind kind,
                                     std::optional<gcode::Language> fallback,
                                     gcode::DwellForm dwells = gcode::DwellForm::kUnknown);

// Of any of these, as of a program.
[[nodiscard]] bool changed_while_read(const CalledFiles& called);

// Asked when all was read: was the file written into since it is watched? Then what was made of it
// is worth nothing, and this says so.
[[nodiscard]] bool changed_while_read(const WatchedFile& file);

// Asked before the work: can what is to be shown be shown? If not, says why.
[[nodiscard]] bool can_show(const PageRequest& request);

// Says that a signal ended the work before anything was written, and returns its exit code.
[[nodiscard]] int end_interrupted();

// The functions below return 0 when all is written; else they say why and return the exit code.

[[nodiscard]] int write_result(const std::string& name, std::string_view bytes,
                               bool replace_existing);

// Of a JSON report: its text is made only where the name is not empty, and written when the
// command has ended (postproc/commands/answer.h).
template <typename Text>
void write_report(const std::string& name, bool replace_existing, const Text& text) {
  if (!name.empty()) answer_with({name, replace_existing, text()});
}

// When a command has ended: writes what last_answer gives. Returns `code`, or why that could not be
// written.
[[nodiscard]] int end_command(int code, const std::vector<std::string>& arguments);

// Of a page, shown too where that is asked for. `program`: what it is about.
[[nodiscard]] int write_page(const PageRequest& request, bool replace_existing,
                             const std::string& program, std::string_view page);

// As the request says, until a signal comes; "-" is standard output.
[[nodiscard]] int write(WriteRequest request);

// Why a program may not be put in the place of the one that it was made of: that one was written
// into, put away or replaced meanwhile. Empty: it may.
[[nodiscard]] std::string objection_to_place_of(const WatchedFile& input);

[[nodiscard]] int exit_code_of(const WriteResult& result);

// file:line:column lines on standard error: all errors, notes and warnings up to a readable number
// and as far as `level` wants them. On a terminal with colours.
void print(const gcode::Diagnostics& diagnostics, const gcode::SourceText& source,
           LogLevel level = LogLevel::kInfo);

// The same. Where a unit is missing, the message also says for which one the numbers of the program
// speak, and the command line follows, with --units, to be copied.
void print(gcode::Diagnostics& diagnostics, const gcode::SourceText& source, LogLevel level,
           std::string_view command_line);

// "batten: message" on standard error.
void say(std::string_view message);

// Whole lines on standard error, as they are but for bytes that are not UTF-8.
void say_lines(std::string_view text);

}  // namespace batten::postproc
