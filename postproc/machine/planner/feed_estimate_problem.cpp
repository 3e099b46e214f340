#include "postproc/machine/planner/feed_estimate_problem.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "postproc/machine/planner/feed_plan_path.h"

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

using geometry::Vector3;

class ProblemMaker {
 public:
  ProblemMaker(std::span<const geometry::PathPiece> path, const EstimateStretch& stretch,
               const KinematicPathLimits& limits);

  EstimateProblem problem;

 private:
  void make_rows(EstimateCell& cell, const LengthDerivatives& x);
  void add_row(double q, double p, double r, double limit);
  void set_knots(const EstimateStretch& stretch);
  void set_ends(const EstimateStretch& stretch, const LengthDerivatives& first,
                const LengthDerivatives& last);

  const KinematicPathLimits& limits_;
};

ProblemMaker::ProblemMaker(std::span<const geometry::PathPiece> path,
                           const EstimateStretch& stretch, const KinematicPathLimits& limits)
    : limits_(limits) {
  problem.cells.resize(stretch.intervals.size());
  problem.knots.resize(stretch.intervals.size() + 1);
  problem.rows.reserve(4 * problem.cells.size());
  LengthDerivatives first;
  LengthDerivatives x;
  for (std::size_t k = 0; k < problem.cells.size(); ++k) {
    const EstimateInterval& interval = stretch.intervals[k];
    EstimateCell& cell = problem.cells[k];
    x = derivatives_by_length(path[interval.piece], interval.t);
    if (k == 0) first = x;
    cell.length = interval.length;
    make_rows(cell, x);
    cell.most = std::min(cell.most, interval.inner_bound * interval.inner_bound);
  }
  set_knots(stretch);
  set_ends(stretch, first, x);
}

void ProblemMaker::add_row(double q, double p, double r, double limit) {
  if (std::isinf(limit) || (q == 0 && p == 0 && r == 0)) return;
  problem.rows.push_back({q / limit, p / limit, r / limit});
}

// mm/s^2: between rest and the greatest speed limited jerk comes to sqrt(J v). A bend may add to
// the jerk along the path, so that much more; limits that are farther away are left out.
double steepest_along(const LimitsAlong& along) {
  constexpr double kMore = 1.5;
  return kMore * std::sqrt(along.jerk * along.speed);
}

void ProblemMaker::make_rows(EstimateCell& cell, const LengthDerivatives& x) {
  const LimitsAlong along = limits_along(x.first, limits_);
  const double curvature = x.second.norm();
  cell.most = along.speed * along.speed;
  if (curvature > 0) {
    cell.most = std::min(cell.most, limits_.normal_acceleration / curvature);
  }
  cell.first_row = problem.rows.size();
  const bool straight = curvature == 0 && x.third == Vector3::Zero();
  if (straight) {
    add_row(0, 0, 0.5, along.jerk);
    cell.jerk_rows = problem.rows.size() - cell.first_row;
    if (steepest_along(along) >= along.acceleration) add_row(0, 0.5, 0, along.acceleration);
  } else {
    for (int i = 0; i < 3; ++i) {
      add_row(x.third[i], 1.5 * x.second[i], 0.5 * x.first[i], limits_.jerk[i]);
    }
    add_row(0, 0, 0.5, limits_.tangential_jerk);
    cell.jerk_rows = problem.rows.size() - cell.first_row;
    const double steepest = steepest_along(along);
    for (int i = 0; i < 3; ++i) {
      const double most = std::abs(x.second[i]) * cell.most + std::abs(x.first[i]) * steepest;
      if (most < limits_.acceleration[i]) continue;
      add_row(x.second[i], 0.5 * x.first[i], 0, limits_.acceleration[i]);
    }
    if (steepest >= limits_.tangential_acceleration) {
      add_row(0, 0.5, 0, limits_.tangential_acceleration);
    }
  }
  cell.rows = problem.rows.size() - cell.first_row;
}

void ProblemMaker::set_knots(const EstimateStretch& stretch) {
  const std::size_t n = problem.cells.size();
  for (std::size_t k = 0; k <= n; ++k) {
    const double before = k > 0 ? problem.cells[k - 1].length : 0;
    const double after = k < n ? problem.cells[k].length : 0;
    EstimateKnot& knot = problem.knots[k];
    knot.before = after / (before + after);
    knot.after = before / (before + after);
    knot.weight = (before + after) / 6;
    if (k > 0) {
      const double bound = stretch.intervals[k - 1].end_bound;
      knot.most = bound * bound;
    }
  }
  for (std::size_t k = 0; k < n; ++k) {
    EstimateCell& cell = problem.cells[k];
    const double h = cell.length;
    const EstimateKnot& from = problem.knots[k];
    const EstimateKnot& to = problem.knots[k + 1];
    // q at the ends as sums over the ordinates k, k + 1, k + 2.
    const LimitWindow q0 = {from.before, from.after, 0};
    const LimitWindow q1 = {0, to.before, to.after};
    for (int i = 0; i < 3; ++i) {
      const double middle = i == 1 ? 1 : 0;
      cell.q_of[i] = 0.25 * (q0[i] + q1[i]) + 0.5 * middle;
      cell.p_of[i] = (q1[i] - q0[i]) / h;
      cell.r_of[i] = 2 * (q0[i] + q1[i] - 2 * middle) / (h * h);
    }
  }
}

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

void ProblemMaker::set_ends(const EstimateStretch& stretch, const LengthDerivatives& first,
                            const LengthDerivatives& last) {
  const auto set = [&](const EstimateEnd& end, const LengthDerivatives& x, double beside,
                       EstimateKnot& knot, EstimateTie& tie) {
    const double q = end.speed * end.speed;
    switch (end.kind) {
      case EstimateEnd::Kind::kFree:
        knot.most = std::min(knot.most, q);
        break;
      case EstimateEnd::Kind::kSlow:
      case EstimateEnd::Kind::kMoving:
        tie.pins = true;
        tie.value = q;
        tie.next = q + end.acceleration * beside;
        break;
      case EstimateEnd::Kind::kArc: {
        const LimitsAlong along = limits_along(x.first, limits_);
        const double v0 = end.speed;
        const double h = end.length;
        const bool jerk = !std::isinf(along.jerk);
        const double v =
            jerk ? speed_after_arc(v0, h, along.jerk) : std::sqrt(q + 2 * along.acceleration * h);
        knot.most = std::min(knot.most, v * v);
        // p = 4 (v - v0) (v + 2 v0) / (3 h), v0 v taken at the greatest; without jerk limit
        // (v^2 - v0^2) / h.
        const double rate = (jerk ? 4.0 / 3 : 1.0) / h;
        const double offset = jerk ? v0 * v - 2 * q : -q;
        tie.ties = true;
        tie.factor = 1 + rate * beside / 2;
        tie.offset = rate * beside / 2 * offset;
        tie.arc_length = jerk ? 3 * h : 2 * h;
        tie.arc_speed = jerk ? 2 * v0 : v0;
        break;
      }
    }
  };
  set(stretch.start, first, problem.cells.front().length, problem.knots.front(), problem.start);
  set(stretch.end, last, problem.cells.back().length, problem.knots.back(), problem.end);
}

}  // namespace

EstimateProblem make_estimate_problem(std::span<const geometry::PathPiece> path,
                                      const EstimateStretch& stretch,
                                      const KinematicPathLimits& limits) {
  return std::move(ProblemMaker(path, stretch, limits).problem);
}

}  // namespace batten::postproc
