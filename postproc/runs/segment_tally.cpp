#include "postproc/runs/segment_tally.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <numbers>
#include <utility>

#include "gcode/text/large_pages.h"

namespace batten::postproc {

namespace {

using geometry::Vector3;

// In between, the mean of the two middle ones.
double median_of(std::vector<double> values) {
  const std::size_t middle = values.size() / 2;
  std::ranges::nth_element(values, values.begin() + static_cast<std::ptrdiff_t>(middle));
  const double upper = values[middle];
  if (values.size() % 2 == 1) return upper;
  return (upper +
          *std::max_element(values.begin(), values.begin() + static_cast<std::ptrdiff_t>(middle))) /
         2;
}

}  // namespace

void SegmentTally::add(const Run& piece) {
  if (lengths_.empty()) gcode::reserve_in_large_pages(lengths_, piece.points.size());
  auto arc = piece.arcs.begin();
  for (std::size_t i = 0; i + 1 < piece.points.size();) {
    if (arc != piece.arcs.end() && arc->first == i) {
      add_arc(arc->arc);
      i = arc++->last;
    } else {
      add_line(piece.points[i + 1] - piece.points[i]);
      ++i;
    }
  }
}

void SegmentTally::add_line(const Vector3& way) {
  const double length = way.norm();
  const Vector3 direction = length > 0 ? Vector3(way / length) : Vector3(Vector3::Zero());
  add_segment(length, direction, direction);
}

void SegmentTally::add_arc(const geometry::Arc& arc) {
  add_segment(geometry::length_of(arc), geometry::direction_at(arc, 0),
              geometry::direction_at(arc, 1));
}

void SegmentTally::add_segment(double length, const Vector3& start, const Vector3& end) {
  look_at_turn(start);
  shortest_ = lengths_.empty() ? length : std::min(shortest_, length);
  longest_ = std::max(longest_, length);
  length_ += length;
  lengths_.push_back(length);
  before_ = end;
}

// Directions are unit vectors, or zero where there is none.
void SegmentTally::look_at_turn(const Vector3& to) {
  if (before_.isZero() || to.isZero()) return;
  const Vector3 across = before_.cross(to);
  const double along = before_.dot(to);
  if (along > 0 && across.squaredNorm() <= turn_.certainly_less) return;
  // atan2 keeps small turns exact where acos loses half of the digits.
  const double turn = std::atan2(across.norm(), along);
  if (!(turn > turn_.radians)) return;
  // Sines rise up to a right angle. Far above the rounding of unit vectors and of a sine.
  constexpr double kRounding = 1e-9;
  const double sine = std::sin(std::min(turn, std::numbers::pi / 2)) * (1 - kRounding);
  turn_ = {turn, lengths_.size(), sine * sine};
}

SegmentStatistics SegmentTally::take() {
  SegmentTally all = std::exchange(*this, {});
  SegmentStatistics statistics;
  if (all.lengths_.empty()) return statistics;
  statistics.count = all.lengths_.size();
  statistics.shortest = all.shortest_;
  statistics.longest = all.longest_;
  statistics.length = all.length_;
  statistics.greatest_turn_deg = all.turn_.radians * 180 / std::numbers::pi;
  statistics.turn_motion = all.turn_.motion;
  statistics.median = median_of(std::move(all.lengths_));
  return statistics;
}

}  // namespace batten::postproc
