#include "postproc/machine/planner/feed_estimate.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <stdexcept>
#include <string>
#include <utility>
#include <variant>

#include "geometry/basic/rounding.h"
#include "postproc/machine/planner/feed_estimate_parts.h"
#include "postproc/machine/planner/feed_estimate_problem.h"
#include "postproc/machine/planner/feed_plan_envelope.h"
#include "postproc/machine/planner/feed_plan_path.h"
#include "postproc/machine/planner/feed_plan_straight.h"

namespace batten::postproc {
namespace {

using geometry::PathPiece;

// No speed is found yet.
constexpr double kUnset = -1;

// Nodes in the time sqrt(v / jerk).
constexpr double kDensity = 3;

// A joint that is this much slower than the ways before and after it let the machine be is passed
// without acceleration: what an acceleration there wins on one side it loses on the other, and
// the difference is 0.15 times the square of the ratio at the most, as part of the time of a ramp.
// The envelope is 1.65 times the speed that jerk allows between two rests.
constexpr double kSlowEstimateJoint = 16;

// A longer stretch is searched in windows of so many intervals. The last ones of a window, which
// do not see what follows, are searched again with the next: the machine changes its speed several
// times within them.
constexpr std::size_t kWindow = 320;
constexpr std::size_t kAgain = 64;

bool has_length(const PathPiece& piece) {
  const geometry::Vector3 way = geometry::end_point(piece) - geometry::start_point(piece);
  return way.norm() > geometry::kSamePlace || geometry::length_of(piece) > geometry::kSamePlace;
}

// Collects the pieces between two stops and adds up the times.
class Estimator {
 public:
  Estimator(std::span<const PathPiece> path, const KinematicPathLimits& limits, bool with_speeds)
      : path_(path), limits_(limits), potential_(limits), with_speeds_(with_speeds) {}

  FeedEstimate run(const PlanEnds& ends);

 private:
  void fill_speeds(double start_speed);
  void add_piece(std::size_t number, const PieceEnds& ends);
  void finish_chain(double end_bound, bool free_end);
  void add_stretch(std::size_t first, std::size_t last, const EstimateEnd& start,
                   const EstimateEnd& end);
  [[nodiscard]] bool is_straight(std::size_t first, std::size_t last) const;
  double search(const EstimateStretch& stretch, std::size_t first_part);
  void commit(const EstimateStretch& stretch, const EstimateSolution& solution, std::size_t count);
  void pass_parts(double way, double length, double q0, double middle, double q1);
  void set_speed(std::size_t part, double speed);

  std::span<const PathPiece> path_;
  const KinematicPathLimits& limits_;
  Potential potential_;
  bool with_speeds_;
  FeedEstimate estimate_;
  // Of the chain between two stops:
  PartChain chain_;
  double start_bound_ = 0;
  bool free_start_ = false;
  // Of the stretch that is searched, where speeds are asked for:
  std::size_t part_ = 0;  // the next whose end is to come
  double part_end_ = 0;   // mm from the start of the stretch
  double way_ = 0;        // mm that are done
};

void Estimator::add_piece(std::size_t number, const PieceEnds& ends) {
  append_parts(path_[number], number, ends, potential_, limits_, chain_.parts);
}

FeedEstimate Estimator::run(const PlanEnds& ends) {
  start_bound_ = ends.start_speed;
  free_start_ = ends.start_speed > 0;
  if (with_speeds_) estimate_.speeds.assign(path_.size() + 1, kUnset);
  LengthDerivatives last;
  for (std::size_t i = 0; i < path_.size(); ++i) {
    if (!has_length(path_[i])) continue;
    const PieceEnds piece = ends_of(path_[i]);
    if (!chain_.parts.empty()) {
      const double bound = passing_speed(last, piece.start, potential_, limits_);
      if (bound == 0) {
        finish_chain(0, false);
        start_bound_ = 0;
        free_start_ = false;
      } else {
        chain_.parts.back().end_bound = bound;
      }
    }
    add_piece(i, piece);
    last = piece.end;
  }
  if (!chain_.parts.empty()) finish_chain(ends.end_speed, ends.end_speed > 0);
  fill_speeds(ends.start_speed);
  return std::move(estimate_);
}

// Pieces without length end at the speed at which they start.
void Estimator::fill_speeds(double start_speed) {
  double last = start_speed;
  for (double& speed : estimate_.speeds) last = speed = speed == kUnset ? last : speed;
}

void Estimator::finish_chain(double end_bound, bool free_end) {
  chain_.find_potentials(start_bound_, end_bound, potential_);
  EstimateEnd start;
  start.kind = free_start_ ? EstimateEnd::Kind::kFree : EstimateEnd::Kind::kSlow;
  start.speed = start_bound_;
  std::size_t first = 0;
  const auto close = [&](std::size_t last, EstimateEnd end) {
    add_stretch(first, last, start, end);
    start = end;
    first = last;
  };
  for (const std::size_t joint : chain_.slow_joints(kSlowEstimateJoint, potential_)) {
    close(joint, {EstimateEnd::Kind::kSlow, potential_.speed(chain_.w[joint]), 0, 0});
  }
  EstimateEnd end;
  end.kind = free_end ? EstimateEnd::Kind::kFree : EstimateEnd::Kind::kSlow;
  end.speed = end_bound;
  close(chain_.parts.size(), end);
  chain_.parts.clear();
}

bool Estimator::is_straight(std::size_t first, std::size_t last) const {
  for (std::size_t i = first; i < last; ++i) {
    if (!chain_.parts[i].straight) return false;
    if (i + 1 < last && !std::isinf(chain_.parts[i].end_bound)) return false;
  }
  return true;
}

void Estimator::add_stretch(std::size_t first, std::size_t last, const EstimateEnd& start,
                            const EstimateEnd& end) {
  const bool slow = start.kind == EstimateEnd::Kind::kSlow && end.kind == EstimateEnd::Kind::kSlow;
  if (slow && is_straight(first, last)) {
    double length = 0;
    for (std::size_t i = first; i < last; ++i) length += chain_.parts[i].length;
    const geometry::Vector3 direction = geometry::direction_at(path_[chain_.parts[first].piece], 0);
    const LimitsAlong along = limits_along(direction, limits_);
    const StraightRun run = straight_run(length, start.speed, end.speed, along);
    estimate_.time += run.time;
    if (!with_speeds_) return;
    double way = 0;
    for (std::size_t i = first; i < last; ++i) {
      way += chain_.parts[i].length;
      set_speed(i, i + 1 < last ? run.speed_at(way, along) : run.to);
    }
    return;
  }
  const auto parts = std::span(chain_.parts).subspan(first, last - first);
  const auto w = std::span(chain_.w).subspan(first, last - first + 1);
  const double speed =
      search(make_estimate_stretch(parts, w, potential_, start, end, kDensity), first);
  set_speed(last - 1, end.kind == EstimateEnd::Kind::kFree ? speed : end.speed);
}

// Window by window. Returns the speed at the last node.
double Estimator::search(const EstimateStretch& stretch, std::size_t first_part) {
  const std::vector<EstimateInterval>& all = stretch.intervals;
  part_ = first_part;
  part_end_ = chain_.parts[first_part].length;
  way_ = stretch.start.length;
  std::size_t first = 0;
  EstimateStretch window;
  window.start = stretch.start;
  while (first < all.size()) {
    const bool last = all.size() - first <= kWindow + kAgain;
    const std::size_t count = last ? all.size() - first : kWindow;
    window.intervals.assign(all.begin() + static_cast<std::ptrdiff_t>(first),
                            all.begin() + static_cast<std::ptrdiff_t>(first + count));
    window.end = stretch.end;
    if (!last) {
      window.end = {};
      window.end.speed = window.intervals.back().speed;
    }
    EstimateSolution solution = quick_search(path_, window, limits_);
    if (!solution.found && window.start.kind == EstimateEnd::Kind::kMoving) {
      // What came before has not seen what follows: go on from a lower speed.
      window.start.kind = EstimateEnd::Kind::kFree;
      solution = quick_search(path_, window, limits_);
    }
    const std::size_t kept = last ? count : count - kAgain;
    commit(window, solution, kept);
    const EstimateNode node = node_of(window, solution, kept);
    window.start = {EstimateEnd::Kind::kMoving, node.speed, node.acceleration, 0};
    first += kept;
  }
  return window.start.speed;
}

// The speed at the end of a piece.
void Estimator::set_speed(std::size_t part, double speed) {
  const std::size_t piece = chain_.parts[part].piece;
  const bool last = part + 1 == chain_.parts.size() || chain_.parts[part + 1].piece != piece;
  if (with_speeds_ && last) estimate_.speeds[piece + 1] = speed;
}

// The speeds at the ends of parts in an interval `way` mm from the start of the stretch, given the
// Bezier ordinates of speed^2.
void Estimator::pass_parts(double way, double length, double q0, double middle, double q1) {
  for (; part_ < chain_.parts.size() && part_end_ <= way + length; ++part_) {
    const double x = (part_end_ - way) / length;
    const double q = q0 + x * (2 * (middle - q0) + x * (q0 - 2 * middle + q1));
    set_speed(part_, std::sqrt(std::max(q, 0.0)));
    if (part_ + 1 < chain_.parts.size()) part_end_ += chain_.parts[part_ + 1].length;
  }
}

void Estimator::commit(const EstimateStretch& stretch, const EstimateSolution& solution,
                       std::size_t count) {
  estimate_.time += solution.start_seconds;
  for (std::size_t i = 0; i < count; ++i) estimate_.time += solution.seconds[i];
  if (count == stretch.intervals.size()) estimate_.time += solution.end_seconds;
  if (!with_speeds_) return;
  double q0 = solution.ordinates.front();
  for (std::size_t i = 0; i < count; ++i) {
    const double speed = node_of(stretch, solution, i + 1).speed;
    const double length = stretch.intervals[i].length;
    pass_parts(way_, length, q0, solution.ordinates[i + 1], speed * speed);
    q0 = speed * speed;
    way_ += length;
  }
}

void require_speeds(const PlanEnds& ends) {
  if (ends.start_speed >= 0 && ends.end_speed >= 0) return;
  throw std::invalid_argument("estimate_feed: end speeds " + std::to_string(ends.start_speed) +
                              " and " + std::to_string(ends.end_speed) + ", expected 0 or more");
}

}  // namespace

FeedEstimate estimate_feed(std::span<const PathPiece> path, const KinematicPathLimits& limits,
                           const PlanEnds& ends) {
  require_sound(limits);
  require_speeds(ends);
  return Estimator(path, limits, true).run(ends);
}

double estimated_time(std::span<const PathPiece> path, const KinematicPathLimits& limits,
                      const PlanEnds& ends) {
  require_sound(limits);
  require_speeds(ends);
  return Estimator(path, limits, false).run(ends).time;
}

double estimated_time(const geometry::BsplineCurve& curve, const KinematicPathLimits& limits,
                      const PlanEnds& ends) {
  return estimated_time(path_of(curve), limits, ends);
}

}  // namespace batten::postproc
