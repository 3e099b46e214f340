#include "geometry/fitting/bspline_fit_system.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numeric>
#include <vector>

namespace batten::geometry {
namespace {

constexpr int kSpans = 12;

FitSpline spline_with_ends() {
  std::vector<double> breaks(kSpans + 1);
  std::iota(breaks.begin(), breaks.end(), 0.0);
  const std::vector<Pin> pins = {{0, {0, 0, 1}}, {kSpans, {kSpans, 1, 0}}};
  return spline_on(breaks, pins, {});
}

// A sample in every span, each given `times` with that part of its weight.
std::vector<Point3> solved(const FitSpline& spline, int times) {
  std::vector<FitRow> rows;
  std::vector<SampleState> states;
  std::size_t span = 3;
  for (int i = 0; i < kSpans; ++i) {
    const double u = i + 0.3 + 0.03 * i;
    for (int k = 0; k < times; ++k) {
      rows.push_back(row_at(spline, u, span));
      SampleState state;
      state.target = {u, std::sin(u), std::cos(2 * u)};
      state.base = (1.0 + 0.2 * i) / times;
      state.push = 0.5 / times;
      states.push_back(state);
    }
  }
  FitSystem system;
  EXPECT_TRUE(system.solve(spline, rows, states, {0, rows.size()}, {0, spline.size()}));
  std::vector<Point3> places;
  for (std::size_t i = 0; i < spline.size(); ++i) places.push_back(system.place(i));
  return places;
}

// Samples that are alone in their span are added on a way of their own.
TEST(FitSystem, OneSampleCountsAsTwoOfHalfItsWeight) {
  const FitSpline spline = spline_with_ends();
  const std::vector<Point3> one = solved(spline, 1);
  const std::vector<Point3> two = solved(spline, 2);
  for (std::size_t i = 0; i < one.size(); ++i) EXPECT_LE((one[i] - two[i]).norm(), 1e-12) << i;
}

}  // namespace
}  // namespace batten::geometry
