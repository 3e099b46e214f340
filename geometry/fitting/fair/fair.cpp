#include "geometry/fitting/fair/fair.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>
#include <string>
#include <utility>

#include "geometry/basic/rounding.h"
#include "geometry/fitting/bspline_fit.h"
#include "geometry/fitting/fair/denoised_path.h"
#include "geometry/fitting/fair/fair_measure.h"

namespace batten::geometry {

namespace {

// A fair curve along a chain of vertices, held inside its band. A value: a copy goes its own way.
// Method: docs/algorithms/fair.md, sections Band and Staying inside.
class BandFit {
 public:
  // `points`: two or more, neighbours apart. `met`: vertices that the curve meets closely though
  // they are no corners. `rooms`: as FairOptions has them, for these points.
  BandFit(std::vector<Point3> points, const FairOptions& options, std::vector<std::size_t> met,
          std::vector<double> rooms)
      : points_(std::move(points)),
        options_(options),
        met_(std::move(met)),
        features_(find_features(points_, {options.tolerance, options.keep_corner_angle,
                                          options.rounding, options.keep_found_corner})),
        rooms_(std::move(rooms)),
        at_(features_.parameters),
        off_(points_.size() - 1),
        tight_(points_.size()) {
    rooms_.resize(points_.size() - 1, 1);
    care_.loosen.assign(points_.size(), 1);
    for (const double room : rooms_) care_.edges.push_back({room, 0});
  }

  // Fits, looks at the curve between the samples, and fits again where it left the band. What
  // depends on the curve can be asked for after it.
  void hold() {
    // Where noise takes much of the band, the smoothest curve in it swings from one of its sides to
    // the other and is further from the path that was meant than the vertices. So that path is
    // estimated first, but for who wants a simple curve further away.
    if (!fit_ && !(options_.scatter > 0)) {
      care_.denoised = denoised_among_noise(points_, features_, aimed_limit(options_),
                                            counted_rounding(options_));
    }
    for (int attempt = 0; attempt <= kFairTuning.attempts; ++attempt) {
      fit();
      measure();
      if (attempt == kFairTuning.attempts || !mend()) return;
      if (attempt + 1 < kFairTuning.attempts) continue;
      // Nothing else is sure to hold.
      for (std::size_t edge = 0; edge < off_.size(); ++edge) keep_edges(edge, 0);
    }
  }

  // Expects the vertices to scatter more, by these factors (per vertex, 1 or more; infinite: only
  // the limit counts), and fits again where that differs from before.
  void loosen(std::vector<double> factors) {
    care_.loosen = std::move(factors);
    hold();
  }

  // Asks for what `before` asked for in these sections of vertices, and fits again. `before`: an
  // earlier fit of the same path.
  void take_back(const BandFit& before, std::span<const IndexRange> sections) {
    for (const IndexRange& section : sections) {
      for (std::size_t i = section.begin; i < section.end; ++i) {
        care_.loosen[i] = before.care_.loosen[i];
        features_.kinds[i] = before.features_.kinds[i];
        if (i + 1 == section.end) break;
        features_.lines[i] = before.features_.lines[i];
        care_.edges[i] = before.care_.edges[i];
      }
    }
    hold();
  }

  [[nodiscard]] std::size_t size() const { return points_.size(); }
  [[nodiscard]] const PathFeatures& features() const { return features_; }
  [[nodiscard]] const std::vector<double>& loosened() const { return care_.loosen; }

  [[nodiscard]] BsplineCurve curve() const { return fit_->curve(); }
  [[nodiscard]] const std::vector<double>& parameters() const { return at_; }  // of the vertices

  // Per edge: greatest distance between it and the curve, mm, over its room.
  [[nodiscard]] const std::vector<double>& deviations() const { return off_; }

  // Whether the curve at a vertex is too tight for the feed.
  [[nodiscard]] bool is_tight(std::size_t vertex) const { return tight_[vertex]; }

  // s: along the curve beside the edges between these vertices.
  [[nodiscard]] double time_beside(const IndexRange& vertices) const {
    SplineWalk curve = walk();
    const VertexPlaces path{points_, at_};
    double time = 0;
    for (std::size_t i = vertices.begin; i + 1 < vertices.end; ++i) {
      time += edge_time(curve, path, i, limits());
    }
    return time;
  }

 private:
  [[nodiscard]] SplineWalk walk() const { return {fit_->spline().knots, fit_->spline().points}; }

  [[nodiscard]] TravelLimits limits() const {
    return {options_.feed / 60, options_.acceleration, options_.jerk};
  }

  void fit() {
    FitProblem problem = state_fair_problem(points_, features_, care_, options_);
    for (const std::size_t i : met_) {
      const double u = features_.parameters[i];
      const auto at = std::ranges::lower_bound(problem.samples, u, {}, &FitSample::parameter);
      if (at == problem.samples.end() || at->parameter != u) continue;
      at->limit = kFairTuning.met * options_.tolerance;
      at->scatter = 0;
    }
    if (fit_) {
      fit_->refit(problem, kFairTuning.closest_knots * aimed_limit(options_));
    } else {
      fit_.emplace(problem);
    }
  }

  // Renews what depends on the curve, where it moved.
  void measure() {
    const std::vector<double>& start = features_.parameters;
    const std::size_t vertices = points_.size();
    SplineWalk curve = walk();
    const TravelLimits most = limits();
    const auto index_of = [&](double u) {
      return static_cast<std::size_t>(std::lower_bound(start.begin(), start.end(), u) -
                                      start.begin());
    };
    std::size_t done = 0;  // vertices before this one are measured
    for (const ParameterRange& part : fit_->moved()) {
      // A vertex belongs to a parameter up to half an edge away.
      const std::size_t first = std::max(done, std::max<std::size_t>(index_of(part.from), 2) - 2);
      const std::size_t last = std::min(index_of(part.to) + 2, vertices);
      for (std::size_t i = first; i < last; ++i) {
        at_[i] = nearest_parameter(curve, points_, start, i);
        tight_[i] = exceeds(curve, at_[i], most);
      }
      const VertexPlaces path{points_, at_};
      const std::size_t first_edge = std::max<std::size_t>(first, 1) - 1;
      const std::size_t last_edge = std::min(last, vertices - 1);
      for (std::size_t edge = first_edge; edge < last_edge; ++edge) {
        off_[edge] = edge_deviation(curve, path, edge, rooms_[edge] * options_.tolerance);
        off_[edge] /= rooms_[edge];
      }
      done = last;
    }
  }

  // Tightens the problem where the curve left the band. Returns whether it did anywhere.
  [[nodiscard]] bool mend() {
    bool left = false;
    for (std::size_t edge = 0; edge < off_.size(); ++edge) {
      if (off_[edge] <= options_.tolerance) continue;
      left = true;
      EdgeRefinement& care = care_.edges[edge];
      const bool noisy = is_noisy(edge);
      const int watched = noisy ? kFairTuning.watched_among_noise : kFairTuning.watched;
      const bool slightly = off_[edge] < kFairTuning.slightly * options_.tolerance;
      care.violations += slightly || noisy ? 1 : watched + 1;
      care.share *= std::max(kFairTuning.least_share,
                             kFairTuning.aim_again * options_.tolerance / off_[edge]);
      if (care.violations > watched) {
        keep_edges(edge, (std::size_t{1} << (care.violations - watched - 1)) - 1);
      }
    }
    return left;
  }

  // Whether noise takes much of the band at an end of the edge.
  [[nodiscard]] bool is_noisy(std::size_t edge) const {
    if (care_.denoised.empty()) return false;
    return care_.denoised[edge] != points_[edge] || care_.denoised[edge + 1] != points_[edge + 1];
  }

  // An edge and so many on either side stay lines between kept corners.
  void keep_edges(std::size_t edge, std::size_t around) {
    const std::size_t last = std::min(edge + around, off_.size() - 1);
    for (std::size_t e = edge < around ? 0 : edge - around; e <= last; ++e) {
      features_.lines[e] = true;
      features_.kinds[e] = VertexKind::kKeptCorner;
      features_.kinds[e + 1] = VertexKind::kKeptCorner;
    }
  }

  std::vector<Point3> points_;
  FairOptions options_;
  std::vector<std::size_t> met_;
  PathFeatures features_;
  FairCare care_;
  std::vector<double> rooms_;  // per edge
  std::optional<PartedFit> fit_;
  std::vector<double> at_;
  std::vector<double> off_;
  std::vector<bool> tight_;  // per vertex
};

// The vertices beside which the curve is too tight for the feed, and some on either side of them.
std::vector<bool> tight_vertices(const BandFit& fit) {
  const std::size_t n = fit.size();
  std::vector<bool> tight(n, false);
  for (std::size_t i = 1; i + 1 < n; ++i) {
    if (fit.features().kinds[i] != VertexKind::kSmooth || !fit.is_tight(i)) continue;
    constexpr std::size_t kAround = kFairTuning.beside_tight;
    const std::size_t last = std::min(i + kAround, n - 1);
    for (std::size_t j = i < kAround ? 0 : i - kAround; j <= last; ++j) tight[j] = true;
  }
  return tight;
}

// More scatter for vertices where the curve is too tight for the feed, beyond what was tried
// before; nothing when there are none that could still be given more.
std::optional<std::vector<double>> widened(const BandFit& fit, const FairOptions& options,
                                           std::vector<double>& tried) {
  const std::vector<bool> tight = tight_vertices(fit);
  std::vector<double> loosen = fit.loosened();
  bool any = false;
  for (std::size_t i = 0; i < tight.size(); ++i) {
    if (!tight[i] || std::isinf(tried[i])) continue;
    tried[i] *= kFairTuning.widen;
    const double scatter = std::max(fit.features().noise[i], options.rounding) * tried[i];
    if (scatter > kFairTuning.most_scatter * options.tolerance)
      tried[i] = std::numeric_limits<double>::infinity();
    loosen[i] = tried[i];
    any = true;
  }
  if (!any) return std::nullopt;
  return loosen;
}

// Sections of vertices in which one fit was asked for something else than the other, and some
// vertices around.
std::vector<IndexRange> sections_apart(const BandFit& before, const BandFit& after) {
  const std::size_t n = before.size();
  std::vector<IndexRange> sections;
  for (std::size_t i = 0; i < n; ++i) {
    if (before.loosened()[i] == after.loosened()[i] &&
        before.features().kinds[i] == after.features().kinds[i]) {
      continue;
    }
    constexpr std::size_t kBeside = kFairTuning.beside_widened;
    const IndexRange around{i < kBeside ? 0 : i - kBeside, std::min(i + kBeside + 1, n)};
    if (!sections.empty() && around.begin <= sections.back().end) {
      sections.back().end = around.end;
    } else {
      sections.push_back(around);
    }
  }
  return sections;
}

// A curve that had to keep edges as they were is not smoother, whatever its time says.
bool is_worth_it(const BandFit& before, const BandFit& after, IndexRange section,
                 double tolerance) {
  for (std::size_t i = section.begin; i < section.end; ++i) {
    if (before.features().kinds[i] != after.features().kinds[i]) return false;
    if (i + 1 == section.end) break;
    if (after.deviations()[i] > tolerance) return false;
  }
  return after.time_beside(section) <= (1 - kFairTuning.worth_it) * before.time_beside(section);
}

bool is_inside(const BandFit& fit, double tolerance) {
  return std::ranges::all_of(fit.deviations(), [&](double off) { return off <= tolerance; });
}

// Widens the scatter where the curve is too tight for the feed, a few times, and keeps that where
// it saves time (docs/algorithms/fair.md, section Need). Every section is judged for itself.
// Returns the number of rounds that anything was kept of.
int widen_for_feed(BandFit& fit, const FairOptions& options) {
  std::vector<double> tried(fit.size(), 1);
  int rounds = 0;
  for (int round = 0; round < kFairTuning.rounds; ++round) {
    auto loosen = widened(fit, options, tried);
    if (!loosen) break;
    BandFit next = fit;
    next.loosen(std::move(*loosen));
    const std::vector<IndexRange> sections = sections_apart(fit, next);
    std::vector<IndexRange> in_vain;
    for (const IndexRange& section : sections) {
      if (!is_worth_it(fit, next, section, options.tolerance)) in_vain.push_back(section);
    }
    if (in_vain.size() == sections.size()) continue;
    if (!in_vain.empty()) next.take_back(fit, in_vain);
    if (!is_inside(next, options.tolerance)) break;
    fit = std::move(next);
    ++rounds;
  }
  return rounds;
}

// A curve along a chain of vertices.
struct Faired {
  BsplineCurve curve;
  std::vector<double> parameters;  // of each vertex, increasing
};

// The same control points, with a knot at u where one is as good as there: the curve slides along
// itself by a thirtieth of a span at the most.
BsplineCurve with_near_knot_at(const BsplineCurve& curve, double u) {
  std::vector<double> knots = curve.basis().knots();
  const auto above = std::lower_bound(knots.begin(), knots.end(), u);
  for (const auto knot : {above, above - 1}) {
    if (knot <= knots.begin() || knot + 1 >= knots.end()) continue;
    const double room = std::min(*knot - *(knot - 1), *(knot + 1) - *knot);
    if (std::abs(*knot - u) < kFairTuning.on_cut * room) *knot = u;
  }
  return {BsplineBasis(curve.degree(), std::move(knots)), curve.control_points()};
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

// The vertices of a closed run (the first is the last) with `wrap` more of them on either side.
// Requires wrap < points.size().
std::vector<Point3> wrapped(std::span<const Point3> points, std::size_t wrap) {
  const std::size_t period = points.size() - 1;
  std::vector<Point3> out;
  out.reserve(points.size() + 2 * wrap);
  for (std::size_t i = 0; i < wrap; ++i) out.push_back(points[period - wrap + i]);
  out.insert(out.end(), points.begin(), points.end());
  for (std::size_t i = 1; i <= wrap; ++i) out.push_back(points[i]);
  return out;
}

// The `count` vertices from `wrap` on of a curve along wrapped vertices.
Faired one_period(const Faired& all, std::size_t wrap, std::size_t count) {
  const auto begin = all.parameters.begin() + static_cast<std::ptrdiff_t>(wrap);
  std::vector<double> at(begin, begin + static_cast<std::ptrdiff_t>(count));
  const BsplineCurve cut = with_near_knot_at(with_near_knot_at(all.curve, at.front()), at.back());
  BsplineCurve part = cut.part(at.front(), at.back());
  return {std::move(part), std::move(at)};
}

// The period without a seam where the tolerance allows it; with one of the size of the fit's error,
// some thousandths of a radian, where joining would leave the band; nothing where neither holds.
std::optional<Faired> closed_at_seam(const Faired& period, std::span<const Point3> points,
                                     double tolerance) {
  const auto deviates = [&](const Faired& faired) {
    return greatest_deviation(faired.curve, {points, faired.parameters}, tolerance);
  };
  constexpr std::size_t kRoomToJoin = 6;
  if (period.curve.control_points().size() >= kRoomToJoin) {
    Faired joined = joined_at(period, points.front());
    if (deviates(joined) <= tolerance) return joined;
  }
  Faired shifted = shifted_to(period, points.front());
  if (deviates(shifted) <= tolerance) return shifted;
  return std::nullopt;
}

// The run without repeated places.
struct Vertices {
  std::vector<Point3> points;
  std::vector<std::size_t> of_input;  // index into points, per input point
};

Vertices distinct(std::span<const Point3> input) {
  Vertices v;
  v.points.reserve(input.size());
  v.of_input.reserve(input.size());
  v.points.push_back(input[0]);
  for (const Point3& p : input) {
    if ((p - v.points.back()).norm() > kSamePlace) v.points.push_back(p);
    v.of_input.push_back(v.points.size() - 1);
  }
  return v;
}

// Of the edges between distinct places: the least room of what is one of them.
std::vector<double> rooms_of(const Vertices& vertices, const FairOptions& options) {
  if (options.rooms.empty()) return {};
  std::vector<double> rooms(vertices.points.size() - 1, 1);
  for (std::size_t i = 0; i < options.rooms.size(); ++i) {
    double& room = rooms[std::min(vertices.of_input[i], rooms.size() - 1)];
    room = std::min(room, options.rooms[i]);
  }
  return rooms;
}

// rms of the vertices' distances from the curve.
double scatter_of(const Faired& faired, std::span<const Point3> points) {
  SplineWalk curve(faired.curve.basis().knots(), faired.curve.control_points());
  double squares = 0;
  for (std::size_t i = 0; i < points.size(); ++i) {
    squares += (curve.point_at(faired.parameters[i]) - points[i]).squaredNorm();
  }
  return std::sqrt(squares / static_cast<double>(points.size()));
}

// `offset`: the vertex of the fit at which `faired` starts.
SmoothCurve result_of(Faired faired, const Vertices& vertices, const PathFeatures& features,
                      std::size_t offset) {
  const double noise = scatter_of(faired, vertices.points);
  SmoothCurve path{std::move(faired.curve), {}, 0, noise, 0, 0};
  for (std::size_t i = 1; i + 1 < vertices.points.size(); ++i) {
    if (features.kinds[i + offset] == VertexKind::kKeptCorner) ++path.kept_corners;
  }
  path.vertex_parameters.reserve(vertices.of_input.size());
  for (const std::size_t i : vertices.of_input) {
    path.vertex_parameters.push_back(faired.parameters[i]);
  }
  return path;
}

// A closed path without a seam: it is faired with some of its vertices repeated before its start
// and after its end, and one period is cut out. Method: docs/algorithms/fair.md, section Closed
// runs.
// Nothing when the run starts at a corner, or when its ends do not join inside the band.
std::optional<SmoothCurve> fair_closed(const Vertices& vertices, const FairOptions& options) {
  const std::size_t n = vertices.points.size();
  const std::size_t wrap = std::min(kFairTuning.wrap, n - 1);
  std::vector<double> rooms = rooms_of(vertices, options);
  if (!rooms.empty()) {
    const std::vector<double> once = rooms;
    rooms.clear();
    for (std::size_t edge = 0; edge + 1 < n + 2 * wrap; ++edge) {
      rooms.push_back(once[(edge + once.size() - wrap) % once.size()]);
    }
  }
  BandFit fit(wrapped(vertices.points, wrap), options, {wrap, wrap + n - 1}, std::move(rooms));
  if (fit.features().kinds[wrap] != VertexKind::kSmooth) return std::nullopt;
  fit.hold();
  const int rounds = options.accurate ? 0 : widen_for_feed(fit, options);
  const Faired period = one_period({fit.curve(), fit.parameters()}, wrap, n);
  auto closed = closed_at_seam(period, vertices.points, options.tolerance);
  if (!closed) return std::nullopt;
  const double deviation =
      greatest_deviation(closed->curve, {vertices.points, closed->parameters}, options.tolerance);
  SmoothCurve path = result_of(std::move(*closed), vertices, fit.features(), wrap);
  path.deviation = deviation;
  path.rounds = rounds;
  return path;
}

SmoothCurve fair_open(const Vertices& vertices, const FairOptions& options) {
  BandFit fit(vertices.points, options, {}, rooms_of(vertices, options));
  fit.hold();
  const int rounds = options.accurate ? 0 : widen_for_feed(fit, options);
  SmoothCurve path = result_of({fit.curve(), fit.parameters()}, vertices, fit.features(), 0);
  path.deviation = *std::ranges::max_element(fit.deviations());
  path.rounds = rounds;
  for (std::size_t i = 0; i + 1 < vertices.of_input.size(); ++i) {
    const std::size_t edge = vertices.of_input[i];
    const bool apart = edge != vertices.of_input[i + 1];
    path.edge_deviations.push_back(apart ? fit.deviations()[edge] : 0);
  }
  return path;
}

void require(bool condition, const std::string& problem) {
  if (!condition) throw std::invalid_argument("fair_path: " + problem);
}

}  // namespace

std::optional<SmoothCurve> fair_path(std::span<const Point3> points, const FairOptions& options) {
  require(points.size() >= 2, std::to_string(points.size()) + " points, expected 2 or more");
  require(options.tolerance > 0,
          "tolerance " + std::to_string(options.tolerance) + " mm, expected more than 0");
  require(options.rooms.empty() || options.rooms.size() + 1 == points.size(),
          std::to_string(options.rooms.size()) + " rooms, expected one for each edge");
  const Vertices vertices = distinct(points);
  const std::size_t n = vertices.points.size();
  if (n < 2) return std::nullopt;

  const bool closed =
      n > 3 && (vertices.points.front() - vertices.points.back()).norm() <= kSamePlace;
  if (closed) {
    if (auto path = fair_closed(vertices, options)) return path;
  }
  return fair_open(vertices, options);
}

}  // namespace batten::geometry
