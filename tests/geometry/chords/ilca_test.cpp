#include "geometry/chords/ilca.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <ostream>
#include <stdexcept>
#include <string>
#include <vector>

#include "geometry/chords/chord_proof.h"
#include "geometry/path/curve_pieces.h"
#include "tests/support/curve_of.h"
#include "tests/support/parabolas.h"

namespace batten::geometry {
namespace {

struct IlcaCount {
  std::string name;
  Parabola parabola;
  double first_step;
  double tolerance;
  std::size_t chords;
};

std::ostream& operator<<(std::ostream& out, const IlcaCount& test) { return out << test.name; }

class Ilca : public testing::TestWithParam<IlcaCount> {};

TEST_P(Ilca, TakesAsManyEqualStepsAsTheClosedFormGives) {
  const auto& [name, parabola, first_step, tolerance, chords] = GetParam();
  for (const BsplineCurve& curve : {parabola.curve(), in_space(parabola.curve())}) {
    const ChordRow row = ilca(curve, parabola.from, parabola.to, {tolerance, first_step}).value();
    ASSERT_EQ(row.parameters.size(), chords + 1);
    const double step = (parabola.to - parabola.from) / static_cast<double>(chords);
    for (std::size_t i = 0; i <= chords; ++i) {
      EXPECT_NEAR(row.parameters[i], parabola.from + static_cast<double>(i) * step, 1e-12);
    }
    EXPECT_EQ(row.parameters.back(), parabola.to);
    EXPECT_LE(row.deviation, tolerance);
    EXPECT_NEAR(row.deviation, parabola.greatest_deviation(row.parameters), 1e-9 * tolerance);
  }
}

INSTANTIATE_TEST_SUITE_P(Parabolas, Ilca,
                         testing::Values(IlcaCount{"FlatCoarse", kFlatParabola, 3, .05, 5},
                                         IlcaCount{"FlatFine", kFlatParabola, 3, .005, 14},
                                         IlcaCount{"FlatFiner", kFlatParabola, 3, .0005, 42},
                                         IlcaCount{"FlatFinest", kFlatParabola, 3, .00005, 132},
                                         IlcaCount{"SteepCoarse", kSteepParabola, 2, .045, 15},
                                         IlcaCount{"SteepFine", kSteepParabola, 2, .0045, 51},
                                         IlcaCount{"SteepFiner", kSteepParabola, 2, .00045, 167},
                                         IlcaCount{"SteepFinest", kSteepParabola, 2, .000045, 531}),
                         [](const auto& test) { return test.param.name; });

TEST(IlcaExamples, HaveTheStepsDeviationsAndLengthsOfTheClosedForm) {
  const ChordRow flat = ilca(kFlatParabola.curve(), 2, 11, {.05, 3}).value();
  EXPECT_NEAR(flat.parameters[1] - flat.parameters[0], 1.8, 1e-12);
  EXPECT_NEAR(flat.deviation, .034533, 5e-7);
  EXPECT_NEAR(kFlatParabola.chords_length(flat.parameters), 10.000914, 1e-6);
  const ChordRow steep = ilca(kSteepParabola.curve(), 1, 10, {.045, 2}).value();
  EXPECT_NEAR(steep.parameters[1] - steep.parameters[0], 0.6, 1e-12);
  EXPECT_NEAR(steep.deviation, .041692, 5e-7);
  EXPECT_NEAR(kSteepParabola.chords_length(steep.parameters), 189.316115, 1e-6);
}

// The paper's 225 segments (226 points) of .04: 1 / 2,900 of the tolerance they are said to need.
TEST(IlcaExamples, FirstStepIsKeptWhereItIsFineEnough) {
  const ChordRow row = ilca(kFlatParabola.curve(), 2, 11, {.05, .04}).value();
  EXPECT_EQ(row.parameters.size(), 226U);
  EXPECT_NEAR(row.deviation, 1.72e-5, 5e-8);
}

// A helix of radius r and pitch 2 pi c over the angle a, seen against its chord, deviates by
// r (1 - cos(a / 2)) in the middle, where the chord's middle is on the same radius.
TEST(ChordDeviation, OfAHelixIsItsSagitta) {
  const double r = 5;
  const double a = 0.5;
  const auto helix = [&](double u) { return Point3(r * std::cos(u), r * std::sin(u), 2 * u); };
  const BsplineCurve curve = curve_of(helix, 0, a, 200);
  EXPECT_NEAR(chord_deviation(CurvePieces(curve, 0, a), 0, a), r * (1 - std::cos(a / 2)), 1e-8);
}

// Ten metres of straight way, and a bend of a micrometre in them: equal steps would be some
// millions.
BsplineCurve long_way_with_a_tight_bend() {
  std::vector<Point3> points;
  for (int i = 0; i <= 50; ++i) points.emplace_back(100.0 * i, 0, 0);
  points.emplace_back(5000 + 1e-3, 0, 0);
  points.emplace_back(5000 + 1e-3, 1e-3, 0);
  for (int i = 0; i <= 50; ++i) points.emplace_back(5000, 100.0 * (i + 1), 0);
  std::vector<double> knots(3, 0.0);
  for (std::size_t i = 0; i + 2 < points.size(); ++i) {
    knots.push_back(i == 0 ? 0 : knots.back() + 1);
  }
  knots.insert(knots.end(), 3, knots.back());
  return {BsplineBasis(3, knots), points};
}

TEST(IlcaRow, IsNoneWhereEqualStepsWouldBeWithoutBound) {
  const BsplineCurve curve = long_way_with_a_tight_bend();
  EXPECT_TRUE(ilca(curve, curve.first(), curve.last(), {.max_deviation = 1}));
  EXPECT_FALSE(ilca(curve, curve.first(), curve.last(), {.max_deviation = 1e-7}));
  // Nor where they are asked for.
  EXPECT_FALSE(ilca(kFlatParabola.curve(), 2, 11, {.max_deviation = .05, .first_step = 1e-6}));
}

// Counted, not timed: whatever is found, chords and readings stay within the bounds.
TEST(IlcaRow, ReadsNoMoreDeviationsThanItsBoundAllows) {
  const BsplineCurve curve = long_way_with_a_tight_bend();
  const CurvePieces pieces(curve, curve.first(), curve.last());
  const double chords =
      std::max(kIlcaLeastBound, kIlcaChordsPerPiece * static_cast<double>(pieces.size()));
  int found = 0;
  for (double deviation = 1; deviation > 1e-7; deviation /= 3) {
    const auto row = ilca(curve, curve.first(), curve.last(), {.max_deviation = deviation});
    if (!row) continue;
    ++found;
    EXPECT_LE(static_cast<double>(row->parameters.size()), chords + 1);
    // One pass may begin within the bound and end behind it.
    EXPECT_LE(static_cast<double>(row->readings), (kIlcaReadings + 1) * chords);
    EXPECT_GE(row->readings, row->parameters.size() - 1);
    EXPECT_LE(row->deviation, deviation);
  }
  EXPECT_GT(found, 3);
}

TEST(IlcaRow, HasEveryCornerAsAVertex) {
  const BsplineCurve corner(
      BsplineBasis(3, {0, 0, 0, 0, 1, 1, 1, 3, 3, 3, 3}),
      {{0, 0, 0}, {1, 0, 0}, {2, 0, 0}, {3, 0, 0}, {3, 1, 0}, {3, 2, 0}, {3, 3, 0}});
  EXPECT_EQ(ilca(corner, 0, 3, {1e-3, 0}).value().parameters, (std::vector<double>{0, 1, 3}));
}

TEST(IlcaRow, RefusesOptionsOutsideTheirRange) {
  EXPECT_THROW((void)ilca(kFlatParabola.curve(), 2, 11, {0, 3}), std::invalid_argument);
  EXPECT_THROW((void)ilca(kFlatParabola.curve(), 2, 11, {1, -3}), std::invalid_argument);
}

}  // namespace
}  // namespace batten::geometry
