// The files of the programs that a program calls, where they stand in its folder.
#pragma once

#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include "gcode/reading/parser.h"
#include "gcode/state/subprograms.h"
#include "gcode/text/source_text.h"
#include "postproc/options/options.h"
#include "postproc/system/output_file.h"

namespace batten::postproc {

// One program that is called.
struct CalledFile {
  std::string call;     // for people: "O1234", "o<probe>", "L54", "CALL PGM PROBE"
  std::string file;     // its name in the folder; empty: there is none, or several may be it
  std::string why_not;  // why nothing is known of it; empty: it was read
};

struct CalledFiles {
  std::vector<CalledFile> files;                       // in the order in which they are called
  std::shared_ptr<const gcode::Subprograms> programs;  // nullptr: none
  std::vector<WatchedFile> watched;                    // those that were read
  std::string bytes;  // of those, each after its name: for a fingerprint
};

// Looks for each program that `source` calls, and that those call, beside `program_file`: M98 P1234
// and G65 P1234 are O1234, 1234 and O01234 with a suffix of programs or none; o<name> call is
// name.ngc; L54 is L54.SPF; CALL PGM NAME is NAME.h; in either case. Programs that are within the
// text itself are not looked for. Nothing for "-", for programs that call nothing, and beyond 100
// files or 64 MB. `reading`: how `source` is read, and they.
[[nodiscard]] CalledFiles read_called_files(const gcode::SourceText& source,
                                            const std::filesystem::path& program_file,
                                            const gcode::Reading& reading);

// The same for a program that is smoothed with these options; they then have what was read. Of a
// program that is to be translated nothing is.
[[nodiscard]] CalledFiles read_called_files(const gcode::SourceText& source,
                                            const std::filesystem::path& program_file,
                                            SmoothOptions& options);

// Lines of a summary: what is called, and what is known of it. Empty where nothing is called.
[[nodiscard]] std::string text_of(const std::vector<CalledFile>& files);

}  // namespace batten::postproc
