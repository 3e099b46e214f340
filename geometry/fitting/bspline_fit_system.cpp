#include "geometry/fitting/bspline_fit_system.h"

#include <algorithm>
#include <cstring>

namespace batten::geometry {

namespace {

constexpr std::size_t kBands = BandedMatrix::kBands;

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

SpanSums sums_of(std::span<const FitRow> rows, std::span<const SampleState> states) {
  const Pair zero = twice(0);
  // Columns of the products, each of rows 0 and 1 and of rows 2 and 3.
  Pair p0low = zero, p0high = zero, p1low = zero, p1high = zero, p2high = zero, p3high = zero;
  Pair xlow = zero, xhigh = zero, ylow = zero, yhigh = zero, zlow = zero, zhigh = zero;
  for (std::size_t i = 0; i < rows.size(); ++i) {
    const Pair weight = twice(states[i].base + states[i].push);
    const Pair low = pair_at(&rows[i].value[0]);
    const Pair high = pair_at(&rows[i].value[2]);
    const Pair wlow = weight * low;
    const Pair whigh = weight * high;
    p0low += twice(wlow[0]) * low;
    p0high += twice(wlow[0]) * high;
    p1low += twice(wlow[1]) * low;
    p1high += twice(wlow[1]) * high;
    p2high += twice(whigh[0]) * high;
    p3high += twice(whigh[1]) * high;
    const Point3& target = states[i].target;
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

bool FitSystem::solve(const FitSpline& spline, std::span<const FitRow> rows,
                      std::span<const SampleState> states, IndexRange samples, IndexRange free) {
  free_ = free;
  offset_ = free.begin < kBands ? 0 : free.begin - kBands;
  const std::size_t end = std::min(free.end + kBands, spline.size());
  matrix_.set_rows({&spline.energy[offset_], end - offset_});
  right_.assign(end - offset_, Point3::Zero());
  add_samples(rows, states, samples);
  for (std::size_t i = offset_; i < end; ++i) {
    if (is_held(spline, i)) matrix_.fix(i - offset_, spline.points[i], right_);
  }
  return matrix_.solve(right_);
}

// Samples of one span share their control points: they are summed up before they are added.
void FitSystem::add_samples(std::span<const FitRow> rows, std::span<const SampleState> states,
                            IndexRange samples) {
  for (std::size_t i = samples.begin; i < samples.end;) {
    const std::size_t first = rows[i].first;
    const std::size_t begin = i;
    while (i < samples.end && rows[i].first == first) ++i;
    if (i == begin + 1) {
      add_sample(rows[begin], states[begin]);
      continue;
    }
    const SpanSums sums = sums_of(rows.subspan(begin, i - begin), states.subspan(begin, i - begin));
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
void FitSystem::add_sample(const FitRow& row, const SampleState& state) {
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
