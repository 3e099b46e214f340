#include "postproc/machine/planner/feed_sections.h"

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <string>
#include <utility>
#include <variant>

#include "geometry/basic/rounding.h"

namespace batten::postproc {
namespace {

using geometry::PathPiece;
using geometry::Vector3;

constexpr double kNone = KinematicPathLimits::kNone;

struct CutTuning {
  double above_feed = 2;            // speeds this many times the feed are of no interest in bends
  double above_feed_on_lines = 20;  // the feed is no reason for nodes, only a slow position near by
  double greatest_bend = 0.35;      // parts over which shares of limits change by more are cut
  int most_cuts = 8;                // in two: a bend of a 250th of a piece is seen
  int uneven_cuts = 2;              // of a cubic that does not run evenly, in any case
  double even_legs = 0.5;           // its control points are about as far from each other as that
  double slow_times = 160;          // than the envelope beside it: 1.6e-5 of a ramp is lost there
  double arc_part = 0.4;            // radians: which axis is the slowest changes with direction
};
constexpr CutTuning kCut;

// Stands for "no limit at all in this direction"; w itself is 1e6 at 1e4 mm/s.
constexpr double kSteep = 1e9;

// Of rounding: w came from that bound or from a slope.
constexpr double kSameBound = 1e-9;

class Potential {
 public:
  explicit Potential(const KinematicPathLimits& limits) : jerk_(has_jerk_limit(limits)) {}

  [[nodiscard]] double of_speed(double v) const { return jerk_ ? v * std::sqrt(v) : v * v; }
  [[nodiscard]] double speed(double w) const { return jerk_ ? std::cbrt(w * w) : std::sqrt(w); }

  // dw/ds.
  [[nodiscard]] double slope(const LimitsAlong& along) const {
    return std::min(kSteep, jerk_ ? std::sqrt(4.5 * along.jerk) : 2 * along.acceleration);
  }
  // Changes of speed per mm are this times slope / w.
  [[nodiscard]] double rate() const { return jerk_ ? 1 / std::sqrt(4.5) : 0.5; }

 private:
  bool jerk_;
};

// --- parts --------------------------------------------------------------------------------------

// What a position asks for.
struct Needs {
  double speed;  // mm/s, if the bend were held; at most kCut.above_feed times the feed
  Vector3 acceleration_share;  // of the limit, at 1 mm/s
  Vector3 jerk_share;
};

Needs needs_of(const LengthDerivatives& x, const KinematicPathLimits& limits) {
  Needs needs;
  needs.acceleration_share =
      x.second.cwiseQuotient(limits.acceleration.cwiseMin(limits.normal_acceleration));
  needs.jerk_share = x.third.cwiseQuotient(limits.jerk);
  const double squared = std::max(needs.acceleration_share.cwiseAbs().maxCoeff(),
                                  x.second.norm() / limits.normal_acceleration);
  const double cubed = needs.jerk_share.cwiseAbs().maxCoeff();
  double v = kCut.above_feed * limits_along(x.first, limits).speed;
  if (squared * v * v > 1) v = 1 / std::sqrt(squared);
  if (cubed * v * v * v > 1) v = 1 / std::cbrt(cubed);
  needs.speed = v;
  return needs;
}

double bend_between(const Needs& a, const Needs& b) {
  const double v = std::min(a.speed, b.speed);
  return std::max((b.acceleration_share - a.acceleration_share).cwiseAbs().maxCoeff() * v * v,
                  (b.jerk_share - a.jerk_share).cwiseAbs().maxCoeff() * v * v * v);
}

// How often a piece is cut in two in any case.
int least_cuts(const PathPiece& piece) {
  if (const auto* arc = std::get_if<geometry::Arc>(&piece)) {
    return std::max(0,
                    static_cast<int>(std::ceil(std::log2(std::abs(arc->sweep) / kCut.arc_part))));
  }
  const auto& control = std::get<geometry::CubicBezier>(piece).control;
  double least = kNone;
  double most = 0;
  for (int i = 0; i < 3; ++i) {
    const double leg = (control[i + 1] - control[i]).norm();
    least = std::min(least, leg);
    most = std::max(most, leg);
  }
  return least > kCut.even_legs * most ? 0 : kCut.uneven_cuts;
}

bool has_length(const PathPiece& piece) {
  const Vector3 way = geometry::end_point(piece) - geometry::start_point(piece);
  return way.norm() > geometry::kSamePlace || geometry::length_of(piece) > geometry::kSamePlace;
}

// What is left of a line between two blends because its vertices are rounded: it has the direction
// of rounding, and the machine passes it within a thousandth of a period.
bool is_of_rounding(std::span<const double> lengths, std::size_t i) {
  constexpr double kShortest = 3e-5;  // mm
  constexpr double kPart = 0.01;      // of both neighbours
  if (lengths[i] >= kShortest || i == 0 || i + 1 == lengths.size()) return false;
  return lengths[i] < kPart * std::min(lengths[i - 1], lengths[i + 1]);
}

// mm/s, at a joint where the limits of speed change; none where they do not.
double feed_change(LimitsOfPieces limits, std::size_t before, std::size_t after) {
  const KinematicPathLimits& a = limits_of(limits, before);
  const KinematicPathLimits& b = limits_of(limits, after);
  if (a.feed == b.feed && a.speed == b.speed) return kNone;
  return std::min(a.feed, b.feed);
}

// The pieces between two stops.
class PartChain {
 public:
  explicit PartChain(LimitsOfPieces limits) : limits_(limits), potential_(limits.front()) {}

  void add(const PathPiece& piece, std::size_t number, const LengthDerivatives& start,
           const LengthDerivatives& end) {
    const KinematicPathLimits& limits = limits_of(limits_, number);
    if (std::holds_alternative<geometry::Line>(piece)) {
      const double cap = kCut.above_feed_on_lines * limits_along(start.first, limits).speed;
      return add_part({.piece = number, .length = geometry::length_of(piece)}, start.first, cap);
    }
    const int forced = least_cuts(piece);
    cut(piece, {.piece = number, .straight = false}, needs_of(start, limits), needs_of(end, limits),
        forced, std::max(forced, kCut.most_cuts));
  }

  [[nodiscard]] bool is_empty() const { return parts_.empty(); }
  void set_end_bound(double speed) { parts_.back().end_bound = speed; }

  // Calls `use` for each section, and forgets the parts.
  void finish(const SectionEnd& start, const SectionEnd& end,
              const std::function<void(const PlannedSection&)>& use) {
    find_envelope(start.speed, end.speed);
    std::size_t first = 0;
    SectionEnd from = start;
    const auto close = [&](std::size_t last, const SectionEnd& to) {
      use({std::span(parts_).subspan(first, last - first),
           std::span(w_).subspan(first, last - first + 1), from, to});
      first = last;
      from = to;
    };
    for (const std::size_t joint : slow_joints()) {
      close(joint, {potential_.speed(w_[joint]), false});
    }
    close(parts_.size(), end);
    parts_.clear();
  }

 private:
  void add_part(FeedPart part, const Vector3& direction, double cap) {
    const LimitsAlong along = limits_along(direction, limits_of(limits_, part.piece));
    part.cap = potential_.of_speed(cap);
    part.slope = potential_.slope(along);
    // From rest the acceleration grows with the speed until feed or acceleration limit are near.
    const double full =
        std::isinf(along.jerk) ? along.speed : along.acceleration * along.acceleration / along.jerk;
    part.top = potential_.of_speed(std::min(along.speed, full));
    parts_.push_back(part);
  }

  // In two until the parts bend little: `forced` times in any case, `most` at the most.
  void cut(const PathPiece& piece, const FeedPart& part, const Needs& from, const Needs& to,
           int forced, int most) {
    const double t = 0.5 * (part.t0 + part.t1);
    const LengthDerivatives x = derivatives_by_length(piece, t);
    const Needs middle = needs_of(x, limits_of(limits_, part.piece));
    FeedPart half = part;
    half.bend = bend_between(from, middle) + bend_between(middle, to);
    if (forced > 0 || (most > 0 && half.bend > kCut.greatest_bend)) {
      half.t1 = t;
      cut(piece, half, from, middle, forced - 1, most - 1);
      half.t0 = t;
      half.t1 = part.t1;
      return cut(piece, half, middle, to, forced - 1, most - 1);
    }
    half.length = length_between(piece, part.t0, part.t1);
    add_part(half, x.first, std::max(middle.speed, std::min(from.speed, to.speed)));
  }

  void find_envelope(double start_speed, double end_speed) {
    const std::size_t n = parts_.size();
    parts_.back().end_bound = std::min(parts_.back().end_bound, end_speed);
    w_.assign(n + 1, 0);
    w_[0] = std::min(potential_.of_speed(start_speed), parts_.front().cap);
    for (std::size_t i = 0; i < n; ++i) {
      const FeedPart& part = parts_[i];
      w_[i + 1] = std::min(
          {part.cap, potential_.of_speed(part.end_bound), w_[i] + part.slope * part.length});
      if (i + 1 < n) w_[i + 1] = std::min(w_[i + 1], parts_[i + 1].cap);
    }
    for (std::size_t i = n; i-- > 0;) {
      w_[i] = std::min(w_[i], w_[i + 1] + parts_[i].slope * parts_[i].length);
    }
  }

  // As numbers of the parts after them.
  [[nodiscard]] std::vector<std::size_t> slow_joints() const {
    const double much = potential_.of_speed(kCut.slow_times);
    std::vector<std::size_t> joints;
    double highest = 0;         // since the last joint whose bound the envelope meets
    std::size_t candidate = 0;  // that joint, if what is before it is fast enough
    for (std::size_t i = 0; i < parts_.size(); ++i) {
      const FeedPart& part = parts_[i];
      const double top = 0.5 * (w_[i] + w_[i + 1] + part.slope * part.length);
      highest = std::max(highest, std::min(part.cap, top));
      if (candidate > 0 && highest >= much * w_[candidate]) {
        joints.push_back(candidate);
        candidate = 0;
      }
      if (!(w_[i + 1] >= potential_.of_speed(part.end_bound) * (1 - kSameBound))) continue;
      candidate = i + 1 < parts_.size() && highest >= much * w_[i + 1] ? i + 1 : 0;
      highest = 0;
    }
    return joints;
  }

  LimitsOfPieces limits_;
  Potential potential_;
  std::vector<FeedPart> parts_;
  std::vector<double> w_;
};

}  // namespace

bool PlannedSection::is_straight() const {
  if (start.is_free || end.is_free) return false;
  for (std::size_t i = 0; i < parts.size(); ++i) {
    if (!parts[i].straight) return false;
    if (i + 1 < parts.size() && !std::isinf(parts[i].end_bound)) return false;
  }
  return true;
}

StraightRun straight_run(const PlannedSection& section, std::span<const PathPiece> path,
                         LimitsOfPieces limits) {
  double length = 0;
  for (const FeedPart& part : section.parts) length += part.length;
  const std::size_t first = section.parts.front().piece;
  const Vector3 direction = geometry::direction_at(path[first], 0);
  return straight_run(length, section.start.speed, section.end.speed,
                      limits_along(direction, limits_of(limits, first)));
}

PassedJoints for_each_section(std::span<const PathPiece> path, LimitsOfPieces limits,
                              const PlanEnds& ends,
                              const std::function<void(const PlannedSection&)>& use) {
  if (limits.size() != 1 && limits.size() != path.size()) {
    throw std::invalid_argument(std::to_string(limits.size()) + " limits, expected one or " +
                                std::to_string(path.size()));
  }
  std::ranges::for_each(limits, require_sound);
  if (path.empty()) return {};
  if (!(ends.start_speed >= 0 && ends.end_speed >= 0)) {
    throw std::invalid_argument("end speeds " + std::to_string(ends.start_speed) + " and " +
                                std::to_string(ends.end_speed) + ", expected 0 or more");
  }
  PassedJoints joints;
  PartChain chain(limits);
  std::vector<double> lengths(path.size());
  std::ranges::transform(path, lengths.begin(),
                         [](const PathPiece& piece) { return geometry::length_of(piece); });
  const bool is_free = !ends.are_steady;
  SectionEnd from = {ends.start_speed, is_free && ends.start_speed > 0};
  LengthDerivatives last;
  std::size_t before = 0;
  for (std::size_t i = 0; i < path.size(); ++i) {
    if (!has_length(path[i]) || is_of_rounding(lengths, i)) continue;
    const LengthDerivatives start = derivatives_by_length(path[i], 0);
    if (!chain.is_empty()) {
      const double bound = joint_speed(last, start, limits_of(limits, i));
      chain.set_end_bound(std::min(bound, feed_change(limits, before, i)));
      if (bound == 0) {
        ++joints.stops;
        chain.finish(from, {}, use);
        from = {};
      } else if (!std::isinf(bound)) {
        ++joints.jumps;
      }
    }
    last =
        std::holds_alternative<geometry::Line>(path[i]) ? start : derivatives_by_length(path[i], 1);
    chain.add(path[i], i, start, last);
    before = i;
  }
  if (!chain.is_empty()) {
    chain.finish(from, {ends.end_speed, is_free && ends.end_speed > 0}, use);
  }
  return joints;
}

// --- intervals ----------------------------------------------------------------------------------

namespace {

// The greatest w over a length, up a slope and down again.
double peak_over(double length, const FeedPart& part, double w0, double w1) {
  return std::max({w0, w1, std::min(part.cap, 0.5 * (w0 + w1 + part.slope * length))});
}

// How w may rise and fall over some length of a part.
class Rise {
 public:
  Rise(const FeedPart& part, double from, double to, double w0, double w1)
      : part_(&part), from_(from), to_(to), w0_(w0), w1_(w1), slope_(part.slope) {
    const double length = to - from;
    top_ = peak_over(length, part, w0, w1);
    up_ = std::min(length, (top_ - w0) / slope_);
    const double down = std::min(length - up_, (top_ - w1) / slope_);
    flat_ = std::max(0.0, length - up_ - down);
    rising_ = std::log(top_ / w0);
    running_ = flat_ * slope_ / top_;
    falling_ = std::log(top_ / w1);
  }

  [[nodiscard]] const FeedPart& part() const { return *part_; }
  [[nodiscard]] double from() const { return from_; }  // mm after the start of the part
  [[nodiscard]] double to() const { return to_; }
  [[nodiscard]] bool reaches_joint() const { return to_ == part_->length; }
  [[nodiscard]] double end() const { return w1_; }

  // The integral of slope / w.
  [[nodiscard]] double measure() const { return rising_ + running_ + falling_; }

  // Where there is so much of the measure before it, mm after the start of the part.
  [[nodiscard]] double position(double m) const {
    if (m < rising_) return from_ + w0_ * std::expm1(m) / slope_;
    m -= rising_;
    if (m < running_) return from_ + up_ + flat_ * m / running_;
    m -= running_;
    return std::min(to_, from_ + up_ + flat_ - top_ * std::expm1(-m) / slope_);
  }

  [[nodiscard]] double w_at(double position) const {
    const double s = position - from_;
    if (s < up_) return w0_ + slope_ * s;
    return std::max(w1_, top_ - slope_ * std::max(0.0, s - up_ - flat_));
  }

  double nodes = 0;  // how many it should have

 private:
  const FeedPart* part_;
  double from_;
  double to_;
  double w0_;
  double w1_;
  double slope_;
  double top_;
  double up_;    // mm
  double flat_;  // mm
  // Natural logarithms of the rise and the fall, and the flat way in the same measure.
  double rising_;
  double running_;
  double falling_;
};

class GridMaker {
 public:
  GridMaker(const PlannedSection& section, std::span<const PathPiece> path, LimitsOfPieces limits,
            const GridRule& rule)
      : section_(section), path_(path), potential_(limits.front()), rule_(rule) {}

  std::vector<FeedInterval> run() {
    const auto& parts = section_.parts;
    const RestInterval first = rest_interval(true);
    const RestInterval last = rest_interval(false);
    if (first.length > 0) close_interval(first.w);
    for (std::size_t i = 0; i < parts.size(); ++i) {
      const bool is_last = i + 1 == parts.size();
      const double to = parts[i].length - (is_last ? last.length : 0);
      Rise rise(parts[i], i == 0 ? first.length : 0, to, i == 0 ? first.w : section_.w[i],
                is_last ? last.w : section_.w[i + 1]);
      rise.nodes =
          rule_.density * potential_.rate() * rise.measure() + rule_.nodes_per_bend * parts[i].bend;
      add(rise);
    }
    close_group();
    if (last.length > 0) {
      extend(parts.back(), parts.back().length - last.length, parts.back().length);
      close_interval(last.w);
    }
    return std::move(intervals_);
  }

 private:
  struct RestInterval {
    double length = 0;  // mm; 0: the section does not end at rest
    double w = 0;       // at the node beside it
  };

  // How high w comes from one end before it falls again.
  [[nodiscard]] double first_rise(bool from_start) const {
    const auto& w = section_.w;
    const std::size_t n = section_.parts.size();
    double highest = 0;
    for (std::size_t k = 0; k < n; ++k) {
      const std::size_t i = from_start ? k : n - 1 - k;
      const FeedPart& part = section_.parts[i];
      highest = std::max(highest, peak_over(part.length, part, w[i], w[i + 1]));
      if (from_start ? w[i + 1] < w[i] : w[i] < w[i + 1]) break;
    }
    return highest;
  }

  RestInterval rest_interval(bool at_start) {
    const SectionEnd& end = at_start ? section_.start : section_.end;
    if (!end.is_rest()) return {0, at_start ? section_.w.front() : section_.w.back()};
    const FeedPart& outer = at_start ? section_.parts.front() : section_.parts.back();
    const double rise = rule_.rest_share * std::min(first_rise(at_start), outer.top);
    const double length = std::min(rise / outer.slope, 0.25 * outer.length);
    if (at_start) extend(outer, 0, length);
    return {length, outer.slope * length};
  }

  void add(const Rise& rise) {
    if (!group_.empty() && rise.part().piece != group_.back().part().piece) close_group();
    group_.push_back(rise);
    nodes_ += rise.nodes;
  }

  // Cuts what was added into intervals of as many nodes' worth.
  void close_group() {
    const double count = std::max(1.0, std::ceil(nodes_));
    double passed = 0;
    double next = 1;
    for (const Rise& rise : group_) {
      double at = rise.from();
      for (; next < count && next * nodes_ / count < passed + rise.nodes; ++next) {
        const double share = (next * nodes_ / count - passed) / rise.nodes;
        const double to = std::min(rise.to(), rise.position(share * rise.measure()));
        if (!(to > at)) continue;
        extend(rise.part(), at, to);
        close_interval(rise.w_at(to));
        at = to;
      }
      if (rise.to() > at) extend(rise.part(), at, rise.to());
      if (rise.reaches_joint()) {
        (open_.length > 0 ? open_ : intervals_.back()).end_bound = rise.part().end_bound;
      }
      passed += rise.nodes;
    }
    if (!group_.empty()) close_interval(group_.back().end());
    group_.clear();
    nodes_ = 0;
  }

  void extend(const FeedPart& part, double from, double to) {
    const auto t = [&](double s) { return part.t0 + (part.t1 - part.t0) * s / part.length; };
    if (!(open_.length > 0)) {
      open_.piece = part.piece;
      open_.t0 = t(from);
    }
    open_.t1 = to == part.length ? part.t1 : t(to);
    open_.end_bound = kNone;
    open_.length += to - from;
  }

  void close_interval(double end_w) {
    if (!(open_.length > 0)) return;
    open_.length = length_between(path_[open_.piece], open_.t0, open_.t1);
    open_.end_speed = potential_.speed(end_w);
    intervals_.push_back(std::exchange(open_, {}));
  }

  const PlannedSection& section_;
  std::span<const PathPiece> path_;
  Potential potential_;
  const GridRule& rule_;
  std::vector<FeedInterval> intervals_;
  FeedInterval open_;
  std::vector<Rise> group_;
  double nodes_ = 0;
};

}  // namespace

std::vector<FeedInterval> intervals_of(const PlannedSection& section,
                                       std::span<const PathPiece> path, LimitsOfPieces limits,
                                       const GridRule& rule) {
  return GridMaker(section, path, limits, rule).run();
}

// The speed at which the interval keeps the jerk: its terms, each at the greater end, all of one
// sign; and the acceleration along the path.
RestMotion rest_motion(const PathPiece& piece, const FeedInterval& interval,
                       const KinematicPathLimits& limits) {
  RestMotion rest{interval.length, has_jerk_limit(limits) ? 2.0 / 3 : 0.5};
  const LengthDerivatives a = derivatives_by_length(piece, interval.t0);
  const LengthDerivatives b = derivatives_by_length(piece, interval.t1);
  const double by_p = 1.5 * rest.slope();
  const double by_r = rest.power * (2 * rest.power - 1) / (rest.length * rest.length);
  const auto greater = [](const Vector3& x, const Vector3& y) {
    return Vector3(x.cwiseAbs().cwiseMax(y.cwiseAbs()));
  };
  const Vector3 jerk = greater(a.third, b.third) + by_p * greater(a.second, b.second) +
                       by_r * greater(a.first, b.first);
  double cubed = by_r > 0 ? limits.tangential_jerk / by_r : kNone;
  for (int i = 0; i < 3; ++i) {
    if (jerk[i] > 0) cubed = std::min(cubed, limits.jerk[i] / jerk[i]);
  }
  const double acceleration = std::min(limits_along(a.first, limits).acceleration,
                                       limits_along(b.first, limits).acceleration);
  rest.speed = std::min(std::cbrt(cubed), std::sqrt(2 * acceleration / rest.slope()));
  return rest;
}

void set_end(const SectionEnd& end, const RestMotion& rest, std::size_t q, double slope,
             SearchPlace& place, SearchProblem& problem) {
  if (rest.is_there()) {
    place.time += rest.time();
    place.lower_speed(rest.speed);
    problem.ties.push_back({q + 1, q, slope, 0});
  } else if (end.is_free) {
    place.lower_speed(end.speed);
  } else {
    place.most = kNone;
    problem.ties.push_back({q, q, 0, end.speed * end.speed});
    problem.ties.push_back({q + 1, q, 0, 0});
  }
}

}  // namespace batten::postproc
