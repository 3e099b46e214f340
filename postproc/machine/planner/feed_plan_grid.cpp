#include "postproc/machine/planner/feed_plan_grid.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "postproc/machine/planner/feed_plan_envelope.h"
#include "postproc/machine/planner/feed_plan_path.h"

namespace batten::postproc {
namespace {

using geometry::PathPiece;

// --- from rest ----------------------------------------------------------------------------------

// The first interval from rest has constant jerk in a plan, so it must be short against the way to
// the first greatest speed: a third of the first jerk phase by time, a 27th by way; and at the
// end of that phase, at half the speed, w is 0.35 of its greatest.
constexpr double kRestShare = 0.35 / 27;

// How high w rises from one end of the path before it falls again.
double first_rise(const Envelope& envelope, bool from_start) {
  const std::size_t n = envelope.steps.size();
  double highest = 0;
  for (std::size_t k = 0; k < n; ++k) {
    const std::size_t i = from_start ? k : n - 1 - k;
    const double w0 = envelope.w[i];
    const double w1 = envelope.w[i + 1];
    highest = std::max(highest, envelope.steps[i].peak(w0, w1));
    if (from_start ? w1 < w0 : w0 < w1) break;
  }
  return highest;
}

// The parameter of the place `length` after the start of a step, within a thousandth.
double parameter_after(const PathPiece& piece, const EnvelopeStep& step, double length) {
  double below = step.t0;
  double above = step.t1;
  double middle = 0.5 * (below + above);
  constexpr int kHalvings = 100;  // far more than doubles have bits between two places
  for (int i = 0; i < kHalvings; ++i) {
    const double reached = length_between(piece, step.t0, middle);
    if (std::abs(reached - length) < 1e-3 * length) break;
    (reached < length ? below : above) = middle;
    middle = 0.5 * (below + above);
  }
  return middle;
}

// Cuts the interval that leaves (or comes to) rest off the first (or last) step.
void cut_off_rest(Envelope& envelope, std::span<const PathPiece> pieces, double top_w,
                  bool at_start) {
  auto& steps = envelope.steps;
  EnvelopeStep& outer = at_start ? steps.front() : steps.back();
  const PathPiece& piece = pieces[outer.piece];
  const double rise = std::min(first_rise(envelope, at_start), top_w);
  const double length = std::min(kRestShare * rise / outer.slope, 0.25 * outer.length);
  const double from = at_start ? length : outer.length - length;
  const double t = parameter_after(piece, outer, from);
  EnvelopeStep head = outer;
  EnvelopeStep tail = outer;
  head.t1 = tail.t0 = t;
  head.length = length_between(piece, head.t0, head.t1);
  tail.length = length_between(piece, tail.t0, tail.t1);
  const double w = outer.slope * (at_start ? head.length : tail.length);
  const std::size_t place = at_start ? 1 : envelope.w.size() - 1;
  const auto offset = static_cast<std::ptrdiff_t>(place);
  outer = head;
  steps.insert(steps.begin() + offset, tail);
  envelope.w.insert(envelope.w.begin() + offset, w);
  envelope.bound.insert(envelope.bound.begin() + offset, KinematicPathLimits::kNone);
}

// --- nodes between ------------------------------------------------------------------------------

// A part of a step over which w is linear in the length.
struct Ramp {
  std::size_t step = 0;
  double offset = 0;  // mm from the start of the step
  double length = 0;  // mm
  double w0 = 0;
  double w1 = 0;
  double nodes = 0;  // how many it should have

  // The place before which it has this share of them: 1 / w integrated.
  [[nodiscard]] double place(double share) const {
    if (std::abs(w1 - w0) < 1e-6 * w0) return share * length;
    return length * (w0 * std::pow(w1 / w0, share) - w0) / (w1 - w0);
  }
  // The integral of 1 / w.
  [[nodiscard]] double turnover() const {
    if (std::abs(w1 - w0) < 1e-6 * w0) return length / w0;
    return length * std::log(w1 / w0) / (w1 - w0);
  }
};

// Nodes for a bend whose share of a limit goes from nothing to all, whatever the time it takes.
constexpr double kNodesPerBend = 2;

// Up, along the cap, and down.
void append_ramps(const Envelope& envelope, std::size_t number, const Potential& potential,
                  double nodes_per_change, std::vector<Ramp>& ramps) {
  const EnvelopeStep& step = envelope.steps[number];
  const double w0 = envelope.w[number];
  const double w1 = envelope.w[number + 1];
  const double top = step.peak(w0, w1);
  const double up = std::min(step.length, (top - w0) / step.slope);
  const double down = std::min(step.length - up, (top - w1) / step.slope);
  const std::array<Ramp, 3> parts = {Ramp{number, 0, up, w0, top, 0},
                                     Ramp{number, up, step.length - up - down, top, top, 0},
                                     Ramp{number, step.length - down, down, top, w1, 0}};
  const double v = potential.speed(std::max(w0, w1));
  const double bend =
      kNodesPerBend * v * v * (step.by_squared_speed + step.by_cubed_speed * v) / step.length;
  for (Ramp ramp : parts) {
    if (!(ramp.length > 1e-9 * step.length)) continue;
    ramp.nodes = nodes_per_change * step.slope * ramp.turnover() + bend * ramp.length;
    ramps.push_back(ramp);
  }
}

class GridMaker {
 public:
  GridMaker(std::span<const PathPiece> pieces, const Envelope& envelope, const Potential& potential,
            double density)
      : pieces_(pieces),
        envelope_(envelope),
        potential_(potential),
        nodes_per_change_(density * potential.rate()) {}

  void add_rest(std::size_t step) {
    const EnvelopeStep& s = envelope_.steps[step];
    close_interval(s.piece, s.t0, s.t1, envelope_.w[step + 1]);
  }

  // The steps [first, last[, which are of one piece and not from rest.
  void add_piece(std::size_t first, std::size_t last) {
    std::vector<Ramp> ramps;
    double total = 0;
    for (std::size_t i = first; i < last; ++i) {
      append_ramps(envelope_, i, potential_, nodes_per_change_, ramps);
    }
    for (const Ramp& ramp : ramps) total += ramp.nodes;
    const double count = std::max(1.0, std::ceil(total));
    const std::size_t piece = envelope_.steps[first].piece;
    double t = envelope_.steps[first].t0;
    double passed = 0;
    double next = 1;
    for (const Ramp& ramp : ramps) {
      for (; next < count && next * total / count < passed + ramp.nodes; ++next) {
        const double share = (next * total / count - passed) / ramp.nodes;
        const EnvelopeStep& step = envelope_.steps[ramp.step];
        const double place = ramp.place(share);
        const double t1 = step.t0 + (step.t1 - step.t0) * (ramp.offset + place) / step.length;
        if (!(t1 > t)) continue;
        close_interval(piece, t, t1, ramp.w0 + (ramp.w1 - ramp.w0) * place / ramp.length);
        t = t1;
      }
      passed += ramp.nodes;
    }
    close_interval(piece, t, envelope_.steps[last - 1].t1, envelope_.w[last]);
  }

  std::vector<GridInterval> intervals;
  std::vector<double> w;  // at their ends

 private:
  void close_interval(std::size_t piece, double t0, double t1, double w1) {
    intervals.push_back({piece, t0, t1, length_between(pieces_[piece], t0, t1)});
    w.push_back(w1);
  }

  std::span<const PathPiece> pieces_;
  const Envelope& envelope_;
  const Potential& potential_;
  double nodes_per_change_;
};

}  // namespace

PlanGrid make_plan_grid(std::span<const PathPiece> pieces, std::span<const double> bounds,
                        const KinematicPathLimits& limits, double density) {
  const Potential potential(limits);
  Envelope envelope = speed_envelope(pieces, bounds, limits);
  const auto fastest = [&](std::size_t piece, double t) {
    return limits_along(derivatives_by_length(pieces[piece], t).first, limits).speed;
  };
  const bool from_rest = bounds.front() == 0;
  const bool to_rest = bounds.back() == 0;
  if (from_rest) cut_off_rest(envelope, pieces, potential.of_speed(fastest(0, 0)), true);
  if (to_rest) {
    cut_off_rest(envelope, pieces, potential.of_speed(fastest(pieces.size() - 1, 1)), false);
  }

  GridMaker maker(pieces, envelope, potential, density);
  const std::size_t end = envelope.steps.size() - (to_rest ? 1 : 0);
  std::size_t i = 0;
  if (from_rest) maker.add_rest(i++);
  while (i < end) {
    std::size_t last = i + 1;
    while (last < end && envelope.steps[last].piece == envelope.steps[i].piece) ++last;
    maker.add_piece(i, last);
    i = last;
  }
  if (to_rest) maker.add_rest(end);

  PlanGrid grid;
  grid.intervals = std::move(maker.intervals);
  grid.bounds.assign(grid.intervals.size() + 1, KinematicPathLimits::kNone);
  grid.bounds.front() = bounds.front();
  grid.bounds.back() = bounds.back();
  grid.speeds.push_back(potential.speed(envelope.w.front()));
  for (std::size_t k = 0; k < grid.intervals.size(); ++k) {
    const GridInterval& interval = grid.intervals[k];
    grid.speeds.push_back(
        std::min(potential.speed(maker.w[k]), fastest(interval.piece, interval.t1)));
    if (k + 1 < grid.intervals.size() && grid.intervals[k + 1].piece != interval.piece) {
      grid.bounds[k + 1] = bounds[interval.piece + 1];
    }
  }
  return grid;
}

}  // namespace batten::postproc
