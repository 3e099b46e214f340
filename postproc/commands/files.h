// Reading and writing as all commands do it: "-" for the standard streams, messages on standard
// error.
#pragma once

#include <cstddef>
#include <functional>
#include <optional>
#include <string>
#include <string_view>

#include "gcode/text/diagnostic.h"
#include "gcode/text/source_text.h"
#include "postproc/options/options.h"
#include "postproc/system/output_file.h"

namespace batten::postproc {

// Reads a file, or standard input to its end. On failure says why and returns nothing.
[[nodiscard]] std::optional<gcode::SourceText> read_program(const std::string& name);

// Was the file written into since it is watched? Then what was made of it is worth nothing, and
// this says so. To be asked when all was read.
[[nodiscard]] bool changed_while_read(const WatchedFile& file);

// Says that a signal ended the work before anything was written, and returns its exit code.
// Requires interrupted() (postproc/system/interrupt.h).
[[nodiscard]] int end_interrupted();

// 0 when written; else says why and returns the exit code.
[[nodiscard]] int write_result(const std::string& name, std::string_view bytes,
                               bool replace_existing);

// The same for a program in the place of the one that it was made of: not where that one was
// written into, put away or replaced meanwhile.
[[nodiscard]] int write_in_place_of(const WatchedFile& input, std::string_view bytes);

// Why no program may be put in the place of this one, which it was made of; empty: it may.
[[nodiscard]] std::string objection_to_place_of(const WatchedFile& input);

// The same of something that was written: 0, or the exit code, with the reason said.
[[nodiscard]] int exit_code_of(const WriteResult& result);

// The same for a file that is made part by part.
[[nodiscard]] int write_parts(const std::string& name,
                              const std::function<void(const PartWriter&)>& parts,
                              bool replace_existing);

// file:line:column lines on standard error: errors all, notes and warnings up to a readable
// number and as far as `level` wants them. On a terminal with colours.
void print(const gcode::Diagnostics& diagnostics, const gcode::SourceText& source,
           LogLevel level = LogLevel::kInfo);

// "batten: message" on standard error.
void say(std::string_view message);

// Whole lines on standard error, as they are but for bytes that are not UTF-8
// (postproc/system/terminal_colour.h).
void say_lines(std::string_view text);

}  // namespace batten::postproc
