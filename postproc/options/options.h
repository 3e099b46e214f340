// What the user asks for, checked, with units.
#pragma once

#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "gcode/control/control.h"
#include "gcode/interpreter/interpreter.h"
#include "gcode/reading/source_kind.h"
#include "gcode/state/modal_state.h"
#include "gcode/state/own_words.h"
#include "gcode/text/language.h"
#include "geometry/basic/tolerance_kind.h"
#include "postproc/machine/machine.h"
#include "postproc/options/profile_words.h"

namespace batten::postproc {

enum class Form { kAuto, kArcs, kLines, kCurves };
enum class Method {
  kBest,
  kFair,
  kTimeOptimal,
  kTube,
  kNaseath,
  kGuo,
  kOzcan,
  kNaseathLiteral,
  kGuoLiteral,
  kOzcanUsual,
  kNone,
};
enum class Prefer { kTime, kAccuracy, kSize };
enum class Linearize { kMinLink, kChord, kIlca, kBlca };

// A value that the user chooses by name.
template <typename Value>
// NOLINTNEXTLINE(clang-analyzer-optin.performance.Padding): rows of short tables
struct Choice {
  Value value;
  std::string_view name;
  std::string_view text;  // one line for the user
  bool in_help = true;    // false: taken, but only `batten methods` and messages name it
};

[[nodiscard]] std::span<const Choice<Form>> forms();
[[nodiscard]] std::span<const Choice<Method>> methods();
[[nodiscard]] std::span<const Choice<Prefer>> preferences();
[[nodiscard]] std::span<const Choice<Linearize>> linearizations();
[[nodiscard]] std::span<const Choice<geometry::ToleranceKind>> tolerance_kinds();
[[nodiscard]] std::span<const Choice<geometry::Side>> sides();
[[nodiscard]] std::span<const Choice<geometry::Seam>> seams();
[[nodiscard]] std::span<const Choice<gcode::SourceKind>> sources();

[[nodiscard]] std::string_view name_of(Form form);
[[nodiscard]] std::string_view name_of(Method method);
[[nodiscard]] std::string_view name_of(Prefer prefer);
[[nodiscard]] std::string_view name_of(Linearize linearize);
[[nodiscard]] std::string_view name_of(geometry::ToleranceKind kind);
[[nodiscard]] std::string_view name_of(geometry::Side side);
[[nodiscard]] std::string_view name_of(geometry::Seam seam);
[[nodiscard]] std::string_view name_of(gcode::Units units);  // "mm", "inch", "unknown"

// Whether the method leaves the lines and puts a curve at each corner by itself: guo, ozcan,
// racing.
[[nodiscard]] bool is_of_corners(Method method);

// Whether it rounds the corner in which a closed run begins, where that is asked for.
[[nodiscard]] bool may_round_seams(Method method);

// Whether there may be arcs in runs of this form: the ends of arcs have decimals of their own.
[[nodiscard]] bool may_have_arcs(Form form);

// Decisions of `smooth`, without files and messages.
struct SmoothOptions {
  const gcode::Control* target = nullptr;  // required
  const Machine* machine = nullptr;        // required; never null after options are checked
  double tolerance_mm = 0.01;              // the full distance allowed, both ways, in order
  std::optional<double> tolerance_inch;    // as given, where it was given in inches
  // It counts for all parts; else the lesser one where the program says one for a part.
  bool one_tolerance = false;
  geometry::ToleranceKind tolerance_kind = geometry::ToleranceKind::kPath;
  geometry::Side side = geometry::Side::kBoth;          // where the new path may be; needs kPath
  gcode::Units units = gcode::Units::kUnknown;          // --units
  gcode::SourceKind source = gcode::SourceKind::kAuto;  // --source
  std::optional<gcode::Decimals> decimals;              // --decimals; nothing: auto
  Method method = Method::kBest;
  Form output = Form::kAuto;
  Prefer prefer = Prefer::kTime;
  double guo_lambda = 0;                          // of guo-literal, see geometry::GuoOptions
  geometry::Seam seam = geometry::Seam::kCorner;  // of closed runs
  std::optional<Linearize> linearize;             // nothing: what serves `prefer`, see linearize_of
  std::optional<double> keep_corners_deg;         // turns above this stay corners
  std::vector<std::string> allowed;               // --allow
  std::shared_ptr<const gcode::OwnWords> own_words;  // --word, and of a profile; nullptr: none
  std::shared_ptr<const gcode::Subprograms>
      subprograms;                // files of called programs, as they were read
  bool keep_expressions = false;  // blocks whose numbers are expressions stay as they are
  bool convert = false;  // a program of another family is taken where every block can be said
  ProfileWords words;    // that a profile adds; its target is `target`
  std::string profile;   // the profile's file, for reports; empty: none
  int threads = 0;       // 0: all cores
  // Runs of one shape are smoothed once in a window (postproc/smooth/repeated_runs.h), and some of
  // many that are alike tell in which forms the others are made (selection/form_record.h). Without,
  // each comes out as it does alone.
  bool share_work = true;
  std::vector<double> timed_feeds;  // the program is timed with its feeds so many times, too
  bool quick = false;  // less effort for few moves, all forms from the same curves: for a survey
};

// How lines are laid along a curve: as the user said, otherwise minlink for the fewest bytes and
// chords, whose ends are nearer to the path that was meant, for time and accuracy.
[[nodiscard]] Linearize linearize_of(const SmoothOptions& options);

// Whether the whole tolerance may be spent on fewer moves: who wants the fewest bytes, and who asks
// for arcs by name.
[[nodiscard]] bool wants_few_moves(const SmoothOptions& options);

// Radians: vertices that turn more stay as they are.
[[nodiscard]] double keep_corner_angle_of(const SmoothOptions& options);

// Whether they say that what is called leaves all modes as it finds them (reason `subprogram`).
[[nodiscard]] bool calls_keep_modes(std::span<const std::string> allowed);

// Sets how a program for this target is read; nullptr: one for any. What only that control has or
// lacks counts where the program was written for no other. A target without curves of its own gets
// those of the control that the program was written for. Its own words are added.
void read_as(const gcode::Control* target, gcode::SourceKind source, gcode::ReadOptions& reading);

// Whether they say that programs that others call are called under the modes of power-on (reason
// `caller-modes`).
[[nodiscard]] bool usual_caller_modes(std::span<const std::string> allowed);

// The modes without which nothing is rewritten: all, but those that an option lifts.
[[nodiscard]] gcode::ModeSet asked_modes(std::span<const std::string> allowed);

// How programs are read under these options.
[[nodiscard]] gcode::ReadOptions read_options_of(const SmoothOptions& options);

// Every problem of the options at once, as sentences; empty when they are fine.
[[nodiscard]] std::vector<std::string> problems_of(const SmoothOptions& options);

// Those of --side alone: under the band reading corners may be cut on the inside, whatever side
// that is.
[[nodiscard]] std::vector<std::string> problems_of_side(geometry::Side side,
                                                        geometry::ToleranceKind kind);

// Those of --allow alone: reason ids that do not exist or that cannot be lifted.
[[nodiscard]] std::vector<std::string> problems_of_allowed(std::span<const std::string> ids);

// How the user's tolerance is shared: smoothing + form + rounding <= tolerance.
//
//  1. The proof bounds a distance from above and may come out 2 % of the tolerance too large
//     (geometry/distance/path_distance.h), so 98 % of the tolerance are given out.
//  2. `rounding` is what printing can move a place in space: half a step of the last decimal on
//     each of three axes, sqrt(3) of it together. Where arcs may be written, their centre offsets
//     are rounded too: half a step on two axes, sqrt(2) together, which moves no place of an arc
//     that spans less than pi by more than itself.
//  3. `form` is a third of the rest, `smoothing` the other two thirds: chords and arcs cost
//     blocks by the square root of their share only, the curve gains by its share directly.
//
// When rounding alone uses up the tolerance, `smoothing` and `form` are 0: nothing can be
// rewritten with these decimals.
struct ToleranceShares {
  double smoothing = 0;  // mm, fair curve to old path
  double form = 0;       // mm, arcs or chords to fair curve
  double rounding = 0;   // mm, printed places to computed ones, in space
};

// `units` are those of the written program; unknown ones count as millimetres. `run_decimals`
// is for runs that are written with more decimals than the target's usual ones, `tolerance_mm` for
// those that have to keep another tolerance than the user's.
[[nodiscard]] ToleranceShares share_tolerance(const SmoothOptions& options, gcode::Units units,
                                              int run_decimals = 0,
                                              std::optional<double> tolerance_mm = {});

// How much is said on standard error.

enum class LogLevel {
  kError,    // what ends or stops the work
  kWarning,  // and what is doubtful in a program
  kInfo,     // and notes, the summary, progress
};

[[nodiscard]] std::span<const Choice<LogLevel>> log_levels();

// --decimals: what a number without a point means, as the user says.

// "explicit", "implied", and "implied:0.0001" for the least increment of millimetre programs, which
// is a power of ten. Nothing for "auto", and with a problem for anything else.
[[nodiscard]] std::optional<gcode::Decimals> read_decimals(std::string_view text,
                                                           std::vector<std::string>& problems);

// The same back: "auto" for nothing.
[[nodiscard]] std::string text_of(const std::optional<gcode::Decimals>& declared);

// Why this cannot be so for this source and this target (nullptr: none is named); empty where it
// can.
[[nodiscard]] std::vector<std::string> problems_of_decimals(
    const std::optional<gcode::Decimals>& declared, gcode::SourceKind source,
    const gcode::Control* target);

}  // namespace batten::postproc
