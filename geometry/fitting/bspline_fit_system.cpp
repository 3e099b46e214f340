#include "geometry/fitting/bspline_fit_system.h"

#include <algorithm>
#include <cassert>
#include <cstring>
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

// What the samples of one span add to the equations of its four control points.
struct SpanSums {
  double product[4][4];  // column, row; the lower half and the diagonal
  double force[3][4];    // axis, row
};

// Two numbers that processors add and multiply at a time.
using Pair = double __attribute__((vector_size(16)));

Pair pair_at(const double* at) { return Pair{at[0], at[1]}; }

void put(const Pair& pair, double* to) { std::memcpy(to, &pair, sizeof pair); }

Pair twice(double value) { return Pair{value, value}; }

SpanSums sums_of(std::span<const SampleState> states) {
  const Pair zero = twice(0);
  // Columns of the products, each of rows 0 and 1 and of rows 2 and 3.
  Pair p0low = zero, p0high = zero, p1low = zero, p1high = zero, p2high = zero, p3high = zero;
  Pair xlow = zero, xhigh = zero, ylow = zero, yhigh = zero, zlow = zero, zhigh = zero;
  for (const SampleState& state : states) {
    const Pair weight = twice(state.base + state.push);
    const Pair low = pair_at(&state.row.value[0]);
    const Pair high = pair_at(&state.row.value[2]);
    const Pair wlow = weight * low;
    const Pair whigh = weight * high;
    p0low += twice(wlow[0]) * low;
    p0high += twice(wlow[0]) * high;
    p1low += twice(wlow[1]) * low;
    p1high += twice(wlow[1]) * high;
    p2high += twice(whigh[0]) * high;
    p3high += twice(whigh[1]) * high;
    const Point3& target = state.target;
    xlow += wlow * twice(target.x());
    xhigh += whigh * twice(target.x());
    ylow += wlow * twice(target.y());
    yhigh += whigh * twice(target.y());
    zlow += wlow * twice(target.z());
    zhigh += whigh * twice(target.z());
  }
  SpanSums sums;
  put(p0low, &sums.product[0][0]);
  put(p0high, &sums.product[0][2]);
  put(p1low, &sums.product[1][0]);
  put(p1high, &sums.product[1][2]);
  put(p2high, &sums.product[2][2]);
  put(p3high, &sums.product[3][2]);
  put(xlow, &sums.force[0][0]);
  put(xhigh, &sums.force[0][2]);
  put(ylow, &sums.force[1][0]);
  put(yhigh, &sums.force[1][2]);
  put(zlow, &sums.force[2][0]);
  put(zhigh, &sums.force[2][2]);
  return sums;
}

// The two numbers the other way round.
Pair swapped(const Pair& pair) { return Pair{pair[1], pair[0]}; }

void add_to(double* at, const Pair& pair) { put(pair_at(at) + pair, at); }

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
    const std::size_t begin = i;
    while (i < states.size() && states[i].row.first == first) ++i;
    if (i == begin + 1) {
      add_sample(states[begin]);
      continue;
    }
    const SpanSums sums = sums_of(states.subspan(begin, i - begin));
    const std::size_t row = first - offset_;
#pragma GCC unroll 4
    for (std::size_t j = 0; j < 4; ++j) {
#pragma GCC unroll 4
      for (std::size_t k = 0; k <= j; ++k) {
        matrix_.at(row + j, static_cast<int>(j - k)) += sums.product[k][j];
      }
      Point3& force = right_[row + j];
      force.x() += sums.force[0][j];
      force.y() += sums.force[1][j];
      force.z() += sums.force[2][j];
    }
  }
}

// The same numbers as those of a span with one sample, without the sums: where every vertex has its
// own knot, most are.
void FitSystem::add_sample(const SampleState& state) {
  const FitRow& row = state.row;
  const std::size_t first = row.first - offset_;
  const Pair weight = twice(state.base + state.push);
  const Pair low = weight * pair_at(&row.value[0]);
  const Pair high = weight * pair_at(&row.value[2]);
  double* const band = &matrix_.at(first, 0);
  const auto row_of = [band](std::size_t j) { return band + j * (BandedMatrix::kBands + 1); };
  row_of(0)[0] += low[0] * row.value[0];
  add_to(row_of(1), swapped(low) * twice(row.value[1]));
  add_to(row_of(2), Pair{high[0], low[1]} * twice(row.value[2]));
  row_of(2)[2] += low[0] * row.value[2];
  add_to(row_of(3), swapped(high) * twice(row.value[3]));
  add_to(row_of(3) + 2, swapped(low) * twice(row.value[3]));
  const Pair target = pair_at(state.target.data());
  const double height = state.target.z();
  const auto pull = [&](std::size_t j, double weighted) {
    double* const force = right_[first + j].data();
    add_to(force, twice(weighted) * target);
    force[2] += weighted * height;
  };
  pull(0, low[0]);
  pull(1, low[1]);
  pull(2, high[0]);
  pull(3, high[1]);
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
