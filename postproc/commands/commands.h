// The commands of the program, with their options read and checked. Each runs from files to
// files, says on standard error what a user must know, and returns the exit code of the program.
#pragma once

#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "gcode/reading/source_kind.h"
#include "gcode/state/modal_state.h"
#include "geometry/basic/point.h"
#include "postproc/batch/program_tree.h"
#include "postproc/options/options.h"
#include "postproc/profile/target_profile.h"
#include "postproc/stream/progress.h"

namespace batten::postproc {

// File names as the user gave them; "-" is standard input or output, "" is not given.

// The report as a page for a browser.
struct PageRequest {
  std::string file;   // not given with `open`: in the folder for temporary files
  bool open = false;  // it is shown, too

  [[nodiscard]] bool is_wanted() const { return open || !file.empty(); }
};

// How programs are smoothed, one or all of a tree.
struct SmoothingCommand {
  SmoothOptions options;
  std::shared_ptr<const Machine> own_machine;        // keeps the machine of the options alive
  std::shared_ptr<const TargetProfile> profile;      // and a target
  std::shared_ptr<const gcode::Control> own_target;  // as the machine is set up
  ProgressStyle progress = ProgressStyle::kAuto;
  bool force = false;   // existing files may be replaced
  bool strict = false;  // a run that could not be proved is an error, not a reason to keep it
  std::vector<std::string> drop;  // words that are taken out of the program first
  // What the command line did not give, and where it comes from.
  std::vector<std::pair<std::string, std::string>> origins;
  std::string command_line;  // as it was called; may be empty
};

struct SmoothCommand : SmoothingCommand {
  std::string input;
  std::string output;  // not given: default_output_path(input), or standard output for "-"
  std::string json_file;
  std::string certificate_file;
  PageRequest page;
  LogLevel log_level = LogLevel::kInfo;
  bool in_place = false;
  bool dry_run = false;  // everything but writing the program
};
[[nodiscard]] int run(const SmoothCommand& command);

// Several programs, one after the other, each to its own default output. The exit code is the
// greatest of them.
struct SmoothFilesCommand {
  std::vector<SmoothCommand> each;
  std::vector<std::string> left_out;  // outputs of others of them
};
[[nodiscard]] int run(const SmoothFilesCommand& command);

// Writes a configuration file.
struct SetupCommand {
  std::string file;
  std::string text;
  std::string json_file;
  bool asks = false;   // nothing was given, and the file may be written
  bool force = false;  // an existing file is replaced
};
[[nodiscard]] int run(const SetupCommand& command);

// All programs of a folder tree (postproc/batch/).
struct BatchCommand : SmoothingCommand {
  std::string settings;  // everything that the bytes of a result depend on, as text
  std::string input_tree;
  std::string output_tree;
  std::vector<std::string> suffixes;
  std::string json_file;
  int jobs = 0;  // 0: as many as there are processors
  Shard shard;
  bool pages = false;  // a page for each program
  bool open = false;   // the page of all is shown
  bool fail_fast = false;
};
[[nodiscard]] int run(const BatchCommand& command);

// What could be had with other tolerances, forms and preferences: a table, nothing is written.
struct ExploreCommand {
  SmoothCommand smooth;                        // its input, JSON, progress and log level
  std::vector<SmoothOptions> settings;         // of explore_program
  std::vector<std::string> options_of_smooth;  // for the command that is recommended, as given
};
[[nodiscard]] int run(const ExploreCommand& explore);

// How programs are read where none is written.
struct ReadingCommand {
  gcode::Units units = gcode::Units::kUnknown;
  gcode::SourceKind source = gcode::SourceKind::kAuto;
  std::optional<gcode::Decimals> decimals;  // as SmoothOptions::decimals
  const gcode::Control* target = nullptr;   // whose curves are read; nullptr: none are
  std::vector<std::string> allowed;  // of these `subprogram` and `caller-modes` change what is read
  std::shared_ptr<const gcode::OwnWords> own_words;
  bool one_tolerance = false;  // as SmoothOptions::one_tolerance
  std::string json_file;
  PageRequest page;
  LogLevel log_level = LogLevel::kInfo;
  bool force = false;
  std::string command_line;  // as it was called; may be empty
};

struct VerifyCommand : ReadingCommand {
  std::string old_program;
  std::string new_program;
  std::vector<std::string> drop;  // as smooth dropped them, of the old program
  double tolerance_mm = 0.01;
  geometry::ToleranceKind tolerance_kind = geometry::ToleranceKind::kPath;
  geometry::Side side = geometry::Side::kBoth;
  std::shared_ptr<const TargetProfile> profile;      // whose words the new program may have
  std::shared_ptr<const gcode::Control> own_target;  // as a machine is set up
  std::string certificate_file;                      // of --tolerance-kind path only
  bool twice = false;                                // --second-check
};
[[nodiscard]] int run(const VerifyCommand& command);

struct InspectCommand : ReadingCommand {
  std::string input;
  const gcode::Control* runs_it = nullptr;       // as which it is read; nullptr: any
  std::shared_ptr<const TargetProfile> profile;  // keeps it alive
};
[[nodiscard]] int run(const InspectCommand& command);

// Without a target dwells are those of the machine's control.
struct TimeCommand : ReadingCommand {
  std::string input;
  std::shared_ptr<const Machine> machine;  // required
  std::optional<geometry::Point3> start;   // mm: where the tool is before the program
  FeedPlanner planner = FeedPlanner::kControl;
  double feed_override = 1;            // see StepOptions
  bool bound = false;                  // tells what is left to win
  std::optional<double> tolerance_mm;  // within which a path may be for that
  std::string profile_file;
  std::shared_ptr<const TargetProfile> profile;  // keeps a target of a file alive
};
[[nodiscard]] int run(const TimeCommand& command);

// Puts the post script where FreeCAD looks for it (postproc/hosts/freecad_post.h).
struct FreecadCommand {
  std::string freecad;  // the program to ask, not given: the one in PATH
  std::string folder;   // given: nobody is asked
  std::string json_file;
  bool uninstall = false;
  bool force = false;  // a file of the post's name that is not ours is replaced, or removed
};
[[nodiscard]] int run(const FreecadCommand& command);

// What is built in, as a table on standard output; or one of it as a file that says everything.
enum class BuiltIn { kTargets, kMachines, kMethods };
struct ListCommand {
  BuiltIn what = BuiltIn::kTargets;
  const gcode::Control* target = nullptr;  // its profile
  std::shared_ptr<const Machine> machine = nullptr;
  std::string json_file;
  bool force = false;
};
[[nodiscard]] int run(const ListCommand& command);

// What each method makes of the paths of a file (docs/algorithms/methods.md has the format), as
// tables on standard output, each when it is known.
struct MethodsCommand {
  std::string table_file;              // - is standard input
  std::optional<double> tolerance_mm;  // in place of the file's
  double guo_lambda = 0;
  std::string json_file;
  bool force = false;
};
[[nodiscard]] int run(const MethodsCommand& command);

}  // namespace batten::postproc
