#include <algorithm>
#include <cstddef>
#include <limits>
#include <numeric>
#include <utility>
#include <vector>

#include "geometry/fitting/tube/tube_smoothing.h"
#include "geometry/fitting/tube/tube_smoothing_solver.h"
#include "geometry/numeric/pattern_search.h"
#include "geometry/path/parameter_samples.h"

namespace batten::geometry {

namespace {

constexpr int kCurvatureSteps = 64;  // per span
constexpr std::size_t kMixed = 4;    // candidates that a mixture is made of, at most
constexpr int kMixtures = 100;       // that are timed, at most
constexpr double kFirstShare = 0.25;

// A gain that is less than this part of the time is none: the curve stays where it was.
constexpr double kWorthMoving = 1e-6;

// Curvature above the old one's by less is rounding.
constexpr double kSameCurvature = 1e-9;

constexpr double kNever = std::numeric_limits<double>::infinity();

struct Timed {
  TubeCandidate candidate;
  double time = 0;
  bool bends_harder = false;
};

class Chooser {
 public:
  Chooser(const BsplineCurve& curve, const TubeOptions& options, const CurveTimer& timer)
      : curve_(curve), options_(options), timer_(timer), bend_(bend_of(curve)) {}

  TubeChoice choose() {
    for (TubeCandidate& candidate : smooth_in_tube(curve_, options_)) {
      timed_.push_back(judged(std::move(candidate)));
    }
    const double before = timed_.front().time;
    const Timed best = best_of(timed_);
    const Timed mixed = mixture(best);
    const Timed& better = mixed.time < best.time ? mixed : best;
    const Timed& chosen = better.time < before * (1 - kWorthMoving) ? better : timed_.front();
    return {chosen.candidate, before, chosen.time, calls_};
  }

 private:
  static double bend_of(const BsplineCurve& curve) {
    return max_curvature(parameter_samples(curve, kCurvatureSteps));
  }

  double time_of(const BsplineCurve& curve) {
    ++calls_;
    return timer_(curve);
  }

  Timed judged(TubeCandidate candidate) {
    const double time = time_of(candidate.curve);
    const bool harder = bend_of(candidate.curve) > bend_ * (1 + kSameCurvature);
    return {std::move(candidate), time, harder};
  }

  // The old curve is among them and does not bend harder than itself.
  static Timed best_of(const std::vector<Timed>& timed) {
    const Timed* soft = &timed.front();
    const Timed* any = soft;
    for (const Timed& t : timed) {
      if (t.time < any->time) any = &t;
      if (!t.bends_harder && t.time < soft->time) soft = &t;
    }
    return any->time < soft->time * (1 - kWorthBending) ? *any : *soft;
  }

  // Tubes are convex: a mean of curves in the tube is in it.
  Timed mixture(const Timed& best) {
    std::vector<const Timed*> parts = parts_for(best);
    const BsplineCurve base = with_spans_halved(curve_, options_.halvings);
    std::vector<std::vector<Vector3>> moves;
    for (const Timed* part : parts) {
      const BsplineCurve raised =
          with_spans_halved(part->candidate.curve, options_.halvings - part->candidate.halvings);
      moves.push_back(raised.control_points());
      for (std::size_t i = 0; i < moves.back().size(); ++i) {
        moves.back()[i] -= base.control_points()[i];
      }
    }
    const auto mixed = [&](const std::vector<double>& shares) {
      // Together they are one at most: what is missing is the old curve's share.
      const double sum = std::accumulate(shares.begin(), shares.end(), 0.0);
      std::vector<Point3> points = base.control_points();
      for (std::size_t k = 0; k < shares.size(); ++k) {
        const double share = shares[k] / std::max(1.0, sum);
        for (std::size_t i = 0; i < points.size(); ++i) points[i] += share * moves[k][i];
      }
      return BsplineCurve(base.basis(), std::move(points));
    };
    const auto time = [&](const std::vector<double>& shares) {
      if (*std::min_element(shares.begin(), shares.end()) < 0) return kNever;
      const BsplineCurve curve = mixed(shares);
      if (!best.bends_harder && bend_of(curve) > bend_ * (1 + kSameCurvature)) {
        return kNever;
      }
      return time_of(curve);
    };
    std::vector<double> start(parts.size(), 0);
    start[0] = 1;
    PatternSearchOptions search;
    search.steps.assign(parts.size(), kFirstShare);
    search.max_evaluations = kMixtures;
    search.finest = 0.01;
    const PatternSearchResult found = pattern_search(time, start, search);
    const BsplineCurve curve = mixed(found.at);
    const TubeSolver tube(base, options_);
    return {{TubeMethod::kMixture, options_.halvings, curve, tube.displacement(curve)},
            found.value,
            best.bends_harder};
  }

  // The best one first, then the quickest of other methods.
  std::vector<const Timed*> parts_for(const Timed& best) {
    std::vector<const Timed*> order;
    for (const Timed& t : timed_) {
      if (t.candidate.method != TubeMethod::kOriginal) order.push_back(&t);
    }
    std::stable_sort(order.begin(), order.end(),
                     [](const Timed* a, const Timed* b) { return a->time < b->time; });
    std::vector<const Timed*> parts = {&best};
    for (const Timed* t : order) {
      const bool known = std::any_of(parts.begin(), parts.end(), [&](const Timed* p) {
        return p->candidate.method == t->candidate.method;
      });
      if (!known && parts.size() < kMixed) parts.push_back(t);
    }
    return parts;
  }

  const BsplineCurve& curve_;
  const TubeOptions& options_;
  const CurveTimer& timer_;
  double bend_;
  std::vector<Timed> timed_;
  int calls_ = 0;
};

}  // namespace

TubeChoice best_in_tube(const BsplineCurve& curve, const TubeOptions& options,
                        const CurveTimer& timer) {
  return Chooser(curve, options, timer).choose();
}

}  // namespace batten::geometry
