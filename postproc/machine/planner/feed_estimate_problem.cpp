#include "postproc/machine/planner/feed_estimate_problem.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "postproc/machine/planner/feed_plan_path.h"
#include "postproc/machine/planner/feed_search.h"

namespace batten::postproc {
namespace {

// The arc of constant jerk from a slow place: so much of the potential's first rise. Half of the
// first jerk phase by time is an eighth of its way, and at its end, at half the speed, the
// potential is 0.35 of its greatest.
constexpr double kArcShare = 0.35 / 8;

// An arc begins at most at this part of the potential that it reaches: else nodes from the start.
constexpr double kArcStart = 0.3;

// Nodes for a bend whose share of a limit goes from nothing to all, whatever the time it takes.
constexpr double kEstimateNodesPerBend = 1;

// A group of parts is complete with so many nodes' worth.
constexpr double kFullGroup = 0.75;

// How the potential may rise and fall over a part.
struct PartRise {
  double w0 = 0;
  double w1 = 0;
  double top = 0;
  double up = 0;    // mm
  double flat = 0;  // mm
  double slope = 0;
  // Natural logarithms of the rise and the fall, and the flat way in the same measure.
  double rising = 0;
  double running = 0;
  double falling = 0;

  [[nodiscard]] double measure() const { return rising + running + falling; }

  // mm from the start of the part to the place before which there is so much of the measure.
  [[nodiscard]] double place(double m) const {
    if (m < rising) return w0 * std::expm1(m) / slope;
    m -= rising;
    if (m < running) return up + flat * m / running;
    m -= running;
    return up + flat - top * std::expm1(-m) / slope;
  }

  [[nodiscard]] double potential_at(double s) const {
    if (s < up) return w0 + slope * s;
    return std::max(w1, top - slope * std::max(0.0, s - up - flat));
  }
};

PartRise rise_over(double length, double cap, double slope, double w0, double w1) {
  PartRise rise;
  rise.w0 = w0;
  rise.w1 = w1;
  rise.slope = slope;
  rise.top = std::max({w0, w1, std::min(cap, 0.5 * (w0 + w1 + slope * length))});
  rise.up = std::min(length, (rise.top - w0) / slope);
  const double down = std::min(length - rise.up, (rise.top - w1) / slope);
  rise.flat = std::max(0.0, length - rise.up - down);
  rise.rising = std::log(rise.top / w0);
  rise.falling = std::log(rise.top / w1);
  rise.running = rise.flat * slope / rise.top;
  return rise;
}

// How high the potential comes from one end before it falls again.
double first_rise(std::span<const EstimatePart> parts, std::span<const double> w, bool from_start) {
  double highest = 0;
  for (std::size_t k = 0; k < parts.size(); ++k) {
    const std::size_t i = from_start ? k : parts.size() - 1 - k;
    const PartRise rise = rise_over(parts[i].length, parts[i].cap, parts[i].slope,
                                    std::max(w[i], 1e-300), std::max(w[i + 1], 1e-300));
    highest = std::max(highest, rise.top);
    if (from_start ? w[i + 1] < w[i] : w[i] < w[i + 1]) break;
  }
  return highest;
}

// Makes an arc of a slow end where that fits. Returns the potential at the first node.
double settle_end(std::span<const EstimatePart> parts, std::span<const double> w, bool at_start,
                  EstimateEnd& end) {
  const double w0 = at_start ? w.front() : w.back();
  if (end.kind != EstimateEnd::Kind::kSlow) return w0;
  const EstimatePart& outer = at_start ? parts.front() : parts.back();
  const double rise = kArcShare * std::min(first_rise(parts, w, at_start), outer.top);
  const double length = std::min(rise / outer.slope, 0.25 * outer.length);
  const double reached = w0 + length * outer.slope;
  if (w0 > kArcStart * reached) return w0;
  end.kind = EstimateEnd::Kind::kArc;
  end.length = length;
  return reached;
}

class StretchMaker {
 public:
  StretchMaker(const Potential& potential, double density)
      : potential_(potential), nodes_per_measure_(density * potential.rate()) {}

  // The way [from, to[ of a part, between these potentials.
  void add(const EstimatePart& part, double from, double to, double w0, double w1) {
    const double length = to - from;
    const PartRise rise = rise_over(length, part.cap, part.slope, w0, w1);
    const double nodes = nodes_per_measure_ * rise.measure() + kEstimateNodesPerBend * part.bend;
    if (group_nodes_ > 0 && (group_nodes_ + nodes > 1 || part.straight != group_straight_)) close();
    if (nodes < kFullGroup) {
      join(part, from + 0.5 * length, length, 0.5 * (w0 + w1), nodes);
      const bool touches =
          potential_.of_speed(part.end_bound) <= w1 * (1 + 1e-9) && to == part.length;
      if (touches || group_nodes_ >= kFullGroup) close();
      return;
    }
    const int count = std::max(1, static_cast<int>(std::lround(nodes)));
    const double each = rise.measure() / count;
    double start = 0;
    for (int i = 1; i <= count; ++i) {
      const double end = i == count ? length : std::min(length, rise.place(i * each));
      if (!(end > start)) continue;
      const double middle = 0.5 * (start + end);
      emit(part, from + middle, end - start, rise.potential_at(middle));
      start = end;
    }
    intervals.back().end_bound = KinematicPathLimits::kNone;
    if (to == part.length) intervals.back().end_bound = part.end_bound;
  }

  void close() {
    if (!(group_nodes_ > 0)) return;
    intervals.push_back(group_);
    group_nodes_ = 0;
  }

  std::vector<EstimateInterval> intervals;

 private:
  [[nodiscard]] static double parameter(const EstimatePart& part, double place) {
    return part.t0 + (part.t1 - part.t0) * place / part.length;
  }

  void emit(const EstimatePart& part, double place, double length, double w) {
    EstimateInterval interval;
    interval.piece = part.piece;
    interval.t = parameter(part, place);
    interval.length = length;
    interval.speed = potential_.speed(w);
    intervals.push_back(interval);
  }

  // The most demanding part's derivatives stand for the group.
  void join(const EstimatePart& part, double place, double length, double w, double nodes) {
    if (!(group_nodes_ > 0)) {
      group_ = {};
      group_.speed = KinematicPathLimits::kNone;
      group_cap_ = -1;
      group_straight_ = part.straight;
    } else {
      group_.inner_bound = std::min(group_.inner_bound, group_.end_bound);
    }
    if (group_cap_ < 0 || part.cap < group_cap_) {
      group_cap_ = part.cap;
      group_.piece = part.piece;
      group_.t = parameter(part, place);
    }
    group_.length += length;
    group_.speed = std::min(group_.speed, potential_.speed(w));
    group_.end_bound = part.end_bound;
    group_nodes_ += std::max(nodes, 1e-12);
  }

  const Potential& potential_;
  double nodes_per_measure_;
  EstimateInterval group_;
  double group_nodes_ = 0;  // 0: there is none
  double group_cap_ = -1;
  bool group_straight_ = true;
};

}  // namespace

EstimateStretch make_estimate_stretch(std::span<const EstimatePart> parts,
                                      std::span<const double> w, const Potential& potential,
                                      const EstimateEnd& start, const EstimateEnd& end,
                                      double density) {
  EstimateStretch stretch;
  stretch.start = start;
  stretch.end = end;
  const double first = settle_end(parts, w, true, stretch.start);
  const double last = settle_end(parts, w, false, stretch.end);
  StretchMaker maker(potential, density);
  for (std::size_t i = 0; i < parts.size(); ++i) {
    const EstimatePart& part = parts[i];
    const bool outer_start = i == 0;
    const bool outer_end = i + 1 == parts.size();
    maker.add(part, outer_start ? stretch.start.length : 0,
              part.length - (outer_end ? stretch.end.length : 0), outer_start ? first : w[i],
              outer_end ? last : w[i + 1]);
  }
  maker.close();
  stretch.intervals = std::move(maker.intervals);
  return stretch;
}

namespace {

// A rough start costs steps; more of them do not make an estimate better.
constexpr SearchRule kQuick = {.first_gap = 0.3,
                               .enough_gap = 3e-3,
                               .enough_kept = 0.02,
                               .least_slack = 0.5,
                               .least_gap_part = 0.1,
                               .per_unexplained = 0,
                               .most_steps = 40};

// The start is this part of the envelope of speed^2, and at ends of the limit there.
constexpr double kStartPart = 0.8;
constexpr double kStartPartOfEnd = 0.9;

// The greatest speed at the end of an arc of constant jerk that begins at v0 without acceleration:
// jerk = 2 (v - v0) (v + 2 v0)^2 / (9 h^2).
double speed_after_arc(double v0, double length, double jerk) {
  const double most = 4.5 * jerk * length * length;
  double v = v0 + std::cbrt(most);
  constexpr int kSteps = 20;  // Newton, from above
  for (int i = 0; i < kSteps; ++i) {
    const double b = v + 2 * v0;
    const double step = ((v - v0) * b * b - most) / (b * (b + 2 * (v - v0)));
    v -= step;
    if (std::abs(step) <= 1e-12 * v) break;
  }
  return v;
}

// mm/s^2: between rest and the greatest speed limited jerk comes to sqrt(J v). A bend may add to
// the jerk along the path, so that much more; limits that are farther away are left out.
double steepest_along(const LimitsAlong& along) {
  constexpr double kMore = 1.5;
  return kMore * std::sqrt(along.jerk * along.speed);
}

// The middles of the intervals come first, then the nodes between them.
class ProblemMaker {
 public:
  ProblemMaker(std::span<const geometry::PathPiece> path, const EstimateStretch& stretch,
               const KinematicPathLimits& limits);

  [[nodiscard]] std::vector<double> guess() const;

  SearchProblem problem;

 private:
  // Shares of the ordinates beside a node in its q.
  struct NodeShares {
    double before;
    double after;
  };

  [[nodiscard]] std::size_t count() const { return stretch_.intervals.size(); }
  [[nodiscard]] double length(std::size_t interval) const {
    return interval < count() ? stretch_.intervals[interval].length : 0;
  }
  [[nodiscard]] NodeShares shares(std::size_t node) const;
  void add_middle(std::size_t k, const LengthDerivatives& x);
  void add_node(std::size_t k);
  void set_end(bool at_start, const EstimateEnd& end, const LengthDerivatives& x);

  const EstimateStretch& stretch_;
  const KinematicPathLimits& limits_;
};

ProblemMaker::ProblemMaker(std::span<const geometry::PathPiece> path,
                           const EstimateStretch& stretch, const KinematicPathLimits& limits)
    : stretch_(stretch), limits_(limits) {
  problem.unknowns = count() + 2;
  problem.places.reserve(2 * count() + 1);
  problem.rows.reserve(4 * count());
  LengthDerivatives first;
  LengthDerivatives x;
  for (std::size_t k = 0; k < count(); ++k) {
    const EstimateInterval& interval = stretch.intervals[k];
    x = derivatives_by_length(path[interval.piece], interval.t);
    if (k == 0) first = x;
    add_middle(k, x);
  }
  for (std::size_t k = 0; k <= count(); ++k) add_node(k);
  set_end(true, stretch.start, first);
  set_end(false, stretch.end, x);
}

ProblemMaker::NodeShares ProblemMaker::shares(std::size_t node) const {
  const double before = node > 0 ? length(node - 1) : 0;
  const double after = length(node);
  return {after / (before + after), before / (before + after)};
}

// q at the ends, and so q, p and r in the middle, as sums over the ordinates k, k + 1, k + 2.
void ProblemMaker::add_middle(std::size_t k, const LengthDerivatives& x) {
  const double h = length(k);
  const NodeShares from = shares(k);
  const NodeShares to = shares(k + 1);
  const LimitWindow q0 = {from.before, from.after, 0};
  const LimitWindow q1 = {0, to.before, to.after};
  SearchPlace place;
  place.first = k;
  place.width = 3;
  for (std::size_t i = 0; i < 3; ++i) {
    const double middle = i == 1 ? 1 : 0;
    place.q[i] = 0.25 * (q0[i] + q1[i]) + 0.5 * middle;
    place.p[i] = (q1[i] - q0[i]) / h;
    place.r[i] = 2 * (q0[i] + q1[i] - 2 * middle) / (h * h);
  }
  place.time = 4 * h / 6;
  problem.add_jerk_rows(x, limits_, place);
  problem.add_other_limits(x, limits_, steepest_along(limits_along(x.first, limits_)), place);
  const double bound = stretch_.intervals[k].inner_bound;
  place.most = std::min(place.most, bound * bound);
  problem.places.push_back(place);
}

void ProblemMaker::add_node(std::size_t k) {
  const NodeShares of_q = shares(k);
  SearchPlace place;
  place.first = k;
  place.width = 2;
  place.q = {of_q.before, of_q.after, 0, 0};
  place.time = ((k > 0 ? length(k - 1) : 0) + length(k)) / 6;
  if (k > 0) place.most = stretch_.intervals[k - 1].end_bound * stretch_.intervals[k - 1].end_bound;
  problem.places.push_back(place);
}

void ProblemMaker::set_end(bool at_start, const EstimateEnd& end, const LengthDerivatives& x) {
  const std::size_t outer = at_start ? 0 : problem.unknowns - 1;
  const std::size_t inner = at_start ? 1 : problem.unknowns - 2;
  // A single interval has one ordinate inside: the start's equation is the one that counts.
  const bool inner_is_free =
      at_start || count() > 1 || (problem.ties.empty() && problem.pins.empty());
  SearchPlace& node = at_start ? problem.places[count()] : problem.places.back();
  const double beside = length(at_start ? 0 : count() - 1);
  const double q = end.speed * end.speed;
  switch (end.kind) {
    case EstimateEnd::Kind::kFree:
      node.most = std::min(node.most, q);
      break;
    case EstimateEnd::Kind::kSlow:
    case EstimateEnd::Kind::kMoving:
      problem.pins.push_back({outer, q});
      if (inner_is_free) problem.pins.push_back({inner, q + end.acceleration * beside});
      break;
    case EstimateEnd::Kind::kArc: {
      const LimitsAlong along = limits_along(x.first, limits_);
      const double v0 = end.speed;
      const double h = end.length;
      const bool jerk = !std::isinf(along.jerk);
      const double v =
          jerk ? speed_after_arc(v0, h, along.jerk) : std::sqrt(q + 2 * along.acceleration * h);
      node.most = std::min(node.most, v * v);
      // p = 4 (v - v0) (v + 2 v0) / (3 h), v0 v taken at the greatest; without jerk limit
      // (v^2 - v0^2) / h.
      const double rate = (jerk ? 4.0 / 3 : 1.0) / h;
      const double offset = jerk ? v0 * v - 2 * q : -q;
      if (inner_is_free) {
        problem.ties.push_back({inner, outer, 1 + rate * beside / 2, rate * beside / 2 * offset});
      }
      problem.arcs.push_back({outer, jerk ? 3 * h : 2 * h, jerk ? 2 * v0 : v0});
      break;
    }
  }
}

std::vector<double> ProblemMaker::guess() const {
  const std::size_t n = count();
  std::vector<double> u(problem.unknowns);
  for (std::size_t k = 0; k < n; ++k) {
    const double v = stretch_.intervals[k].speed;
    u[k + 1] = kStartPart * std::min(v * v, problem.places[k].most);
  }
  // Limited jerk rounds the envelope off; nodes are spread by the time that it takes.
  constexpr int kPasses = 3;
  for (int pass = 0; pass < kPasses; ++pass) {
    double before = u[1];
    for (std::size_t k = 2; k + 1 <= n; ++k) {
      const double here = u[k];
      u[k] = std::sqrt(here * std::sqrt(before * u[k + 1]));
      before = here;
    }
  }
  u[0] = std::min(u[1], kStartPartOfEnd * problem.places[n].most);
  u[n + 1] = std::min(u[n], kStartPartOfEnd * problem.places.back().most);
  for (const UnknownPin& pin : problem.pins) u[pin.unknown] = pin.value;
  for (const UnknownTie& tie : problem.ties) u[tie.tied] = tie.factor * u[tie.free] + tie.offset;
  return u;
}

}  // namespace

EstimateSolution quick_search(std::span<const geometry::PathPiece> path,
                              const EstimateStretch& stretch, const KinematicPathLimits& limits) {
  const ProblemMaker maker(path, stretch, limits);
  SearchResult found = fastest(maker.problem, maker.guess(), kQuick);
  const std::vector<double>& u = found.unknowns;
  EstimateSolution solution;
  solution.found = found.found;
  const auto root_at = [&](const SearchPlace& place) {
    double q = 0;
    for (std::size_t i = 0; i < place.width; ++i) q += place.q[i] * u[place.first + i];
    return 1 / std::sqrt(q);
  };
  const std::size_t n = stretch.intervals.size();
  const auto& places = maker.problem.places;
  for (std::size_t k = 0; k < n; ++k) {
    const double ends = root_at(places[n + k]) + root_at(places[n + k + 1]);
    solution.seconds.push_back(stretch.intervals[k].length / 6 * (ends + 4 * root_at(places[k])));
  }
  for (const ArcTime& arc : maker.problem.arcs) {
    (arc.unknown == 0 ? solution.start_seconds : solution.end_seconds) =
        arc.seconds(u[arc.unknown]);
  }
  solution.ordinates = std::move(found.unknowns);
  return solution;
}

EstimateNode node_of(const EstimateStretch& stretch, const EstimateSolution& solution,
                     std::size_t i) {
  const auto& intervals = stretch.intervals;
  const auto& u = solution.ordinates;
  const double before = i > 0 ? intervals[i - 1].length : 0;
  const double after = i < intervals.size() ? intervals[i].length : 0;
  const double q = (after * u[i] + before * u[i + 1]) / (before + after);
  return {std::sqrt(q), (u[i + 1] - u[i]) / (before + after)};
}

}  // namespace batten::postproc
