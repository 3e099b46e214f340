#include "geometry/fitting/fair/denoised_path.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <vector>

#include "geometry/fitting/bspline_fit_system.h"
#include "geometry/numeric/extrema.h"

namespace batten::geometry {

namespace {

// Fewer vertices than this tell nothing of their noise.
constexpr std::size_t kFewest = 8;

// A vertex that turns by so many times what its noise turns it (standard deviations) was meant to.
constexpr double kSurelyMeant = 4;

// The weight is looked for on so many vertices at the most, from the middle of a stretch: enough
// to know it to some percent, and few enough for the search to cost little.
constexpr std::size_t kJudged = 1000;

// Decades of the weight over the stiffness of the spline that are looked at. At the lower end a
// wave of a hundred vertices is smoothed away, at the upper one nothing is.
constexpr int kLowestDecade = -12;
constexpr int kHighestDecade = 1;
constexpr int kClosings = 6;  // of the interval around the best decade, by the golden section

// Where this part of the vertices is further from the meant path than the limit, noise fills the
// band: the curve that the others would allow has no room between these.
constexpr double kFillsBand = 0.125;

// Vertices that scatter by more than this part of the limit, and by more than so many of the
// greatest rounding errors, are drawn to their places. A curve that is only expected to leave their
// scatter leaves some of the path, too, where they are coarse, and would find room for the feed on
// any side of it.
constexpr double kMuch = 0.2;
constexpr double kRoundingNoise = 2;

// Of normal noise an eighth is beyond 1.5 standard deviations, and noise is known to a third.
constexpr double kMayFill = 0.4;

// Vertices are counted over so many on either side.
constexpr std::size_t kAround = 40;

bool parts_stretches(const PathFeatures& f, std::size_t i) {
  if (f.kinds[i] == VertexKind::kKeptCorner) return true;
  if (i > 0 && f.lines[i - 1]) return true;
  if (i < f.lines.size() && f.lines[i]) return true;
  if (f.kinds[i] == VertexKind::kSmooth) return false;
  const double before = f.parameters[i] - f.parameters[i - 1];
  const double after = f.parameters[i + 1] - f.parameters[i];
  return f.turns[i] > kSurelyMeant * f.noise[i] * (1 / before + 1 / after);
}

// The spline on a stretch of vertices; its ends are the first and the last of them.
class StretchSpline {
 public:
  StretchSpline(std::span<const Point3> points, std::span<const double> parameters)
      : spline_(spline_on({parameters.begin(), parameters.end()},
                          std::array{Pin{parameters.front(), points.front()},
                                     Pin{parameters.back(), points.back()}},
                          {})) {
    constexpr std::size_t kDegree = 3;
    std::size_t span = kDegree;
    for (std::size_t i = 0; i < points.size(); ++i) {
      rows_.push_back(row_at(spline_, parameters[i], span));
      states_.push_back({});
      states_.back().target = points[i];
    }
    std::vector<double> stiffness;
    for (const auto& row : spline_.energy) stiffness.push_back(row[0]);
    const auto middle = stiffness.begin() + static_cast<std::ptrdiff_t>(stiffness.size() / 2);
    std::nth_element(stiffness.begin(), middle, stiffness.end());
    stiffness_ = *middle;
  }

  // `weight`: of the squared distances, in stiffnesses.
  void solve(double weight) {
    for (SampleState& state : states_) state.base = weight * stiffness_;
    const IndexRange all{0, spline_.size()};
    if (!system_.solve(spline_, rows_, states_, {0, rows_.size()}, all)) return;
    for (std::size_t i = 0; i < spline_.size(); ++i) {
      if (spline_.fixed[i] == 0) spline_.points[i] = system_.place(i);
    }
  }

  // Generalised cross-validation (Craven and Wahba 1978): the squares that are left, over the
  // square of the freedom that is left.
  [[nodiscard]] double validation(double weight) {
    solve(weight);
    system_.invert(spline_, 0);
    double squares = 0;
    double freedom = 0;
    for (std::size_t i = 1; i + 1 < rows_.size(); ++i) {
      squares += (place(i) - states_[i].target).squaredNorm();
      freedom += 1 - states_[i].base * system_.leverage(rows_[i]);
    }
    return freedom > 0 ? squares / (freedom * freedom) : HUGE_VAL;
  }

  [[nodiscard]] Point3 place(std::size_t i) const { return place_of(rows_[i], spline_.points); }

 private:
  FitSpline spline_;
  FitSystem system_;
  std::vector<FitRow> rows_;
  std::vector<SampleState> states_;
  double stiffness_ = 0;
};

// Decades of the best weight.
double best_weight(StretchSpline& spline) {
  const auto of = [&](double decades) { return spline.validation(std::pow(10, decades)); };
  double best = kHighestDecade;
  double least = of(best);
  for (int decade = kHighestDecade - 1; decade >= kLowestDecade; --decade) {
    const double value = of(decade);
    if (value < least) {
      least = value;
      best = decade;
    }
  }
  const auto worth = [&](double decades) { return -of(decades); };
  return golden_maximum(worth, best - 1, best + 1, kClosings).at;
}

void place_stretch(std::span<const Point3> points, std::span<const double> parameters,
                   std::span<Point3> meant) {
  const std::size_t judged = std::min(points.size(), kJudged);
  const std::size_t first = (points.size() - judged) / 2;
  StretchSpline part(points.subspan(first, judged), parameters.subspan(first, judged));
  const double weight = std::pow(10, best_weight(part));
  StretchSpline whole(points, parameters);
  whole.solve(weight);
  for (std::size_t i = 1; i + 1 < points.size(); ++i) meant[i] = whole.place(i);
}

// Calls `found` with the first and the last vertex of each stretch.
template <typename Function>
void each_stretch(std::size_t vertices, const PathFeatures& features, const Function& found) {
  std::size_t begin = 0;
  for (std::size_t i = 1; i < vertices; ++i) {
    if (i + 1 < vertices && !parts_stretches(features, i)) continue;
    found(begin, i);
    begin = i;
  }
}

// A straight line from its first to its last vertex would do: nothing is smoother, and the ends
// stay where they are.
bool is_straight_within(std::span<const Point3> stretch, double limit) {
  const Vector3 way = stretch.back() - stretch.front();
  const double length = way.norm();
  if (!(length > 0)) return false;
  return std::ranges::all_of(stretch, [&](const Point3& p) {
    return way.cross(p - stretch.front()).norm() <= limit * length;
  });
}

}  // namespace

std::vector<Point3> denoised_positions(std::span<const Point3> points,
                                       const PathFeatures& features) {
  std::vector<Point3> meant(points.begin(), points.end());
  const std::span<const double> parameters = features.parameters;
  each_stretch(points.size(), features, [&](std::size_t first, std::size_t last) {
    const std::size_t count = last + 1 - first;
    if (count < kFewest) return;
    place_stretch(points.subspan(first, count), parameters.subspan(first, count),
                  std::span(meant).subspan(first, count));
  });
  return meant;
}

std::vector<Point3> meant_among_noise(std::span<const Point3> points, const PathFeatures& features,
                                      double limit, double rounding) {
  const auto is_much = [&](double noise) {
    return noise > kMuch * limit && noise > kRoundingNoise * rounding;
  };
  const auto may_fill = [&](double noise) { return is_much(noise) || noise > kMayFill * limit; };
  if (std::ranges::none_of(features.noise, may_fill)) return {};
  std::vector<Point3> meant = denoised_positions(points, features);
  std::vector<std::size_t> beyond = {0};  // so many of the vertices before
  for (std::size_t i = 0; i < points.size(); ++i) {
    const bool is_beyond = (meant[i] - points[i]).norm() > limit;
    beyond.push_back(beyond.back() + (is_beyond ? 1 : 0));
  }
  bool any = false;
  for (std::size_t i = 0; i < points.size(); ++i) {
    const std::size_t begin = i < kAround ? 0 : i - kAround;
    const std::size_t end = std::min(i + kAround + 1, points.size());
    const auto count = static_cast<double>(beyond[end] - beyond[begin]);
    if (is_much(features.noise[i]) || count > kFillsBand * static_cast<double>(end - begin)) {
      any = true;
    } else {
      meant[i] = points[i];
    }
  }
  each_stretch(points.size(), features, [&](std::size_t first, std::size_t last) {
    const auto stretch = points.subspan(first, last + 1 - first);
    if (is_straight_within(stretch, limit)) std::ranges::copy(stretch, &meant[first]);
  });
  if (!any) meant.clear();
  return meant;
}

}  // namespace batten::geometry
