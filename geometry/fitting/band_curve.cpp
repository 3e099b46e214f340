#include "geometry/fitting/band_curve.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>
#include <string>
#include <utility>

#include "geometry/fitting/band_curve_barrier.h"
#include "geometry/fitting/band_problem.h"

namespace batten::geometry {

namespace {

// The barrier counts for less by this factor as soon as a curve is near its least: some four
// Newton steps each.
constexpr double kSharpen = 20;

// A squared Newton decrement below which a curve is near the least of the barrier function, and
// one below which it is there.
constexpr double kNear = 0.5;
constexpr double kThere = 1e-3;

// A start outside is inside a band widened by this much more than it needs.
constexpr double kWider = 1.05;

// The band is no longer widened when the greatest ratio is below this: strictly inside, so that
// the barrier is finite.
constexpr double kInside = 0.9999;

// The part that the energy at the start has in what is made least, beside the widening.
constexpr double kTrace = 1e-3;

int rates_never() { return std::numeric_limits<int>::max(); }

class BandSolver {
 public:
  BandSolver(const BandProblem& problem, std::vector<Point3> start, int rates_from,
             const BarrierOptions& options)
      : problem_(problem), options_(options), band_(band_rows(problem, rates_from)) {
    if (start.size() != problem.basis.size()) {
      throw std::invalid_argument("solve_band: " + std::to_string(start.size()) +
                                  " points to start with, expected " +
                                  std::to_string(problem.basis.size()));
    }
    at_.points = std::move(start);
    for (const HeldPoint& held : problem.held) {
      Point3& p = at_.points[held.index];
      p = held.place + held.free * (p - held.place);
    }
  }

  BandCurve least_energy() {
    const BandEnd end = get_inside() ? descend() : BandEnd::kOutside;
    return result(end, band_.worst_ratio(at_.points, false));
  }

  BandCurve least_ratio() {
    BandEnd end = BandEnd::kOutside;
    if (get_inside()) end = shrink(Widening::kRates, 0);
    return result(end, band_.worst_ratio(at_.points, true));
  }

 private:
  [[nodiscard]] BandCurve result(BandEnd end, double worst_ratio) const {
    return {BsplineCurve(problem_.basis, at_.points), end, band_.energy(at_.points), worst_ratio,
            steps_};
  }

  [[nodiscard]] BandBarrier barrier(Widening widening) const {
    return {band_, problem_.held, at_.points.size(), widening};
  }

  bool get_inside() {
    if (band_.worst_ratio(at_.points, false) < 1) return true;
    shrink(Widening::kPlaces, kInside);
    return band_.worst_ratio(at_.points, false) < 1;
  }

  // Makes the greatest ratio as small as it gets, or just smaller than `enough`.
  BandEnd shrink(Widening widening, double enough) {
    BandBarrier f = barrier(widening);
    const bool rates = widening == Widening::kRates;
    at_.wide = kWider * band_.worst_ratio(at_.points, rates);
    if (!(at_.wide > 0)) return BandEnd::kLeast;
    const double energy = std::max(band_.energy(at_.points), band_.energy_of_moves());
    f.price = 1;
    f.energy = energy > 0 ? kTrace * at_.wide / energy : 0;
    f.weight = f.gap_times_weight() / at_.wide;
    return follow(
        f, [&] { return band_.worst_ratio(at_.points, rates) < enough; },
        [&] { return f.gap_times_weight() <= options_.gap * at_.wide * f.weight; });
  }

  // Makes the energy as small as it gets inside the band.
  BandEnd descend() {
    BandBarrier f = barrier(Widening::kNone);
    at_.wide = 1;
    const double noise = band_.energy_noise(at_.points);
    const double start = std::max(band_.energy(at_.points), noise);
    if (!(start > 0)) return BandEnd::kLeast;  // nothing has an energy: a line on one place
    f.energy = 1 / start;
    f.weight = f.gap_times_weight();
    return follow(
        // A straight run has no energy, and what is left of it is rounding.
        f, [&] { return band_.energy(at_.points) <= noise; },
        [&] {
          const double left = std::max(options_.gap * band_.energy(at_.points), noise);
          return f.gap_times_weight() * start <= left * f.weight;
        });
  }

  // Until it is `enough`, or the barrier so sharp that its least is the least of what is priced.
  template <typename Enough, typename Sharp>
  BandEnd follow(BandBarrier& f, const Enough& enough, const Sharp& sharp) {
    while (steps_ < options_.max_steps) {
      const auto decrement = f.step(at_);
      ++steps_;
      if (enough()) return BandEnd::kLeast;
      const bool last = sharp();
      if (!decrement || *decrement < (last ? kThere : kNear)) {
        if (last) return BandEnd::kLeast;
        f.weight *= kSharpen;
      }
    }
    return BandEnd::kStepLimit;
  }

  const BandProblem& problem_;
  BarrierOptions options_;
  BandRows band_;
  BarrierPoint at_;
  int steps_ = 0;
};

}  // namespace

BandCurve solve_band(const BandProblem& problem, std::vector<Point3> start,
                     const BarrierOptions& options) {
  return BandSolver(problem, std::move(start), rates_never(), options).least_energy();
}

BandCurve least_ratio_in_band(const BandProblem& problem, std::vector<Point3> start,
                              int from_derivative, const BarrierOptions& options) {
  return BandSolver(problem, std::move(start), from_derivative, options).least_ratio();
}

}  // namespace batten::geometry
