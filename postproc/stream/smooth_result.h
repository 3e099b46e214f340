// What smoothing a program gives, what it says of it, and whether it may be written.
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "gcode/control/control.h"
#include "gcode/state/modal_state.h"
#include "gcode/state/motion.h"
#include "gcode/text/diagnostic.h"
#include "gcode/text/program.h"
#include "postproc/proof/verification.h"
#include "postproc/runs/kept_causes.h"
#include "postproc/runs/section.h"
#include "postproc/smooth/forms/output_plan.h"
#include "postproc/smooth/part_runs.h"
#include "postproc/smooth/selection/selection.h"
#include "postproc/stream/program_timers.h"
#include "postproc/system/exit_code.h"

namespace batten::postproc {

enum class RunStatus { kRewritten, kKept };

// How far a path is from the one that was meant, and how rough. docs/algorithms/choice.md.
struct PathFigures {
  double length_mm = 0;    // that the figures are known of
  double distance_mm = 0;  // rms
  double roughness = 0;    // rad/sqrt(mm)

  // Of both together.
  PathFigures& operator+=(const PathFigures& other);
};

// One run of the report. Also verbatim chains of cutting moves appear, kept, with their reason.
struct RunReport {
  std::uint32_t first_line = 0;
  std::uint32_t last_line = 0;
  std::size_t points = 0;
  double tolerance_mm = 0;  // what it has to keep: the user's, or less where the program says so
  RunStatus status = RunStatus::kKept;
  std::string_view reason;          // why it was kept; empty when rewritten
  std::string_view method;          // that made what stands there now; empty where it was kept
  std::vector<MethodTime> methods;  // all that were tried, whether it was rewritten or not
  Form form = Form::kLines;
  bool had_curves = false;  // it was said in the target's curve words
  std::size_t blocks_in = 0;
  std::size_t blocks_out = 0;
  std::size_t computed_blocks = 0;  // of a rewritten run: with expressions, which are numbers now
  double deviation_mm = 0;          // proved bound
  bool proved = false;
  bool chords_for_steps = false;  // see OutputPlan
  bool arcs_as_chords = false;
  bool is_cut_short = false;  // see SmoothedRun
  bool closed = false;        // it ends where it begins; of a cut run its first part
  bool rounds_seam = false;   // what stands there now rounds the corner in which it does
  double noise_mm = 0;
  double coarse_part = 0;           // of its vertices, whose chords are coarser than the tolerance
  double max_curvature_before = 0;  // 1/mm, circle through three neighbouring vertices
  double max_curvature_after = 0;
  double time_before_s = 0;
  double time_after_s = 0;
  std::size_t bytes_in = 0;
  std::size_t bytes_out = 0;
  PathFigures path_before;  // of runs that were tried
  PathFigures path_after;
};

// What became of the runs, in the order of the program; `compared` and `proved` of the proof.
[[nodiscard]] std::vector<RunReport> report_runs(const ProgramPart& part, const PartRuns& runs,
                                                 double user_tolerance_mm,
                                                 std::span<const ComparedSection> compared,
                                                 bool proved);

// What the program says of how exact it has to be, from a line on until the next of these.
struct StatedFrom {
  std::uint32_t line = 0;
  std::optional<double> tolerance_mm;  // nothing: it asks for none any more
};

// In one part of the program.
[[nodiscard]] std::vector<StatedFrom> stated_in(const gcode::Program& part,
                                                const gcode::Interpretation& meaning);

// Behind what the parts before it have said, but for what says the same again.
void add_stated(const std::vector<StatedFrom>& part, std::vector<StatedFrom>& all);

struct SmoothResult {
  std::string text;  // the new program, where it was not handed on as it came; or empty
  std::vector<RunReport> runs;
  std::vector<StatedFrom> stated;
  KeptCauses kept;
  gcode::Diagnostics diagnostics;
  bool understood = false;  // false: nothing may be rewritten (no units ..): exit code 2
  gcode::Units units = gcode::Units::kUnknown;
  std::size_t blocks_in = 0;
  std::size_t blocks_out = 0;
  std::size_t added_lines = 0;  // words of the profile
  double deviation_mm = 0;
  std::uint32_t deviation_line = 0;
  double corner_mm = 0;      // band reading: greatest distance of a corner that was cut
  double runs_before_s = 0;  // their cutting moves only
  double runs_after_s = 0;
  TimeFigures program_before;  // the source, and what is written
  TimeFigures program_after;
  PathFigures path_before;
  PathFigures path_after;
  Outlook outlook;
  bool proved = false;  // of the whole text
  std::size_t bytes_out = 0;
};

// The first that are known.
[[nodiscard]] gcode::Units first_units(const gcode::Interpretation& meaning);

// Called now and then with the part that is done, 0..1. Returning false stops the work: the
// result then is not understood and carries no text.
using Progress = std::function<bool(double)>;

// kDone, kNotUnderstood or kNotProved; only what is kDone may be written. `strict`: a run that was
// kept because it could not be proved counts as not proved.
[[nodiscard]] ExitCode judge(const SmoothResult& result, std::string_view source, bool strict);

// Why nothing was written, for the user. Requires a verdict other than kDone.
[[nodiscard]] std::string_view complaint(ExitCode verdict, bool strict);

// What a user must know of the runs that were written, at the first run that it is true of:
// - the note `missing-provenance` where the target has no certain comment: nothing in the text says
//   then that it was smoothed;
// - the warning `curves-unverified` for curves, in the words of the target's CurveFormat::caution;
// - the note `chords-for-steps` for chords in the place of the equal steps that were asked for;
// - the note `arcs-as-chords` for those in the place of arcs that the target would cut too
// coarsely. `program` may be the part of it with these runs.
[[nodiscard]] gcode::Diagnostics notes_on_runs(std::span<const RunReport> runs,
                                               const gcode::Program& program,
                                               const gcode::Control& target);

// What became of the closed runs of a program whose seams are to be rounded, added up window by
// window.
class SeamTally {
 public:
  // `program`: the part of it with these runs.
  void add(std::span<const RunReport> runs, const gcode::Program& program);
  SeamTally& operator+=(const SeamTally& next);

  // The note `seam-not-rounded` where no seam is rounded, at the first closed run or else at the
  // begin of the program.
  [[nodiscard]] gcode::Diagnostics diagnostics() const;

 private:
  std::size_t closed_ = 0;
  std::size_t rounded_ = 0;
  std::optional<gcode::SourceSpan> first_closed_;
};

}  // namespace batten::postproc
