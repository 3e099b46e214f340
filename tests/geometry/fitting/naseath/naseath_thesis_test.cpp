// Naseath's method as his thesis has it, against the figures of an independent program.
#include <gtest/gtest.h>

#include <cmath>
#include <string>
#include <vector>

#include "geometry/fitting/naseath/naseath.h"
#include "geometry/path/parameter_samples.h"
#include "tests/support/naseath_cases.h"

namespace batten::geometry {
namespace {

class NaseathCase : public testing::TestWithParam<std::string> {
 protected:
  nlohmann::json given = naseath_case(GetParam());
  BsplineCurve curve = curve_in(given);
};

TEST_P(NaseathCase, PassesAreThoseOfTheThesis) {
  const NaseathResult result = smooth_naseath(curve, literal(given["R"]));
  EXPECT_EQ(result.passes, given["iterations"].get<int>());
  EXPECT_EQ(result.kept_pass, result.passes);
  EXPECT_EQ(result.stop, NaseathStop::kTouchesTube);
  const auto remaining = given["dmax"].get<std::vector<double>>();
  ASSERT_EQ(result.remaining.size(), remaining.size());
  for (std::size_t i = 0; i < remaining.size(); ++i) {
    EXPECT_NEAR(result.remaining[i], remaining[i], 1e-9) << "pass " << i;
  }
  EXPECT_LE(farthest(result.curve.control_points(), points_of(given["result"])), 1e-9);
}

TEST_P(NaseathCase, LengthAndCurvatureAreThoseOfTheThesis) {
  const auto before = parameter_samples(curve, kNaseathSteps);
  EXPECT_NEAR(sampled_length(before), given["L0"].get<double>(), 1e-9);
  EXPECT_NEAR(max_curvature(before), given["kmax0"].get<double>(), 1e-9);
  const NaseathResult result = smooth_naseath(curve, literal(given["R"]));
  const auto after = parameter_samples(result.curve, kNaseathSteps);
  EXPECT_NEAR(sampled_length(after), given["L1"].get<double>(), 1e-9);
  EXPECT_NEAR(max_curvature(after), given["kmax1"].get<double>(), 1e-9);
}

INSTANTIATE_TEST_SUITE_P(Small, NaseathCase, testing::Values("G1", "G2", "G3"),
                         [](const auto& test) { return test.param; });

// Legs that are parallel but for the rounding of their coordinates; ten times as long they are
// exactly parallel.
TEST(NaseathPolygon, ARoundingErrorIsNoTurn) {
  const std::vector<Point3> points{{0, 0, 0},     {0.1, 0.3, 0}, {0.3, 0.9, 0},
                                   {0.7, 2.1, 0}, {5, 1, 0},     {6, 3, 0}};
  std::vector<Point3> exact;
  for (const Point3& p : points) exact.push_back((10 * p).array().round());
  const NaseathResult found = smooth_naseath(uniform_cubic(points), literal(.01));
  const NaseathResult expected = smooth_naseath(uniform_cubic(exact), literal(.1));
  std::vector<Point3> scaled = expected.curve.control_points();
  for (Point3& p : scaled) p /= 10;
  EXPECT_EQ(found.passes, expected.passes);
  EXPECT_LE(farthest(found.curve.control_points(), scaled), 1e-9);
}

// --- the tables --------------------------------------------------------------------------------

class NaseathOriginal : public testing::TestWithParam<std::string> {};

TEST_P(NaseathOriginal, HasTheLengthAndCurvatureOfTheTable) {
  const auto given = naseath_case(GetParam());
  const auto samples = parameter_samples(curve_in(given), kNaseathSteps);
  const double length = given["length"];
  const double mean = given["kappa_param_mean"];
  const double most = given["kappa_max"];
  EXPECT_NEAR(sampled_length(samples), length, 1e-9 * length);
  EXPECT_NEAR(mean_curvature(samples), mean, 1e-9 * mean);
  EXPECT_NEAR(max_curvature(samples), most, 1e-9 * most);
}

INSTANTIATE_TEST_SUITE_P(Tables, NaseathOriginal,
                         testing::Values("tc1", "tc2", "tc3", "tc5a", "tc5b", "tc6"),
                         [](const auto& test) { return test.param; });

// What is cut off, in percent, as the table prints it; below 0 where it prints nothing.
struct TableRow {
  std::string name;
  double radius;
  double curvature;
  double length;
};

class NaseathTable : public testing::TestWithParam<TableRow> {};

TEST_P(NaseathTable, TheLiteralMethodCutsOffWhatTheTableSays) {
  const TableRow& row = GetParam();
  const BsplineCurve curve = curve_of_case(row.name);
  const auto before = parameter_samples(curve, kNaseathSteps);
  const NaseathResult result = smooth_naseath(curve, literal(row.radius));
  const auto after = parameter_samples(result.curve, kNaseathSteps);
  const auto cut = [](double was, double is) { return 100 * (1 - is / was); };
  if (row.curvature >= 0) {
    EXPECT_NEAR(cut(mean_curvature(before), mean_curvature(after)), row.curvature, 0.06);
  }
  if (row.length >= 0) {
    EXPECT_NEAR(cut(sampled_length(before), sampled_length(after)), row.length, 0.006);
  }
}

// tc5a prints lengths, 100.375, 100.168 and 100.023 of 100.441.
constexpr double kNone = -1;
INSTANTIATE_TEST_SUITE_P(
    Tables, NaseathTable,
    testing::Values(TableRow{"tc5a", .025, 7.5, .066}, TableRow{"tc5a", .125, 38.0, .272},
                    TableRow{"tc5a", .25, 84.7, .416}, TableRow{"tc6", .025, 1.6, .18},
                    TableRow{"tc6", .125, 7.6, .88}, TableRow{"tc6", .25, 14.6, 1.66},
                    TableRow{"tc1", .025, kNone, .04}, TableRow{"tc1", .125, kNone, .21},
                    TableRow{"tc1", .25, kNone, .51}, TableRow{"tc3", .025, kNone, .46},
                    TableRow{"tc3", .125, kNone, 2.28}, TableRow{"tc3", .25, kNone, 4.51}),
    [](const auto& test) {
      return test.param.name + "_" +
             std::to_string(static_cast<int>(std::lround(1000 * test.param.radius)));
    });

}  // namespace
}  // namespace batten::geometry
