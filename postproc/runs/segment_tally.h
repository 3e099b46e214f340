// The segments of a run, counted one after the other: of all of it, or of its pieces in order.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "geometry/basic/point.h"
#include "geometry/path/path.h"
#include "postproc/runs/section.h"

namespace batten::postproc {

struct SegmentStatistics {
  std::size_t count = 0;
  double shortest = 0;           // mm
  double median = 0;             // mm
  double longest = 0;            // mm
  double length = 0;             // mm, of the whole run
  double greatest_turn_deg = 0;  // at the vertices between the segments
  std::size_t turn_motion = 0;   // of the run, from 1, that ends at that vertex; 0: no turn
  std::uint32_t turn_line = 0;   // line of its block; 0: no turn, or not asked for
};

// Holds a length for each segment, for their median, and nothing else of them.
class SegmentTally {
 public:
  // The piece starts where the one before it has ended.
  void add(const Run& piece);

  [[nodiscard]] std::size_t count() const { return lengths_.size(); }
  // Of all pieces so far, from 1, the motion that ends at the greatest turn; 0: no turn.
  [[nodiscard]] std::size_t turn_motion() const { return turn_.motion; }

  // `turn_line` is 0. Begins anew.
  [[nodiscard]] SegmentStatistics take();

 private:
  struct Turn {
    double radians = 0;
    std::size_t motion = 0;
    double certainly_less = 0;  // squared sine of turns that are less than the greatest so far
  };

  void add_line(const geometry::Vector3& way);
  void add_arc(const geometry::Arc& arc);
  void add_segment(double length, const geometry::Vector3& start, const geometry::Vector3& end);
  void look_at_turn(const geometry::Vector3& to);

  std::vector<double> lengths_;
  double length_ = 0;
  double shortest_ = 0;
  double longest_ = 0;
  Turn turn_;
  geometry::Vector3 before_ = geometry::Vector3::Zero();  // the direction of the last one
};

}  // namespace batten::postproc
