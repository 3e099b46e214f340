// A long run cut into pieces, so that those that gain are rewritten and the others stay.
// Method: docs/algorithms/fair.md, section Long runs.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <utility>
#include <vector>

#include "gcode/state/motion.h"
#include "gcode/text/program.h"
#include "geometry/band/self_proximity.h"
#include "geometry/basic/point.h"
#include "postproc/machine/models/cycle_time.h"
#include "postproc/runs/run_grouping.h"
#include "postproc/runs/section.h"

namespace batten::postproc {

struct CuttingOptions {
  // By vertices, of which an arc has several.
  std::size_t shortest = 60;  // in a piece, but for a run that is shorter itself
  std::size_t longest = 400;  // in a piece, but where it cannot be cut
};

// Whether it makes more than two pieces.
[[nodiscard]] inline bool is_long(const Run& run) {
  return run.points.size() > 2 * CuttingOptions{}.longest;
}

// The vertices at which a run is cut, increasing, neither its first nor its last: where a cut
// costs least (Fitness); never within an arc, nor before one that takes its G2 or G3 from the block
// before it. Linear cost; they depend on the path alone.
[[nodiscard]] std::vector<std::size_t> cut_places(const Run& run, const CuttingOptions& options);

// A part of a run as a section of its own.
struct RunPiece {
  Section section;        // content is a Run
  std::size_t first = 0;  // vertices of the whole run
  std::size_t last = 0;
};

// The parts cover the section's blocks, each once. A cut is left out where blocks that do not
// move are between the motions that meet there. One part when nothing can be cut.
[[nodiscard]] std::vector<RunPiece> cut_run(const Section& section,
                                            const gcode::Interpretation& interpretation,
                                            const CuttingOptions& options);

// How good a vertex is to cut a path into runs, the greater the better: reversals, else the
// sharpest corner, else within a straight line, else where the path turns least.
using Fitness = std::pair<int, double>;  // rank, and within it

// Of the vertex `at` between its neighbours.
[[nodiscard]] Fitness split_score_at(const geometry::Point3& before, const geometry::Point3& at,
                                     const geometry::Point3& after);

// A block that begins a run of its own.
struct LongRunCut {
  std::uint32_t line = 0;   // from 1
  std::uint32_t begin = 0;  // bytes
};

struct CutCandidate {
  std::size_t vertex = 0;
  Fitness split_score;
  LongRunCut block = {};  // of a program that is being read
};

// The best one up to `furthest`, of equals the last: fewer parts. Beyond `furthest` only where
// there is none, and none beyond `end`. `candidates` in order.
[[nodiscard]] const CutCandidate* best_cut(std::span<const CutCandidate> candidates,
                                           std::size_t furthest, std::size_t end);

// Lines of the old program, inclusive.
struct LineRange {
  std::uint32_t first = 0;
  std::uint32_t last = 0;
};

// Of one long run.
struct SelfProximity {
  std::uint32_t first_line = 0;
  std::uint32_t last_line = 0;
  std::vector<std::uint32_t> cuts;  // lines at which its parts begin, but the first
  int axis = 2;                     // across which most of it is flat
  // Near to another part, in order; labels are lines.
  std::vector<geometry::SegmentCluster> clusters;
};

// `ranges` and `others` as one list: increasing, without overlaps.
[[nodiscard]] std::vector<LineRange> joined(std::vector<LineRange> ranges,
                                            std::span<const LineRange> others);

[[nodiscard]] std::size_t lines_in(std::span<const LineRange> ranges);

// Whether a line is in one of them. They must be as `joined` gives them.
[[nodiscard]] bool holds(std::span<const LineRange> ranges, std::uint32_t line);

struct LongRunLimits {
  std::size_t whole_at_most = 50000;  // points of a run that is not cut, but at sharp corners
  std::size_t uncut_at_most = 20000;  // points of a run that is not cut there, either
  std::size_t shortest = 12500;       // motions of a part; kNeighbourBlocks or more
  std::size_t longest = 25000;        // the same, but where it cannot be cut
  bool rewritten = true;              // else nothing can come near to anything
};

// Where runs that are too long to be held are cut, found while a program is read from its begin:
// each cut depends on what is read up to some blocks after it, so the whole of a program and its
// windows find the same ones. Why, and what a cut costs: docs/long_programs.md.
//
// Looks at lines between arcs and all that ends a run: of more than `whole_at_most` points they are
// cut as cut_places cuts runs; of fewer, but more than `uncut_at_most`, at reversals and sharp
// corners alone, into parts of half as many and more. Both where a motion follows another one in the next block, and neither
// goes straight along Z: at the end of a run that would be a plunge.
class LongRunCuts {
 public:
  LongRunCuts(const LongRunLimits& limits, const GroupingOptions& grouping)
      : limits_(limits),
        tolerance_(grouping.tolerance_mm),
        states_(grouping),
        covers_{{{0, tolerance_}, {1, tolerance_}, {2, tolerance_}}} {}

  // The blocks that follow are those of this part, which must outlive them.
  void begin_part(const gcode::Program& program, const gcode::Interpretation& meaning);
  void take(std::uint32_t block);
  void end_run();  // at the end of the program; else by `take`

  // Those that are certain and were not given yet, in order.
  [[nodiscard]] std::vector<LongRunCut> found() { return std::exchange(found_, {}); }
  // Of the runs that were cut and have ended, and that were not given yet, in order. None of a run
  // whose parts do not come near to each other, or that takes too many clusters.
  [[nodiscard]] std::vector<SelfProximity> self_proximity() { return std::exchange(near_, {}); }

 private:
  void take_move(std::uint32_t block, const gcode::Motion& motion);
  void add_move(std::uint32_t block, const geometry::Point3& start, const geometry::Point3& end);
  void cut(bool run_ends);
  void cut_at_corners();
  void note_self_proximity();

  LongRunLimits limits_;
  double tolerance_;
  UnsafeStates states_;
  const gcode::Program* program_ = nullptr;
  const gcode::Interpretation* meaning_ = nullptr;

  // The run that goes on.
  std::size_t moves_ = 0;     // also the index of its last vertex
  std::size_t plunging_ = 0;  // moves along Z behind it, which may be a plunge
  bool flat_ = false;         // its last move
  bool adjacent_ = false;     // that move is the last block
  geometry::Point3 before_ = geometry::Point3::Zero();  // where its last move starts
  std::size_t from_ = 0;                                // vertex: the last cut
  std::vector<CutCandidate> candidates_;                // `shortest` and more after it
  std::vector<LongRunCut> pending_;                     // of a run that may still be short
  std::vector<CutCandidate> corners_;                   // where it is cut if it is not long
  std::vector<LongRunCut> found_;
  std::vector<std::uint32_t> cut_lines_;          // all cuts of the run that goes on
  std::array<geometry::ClusterCover, 3> covers_;  // its flat moves across X, Y and Z
  std::uint32_t first_line_ = 0;                  // of its moves
  std::uint32_t last_line_ = 0;
  std::vector<SelfProximity> near_;
};

struct LongRuns {
  std::vector<std::uint32_t> cuts;  // block indices
  std::vector<SelfProximity> near;
};

[[nodiscard]] LongRuns find_long_runs(const gcode::Program& program,
                                      const gcode::Interpretation& meaning,
                                      const LongRunLimits& limits, const GroupingOptions& grouping);

// The machine looks ahead over no more blocks to stop.
inline constexpr std::uint32_t kNeighbourBlocks = 100;

// The moves on both sides of a cut before `block`: of at most that many blocks, none beyond what
// ends a run, and none before `from` or from `end` on.
[[nodiscard]] std::vector<TimedPiece> moves_before(const gcode::Program& program,
                                                   const gcode::Interpretation& meaning,
                                                   std::uint32_t block, std::uint32_t from = 0);
[[nodiscard]] std::vector<TimedPiece> moves_from(const gcode::Program& program,
                                                 const gcode::Interpretation& meaning,
                                                 std::uint32_t block,
                                                 std::uint32_t end = UINT32_MAX);

}  // namespace batten::postproc
