#include "geometry/fitting/tube/tube_smoothing.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <optional>
#include <span>
#include <stdexcept>
#include <string>
#include <utility>

#include "geometry/fitting/band_curve.h"
#include "geometry/fitting/naseath/naseath.h"
#include "geometry/numeric/extrema.h"
#include "geometry/path/parameter_samples.h"

namespace batten::geometry {

namespace {

std::vector<HeldPoint> held_ends(const BsplineCurve& curve, int held_points) {
  const auto& points = curve.control_points();
  const std::size_t last = points.size() - 1;
  if (held_points == 0) {
    return {HeldPoint::on_plane(0, points[0], curve.direction_at(curve.first())),
            HeldPoint::on_plane(last, points[last], curve.direction_at(curve.last()))};
  }
  std::vector<HeldPoint> held;
  const std::size_t most = std::min<std::size_t>(held_points, points.size() / 2);
  for (std::size_t i = 0; i < most; ++i) {
    held.push_back(HeldPoint::at(i, points[i]));
    held.push_back(HeldPoint::at(last - i, points[last - i]));
  }
  return held;
}

std::vector<BandSample> tube_samples(const BsplineCurve& curve, double radius) {
  std::vector<BandSample> samples;
  for (const ParameterSample& at : parameter_samples(curve, kTubeTuning.watched)) {
    BandSample sample;
    sample.parameter = at.parameter;
    sample.foot = curve.point_at(at.parameter);
    sample.radius = radius;
    samples.push_back(sample);
  }
  return samples;
}

// Curves of least energy in the tube about one curve, on its knots.
class TubeSolver {
 public:
  TubeSolver(const BsplineCurve& curve, const TubeOptions& options)
      : original_(curve), radius_(options.radius), problem_{curve.basis(), 3, {}, {}, {}} {
    problem_.samples = tube_samples(curve, options.radius);
    problem_.held = held_ends(curve, options.held_points);
  }

  // The curve with the least integral of weight * |C^(energy)|^2, energy 2 or 3.
  [[nodiscard]] BsplineCurve least(int energy, std::function<EnergyWeight(double)> weight) {
    problem_.energy = energy;
    problem_.weight = std::move(weight);
    const BandCurve found = solve_band(problem_, original_.control_points(), kTubeTuning.gap);
    visits_ += static_cast<std::size_t>(found.steps) * problem_.samples.size();
    return pulled_inside(found.curve);
  }

  // Newton steps so far, times the samples of each.
  [[nodiscard]] std::size_t visits() const { return visits_; }

  // The part of the way from the old curve to `moved`, which has its knots, that is inside the
  // tube at every parameter: all of it, if that is.
  [[nodiscard]] BsplineCurve pulled_inside(const BsplineCurve& moved) const {
    const double far = displacement(moved);
    if (far <= radius_) return moved;
    // The bound of the shorter displacement is rounded again: a slack less is surely enough.
    const double part = radius_ * (1 - kTubeTuning.slack) / far;
    std::vector<Point3> points = original_.control_points();
    for (std::size_t i = 0; i < points.size(); ++i) {
      points[i] += part * (moved.control_points()[i] - points[i]);
    }
    return {original_.basis(), std::move(points)};
  }

  // mm: a bound on |curve(u) - old(u)| for every u.
  [[nodiscard]] double displacement(const BsplineCurve& moved) const {
    std::vector<Point3> moves = moved.control_points();
    for (std::size_t i = 0; i < moves.size(); ++i) moves[i] -= original_.control_points()[i];
    const auto bounds = displacement_bounds(BsplineCurve(original_.basis(), std::move(moves)),
                                            kTubeTuning.slack * radius_);
    return *std::max_element(bounds.begin(), bounds.end());
  }

  [[nodiscard]] const BsplineCurve& original() const { return original_; }

 private:
  BsplineCurve original_;
  double radius_;
  BandProblem problem_;
  std::size_t visits_ = 0;
};

class TubeCandidates {
 public:
  TubeCandidates(const BsplineCurve& curve, const TubeOptions& options, int halvings)
      : options_(options),
        halvings_(halvings),
        solver_(with_spans_halved(curve, halvings), options),
        slow_curvature_(options.acceleration / (options.feed * options.feed)) {}

  void add(TubeMethod method, const BsplineCurve& curve) {
    found.push_back({method, halvings_, curve, solver_.displacement(curve)});
  }

  void add_least_energies() {
    const BsplineCurve bending = solver_.least(2, {});
    const BsplineCurve third = solver_.least(3, {});
    add(TubeMethod::kBending, bending);
    add(TubeMethod::kThirdDerivative, third);
    for (const BsplineCurve& start : {bending, third}) {
      add_weighted(TubeMethod::kCurvature, start, 0);
      add_weighted(TubeMethod::kQuick, start, kTubeTuning.quick_power);
      add_even(start);
    }
    add_weighted(TubeMethod::kQuick, solver_.original(), kTubeTuning.quick_power);
  }

  void add_few(std::span<const TubeMethod> methods, std::optional<BsplineCurve> third) {
    const auto least_third = [&]() -> const BsplineCurve& {
      if (!third) third = solver_.least(3, {});
      return *third;
    };
    for (const TubeMethod method : methods) {
      switch (method) {
        case TubeMethod::kOriginal:
          add(method, solver_.original());
          break;
        case TubeMethod::kBending:
          add(method, solver_.least(2, {}));
          break;
        case TubeMethod::kThirdDerivative:
          add(method, least_third());
          break;
        case TubeMethod::kCurvature:
          add(method, weighted(least_third(), 0));
          break;
        case TubeMethod::kQuick:
          add(method, weighted(least_third(), kTubeTuning.quick_power));
          break;
        default:
          throw std::invalid_argument("few_in_tube: method " + std::string(name_of(method)) +
                                      ", expected one of kFewMethods");
      }
    }
  }

  [[nodiscard]] std::size_t visits() const { return solver_.visits(); }

  void add_naseath(const NaseathRepairs& repairs, TubeMethod method) {
    NaseathOptions options;
    options.radius = options_.radius;
    options.held_points = options_.held_points;
    options.repairs = repairs;
    const BsplineCurve moved = smooth_naseath(solver_.original(), options).curve;
    add(method, solver_.pulled_inside(moved));
    add_weighted(TubeMethod::kQuick, moved, kTubeTuning.quick_power);
  }

  std::vector<TubeCandidate> found;

 private:
  // The integral of (1 + (kappa / slow)^2)^power * kappa^2 ds, the power taken of the curve of the
  // round before. kappa^2 ds is the square of what C'' has across C', over the third power of the
  // speed, du.
  void add_weighted(TubeMethod method, BsplineCurve curve, double power) {
    for (int round = 1; round <= kTubeTuning.rounds; ++round) {
      curve = weighted(curve, power);
      if (kTubeTuning.is_taken(round)) add(method, curve);
    }
  }

  [[nodiscard]] BsplineCurve weighted(const BsplineCurve& before, double power) {
    return solver_.least(2, [&](double u) {
      const double ratio = before.curvature_at(u) / slow_curvature_;
      return weight_at(before, u, std::pow(1 + ratio * ratio, power));
    });
  }

  // Weights rise from round to round where the curvature holds the machine up, until what is left
  // of it is spread evenly.
  void add_even(BsplineCurve curve) {
    const auto breaks = curve.breakpoints();
    std::vector<double> raised(breaks.size() - 1, 1);
    for (int round = 1; round <= kTubeTuning.rounds; ++round) {
      const BsplineCurve before = curve;
      raise(raised, before);
      curve = solver_.least(2, [&](double u) {
        const auto above = std::upper_bound(breaks.begin() + 1, breaks.end() - 1, u);
        return weight_at(before, u, raised[static_cast<std::size_t>(above - breaks.begin() - 1)]);
      });
      if (kTubeTuning.is_taken(round)) add(TubeMethod::kEven, curve);
    }
  }

  void raise(std::vector<double>& weights, const BsplineCurve& curve) const {
    constexpr std::size_t kSteps = kTubeTuning.curvature_samples;
    const auto samples = parameter_samples(curve, kTubeTuning.curvature_samples);
    for (std::size_t i = 0; i < weights.size(); ++i) {
      double most = slow_curvature_;
      for (std::size_t k = 0; k <= kSteps; ++k) {
        most = std::max(most, samples[i * kSteps + k].curvature);
      }
      weights[i] *= std::pow(most / slow_curvature_, kTubeTuning.raise);
    }
  }

  [[nodiscard]] static EnergyWeight weight_at(const BsplineCurve& curve, double u, double weight) {
    const Vector3 speed = curve.derivative_at(u, 1);
    const double size = std::max(speed.norm(), kTubeTuning.least_speed);
    return {weight / (size * size * size), speed / size};
  }

  const TubeOptions& options_;
  int halvings_;
  TubeSolver solver_;
  double slow_curvature_;  // 1/mm: from here on the feed cannot be held
};

void require(bool holds, const std::string& what) {
  if (!holds) throw std::invalid_argument("smooth_in_tube: " + what);
}

void check(const BsplineCurve& curve, const TubeOptions& options) {
  require(curve.degree() == 3, "degree " + std::to_string(curve.degree()) + ", expected 3");
  const auto& t = curve.basis().knots();
  const auto spans = curve.breakpoints().size() - 1;
  require(spans + 3 == curve.basis().size() && t[0] == curve.first() && t.back() == curve.last(),
          "knots that are not clamped, or repeated ones inside");
  require(options.radius > 0 && std::isfinite(options.radius),
          "radius " + std::to_string(options.radius) + " mm, expected a positive number");
  require(options.feed > 0 && options.acceleration > 0, "feed and acceleration must be positive");
  require(options.held_points >= 0 && options.held_points <= 3,
          std::to_string(options.held_points) + " held points, expected 0 to 3");
  require(options.halvings >= 0, "halvings below 0");
}

}  // namespace

std::string_view name_of(TubeMethod method) {
  constexpr std::string_view kNames[] = {
      "original",  "naseath", "naseath-literal", "bending", "third-derivative",
      "curvature", "even",    "quick",           "mixture"};
  return kNames[static_cast<std::size_t>(method)];
}

BsplineCurve with_spans_halved(const BsplineCurve& curve, int times) {
  if (times == 0) return curve;
  std::vector<double> knots;
  for (const double u : curve.basis().knots()) {
    if (!knots.empty() && knots.back() < u) knots.push_back(0.5 * (knots.back() + u));
    knots.push_back(u);
  }
  std::vector<Point3> points;
  for (std::size_t i = 0; i + 4 < knots.size(); ++i) {
    // Control point i is the value for the three knots after i of the symmetric polynomial, affine
    // in each of them, that is the curve's where all three are equal (L. Ramshaw 1987), on any span
    // that they surround.
    const double inside = 0.5 * (knots[i + 1] + knots[i + 3]);
    const double x = knots[i + 1] - inside;
    const double y = knots[i + 2] - inside;
    const double z = knots[i + 3] - inside;
    points.push_back(curve.point_at(inside) + (x + y + z) / 3 * curve.derivative_at(inside, 1) +
                     (x * y + x * z + y * z) / 6 * curve.derivative_at(inside, 2) +
                     x * y * z / 6 * curve.derivative_at(inside, 3));
  }
  return with_spans_halved({BsplineBasis(3, std::move(knots)), std::move(points)}, times - 1);
}

std::vector<TubeCandidate> smooth_in_tube(const BsplineCurve& curve, const TubeOptions& options) {
  check(curve, options);
  std::vector<TubeCandidate> all;
  for (int halvings = 0; halvings <= options.halvings; ++halvings) {
    TubeCandidates made(curve, options, halvings);
    if (halvings == 0) {
      made.add(TubeMethod::kOriginal, curve);
      made.add_naseath({}, TubeMethod::kNaseath);
      made.add_naseath(NaseathRepairs::none(), TubeMethod::kNaseathLiteral);
    }
    made.add_least_energies();
    for (TubeCandidate& candidate : made.found) all.push_back(std::move(candidate));
  }
  return all;
}

FewInTube few_in_tube(const BsplineCurve& curve, const TubeOptions& options,
                      std::span<const TubeMethod> methods,
                      const std::optional<BsplineCurve>& third) {
  check(curve, options);
  TubeCandidates made(curve, options, 0);
  made.add_few(methods, third);
  return {std::move(made.found), made.visits()};
}

namespace {

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
    const Timed& chosen =
        better.time < before * (1 - kTubeTuning.worth_moving) ? better : timed_.front();
    return {chosen.candidate, before, chosen.time, calls_};
  }

 private:
  static double bend_of(const BsplineCurve& curve) {
    return max_curvature(parameter_samples(curve, kTubeTuning.curvature_steps));
  }

  double time_of(const BsplineCurve& curve) {
    ++calls_;
    return timer_(curve);
  }

  Timed judged(TubeCandidate candidate) {
    const double time = time_of(candidate.curve);
    const bool harder = bend_of(candidate.curve) > bend_ * (1 + kTubeTuning.same_curvature);
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
    return any->time < soft->time * (1 - kTubeTuning.worth_bending) ? *any : *soft;
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
      if (!best.bends_harder && bend_of(curve) > bend_ * (1 + kTubeTuning.same_curvature)) {
        return kNever;
      }
      return time_of(curve);
    };
    std::vector<double> start(parts.size(), 0);
    start[0] = 1;
    PatternSearchOptions search;
    search.steps.assign(parts.size(), kTubeTuning.first_share);
    search.max_evaluations = kTubeTuning.mixtures;
    search.finest = kTubeTuning.finest_share;
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
      if (!known && parts.size() < kTubeTuning.mixed) parts.push_back(t);
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
