#include "geometry/fitting/fewer_knots.h"

#include <algorithm>
#include <utility>

#include "geometry/basic/require.h"
#include "geometry/fitting/bspline_fit.h"
#include "geometry/path/curve_pieces.h"

namespace batten::geometry {

namespace {

// The fit starts with a span in the place of so many; those that cannot follow are split.
constexpr std::size_t kSpansPerSpan = 16;

constexpr int kSamplesPerSpan = 4;

// Between samples the curve may be this much further off than at them.
constexpr double kAtSamples = 0.95;

// Fits with ever smaller limits, until the distance that is measured is small enough.
constexpr int kTries = 3;

constexpr int kMeasuredPerSpan = 8;

// Towards the nearest place of a curve whose speed is nearly even: each step leaves a few percent.
constexpr int kMoveSteps = 3;

class Reducer {
 public:
  Reducer(const BsplineCurve& curve, const FewerKnotsOptions& options)
      : curve_(curve), options_(options), pieces_(curve, curve.first(), curve.last()) {}

  std::optional<BsplineCurve> reduce() {
    add_pins();
    add_zones();
    add_samples();
    add_breakpoints();
    for (int i = 0; i < kTries; ++i) {
      BsplineFit fit = fit_bspline(problem_);
      if (!(fit.worst_ratio <= 1 / kAtSamples)) return std::nullopt;
      if (fit.curve.control_points().size() >= curve_.control_points().size()) return std::nullopt;
      const double off = greatest_distance(fit.curve);
      if (off <= options_.max_deviation) return std::move(fit.curve);
      for (FitSample& sample : problem_.samples) {
        sample.limit *= kAtSamples * options_.max_deviation / off;
      }
    }
    return std::nullopt;
  }

 private:
  // Of places of the old curve from the new one. The fit measures across the old curve's tangents:
  // where the new one has run ahead in a bend, that is less.
  [[nodiscard]] double greatest_distance(const BsplineCurve& fewer) const {
    double most = 0;
    const auto& breaks = pieces_.breaks();
    for (std::size_t i = 0; i < pieces_.size(); ++i) {
      for (int k = 0; k < kMeasuredPerSpan; ++k) {
        const double u = breaks[i] + (breaks[i + 1] - breaks[i]) * k / kMeasuredPerSpan;
        most = std::max(most, distance_near(fewer, u, pieces_.point_at(u)));
      }
    }
    return most;
  }

  // From `place` to the curve about its parameter u.
  static double distance_near(const BsplineCurve& curve, double u, const Point3& place) {
    for (int i = 0; i < kMoveSteps; ++i) {
      const Vector3 along = curve.derivative_at(u, 1);
      const double speed = along.squaredNorm();
      if (!(speed > 0)) break;
      u += along.dot(place - curve.point_at(u)) / speed;
      u = std::clamp(u, curve.first(), curve.last());
    }
    return (curve.point_at(u) - place).norm();
  }

  void add_pins() {
    problem_.pins.push_back({curve_.first(), curve_.control_points().front()});
    for (const double u : pieces_.corners()) problem_.pins.push_back({u, pieces_.point_at(u)});
    problem_.pins.push_back({curve_.last(), curve_.control_points().back()});
  }

  // A straight part with a pin inside is two.
  void add_zones() {
    for (const StraightRun& run : pieces_.straight_runs()) {
      double from = run.from;
      auto pin = std::ranges::upper_bound(problem_.pins, from, {}, &Pin::parameter);
      for (; pin != problem_.pins.end() && pin->parameter < run.to; ++pin) {
        add_zone(from, pin->parameter);
        from = pin->parameter;
      }
      add_zone(from, run.to);
    }
  }

  void add_zone(double from, double to) {
    const Point3 start = pieces_.point_at(from);
    const Point3 end = pieces_.point_at(to);
    if ((end - start).norm() < options_.long_line) return;
    problem_.zones.push_back({from, to, start, end});
  }

  [[nodiscard]] bool in_zone(double u) const {
    const auto zone = std::ranges::lower_bound(problem_.zones, u, {}, &StraightZone::to);
    return zone != problem_.zones.end() && zone->from <= u;
  }

  [[nodiscard]] bool is_pinned(double u) const {
    return std::ranges::binary_search(problem_.pins, u, {}, &Pin::parameter);
  }

  void add_samples() {
    const auto& breaks = pieces_.breaks();
    for (std::size_t i = 0; i < pieces_.size(); ++i) {
      const double width = breaks[i + 1] - breaks[i];
      for (int k = 0; k < kSamplesPerSpan; ++k) {
        add_sample(breaks[i] + width * (k + 0.5) / kSamplesPerSpan, true);
      }
    }
    for (const double u : options_.places) add_sample(u, false);
    std::ranges::stable_sort(problem_.samples, {}, &FitSample::parameter);
    const auto same = [](const FitSample& a, const FitSample& b) {
      return a.parameter == b.parameter;
    };
    problem_.samples.erase(std::unique(problem_.samples.begin(), problem_.samples.end(), same),
                           problem_.samples.end());
  }

  void add_sample(double u, bool slides) {
    if (is_pinned(u) || in_zone(u)) return;
    FitSample sample;
    sample.parameter = u;
    sample.target = pieces_.point_at(u);
    if (slides) sample.along = pieces_.leaving(u);
    sample.limit = kAtSamples * options_.max_deviation;
    problem_.samples.push_back(sample);
  }

  void add_breakpoints() {
    auto& knots = problem_.breakpoints;
    for (const Pin& pin : problem_.pins) knots.push_back(pin.parameter);
    for (const StraightZone& zone : problem_.zones) {
      knots.push_back(zone.from);
      knots.push_back(zone.to);
    }
    const auto& breaks = pieces_.breaks();
    for (std::size_t i = kSpansPerSpan; i + 1 < breaks.size(); i += kSpansPerSpan) {
      if (!in_zone(breaks[i])) knots.push_back(breaks[i]);
    }
    std::ranges::sort(knots);
    knots.erase(std::unique(knots.begin(), knots.end()), knots.end());
  }

  const BsplineCurve& curve_;
  const FewerKnotsOptions& options_;
  CurvePieces pieces_;
  FitProblem problem_;
};

}  // namespace

double spans_expected(const CurvePieces& pieces, double deviation) {
  require(deviation > 0, "spans_expected: deviation", deviation, "> 0");
  constexpr double kInterpolation = 5.0 / 384;
  const auto& breaks = pieces.breaks();
  const auto third_derivative = [&](std::size_t i) -> Vector3 {
    const auto& c = pieces.piece(i).control;
    const double width = breaks[i + 1] - breaks[i];
    return 6 / (width * width * width) * (c[3] - 3 * c[2] + 3 * c[1] - c[0]);
  };
  double spans = 1;
  std::size_t first = 0;  // piece of the span
  Vector3 there = third_derivative(0);
  for (std::size_t i = 1; i < pieces.size(); ++i) {
    const double width = breaks[i + 1] - breaks[first];
    const Vector3 here = third_derivative(i);
    if (kInterpolation * (here - there).norm() * width * width * width <= deviation) continue;
    ++spans;
    first = i;
    there = here;
  }
  return spans;
}

std::optional<BsplineCurve> on_fewer_knots(const BsplineCurve& curve,
                                           const FewerKnotsOptions& options) {
  require(options.max_deviation > 0, "on_fewer_knots: deviation", options.max_deviation, "> 0");
  return Reducer(curve, options).reduce();
}

}  // namespace batten::geometry
