// Where runs that are too long to be held are cut, found while a program is read from its begin:
// each place depends on what is read up to some blocks behind it, so the whole of a program and its
// parts find the same ones.
//
// Why a long run is cut, and what the joint costs: docs/long_programs.md.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string_view>
#include <utility>
#include <vector>

#include "gcode/state/motion.h"
#include "gcode/text/program.h"
#include "geometry/band/self_proximity.h"
#include "geometry/basic/point.h"
#include "postproc/machine/models/cycle_time.h"
#include "postproc/runs/run_cutting.h"
#include "postproc/runs/run_grouping.h"

namespace batten::postproc {

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
  std::vector<geometry::SegmentCluster>
      clusters;  // labels are lines; in order, near to another part
};

// The flat moves of a run that may be long.
class ProximityIndex {
 public:
  explicit ProximityIndex(double tolerance_mm);

  void add(const geometry::Point3& from, const geometry::Point3& to, std::uint32_t line);
  void clear();
  // Nothing where no part comes near to another one, or the run takes too many strands.
  [[nodiscard]] std::optional<SelfProximity> self_proximity(std::vector<std::uint32_t> cuts) const;

 private:
  double tolerance_;
  std::array<geometry::ClusterCover, 3> covers_;  // across Z, Y and X
  std::uint32_t first_line_ = 0;                  // 0: there are no moves
  std::uint32_t last_line_ = 0;
};

// mm: how wide a cover is where the program may move by this.
[[nodiscard]] double cluster_width(double tolerance_mm);

// `ranges` and `others` as one list: increasing, without overlaps.
[[nodiscard]] std::vector<LineRange> joined(std::vector<LineRange> ranges,
                                            std::span<const LineRange> others);

[[nodiscard]] std::size_t lines_in(std::span<const LineRange> ranges);

// Whether a line is in one of them. They must be as `joined` gives them.
[[nodiscard]] bool holds(std::span<const LineRange> ranges, std::uint32_t line);

struct LongRunLimits {
  std::size_t whole_at_most = 50000;  // points of a run that is not cut
  std::size_t shortest = 12500;       // motions of a piece; kNeighbourBlocks or more
  std::size_t longest = 25000;        // the same, but where it cannot be cut
  bool rewritten = true;              // else nothing can come near to anything
};

// A block that begins a run of its own.
struct LongRunCut {
  std::uint32_t line = 0;   // from 1
  std::uint32_t begin = 0;  // bytes
};

// Looks at lines between arcs and all that ends a run: of more than `whole_at_most` points they are
// cut as cut_places (postproc/runs/run_cutting.h) cuts runs. A place is where a motion follows
// another one in the next block, and neither goes straight along Z: at the end of a run that would
// be a plunge.
class LongRunCuts {
 public:
  LongRunCuts(const LongRunLimits& limits, const GroupingOptions& grouping)
      : limits_(limits), grouping_(grouping), clusters_(grouping.tolerance_mm) {}

  // The blocks that follow are those of this part, which must outlive them.
  void begin_part(const gcode::Program& program, const gcode::Interpretation& meaning);
  void take(std::uint32_t block);
  void end();  // of the program

  // Those that are certain and were not given yet, in order.
  [[nodiscard]] std::vector<LongRunCut> found();

  // Of the runs that were cut and have ended, and that were not given yet, in order.
  [[nodiscard]] std::vector<SelfProximity> self_proximity();

 private:
  struct Candidate {
    std::size_t vertex = 0;
    Fitness split_score;
    LongRunCut place;
  };

  void take_move(std::uint32_t block, const gcode::Motion& motion);
  void add_move(std::uint32_t block, const geometry::Point3& start, const geometry::Point3& end);
  void cut(bool run_ends);
  [[nodiscard]] std::optional<Candidate> choice(std::size_t end) const;
  void end_run();
  [[nodiscard]] bool is_unsafe(std::uint32_t state);

  LongRunLimits limits_;
  GroupingOptions grouping_;
  const gcode::Program* program_ = nullptr;
  const gcode::Interpretation* meaning_ = nullptr;
  std::optional<std::uint32_t> asked_state_;
  bool unsafe_ = false;  // that state

  // The run that goes on.
  std::size_t moves_ = 0;     // also the index of its last vertex
  std::size_t plunging_ = 0;  // moves along Z behind it, which may be a plunge
  bool flat_ = false;         // its last move
  bool adjacent_ = false;     // that move is the last block
  geometry::Point3 before_ = geometry::Point3::Zero();  // where its last move starts
  std::size_t from_ = 0;                                // vertex: the last cut
  std::vector<Candidate> candidates_;                   // `shortest` and more behind it
  std::vector<LongRunCut> pending_;                     // of a run that may still be short
  std::vector<LongRunCut> found_;
  std::vector<std::uint32_t> cut_lines_;  // all cuts of the run that goes on
  ProximityIndex clusters_;               // its own
  std::vector<SelfProximity> near_;
};

struct LongRuns {
  std::vector<std::uint32_t> cuts;  // block indices
  std::vector<SelfProximity> near;
};

[[nodiscard]] LongRuns find_long_runs(const gcode::Program& program,
                                      const gcode::Interpretation& meaning,
                                      const LongRunLimits& limits, const GroupingOptions& grouping);

// The moves on both sides of the place where a long run is cut (postproc/runs/long_run_cuts.h).

// The machine looks ahead over no more blocks to stop.
inline constexpr std::uint32_t kNeighbourBlocks = 100;

// What is cut in the last of the blocks before `block`, and in it and those behind it: no more than
// that many blocks, none beyond what ends a run, and none before `from` or from `end` on.
[[nodiscard]] std::vector<TimedPiece> moves_before(const gcode::Program& program,
                                                   const gcode::Interpretation& meaning,
                                                   std::uint32_t block, std::uint32_t from = 0);
[[nodiscard]] std::vector<TimedPiece> moves_from(const gcode::Program& program,
                                                 const gcode::Interpretation& meaning,
                                                 std::uint32_t block,
                                                 std::uint32_t end = UINT32_MAX);

}  // namespace batten::postproc
