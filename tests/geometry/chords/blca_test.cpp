#include <gtest/gtest.h>

#include <cmath>
#include <ostream>
#include <span>
#include <stdexcept>
#include <string>
#include <vector>

#include "geometry/chords/chord_proof.h"
#include "geometry/chords/ilca.h"
#include "geometry/path/path.h"
#include "tests/support/curve_of.h"
#include "tests/support/parabolas.h"

namespace batten::geometry {
namespace {

struct BlcaCount {
  std::string name;
  Parabola parabola;
  double tolerance;
  std::size_t chords;
};

std::ostream& operator<<(std::ostream& out, const BlcaCount& test) { return out << test.name; }

class Blca : public testing::TestWithParam<BlcaCount> {};

// The closed form: dx = sqrt(T sqrt(1 + slope^2) / |c1|), the last step cut at the end.
TEST_P(Blca, StepsAsTheClosedFormSays) {
  const auto& [name, parabola, tolerance, chords] = GetParam();
  for (const BsplineCurve& curve : {parabola.curve(), in_space(parabola.curve())}) {
    const ChordRow row = blca(curve, parabola.from, parabola.to, tolerance);
    ASSERT_EQ(row.parameters.size(), chords + 1);
    for (std::size_t i = 0; i + 1 < chords; ++i) {
      const double slope = parabola.slope(row.parameters[i]);
      const double step = std::sqrt(tolerance * std::hypot(1, slope) / std::abs(parabola.c1));
      EXPECT_NEAR(row.parameters[i + 1] - row.parameters[i], step, 1e-9 * step);
    }
    EXPECT_EQ(row.parameters.back(), parabola.to);
    EXPECT_NEAR(row.deviation, parabola.greatest_deviation(row.parameters), 1e-9 * tolerance);
    EXPECT_LE(row.deviation, tolerance);
  }
}

INSTANTIATE_TEST_SUITE_P(Parabolas, Blca,
                         testing::Values(BlcaCount{"FlatCoarse", kFlatParabola, .05, 8},
                                         BlcaCount{"FlatFine", kFlatParabola, .005, 26},
                                         BlcaCount{"FlatFiner", kFlatParabola, .0005, 80},
                                         BlcaCount{"FlatFinest", kFlatParabola, .00005, 251},
                                         BlcaCount{"SteepCoarse", kSteepParabola, .045, 16},
                                         BlcaCount{"SteepFine", kSteepParabola, .0045, 49},
                                         BlcaCount{"SteepFiner", kSteepParabola, .00045, 151},
                                         BlcaCount{"SteepFinest", kSteepParabola, .000045, 475}),
                         [](const auto& test) { return test.param.name; });

// The tool path that the paper draws over these vertices: from each a jump of length `tolerance`
// across the tangent, to the side where the curve goes, then along the tangent until abeam of the
// next vertex, which is met there when the step was a whole one. Not a path to be cut: it leaves
// the curve by the tolerance in every step.
//
// Requires `parameters` of the curve, increasing.
Path blca_tool_path(const BsplineCurve& curve, std::span<const double> parameters,
                    double tolerance) {
  Path path;
  for (std::size_t i = 0; i + 1 < parameters.size(); ++i) {
    const Point3 start = curve.point_at(parameters[i]);
    const Vector3 way = curve.point_at(parameters[i + 1]) - start;
    const Vector3 tangent = curve.direction_at(parameters[i]);
    const double along = way.dot(tangent);
    const Vector3 across = way - along * tangent;
    const Point3 moved = start + tolerance * across.stableNormalized();
    path.push_back(Line{start, moved});
    path.push_back(Line{moved, moved + along * tangent});
  }
  return path;
}

struct Example {
  std::string name;
  Parabola parabola;
  double tolerance;
  std::vector<double> x;
  double secants;
  double with_jumps;
  double chords;
  double deviation;
};

std::ostream& operator<<(std::ostream& out, const Example& test) { return out << test.name; }

class BlcaExample : public testing::TestWithParam<Example> {};

TEST_P(BlcaExample, HasTheFiguresOfTheRestatedMethod) {
  const Example& example = GetParam();
  const BsplineCurve curve = example.parabola.curve();
  const ChordRow row = blca(curve, example.parabola.from, example.parabola.to, example.tolerance);
  ASSERT_EQ(row.parameters.size(), example.x.size());
  for (std::size_t i = 0; i < example.x.size(); ++i) {
    EXPECT_NEAR(row.parameters[i], example.x[i], 1e-4);
  }
  const Path path = blca_tool_path(curve, row.parameters, example.tolerance);
  double secants = 0;
  for (std::size_t i = 1; i < path.size(); i += 2) secants += length_of(path[i]);
  EXPECT_NEAR(secants, example.secants, 1e-6);
  EXPECT_NEAR(length_of(path), example.with_jumps, 1e-6);
  EXPECT_NEAR(example.parabola.chords_length(row.parameters), example.chords, 1e-6);
  EXPECT_NEAR(row.deviation, example.deviation, 1e-6);
}

// A whole step ends on the curve: the secant meets the next vertex.
TEST_P(BlcaExample, SecantsOfWholeStepsEndOnTheCurve) {
  const Example& example = GetParam();
  const BsplineCurve curve = example.parabola.curve();
  const ChordRow row = blca(curve, example.parabola.from, example.parabola.to, example.tolerance);
  const Path path = blca_tool_path(curve, row.parameters, example.tolerance);
  ASSERT_EQ(path.size(), 2 * (row.parameters.size() - 1));
  for (std::size_t i = 0; i + 2 < row.parameters.size(); ++i) {
    EXPECT_NEAR(length_of(path[2 * i]), example.tolerance, 1e-12);
    EXPECT_LE((end_point(path[2 * i + 1]) - curve.point_at(row.parameters[i + 1])).norm(), 1e-9);
  }
}

INSTANTIATE_TEST_SUITE_P(
    Parabolas, BlcaExample,
    testing::Values(Example{"Flat",
                            kFlatParabola,
                            .05,
                            {2, 3.2287, 4.4264, 5.5959, 6.7404, 7.8635, 8.9690, 10.0612, 11},
                            9.997480,
                            10.397480,
                            10.005079,
                            .012826},
                    Example{"Steep",
                            kSteepParabola,
                            .045,
                            {1, 1.2667, 1.5737, 1.9219, 2.3120, 2.7443, 3.2193, 3.7372, 4.2981,
                             4.9023, 5.5498, 6.2409, 6.9755, 7.7537, 8.5758, 9.4416, 10},
                            189.314273,
                            190.034273,
                            189.317958,
                            .010694}),
    [](const auto& test) { return test.param.name; });

// y = x^3 bends to the other side at 0: the tangent of a place before it comes near again.
TEST(BlcaRow, KeepsTheToleranceAcrossInflections) {
  const auto cubic = [](double x) { return Point3(x, x * x * x, 0); };
  const BsplineCurve curve = curve_of(cubic, -1.5, 1.5, 3);
  for (const double tolerance : {1e-4, 1e-3, 1e-2, 0.1, 1.0}) {
    const ChordRow row = blca(curve, -1.5, 1.5, tolerance);
    EXPECT_LE(row.deviation, tolerance);
    const CurvePieces pieces(curve, -1.5, 1.5);
    for (std::size_t i = 0; i + 1 < row.parameters.size(); ++i) {
      EXPECT_LE(chord_deviation(pieces, row.parameters[i], row.parameters[i + 1]), tolerance);
    }
  }
}

TEST(BlcaRow, CoversALineWithOneChord) {
  const BsplineCurve line(BsplineBasis::clamped(3, {0, 1}),
                          {{0, 0, 0}, {1, 1, 1}, {2, 2, 2}, {3, 3, 3}});
  EXPECT_EQ(blca(line, 0, 1, 1e-3).parameters, (std::vector<double>{0, 1}));
}

TEST(BlcaRow, RefusesAToleranceOfZero) {
  EXPECT_THROW((void)blca(kFlatParabola.curve(), 2, 11, 0), std::invalid_argument);
}

}  // namespace
}  // namespace batten::geometry
