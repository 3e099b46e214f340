#include "geometry/fitting/bspline_fit_spline.h"

#include <algorithm>
#include <stdexcept>
#include <utility>

namespace batten::geometry {

namespace {

constexpr std::size_t kSplineDegree = 3;

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
  if (points.size() != pins.size()) {
    throw std::invalid_argument("fit_bspline: a pin is no breakpoint");
  }
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

std::vector<std::size_t> carry_points(const FitSpline& before, FitSpline& after) {
  constexpr std::ptrdiff_t kSupport = kSplineDegree + 2;  // knots of one control point
  std::vector<std::size_t> now_at(before.size(), kNotCarried);
  std::size_t j = 0;
  for (std::size_t i = 0; i < before.size() && j < after.size(); ++i) {
    const auto old_knots = before.knots.begin() + static_cast<std::ptrdiff_t>(i);
    const auto new_knots = [&] { return after.knots.begin() + static_cast<std::ptrdiff_t>(j); };
    while (j < after.size() && std::lexicographical_compare(new_knots(), new_knots() + kSupport,
                                                            old_knots, old_knots + kSupport)) {
      ++j;
    }
    if (j == after.size()) break;
    if (!std::equal(old_knots, old_knots + kSupport, new_knots())) continue;
    if (before.fixed[i] != after.fixed[j]) continue;
    if (after.fixed[j] != 0 && before.points[i] != after.points[j]) continue;
    after.points[j] = before.points[i];
    now_at[i] = j;
  }
  return now_at;
}

FitRow row_at(const FitSpline& spline, double u, std::size_t& span) {
  const std::vector<double>& knots = spline.knots;
  while (span + 1 < spline.size() && knots[span + 1] <= u) ++span;
  FitRow row;
  row.first = span - kSplineDegree;
  // Piegl and Tiller, The NURBS Book, algorithm A2.2, written out for degree 3.
  const double* t = &knots[span];
  const double left1 = u - t[0];
  const double left2 = u - t[-1];
  const double left3 = u - t[-2];
  const double right1 = t[1] - u;
  const double right2 = t[2] - u;
  const double right3 = t[3] - u;
  const double one = 1 / (right1 + left1);
  const double a0 = right1 * one;
  const double a1 = left1 * one;
  const double part0 = a0 / (right1 + left2);
  const double part1 = a1 / (right2 + left1);
  const double b0 = right1 * part0;
  const double b1 = left2 * part0 + right2 * part1;
  const double b2 = left1 * part1;
  const double third0 = b0 / (right1 + left3);
  const double third1 = b1 / (right2 + left2);
  const double third2 = b2 / (right3 + left1);
  row.value = {right1 * third0, left3 * third0 + right2 * third1, left2 * third1 + right3 * third2,
               left1 * third2};
  return row;
}

}  // namespace batten::geometry
