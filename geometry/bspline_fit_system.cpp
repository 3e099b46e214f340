#include "geometry/bspline_fit_system.h"

#include <algorithm>
#include <array>

namespace batten::geometry {

namespace {

constexpr std::size_t kBands = BandedMatrix::kBands;

}  // namespace

bool FitSystem::solve(const FitSpline& spline, std::span<const FitRow> rows,
                      std::span<const SampleState> states, IndexRange samples, IndexRange free) {
  free_ = free;
  offset_ = free.begin < kBands ? 0 : free.begin - kBands;
  const std::size_t end = std::min(free.end + kBands, spline.size());
  matrix_.reset(end - offset_);
  right_.assign(end - offset_, Point3::Zero());
  for (std::size_t i = offset_; i < end; ++i) {
    for (std::size_t k = 0; k <= kBands && k <= i - offset_; ++k) {
      matrix_.at(i - offset_, static_cast<int>(k)) = spline.energy[i][k];
    }
  }
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
    std::array<std::array<double, 4>, 4> product{};  // [below][column]
    std::array<Vector3, 4> force = {Vector3::Zero(), Vector3::Zero(), Vector3::Zero(),
                                    Vector3::Zero()};
    for (; i < samples.end && rows[i].first == first; ++i) {
      const double weight = states[i].base + states[i].push;
      const auto& [a, b, c, d] = rows[i].value;
      const double wa = weight * a;
      const double wb = weight * b;
      const double wc = weight * c;
      const double wd = weight * d;
      product[0][0] += wa * a;
      product[0][1] += wb * b;
      product[0][2] += wc * c;
      product[0][3] += wd * d;
      product[1][0] += wa * b;
      product[1][1] += wb * c;
      product[1][2] += wc * d;
      product[2][0] += wa * c;
      product[2][1] += wb * d;
      product[3][0] += wa * d;
      const Point3& target = states[i].target;
      force[0] += wa * target;
      force[1] += wb * target;
      force[2] += wc * target;
      force[3] += wd * target;
    }
    const std::size_t row = first - offset_;
    for (std::size_t j = 0; j < 4; ++j) {
      for (std::size_t k = 0; k + j < 4; ++k) {
        matrix_.at(row + j + k, static_cast<int>(j)) += product[j][k];
      }
      right_[row + j] += force[j];
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
