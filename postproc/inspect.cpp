#include "postproc/inspect.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "gcode/large_pages.h"
#include "geometry/numeric.h"
#include "geometry/path.h"

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

// The greatest turn of a chain of directions, each a unit vector or zero where there is none.
class GreatestTurn {
 public:
  // `vertex`: where it is.
  void add(const Vector3& from, const Vector3& to, std::size_t vertex) {
    if (from.isZero() || to.isZero()) return;
    const Vector3 across = from.cross(to);
    const double along = from.dot(to);
    if (along > 0 && across.squaredNorm() <= certainly_less_) return;
    // atan2 keeps small turns exact where acos loses half of the digits.
    const double turn = std::atan2(across.norm(), along);
    if (!(turn > radians_)) return;
    radians_ = turn;
    vertex_ = vertex;
    // Sines rise up to a right angle. Far above the rounding of unit vectors and of a sine.
    constexpr double kRounding = 1e-9;
    const double sine = std::sin(std::min(turn, std::numbers::pi / 2)) * (1 - kRounding);
    certainly_less_ = sine * sine;
  }

  [[nodiscard]] double degrees() const { return radians_ * 180 / std::numbers::pi; }
  [[nodiscard]] std::size_t vertex() const { return vertex_; }

 private:
  double radians_ = 0;
  std::size_t vertex_ = 0;
  double certainly_less_ = 0;  // squared sine of turns that are less than the greatest so far
};

bool moves(const gcode::Interpretation& interpretation, std::uint32_t block) {
  const std::int32_t motion = interpretation.blocks[block].motion;
  if (motion < 0) return false;
  const gcode::MotionPath& path = interpretation.motions[static_cast<std::size_t>(motion)].piece;
  const double length =
      path.is_line() ? (path.end() - path.start()).norm() : geometry::length_of(path);
  return length > geometry::kSamePlace;
}

// The line of the section's block that moves, counted from 1 among those that do; 0 for none.
std::uint32_t line_of_motion(std::size_t number, const gcode::Program& program,
                             const gcode::Interpretation& interpretation, const Section& section) {
  std::size_t left = number;
  for (std::uint32_t b = section.first_block; left > 0 && b <= section.last_block; ++b) {
    if (moves(interpretation, b) && --left == 0) return program.blocks[b].line;
  }
  return 0;
}

std::size_t cutting_moves_in(const gcode::Interpretation& interpretation, const Section& section) {
  std::size_t count = 0;
  for (std::uint32_t block = section.first_block; block <= section.last_block; ++block) {
    const std::int32_t motion = interpretation.blocks[block].motion;
    if (motion < 0) continue;
    if (interpretation.motions[static_cast<std::size_t>(motion)].kind !=
        gcode::MotionKind::kRapid) {
      ++count;
    }
  }
  return count;
}

void describe_run(const Run& run, InspectedSection& section) {
  section.closed = run.closed;
  section.decimals = run.decimals;
  section.segments = segment_statistics(run);
  if (run.feeds.empty()) return;
  const auto [least, greatest] = std::ranges::minmax(run.feeds, {}, &FeedFrom::feed);
  section.least_feed = least.feed;
  section.greatest_feed = greatest.feed;
}

// What is asked of the motions of a run, one after the other.
class SegmentTally {
 public:
  explicit SegmentTally(const Run& run) {
    gcode::reserve_in_large_pages(lengths_, run.points.size());
  }

  void add_line(const Vector3& way) {
    const double length = way.norm();
    const Vector3 direction = length > 0 ? Vector3(way / length) : Vector3(Vector3::Zero());
    add(length, direction, direction);
  }
  void add_arc(const geometry::Arc& arc) {
    add(geometry::length_of(arc), geometry::direction_at(arc, 0), geometry::direction_at(arc, 1));
  }

  SegmentStatistics take() {
    SegmentStatistics statistics;
    if (lengths_.empty()) return statistics;
    statistics.count = lengths_.size();
    statistics.shortest = shortest_;
    statistics.longest = longest_;
    statistics.length = length_;
    statistics.greatest_turn_deg = turn_.degrees();
    statistics.turn_motion = turn_.vertex();
    statistics.median = median_of(std::move(lengths_));
    return statistics;
  }

 private:
  void add(double length, const Vector3& start, const Vector3& end) {
    turn_.add(before_, start, lengths_.size());
    lengths_.push_back(length);
    length_ += length;
    shortest_ = std::min(shortest_, length);
    longest_ = std::max(longest_, length);
    before_ = end;
  }

  std::vector<double> lengths_;
  double length_ = 0;
  double shortest_ = std::numeric_limits<double>::infinity();
  double longest_ = 0;
  GreatestTurn turn_;
  Vector3 before_ = Vector3::Zero();
};

}  // namespace

SegmentStatistics segment_statistics(const Run& run) {
  SegmentTally tally(run);
  auto arc = run.arcs.begin();
  for (std::size_t i = 0; i + 1 < run.points.size();) {
    if (arc != run.arcs.end() && arc->first == i) {
      tally.add_arc(arc->arc);
      i = arc++->last;
    } else {
      tally.add_line(run.points[i + 1] - run.points[i]);
      ++i;
    }
  }
  return tally.take();
}

std::vector<InspectedSection> inspect(const gcode::Program& program,
                                      const gcode::Interpretation& interpretation,
                                      const std::vector<Section>& sections) {
  std::vector<InspectedSection> inspected;
  for (const Section& section : sections) {
    InspectedSection description;
    description.first_line = program.blocks[section.first_block].line;
    description.last_line = program.blocks[section.last_block].line;
    description.blocks = section.last_block - section.first_block + 1;
    description.cutting_moves = cutting_moves_in(interpretation, section);
    if (const auto* verbatim = std::get_if<Verbatim>(&section.content)) {
      description.reason = verbatim->reason;
    } else {
      describe_run(std::get<Run>(section.content), description);
      description.segments.turn_line =
          line_of_motion(description.segments.turn_motion, program, interpretation, section);
    }
    inspected.push_back(description);
  }
  return inspected;
}

}  // namespace batten::postproc
