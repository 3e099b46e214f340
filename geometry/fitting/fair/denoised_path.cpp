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

bool parts_sections(const PathFeatures& f, std::size_t i) {
  if (f.kinds[i] == VertexKind::kKeptCorner) return true;
  if (i > 0 && f.lines[i - 1]) return true;
  if (i < f.lines.size() && f.lines[i]) return true;
  if (f.kinds[i] == VertexKind::kSmooth) return false;
  const double before = f.parameters[i] - f.parameters[i - 1];
  const double after = f.parameters[i + 1] - f.parameters[i];
  return f.turns[i] > kDenoiseTuning.surely_meant * f.noise[i] * (1 / before + 1 / after);
}

// The spline on a section of vertices; its ends are the first and the last of them.
class SectionSpline {
 public:
  SectionSpline(std::span<const Point3> points, std::span<const double> parameters)
      : spline_(spline_on({parameters.begin(), parameters.end()},
                          std::array{Pin{parameters.front(), points.front()},
                                     Pin{parameters.back(), points.back()}},
                          {})),
        states_(points.size()) {
    std::size_t span = kSplineDegree;
    for (std::size_t i = 0; i < points.size(); ++i) {
      states_[i].row = row_at(spline_, parameters[i], span);
      states_[i].target = points[i];
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
    if (!system_.solve(spline_, states_, {0, states_.size()}, {0, spline_.size()})) return;
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
    for (std::size_t i = 1; i + 1 < states_.size(); ++i) {
      squares += (place(i) - states_[i].target).squaredNorm();
      freedom += 1 - states_[i].base * system_.leverage(states_[i].row);
    }
    return freedom > 0 ? squares / (freedom * freedom) : HUGE_VAL;
  }

  [[nodiscard]] Point3 place(std::size_t i) const { return states_[i].row.on(spline_.points); }

 private:
  FitSpline spline_;
  FitSystem system_;
  std::vector<SampleState> states_;
  double stiffness_ = 0;
};

// Decades of the best weight.
double best_weight(SectionSpline& spline) {
  const auto of = [&](double decades) { return spline.validation(std::pow(10, decades)); };
  double best = kDenoiseTuning.highest_decade;
  double least = of(best);
  for (int decade = kDenoiseTuning.highest_decade - 1; decade >= kDenoiseTuning.lowest_decade;
       --decade) {
    const double value = of(decade);
    if (value < least) best = decade;
    least = std::min(least, value);
  }
  const auto worth = [&](double decades) { return -of(decades); };
  return golden_maximum(worth, best - 1, best + 1, kDenoiseTuning.closings).at;
}

void denoise_section(std::span<Point3> points, std::span<const double> parameters) {
  const std::size_t judged = std::min(points.size(), kDenoiseTuning.judged);
  const std::size_t first = (points.size() - judged) / 2;
  SectionSpline part(points.subspan(first, judged), parameters.subspan(first, judged));
  const double weight = std::pow(10, best_weight(part));
  SectionSpline whole(points, parameters);
  whole.solve(weight);
  for (std::size_t i = 1; i + 1 < points.size(); ++i) points[i] = whole.place(i);
}

// Calls `found` with the first and the last vertex of each section.
template <typename Function>
void each_section(std::size_t vertices, const PathFeatures& features, const Function& found) {
  std::size_t begin = 0;
  for (std::size_t i = 1; i < vertices; ++i) {
    if (i + 1 < vertices && !parts_sections(features, i)) continue;
    found(begin, i);
    begin = i;
  }
}

// Puts the vertices from `first` to `last`, which were meant to be on one line, on that of least
// squares. A corner at its end stays.
void straighten(std::span<const Point3> points, const PathFeatures& f, std::size_t first,
                std::size_t last, std::span<Point3> denoised) {
  const bool keeps_first = f.kinds[first] != VertexKind::kSmooth;
  const bool keeps_last = f.kinds[last] != VertexKind::kSmooth;
  // The line passes the mean of these.
  const std::size_t from = keeps_last && !keeps_first ? last : first;
  const std::size_t to = keeps_first ? first : last;
  const auto count = static_cast<double>(to + 1 - from);
  Point3 mean = Point3::Zero();
  double at = 0;
  for (std::size_t i = from; i <= to; ++i) {
    mean += points[i] / count;
    at += f.parameters[i] / count;
  }
  Vector3 step = Vector3::Zero();
  for (std::size_t i = first; i <= last; ++i) step += (f.parameters[i] - at) * (points[i] - mean);
  step.normalize();
  for (std::size_t i = first; i <= last; ++i) {
    const bool is_kept = (i == first && keeps_first) || (i == last && keeps_last);
    if (!is_kept) denoised[i] = mean + (points[i] - mean).dot(step) * step;
  }
}

// Lines that meet at a smooth vertex are one: beside another one neither would be longer.
void straighten_lines(std::span<const Point3> points, const PathFeatures& f,
                      std::span<Point3> denoised) {
  for (std::size_t first = 0; first + 1 < points.size();) {
    std::size_t last = first + 1;
    while (last + 1 < points.size() && f.lines[last - 1] && f.lines[last] &&
           f.kinds[last] == VertexKind::kSmooth) {
      ++last;
    }
    if (last > first + 1) straighten(points, f, first, last, denoised);
    first = last;
  }
}

// A straight line from its first to its last vertex would do: nothing is smoother, and the ends
// stay where they are.
bool is_straight_within(std::span<const Point3> section, double limit) {
  const Vector3 chord = section.back() - section.front();
  const double length = chord.norm();
  if (!(length > 0)) return false;
  return std::ranges::all_of(section, [&](const Point3& p) {
    return chord.cross(p - section.front()).norm() <= limit * length;
  });
}

}  // namespace

std::vector<Point3> denoised_positions(std::span<const Point3> points,
                                       const PathFeatures& features) {
  std::vector<Point3> denoised(points.begin(), points.end());
  straighten_lines(points, features, denoised);
  const std::span<const double> parameters = features.parameters;
  each_section(points.size(), features, [&](std::size_t first, std::size_t last) {
    const std::size_t count = last + 1 - first;
    if (count < kDenoiseTuning.fewest) return;
    denoise_section(std::span(denoised).subspan(first, count), parameters.subspan(first, count));
  });
  return denoised;
}

std::vector<Point3> denoised_among_noise(std::span<const Point3> points,
                                         const PathFeatures& features, double limit,
                                         double rounding) {
  const auto is_much = [&](double noise) {
    return noise > kDenoiseTuning.much * limit && noise > kDenoiseTuning.rounding_noise * rounding;
  };
  const auto may_fill = [&](double noise) {
    return is_much(noise) || noise > kDenoiseTuning.may_fill * limit;
  };
  if (std::ranges::none_of(features.noise, may_fill)) return {};
  std::vector<Point3> denoised = denoised_positions(points, features);
  std::vector<std::size_t> beyond = {0};  // so many of the vertices before
  for (std::size_t i = 0; i < points.size(); ++i) {
    const bool is_beyond = (denoised[i] - points[i]).norm() > limit;
    beyond.push_back(beyond.back() + (is_beyond ? 1 : 0));
  }
  bool any = false;
  constexpr std::size_t kAround = kDenoiseTuning.around;
  for (std::size_t i = 0; i < points.size(); ++i) {
    const std::size_t begin = i < kAround ? 0 : i - kAround;
    const std::size_t end = std::min(i + kAround + 1, points.size());
    const auto count = static_cast<double>(beyond[end] - beyond[begin]);
    if (is_much(features.noise[i]) ||
        count > kDenoiseTuning.fills_band * static_cast<double>(end - begin)) {
      any = true;
    } else {
      denoised[i] = points[i];
    }
  }
  each_section(points.size(), features, [&](std::size_t first, std::size_t last) {
    const auto section = points.subspan(first, last + 1 - first);
    if (section.size() < 3 || !is_straight_within(section, limit)) return;
    std::ranges::copy(section.subspan(1, section.size() - 2), &denoised[first + 1]);
  });
  if (!any) denoised.clear();
  return denoised;
}

}  // namespace batten::geometry
