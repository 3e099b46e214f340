// Where the parts of a long run that is cut are so near to each other that their new paths may
// cross. Found while a program is read; holds a strand for some twenty motions of a curve.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <utility>
#include <vector>

#include "geometry/band/self_proximity.h"
#include "geometry/basic/point.h"

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

}  // namespace batten::postproc
