#include "geometry/chords/ilca.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <vector>

#include "geometry/chords/chord_proof.h"
#include "geometry/path/curve_pieces.h"
#include "geometry/path/path.h"
#include "tests/support/curve_of.h"
#include "tests/support/parabolas.h"

namespace batten::geometry {
namespace {

TEST(Ilca, TakesAsManyEqualStepsAsTheClosedFormGives) {
  for (const ParabolaRow& given : kParabolaRows) {
    SCOPED_TRACE(given.name);
    const Parabola& parabola = given.parabola;
    for (const BsplineCurve& curve : {parabola.curve(), in_space(parabola.curve())}) {
      const ChordRow row =
          ilca(curve, parabola.from, parabola.to, {given.tolerance, given.first_step}).value();
      ASSERT_EQ(row.parameters.size(), given.ilca + 1);
      const double step = (parabola.to - parabola.from) / static_cast<double>(given.ilca);
      for (std::size_t i = 0; i <= given.ilca; ++i) {
        EXPECT_NEAR(row.parameters[i], parabola.from + static_cast<double>(i) * step, 1e-12);
      }
      EXPECT_EQ(row.parameters.back(), parabola.to);
      EXPECT_LE(row.deviation, given.tolerance);
      EXPECT_NEAR(row.deviation, parabola.greatest_deviation(row.parameters),
                  1e-9 * given.tolerance);
    }
  }
}

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

// The closed form: dx = sqrt(T sqrt(1 + slope^2) / |c1|), the last step cut at the end.
TEST(Blca, StepsAsTheClosedFormSays) {
  for (const ParabolaRow& given : kParabolaRows) {
    SCOPED_TRACE(given.name);
    const Parabola& parabola = given.parabola;
    for (const BsplineCurve& curve : {parabola.curve(), in_space(parabola.curve())}) {
      const ChordRow row = blca(curve, parabola.from, parabola.to, given.tolerance);
      ASSERT_EQ(row.parameters.size(), given.blca + 1);
      for (std::size_t i = 0; i + 1 < given.blca; ++i) {
        const double slope = parabola.slope(row.parameters[i]);
        const double step =
            std::sqrt(given.tolerance * std::hypot(1, slope) / std::abs(parabola.c1));
        EXPECT_NEAR(row.parameters[i + 1] - row.parameters[i], step, 1e-9 * step);
      }
      EXPECT_EQ(row.parameters.back(), parabola.to);
      EXPECT_NEAR(row.deviation, parabola.greatest_deviation(row.parameters),
                  1e-9 * given.tolerance);
      EXPECT_LE(row.deviation, given.tolerance);
    }
  }
}

TEST(Blca, HasTheFiguresOfTheRestatedMethod) {
  struct Example {
    Parabola parabola;
    double tolerance;
    std::vector<double> x;
    double secants, with_jumps, chords, deviation;
  };
  const Example examples[] = {{kFlatParabola,
                               .05,
                               {2, 3.2287, 4.4264, 5.5959, 6.7404, 7.8635, 8.9690, 10.0612, 11},
                               9.997480,
                               10.397480,
                               10.005079,
                               .012826},
                              {kSteepParabola,
                               .045,
                               {1, 1.2667, 1.5737, 1.9219, 2.3120, 2.7443, 3.2193, 3.7372, 4.2981,
                                4.9023, 5.5498, 6.2409, 6.9755, 7.7537, 8.5758, 9.4416, 10},
                               189.314273,
                               190.034273,
                               189.317958,
                               .010694}};
  for (const auto& [parabola, tolerance, x, secants, with_jumps, chords, deviation] : examples) {
    SCOPED_TRACE(testing::Message() << "tolerance " << tolerance);
    const BsplineCurve curve = parabola.curve();
    const ChordRow row = blca(curve, parabola.from, parabola.to, tolerance);
    ASSERT_EQ(row.parameters.size(), x.size());
    for (std::size_t i = 0; i < x.size(); ++i) EXPECT_NEAR(row.parameters[i], x[i], 1e-4);
    EXPECT_NEAR(parabola.chords_length(row.parameters), chords, 1e-6);
    EXPECT_NEAR(row.deviation, deviation, 1e-6);
    const TangentLines moved = tangent_lines(curve, row.parameters, tolerance);
    ASSERT_EQ(moved.path.size(), 2 * (x.size() - 1));
    double length = 0;
    for (const PathPiece& piece : moved.path) length += length_of(piece);
    EXPECT_EQ(moved.jumps, x.size() - 1);
    EXPECT_NEAR(length - moved.jumped, secants, 1e-6);
    EXPECT_NEAR(length, with_jumps, 1e-6);
    // A whole step ends on the curve: the secant meets the next vertex.
    for (std::size_t i = 0; i + 2 < x.size(); ++i) {
      EXPECT_NEAR(length_of(moved.path[2 * i]), tolerance, 1e-12);
      EXPECT_LE((end_point(moved.path[2 * i + 1]) - curve.point_at(row.parameters[i + 1])).norm(),
                1e-9);
    }
  }
}

// The first parabola bends to the right on its way, the second one to the left. A tangent leaves
// the curve by the tolerance at the end of its step, to the outside of the bend; moved by the
// tolerance it begins as far on the inside.
TEST(TangentLinesOfBlca, AreOutsideTheBendUnmovedAndInsideItMoved) {
  struct Example {
    Parabola parabola;
    double tolerance;
    double BesideCurve::*outside;
    double BesideCurve::*inside;
  };
  const Example examples[] = {
      {kFlatParabola, .05, &BesideCurve::left, &BesideCurve::right},
      {kSteepParabola, .045, &BesideCurve::right, &BesideCurve::left},
  };
  for (const auto& [parabola, tolerance, outside, inside] : examples) {
    SCOPED_TRACE(testing::Message() << "tolerance " << tolerance);
    const BsplineCurve curve = parabola.curve();
    const ChordRow row = blca(curve, parabola.from, parabola.to, tolerance);
    const TangentLines unmoved = tangent_lines(curve, row.parameters, 0);
    EXPECT_NEAR(unmoved.beside.*outside, tolerance, 1e-9);
    EXPECT_NEAR(unmoved.beside.*inside, 0, 1e-9);
    // The first line begins on the curve, without a jump; after all whole steps there is one.
    EXPECT_EQ(unmoved.jumps, row.parameters.size() - 2);
    EXPECT_NEAR(unmoved.jumped, tolerance * static_cast<double>(unmoved.jumps), 1e-9);
    const TangentLines moved = tangent_lines(curve, row.parameters, tolerance);
    EXPECT_NEAR(moved.beside.*outside, 0, 1e-9);
    EXPECT_NEAR(moved.beside.*inside, tolerance, 1e-9);
  }
}

// Chords of a bend are on its inside, by the closed form of their deviation.
TEST(LineBeside, OfAChordIsItsDeviationOnTheInsideOfTheBend) {
  const BsplineCurve curve = kFlatParabola.curve();
  const CurvePieces pieces(curve, 2, 11);
  const Line chord{curve.point_at(3), curve.point_at(7)};
  const BesideCurve beside = line_beside(pieces, 3, 7, chord);
  EXPECT_NEAR(beside.right, kFlatParabola.deviation(3, 7), 1e-12);
  EXPECT_NEAR(beside.left, 0, 1e-12);
  // Going back, left and right change places.
  const BesideCurve back = line_beside(pieces, 3, 7, {chord.end, chord.start});
  EXPECT_NEAR(back.left, beside.right, 1e-12);
  EXPECT_NEAR(back.right, 0, 1e-12);
}

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
