// The runs of a part of a program: found, smoothed, and cut where they would be kept as a whole.
#pragma once

#include <cstdint>
#include <functional>
#include <map>
#include <memory>
#include <mutex>
#include <optional>
#include <string_view>
#include <utility>
#include <vector>

#include "gcode/text/diagnostic.h"
#include "postproc/options/options.h"
#include "postproc/runs/run_cutting.h"
#include "postproc/runs/section.h"
#include "postproc/smooth/growth.h"
#include "postproc/smooth/run_smoother.h"

namespace batten::postproc {

// Of the long runs of a program; or none.
using NearParts = std::shared_ptr<const std::vector<SelfProximity>>;

// What is known of the parts of a program's long runs before they are smoothed.
struct LongRunFacts {
  NearParts near = {};  // of a window: those of the whole program; the whole finds its own
  // Sections that are copied, for the new paths of parts crossed there. As `joined` gives them.
  std::vector<LineRange> copied = {};
};

struct PartRuns {
  std::vector<std::uint32_t> cuts;         // blocks at which long runs are cut
  std::vector<std::uint32_t> copied_cuts;  // others, where a section that is copied begins or ends
  NearParts near;
  std::vector<Section> sections;
  std::vector<RunState> works;  // of the sections that are runs, in order
  std::size_t moves = 0;        // of all runs
  std::vector<CutRun> cut_runs;
  // Of a window: the runs before it, with which it must not be worse; nothing: others may make up
  // for what is larger or farther off here.
  std::optional<PartSums> beside = {};
  std::vector<gcode::Diagnostics> notes;  // on the bands of the runs (postproc/runs/band_notes.h)
};

// Whether the user has lifted this rule.
[[nodiscard]] bool is_allowed(std::string_view reason, const SmoothOptions& options);

[[nodiscard]] GroupingOptions grouping_of(const SmoothOptions& options);
[[nodiscard]] LongRunLimits asked_of(LongRunLimits limits, const SmoothOptions& options);

// `part` must outlive the runs. A window ends where a long run is to be cut, the whole is cut here;
// but not where no method is asked for.
[[nodiscard]] PartRuns find_runs(const ProgramPart& part, const SmoothOptions& options,
                                 const LongRunLimits& limits = {}, const LongRunFacts& facts = {});

// Every run is kept, since the program was smoothed before.
void keep_as_smoothed(PartRuns& runs);

// Where the whole, or a window beside the runs before it, is worse (revert_growth).
void revert_growth_of(const ProgramPart& part, const SmoothOptions& options, PartRuns& runs);

// Called with the share of the work that is done, 0..1; false stops it.
using ProgressCallback = std::function<bool(double)>;

// Of all runs of a part and their pieces.
class RunMemos {
 public:
  // May be called from several threads.
  [[nodiscard]] RunMemo& of(const Section& section);

 private:
  std::mutex looking_;
  std::map<std::pair<std::uint32_t, std::uint32_t>, RunMemo> memos_;  // by first and last block
};

// Makes candidates for all runs and chooses among them. The same for any number of threads. False:
// the work was stopped. With memos the bands of the runs are not noted.
[[nodiscard]] bool smooth_runs(const ProgramPart& part, const SmoothOptions& options,
                               const ProgressCallback& progress, PartRuns& runs,
                               RunMemos* memos = nullptr);

// Smooths runs that the proof left no candidate of once more, in pieces, where they can be cut.
// Works and sections move. False: the work was stopped.
[[nodiscard]] bool cut_rejected_runs(const ProgramPart& part, const SmoothOptions& options,
                                     const ProgressCallback& progress, PartRuns& runs);

}  // namespace batten::postproc
