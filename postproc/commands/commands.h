// The commands of the program, with their options read and checked. Each runs from files to
// files, says on standard error what a user must know, and returns the exit code of the program.
#pragma once

#include <memory>
#include <string>

#include "gcode/modal_state.h"
#include "postproc/options.h"
#include "postproc/progress.h"
#include "postproc/target_profile.h"

namespace batten::postproc {

// File names as the user gave them; "-" is standard input or output, "" is not given.

struct SmoothCommand {
  SmoothOptions options;
  std::shared_ptr<const Machine> own_machine;    // keeps a machine read from a file alive
  std::shared_ptr<const TargetProfile> profile;  // and a target
  std::string input;
  std::string output;  // not given: default_output_path(input), or standard output for "-"
  std::string json_file;
  std::string report_file;   // the page for a browser
  std::string command_line;  // as it was called, for that page; may be empty
  ProgressStyle progress = ProgressStyle::kAuto;
  bool in_place = false;
  bool force = false;    // existing files may be replaced
  bool strict = false;   // a run that could not be proved is an error, not a reason to keep it
  bool dry_run = false;  // everything but writing the program
};
[[nodiscard]] int run(const SmoothCommand& command);

struct VerifyCommand {
  std::string old_program;
  std::string new_program;
  double tolerance_mm = 0.01;
  geometry::ToleranceKind tolerance_kind = geometry::ToleranceKind::kPath;
  gcode::Units units = gcode::Units::kUnknown;
  std::shared_ptr<const TargetProfile> profile;  // whose words the new program may have
  const gcode::Dialect* target = nullptr;        // whose curves are read; nullptr: none are
  std::string json_file;
  bool force = false;
};
[[nodiscard]] int run(const VerifyCommand& command);

struct InspectCommand {
  std::string input;
  gcode::Units units = gcode::Units::kUnknown;
  std::vector<std::string> allowed;
  std::string json_file;
  bool force = false;
};
[[nodiscard]] int run(const InspectCommand& command);

// What is built in, as a table on standard output.
enum class BuiltIn { kTargets, kMachines, kMethods };
struct ListCommand {
  BuiltIn what = BuiltIn::kTargets;
  const gcode::Dialect* show = nullptr;  // kTargets: this one's profile instead of the table
  std::string json_file;
  bool force = false;
};
[[nodiscard]] int run(const ListCommand& command);

}  // namespace batten::postproc
