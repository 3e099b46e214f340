#include "geometry/fitting/bspline_fit_system.h"

#include <algorithm>
#include <cassert>
#include <stdexcept>
#include <utility>

namespace batten::geometry {

namespace {

// Knots, and the control point at each pin: the one whose Greville abscissa is the pin.
std::vector<std::size_t> make_knots(FitSpline& spline, std::span<const Pin> pins) {
  std::vector<std::size_t> points;
  std::vector<double>& knots = spline.knots;
  knots.reserve(spline.breaks.size() + 2 * pins.size() + 2);
  for (const double u : spline.breaks) {
    std::size_t copies = 1;
    const std::size_t pin = points.size();
    if (pin < pins.size() && u == pins[pin].parameter) {
      const bool end = pin == 0 || pin + 1 == pins.size();
      copies = end ? kSplineDegree + 1 : kSplineDegree;
      points.push_back(knots.empty() ? 0 : knots.size() - 1);
    }
    knots.insert(knots.end(), copies, u);
  }
  assert(points.size() == pins.size());
  return points;
}

// A cubic span whose four control points lie on a line at their Greville abscissas is that line.
void fix_zones(FitSpline& spline, std::span<const StraightZone> zones) {
  const std::vector<double>& t = spline.knots;
  for (const StraightZone& zone : zones) {
    const auto after = std::upper_bound(t.begin(), t.end(), zone.from);
    const auto span = static_cast<std::size_t>(after - t.begin()) - 1;
    if (after == t.begin() || after == t.end() || t[span] != zone.from || *after != zone.to) {
      throw std::invalid_argument("fit_bspline: a straight zone is no span");
    }
    const Vector3 per_unit = (zone.end - zone.start) / (zone.to - zone.from);
    for (std::size_t i = span - kSplineDegree; i <= span; ++i) {
      const double greville = (t[i + 1] + t[i + 2] + t[i + 3]) / 3;
      spline.points[i] = zone.start + (greville - zone.from) * per_unit;
      spline.fixed[i] = 1;
    }
  }
}

// The third derivative is constant on a span: differences of differences of the control points.
std::array<double, 4> third_derivatives(const double* t) {
  // t points to the last knot of the span's start.
  const double last = 1 / (t[1] - t[0]);
  const double b0 = 2 / (t[1] - t[-1]);
  const double b1 = 2 / (t[2] - t[0]);
  const double d0 = last * b0 * 3 / (t[1] - t[-2]);
  const double d1 = -last * (b0 + b1) * 3 / (t[2] - t[-1]);
  const double d2 = last * b1 * 3 / (t[3] - t[0]);
  return {-d0, d0 - d1, d1 - d2, d2};
}

void make_energy(FitSpline& spline) {
  const std::vector<double>& t = spline.knots;
  spline.energy.assign(spline.size(), {});
  for (std::size_t span = kSplineDegree; span < spline.size(); ++span) {
    const double width = t[span + 1] - t[span];
    if (!(width > 0)) continue;
    const std::array<double, 4> third = third_derivatives(&t[span]);
    for (std::size_t j = 0; j < 4; ++j) {
      std::array<double, 4>& row = spline.energy[span - kSplineDegree + j];
      for (std::size_t k = 0; k <= j; ++k) row[j - k] += width * third[j] * third[k];
    }
  }
}

}  // namespace

std::vector<double> required_breaks(const FitProblem& problem) {
  std::vector<double> required;
  required.reserve(problem.pins.size() + 2 * problem.zones.size());
  for (const Pin& pin : problem.pins) required.push_back(pin.parameter);
  for (const StraightZone& zone : problem.zones) {
    required.push_back(zone.from);
    required.push_back(zone.to);
  }
  std::sort(required.begin(), required.end());
  required.erase(std::unique(required.begin(), required.end()), required.end());
  return required;
}

FitSpline spline_on(std::vector<double> breaks, std::span<const Pin> pins,
                    std::span<const StraightZone> zones) {
  FitSpline spline;
  spline.breaks = std::move(breaks);
  const std::vector<std::size_t> pinned = make_knots(spline, pins);
  const std::size_t size = spline.knots.size() - kSplineDegree - 1;
  spline.points.assign(size, Point3::Zero());
  spline.fixed.assign(size, 0);
  fix_zones(spline, zones);
  for (std::size_t i = 0; i < pins.size(); ++i) {
    spline.points[pinned[i]] = pins[i].place;
    spline.fixed[pinned[i]] = 1;
  }
  make_energy(spline);
  return spline;
}

FitRow row_at(const FitSpline& spline, double u, std::size_t& span) {
  while (span + 1 < spline.size() && spline.knots[span + 1] <= u) ++span;
  // Piegl and Tiller, The NURBS Book, algorithm A2.2.
  const double* const t = &spline.knots[span];
  FitRow row{span - kSplineDegree, {1, 0, 0, 0}};
#pragma GCC unroll 3
  for (int degree = 1; degree <= 3; ++degree) {
    double carried = 0;
#pragma GCC unroll 3
    for (int r = 0; r < degree; ++r) {
      const double right = t[r + 1] - u;
      const double left = u - t[r + 1 - degree];
      const double part = row.value[r] / (right + left);
      row.value[r] = carried + right * part;
      carried = left * part;
    }
    row.value[degree] = carried;
  }
  return row;
}

bool FitSystem::solve(const FitSpline& spline, std::span<const SampleState> states,
                      IndexRange samples, IndexRange free) {
  free_ = free;
  offset_ = free.begin < kSplineDegree ? 0 : free.begin - kSplineDegree;
  const std::size_t end = std::min(free.end + kSplineDegree, spline.size());
  matrix_.set_rows({&spline.energy[offset_], end - offset_});
  right_.assign(end - offset_, Point3::Zero());
  add_samples(states.subspan(samples.begin, samples.end - samples.begin));
  for (std::size_t i = offset_; i < end; ++i) {
    if (is_held(spline, i)) matrix_.fix(i - offset_, spline.points[i], right_);
  }
  return matrix_.solve(right_);
}

// Samples of one span share their control points: they are summed up before they are added.
void FitSystem::add_samples(std::span<const SampleState> states) {
  for (std::size_t i = 0; i < states.size();) {
    const std::size_t first = states[i].row.first;
    std::array<std::array<double, 4>, 4> product{};  // column, row; the lower half
    std::array<std::array<double, 4>, 3> force{};    // axis, row
    for (; i < states.size() && states[i].row.first == first; ++i) {
      const std::array<double, 4>& value = states[i].row.value;
      const double weight = states[i].base + states[i].push;
      for (std::size_t j = 0; j < 4; ++j) {
        const double weighted = weight * value[j];
        for (std::size_t k = j; k < 4; ++k) product[j][k] += weighted * value[k];
        for (int axis = 0; axis < 3; ++axis) force[axis][j] += weighted * states[i].target[axis];
      }
    }
    for (std::size_t j = 0; j < 4; ++j) {
      const std::size_t row = first - offset_ + j;
      for (std::size_t k = 0; k <= j; ++k) {
        matrix_.at(row, static_cast<int>(j - k)) += product[k][j];
      }
      right_[row] += Point3(force[0][j], force[1][j], force[2][j]);
    }
  }
}

void FitSystem::invert(const FitSpline& spline, std::size_t first_point) {
  const std::size_t first = std::max(first_point, offset_) - offset_;
  matrix_.inverse_band(inverse_, first);
  // Held control points do not move: their unit rows stand for no compliance.
  for (std::size_t i = first; i < inverse_.size(); ++i) {
    if (is_held(spline, offset_ + i)) inverse_.at(i, 0) = 0;
  }
}

double FitSystem::leverage(const FitRow& row) const {
  const std::size_t first = row.first - offset_;
  double sum = 0;
  for (std::size_t j = 0; j < 4; ++j) {
    sum += row.value[j] * row.value[j] * inverse_.at(first + j, 0);
    for (std::size_t k = 0; k < j; ++k) {
      sum += 2 * row.value[j] * row.value[k] * inverse_.at(first + j, static_cast<int>(j - k));
    }
  }
  return sum;
}

}  // namespace batten::geometry
