#include "geometry/fair.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>
#include <string>
#include <utility>

#include "geometry/fair_problem.h"
#include "geometry/numeric.h"
#include "geometry/path_features.h"

namespace batten::geometry {

namespace {

// The fit aims inside the band by this share, since between its samples the curve leaves the
// band by a percent or two.
constexpr double kAim = 0.96;
constexpr int kAttempts = 4;
constexpr double kSlightly = 1.2;  // left the band by less: one more fit further inside holds it

// Vertices of a closed run that are added before its start and after its end: the influence of
// a vertex on the curve dies out over some ten vertices.
constexpr std::size_t kWrap = 200;

// The seam of a closed run is met to this part of the tolerance by the fit, and then exactly by
// a shift of that size.
constexpr double kSeamLimit = 0.01;

// Rounds of widening for the machine's need, what one widens by, and the least part of the
// time that a round must win to be kept.
constexpr int kNeedRounds = 3;
constexpr double kWiden = 4;
constexpr double kWorthIt = 0.002;

// The run without repeated places.
struct Vertices {
  std::vector<Point3> points;
  std::vector<std::size_t> of_input;  // index into points, per input point
};

Vertices distinct(std::span<const Point3> input) {
  Vertices v;
  v.points.push_back(input[0]);
  for (const Point3& p : input) {
    if ((p - v.points.back()).norm() > kSamePlace) v.points.push_back(p);
    v.of_input.push_back(v.points.size() - 1);
  }
  return v;
}

// A fit to a chain of vertices with what is needed to judge it.
struct Faired {
  BsplineCurve curve;
  std::vector<double> parameters;  // of each vertex, increasing
};

// The places on the curve that are nearest to the vertices, in order: two Newton steps from the
// parameters that the fit started with.
std::vector<double> nearest_parameters(const BsplineCurve& curve, std::span<const Point3> points,
                                       const std::vector<double>& start) {
  std::vector<double> at = start;
  for (std::size_t i = 0; i < at.size(); ++i) {
    const double low = i == 0 ? start[i] : 0.5 * (start[i - 1] + start[i]);
    const double high = i + 1 == at.size() ? start[i] : 0.5 * (start[i] + start[i + 1]);
    for (int step = 0; step < 2; ++step) {
      const Vector3 velocity = curve.derivative_at(at[i], 1);
      const double squared = velocity.squaredNorm();
      if (squared == 0) break;
      at[i] += (points[i] - curve.point_at(at[i])).dot(velocity) / squared;
      at[i] = std::clamp(at[i], low, high);
    }
  }
  at.front() = start.front();
  at.back() = start.back();
  return at;
}

double distance_to_edge(const Point3& p, const Point3& a, const Point3& b) {
  const Vector3 d = b - a;
  const double t = std::clamp((p - a).dot(d) / d.squaredNorm(), 0.0, 1.0);
  return (p - a - t * d).norm();
}

// Greatest distance between each edge and the curve beside it, by samples, near in order; the
// distance of a vertex counts for both its edges.
std::vector<double> edge_deviations(const Faired& faired, std::span<const Point3> points) {
  const std::size_t edges = points.size() - 1;
  std::vector<double> worst(edges, 0);
  const std::vector<double> breaks = faired.curve.breakpoints();
  std::vector<double> places;
  std::size_t span = 0;
  for (std::size_t i = 0; i <= edges; ++i) {
    const double off = (faired.curve.point_at(faired.parameters[i]) - points[i]).norm();
    if (i > 0) worst[i - 1] = std::max(worst[i - 1], off);
    if (i == edges) break;
    worst[i] = std::max(worst[i], off);
    const double from = faired.parameters[i];
    const double to = faired.parameters[i + 1];
    places.clear();
    constexpr int kParts = 6;
    for (int k = 1; k < kParts; ++k) places.push_back(from + (to - from) * k / kParts);
    while (span + 1 < breaks.size() && breaks[span + 1] <= from) ++span;
    for (std::size_t b = span; b + 1 < breaks.size() && breaks[b] < to; ++b) {
      for (int k = 0; k < kParts; ++k) {
        const double u = breaks[b] + (breaks[b + 1] - breaks[b]) * k / kParts;
        if (u > from && u < to) places.push_back(u);
      }
    }
    for (const double u : places) {
      const Point3 here = faired.curve.point_at(u);
      double nearest = std::numeric_limits<double>::infinity();
      for (std::size_t e = i == 0 ? 0 : i - 1; e <= i + 1 && e < edges; ++e) {
        nearest = std::min(nearest, distance_to_edge(here, points[e], points[e + 1]));
      }
      worst[i] = std::max(worst[i], nearest);
    }
  }
  return worst;
}

double deviation_of(const Faired& faired, std::span<const Point3> points) {
  const std::vector<double> edges = edge_deviations(faired, points);
  return *std::max_element(edges.begin(), edges.end());
}

class Fairing {
 public:
  Fairing(std::vector<Point3> points, const FairOptions& options, std::vector<std::size_t> met)
      : points_(std::move(points)), options_(options), met_(std::move(met)) {
    features_ =
        find_features(points_, {options.tolerance, options.keep_corner_angle, options.rounding});
  }

  [[nodiscard]] const PathFeatures& features() const { return features_; }
  [[nodiscard]] const std::vector<Point3>& points() const { return points_; }
  [[nodiscard]] int rounds() const { return rounds_; }

  [[nodiscard]] Faired solve() {
    std::vector<double> loosen(points_.size(), 1);
    Faired best = fit(loosen);
    if (options_.accurate) return best;
    double time = travel_time(best);
    for (int round = 0; round < kNeedRounds; ++round) {
      if (!widen_where_needed(best, loosen)) break;
      const PathFeatures before = features_;
      Faired next = fit(loosen);
      const double next_time = travel_time(next);
      // A curve that had to keep edges as they were is not smoother, whatever its time says.
      const bool held =
          deviation_of(next, points_) <= options_.tolerance && features_.kinds == before.kinds;
      if (!held || next_time > (1 - kWorthIt) * time) {
        features_ = before;
        break;
      }
      best = std::move(next);
      time = next_time;
      ++rounds_;
    }
    return best;
  }

 private:
  // Fits, looks at the curve between the samples, and fits again where it left the band: a
  // little further inside at first, and then with the edges that cannot be held as they were.
  [[nodiscard]] Faired fit(const std::vector<double>& loosen) {
    double limit = kAim * options_.tolerance;
    for (int attempt = 0;; ++attempt) {
      Faired faired = fit_inside(limit, loosen);
      const std::vector<double> off = edge_deviations(faired, points_);
      const double worst = *std::max_element(off.begin(), off.end());
      if (worst <= options_.tolerance || attempt > kAttempts) return faired;
      if (attempt == 0 && worst < kSlightly * options_.tolerance) {
        limit *= kAim * options_.tolerance / worst;
      } else if (attempt < kAttempts) {
        keep_edges(off, attempt);
      } else {
        // Nothing else is sure to hold: the polyline itself.
        keep_edges(std::vector<double>(off.size(), worst), 0);
      }
    }
  }

  // The edges that the curve left, and more around them with every attempt, stay lines between
  // kept corners.
  void keep_edges(const std::vector<double>& off, int around) {
    const std::size_t edges = off.size();
    const auto reach = static_cast<std::size_t>(around);
    for (std::size_t e = 0; e < edges; ++e) {
      if (off[e] <= options_.tolerance) continue;
      for (std::size_t k = e < reach ? 0 : e - reach; k <= e + reach && k < edges; ++k) {
        features_.lines[k] = true;
        features_.kinds[k] = VertexKind::kKeptCorner;
        features_.kinds[k + 1] = VertexKind::kKeptCorner;
      }
    }
  }

  [[nodiscard]] Faired fit_inside(double limit, const std::vector<double>& loosen) const {
    BandOptions band;
    band.limit = limit;
    band.least_scatter =
        std::max(options_.scatter, std::min(options_.rounding, 0.25 * options_.tolerance));
    FitProblem problem = state_fair_problem(points_, features_, loosen, band);
    for (const std::size_t i : met_) {
      const auto at =
          std::lower_bound(problem.samples.begin(), problem.samples.end(), features_.parameters[i],
                           [](const FitSample& sample, double u) { return sample.parameter < u; });
      if (at == problem.samples.end() || at->parameter != features_.parameters[i]) continue;
      at->limit = kSeamLimit * options_.tolerance;
      at->scatter = 0;
    }
    BsplineFit result = fit_bspline(problem, {});
    std::vector<double> at = nearest_parameters(result.curve, points_, features_.parameters);
    return {std::move(result.curve), std::move(at)};
  }

  [[nodiscard]] double allowed_curvature() const {
    const double speed = options_.feed / 60;
    return options_.acceleration / (speed * speed);
  }

  // Seconds at the feed or at the speed that the acceleration across the path allows, whichever
  // is lower, vertex by vertex.
  [[nodiscard]] double travel_time(const Faired& faired) const {
    const double speed = options_.feed / 60;
    double time = 0;
    Point3 before = faired.curve.point_at(faired.parameters.front());
    for (std::size_t i = 1; i < faired.parameters.size(); ++i) {
      constexpr int kParts = 4;
      const double a = faired.parameters[i - 1];
      const double step = (faired.parameters[i] - a) / kParts;
      for (int k = 1; k <= kParts; ++k) {
        const Point3 here = faired.curve.point_at(a + k * step);
        const double curvature = faired.curve.curvature_at(a + (k - 0.5) * step);
        const double limit = std::sqrt(options_.acceleration / std::max(curvature, 1e-9));
        time += (here - before).norm() / std::min(speed, limit);
        before = here;
      }
    }
    return time;
  }

  // Widens the scatter around vertices where the curve is too tight for the feed. Returns
  // whether there were any that could still be widened.
  [[nodiscard]] bool widen_where_needed(const Faired& faired, std::vector<double>& loosen) const {
    const double allowed = allowed_curvature();
    std::vector<bool> tight(points_.size(), false);
    bool any = false;
    for (std::size_t i = 1; i + 1 < points_.size(); ++i) {
      if (features_.kinds[i] != VertexKind::kSmooth) continue;
      if (faired.curve.curvature_at(faired.parameters[i]) <= allowed) continue;
      constexpr std::size_t kAround = 3;
      for (std::size_t j = i < kAround ? 0 : i - kAround; j <= i + kAround && j < points_.size();
           ++j) {
        tight[j] = true;
      }
    }
    for (std::size_t i = 0; i < tight.size(); ++i) {
      if (!tight[i] || std::isinf(loosen[i])) continue;
      loosen[i] *= kWiden;
      const double scatter = std::max(features_.noise[i], options_.rounding) * loosen[i];
      if (scatter > 0.5 * options_.tolerance) {
        loosen[i] = std::numeric_limits<double>::infinity();
      }
      any = true;
    }
    return any;
  }

  std::vector<Point3> points_;
  FairOptions options_;
  std::vector<std::size_t> met_;  // vertices that the curve meets exactly, though no corners
  PathFeatures features_;
  int rounds_ = 0;
};

// rms of the vertices' distances from the curve.
double scatter_of(const Faired& faired, std::span<const Point3> points) {
  double squares = 0;
  for (std::size_t i = 0; i < points.size(); ++i) {
    squares += (faired.curve.point_at(faired.parameters[i]) - points[i]).squaredNorm();
  }
  return std::sqrt(squares / static_cast<double>(points.size()));
}

// The vertices of a closed run with kWrap (or a whole turn) more of them on either side.
std::vector<Point3> wrapped(const std::vector<Point3>& points, std::size_t wrap) {
  const std::size_t period = points.size() - 1;
  std::vector<Point3> out;
  out.reserve(points.size() + 2 * wrap);
  for (std::size_t i = 0; i < wrap; ++i) out.push_back(points[period - wrap + i]);
  out.insert(out.end(), points.begin(), points.end());
  for (std::size_t i = 1; i <= wrap; ++i) out.push_back(points[i]);
  return out;
}

// One period of a fit to a wrapped run.
Faired one_period(const Faired& all, std::size_t wrap, std::size_t count) {
  const auto begin = all.parameters.begin() + static_cast<std::ptrdiff_t>(wrap);
  std::vector<double> at(begin, begin + static_cast<std::ptrdiff_t>(count));
  BsplineCurve part = all.curve.part(at.front(), at.back());
  return {std::move(part), std::move(at)};
}

// The period moved at both ends so that it starts and ends at `seam`: three control points are
// shifted alike, so that tangent and curvature stay as they are there.
Faired shifted_to(const Faired& period, const Point3& seam) {
  std::vector<Point3> points = period.curve.control_points();
  const Vector3 at_start = seam - points.front();
  const Vector3 at_end = seam - points.back();
  const std::size_t n = points.size();
  for (std::size_t i = 0; i < std::min<std::size_t>(3, n / 2); ++i) {
    points[i] += at_start;
    points[n - 1 - i] += at_end;
  }
  points.front() = seam;
  points.back() = seam;
  return {BsplineCurve(period.curve.basis(), std::move(points)), period.parameters};
}

// The period with both ends at `seam` and with the mean of the two first and second derivatives
// there: no seam at all. Requires six control points or more.
Faired joined_at(const Faired& period, const Point3& seam) {
  const BsplineCurve& curve = period.curve;
  std::vector<Point3> points = curve.control_points();
  const std::size_t n = points.size();
  const auto mean = [&](int order) {
    return Vector3(0.5 * (curve.derivative_at(curve.first(), order) +
                          curve.derivative_at(curve.last(), order)));
  };
  const Vector3 d1 = mean(1);
  const Vector3 d2 = mean(2);
  const auto& t = curve.basis().knots();
  const std::size_t m = t.size();
  const double h1 = t[4] - t[3];
  const double h2 = t[5] - t[3];
  const double g1 = t[m - 4] - t[m - 5];
  const double g2 = t[m - 4] - t[m - 6];
  points[0] = seam;
  points[1] = seam + h1 / 3 * d1;
  points[2] = points[1] + h2 / 3 * (d1 + h1 / 2 * d2);
  points[n - 1] = seam;
  points[n - 2] = seam - g1 / 3 * d1;
  points[n - 3] = points[n - 2] - g2 / 3 * (d1 - g1 / 2 * d2);
  return {BsplineCurve(curve.basis(), std::move(points)), period.parameters};
}

// A closed curve without a seam where the band allows it; with one of the size of the fit's
// error, some thousandths of a radian, where joining would leave the band.
std::optional<Faired> closed_at(const Faired& period, std::span<const Point3> points,
                                double tolerance) {
  constexpr std::size_t kRoomToJoin = 6;
  if (period.curve.control_points().size() >= kRoomToJoin) {
    Faired joined = joined_at(period, points.front());
    if (deviation_of(joined, points) <= tolerance) return joined;
  }
  Faired shifted = shifted_to(period, points.front());
  if (deviation_of(shifted, points) <= tolerance) return shifted;
  return std::nullopt;
}

FairPath result_of(Faired faired, const Vertices& vertices, const Fairing& fairing,
                   std::size_t offset) {
  const std::size_t n = vertices.points.size();
  FairPath path{std::move(faired.curve), {}, 0, 0, 0, fairing.rounds()};
  const Faired view{path.curve, std::move(faired.parameters)};
  path.deviation = deviation_of(view, vertices.points);
  path.noise = scatter_of(view, vertices.points);
  for (std::size_t i = 1; i + 1 < n; ++i) {
    if (fairing.features().kinds[i + offset] == VertexKind::kKeptCorner) ++path.kept_corners;
  }
  path.vertex_parameters.reserve(vertices.of_input.size());
  for (const std::size_t i : vertices.of_input) {
    path.vertex_parameters.push_back(view.parameters[i]);
  }
  return path;
}

void require(bool condition, const std::string& problem) {
  if (!condition) throw std::invalid_argument("fair_path: " + problem);
}

}  // namespace

std::optional<FairPath> fair_path(std::span<const Point3> points, const FairOptions& options) {
  require(points.size() >= 2, std::to_string(points.size()) + " points, expected 2 or more");
  require(options.tolerance > 0,
          "tolerance " + std::to_string(options.tolerance) + " mm, expected more than 0");
  const Vertices vertices = distinct(points);
  const std::size_t n = vertices.points.size();
  if (n < 2) return std::nullopt;

  const bool closed =
      n > 3 && (vertices.points.front() - vertices.points.back()).norm() <= kSamePlace;
  if (closed) {
    const std::size_t wrap = std::min(kWrap, n - 1);
    Fairing fairing(wrapped(vertices.points, wrap), options, {wrap, wrap + n - 1});
    if (fairing.features().kinds[wrap] == VertexKind::kSmooth) {
      const Faired period = one_period(fairing.solve(), wrap, n);
      auto closed_path = closed_at(period, vertices.points, options.tolerance);
      if (closed_path) return result_of(std::move(*closed_path), vertices, fairing, wrap);
    }
  }
  Fairing fairing(vertices.points, options, {});
  return result_of(fairing.solve(), vertices, fairing, 0);
}

}  // namespace batten::geometry
