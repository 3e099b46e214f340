// Promises of geometry/distance/path_distance on paths whose distance is known by hand.
#include "geometry/distance/path_distance.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <string>
#include <variant>
#include <vector>

#include "geometry/distance/chord_polyline.h"
#include "geometry/distance/free_space.h"
#include "tests/support/processor_time.h"

namespace batten::geometry {
namespace {

constexpr double kPi = std::numbers::pi;

// The chain through the places as it is: zero-length pieces and repeated places stay.
Path chain(const std::vector<Point3>& places) {
  Path path;
  for (std::size_t i = 1; i < places.size(); ++i) path.push_back(Line{places[i - 1], places[i]});
  return path;
}

Path moved(const Path& path, const Vector3& by) {
  Path result;
  for (const PathPiece& piece : path) {
    if (const auto* line = std::get_if<Line>(&piece)) {
      result.push_back(Line{line->start + by, line->end + by});
    } else {
      const Arc& arc = std::get<Arc>(piece);
      result.push_back(Arc{arc.start + by, arc.end + by, arc.center + by, arc.axis, arc.sweep});
    }
  }
  return result;
}

// Along x from 0 to `length` and back, `times` runs, `parts` pieces in each run.
Path back_and_forth(double length, int times, int parts) {
  std::vector<Point3> places{Point3(0, 0, 0)};
  for (int run = 0; run < times; ++run) {
    for (int k = 1; k <= parts; ++k) {
      const double x = length * k / parts;
      places.emplace_back(run % 2 == 0 ? x : length - x, 0, 0);
    }
  }
  return chain(places);
}

Arc circle_arc(double radius, double from, double sweep) {
  const auto at = [radius](double angle) {
    return Point3(radius * std::cos(angle), radius * std::sin(angle), 0);
  };
  return Arc{at(from), at(from + sweep), Point3::Zero(), Vector3::UnitZ(), sweep};
}

// --- the tolerance is a promise to the last digit -----------------------------------------------

struct PairCase {
  std::string name;
  Path a;
  Path b;
  double tolerance;
  Verdict expected;
  double at_most = HUGE_VAL;
};

void expect_verdict_both_ways(const PairCase& test) {
  SCOPED_TRACE(test.name);
  const PathComparison found = compare_paths(test.a, test.b, test.tolerance);
  EXPECT_EQ(found.verdict, test.expected)
      << "between " << found.bounds.at_least << " and " << found.bounds.at_most;
  EXPECT_LE(found.bounds.at_most, test.at_most);
  const PathComparison swapped = compare_paths(test.b, test.a, test.tolerance);
  EXPECT_EQ(swapped.verdict, test.expected);
}

class Verdicts : public testing::TestWithParam<PairCase> {};

TEST_P(Verdicts, AreTheSameBothWays) { expect_verdict_both_ways(GetParam()); }

// Too long to be made before any test runs.
TEST(ComparePaths, TellsOneRunMoreOrLessOfManyBackAndForth) {
  const Path fine = back_and_forth(100, 300, 100);
  const Path coarse = back_and_forth(100, 300, 1);
  for (const PairCase& test :
       {PairCase{"the same", fine, coarse, 0.01, Verdict::kProved},
        {"moved", fine, moved(coarse, {0.006, 0.007, 0}), 0.01, Verdict::kProved},
        {"two less", fine, back_and_forth(100, 298, 1), 0.01, Verdict::kBroken}}) {
    expect_verdict_both_ways(test);
  }
}

std::vector<PairCase> digit_cases() {
  const Path bent = chain({{0, 0, 0}, {10.1, 0.3, 0}, {20.7, 5.1, 0.7}, {3.3, 8.8, 1.9}});
  const Path two = chain({{0, 0, 0}, {3, 0, 0}, {7.7, 0, 0}, {10, 0, 0}});
  const Path one_up = chain({{0, 0.01, 0}, {10, 0.01, 0}});
  const Path one_up_more = chain({{0, 0.010001, 0}, {10, 0.010001, 0}});
  // A slanted line and a vertex off it by (-0.006, 0.008): the foot (3, 2.25) has t = 0.3.
  const Path slanted = chain({{0, 0, 0}, {10, 7.5, 0}});
  const Path slanted_off = chain({{0, 0, 0}, {2.994, 2.258, 0}, {10, 7.5, 0}});
  const Path slanted_more = chain({{0, 0, 0}, {2.994, 2.258001, 0}, {10, 7.5, 0}});
  // Two vertices with the same foot (5, 0), on both sides of the line.
  const Path straight = chain({{0, 0, 0}, {9.1, 0, 0}});
  const Path spike = chain({{0, 0, 0}, {0.7, 0.01, 0}, {0.7, -0.01, 0}, {9.1, 0, 0}});
  // Inches: 0.0004 in = 0.01016 mm. Coordinates as an interpreter makes them.
  const Path inch = chain({{0, 0, 0}, {1.2345 * 25.4, 0.1 * 25.4, 0}});
  const Path inch_up = chain({{0, 0.0004 * 25.4, 0}, {1.2345 * 25.4, 0.1004 * 25.4, 0}});
  const double more = 1e-9;
  return {
      {"SpaceDiagonalEqual", bent, moved(bent, {0.002, 0.006, 0.009}), 0.011, Verdict::kProved},
      {"PlaneDiagonalEqual", bent, moved(bent, {0.006, -0.008, 0}), 0.01, Verdict::kProved},
      {"ThirdDecimalMore", bent, moved(bent, {0.006, -0.009, 0}), 0.01, Verdict::kBroken},
      {"NinthDecimalMore", bent, moved(bent, {0, 0, 0.01 + more}), 0.01, Verdict::kBroken},
      {"FarFromTheOriginEqual", moved(bent, {1234.5, -999.9, 0.1}),
       moved(bent, {1234.506, -999.892, 0.1}), 0.01, Verdict::kProved},
      {"FarFromTheOriginMore", moved(bent, {1234.5, -999.9, 0.1}),
       moved(bent, {1234.506, -999.891999, 0.1}), 0.01, Verdict::kBroken},
      {"FootsOnOneLineEqual", two, one_up, 0.01, Verdict::kProved},
      {"FootsOnOneLineMore", two, one_up_more, 0.01, Verdict::kBroken},
      {"FootOnASlantedLineEqual", slanted, slanted_off, 0.01, Verdict::kProved},
      {"FootOnASlantedLineMore", slanted, slanted_more, 0.01, Verdict::kBroken},
      {"TwoVerticesWithOneFoot", straight, spike, 0.01, Verdict::kProved},
      {"InchesEqual", inch, inch_up, 0.01016, Verdict::kProved},
      {"InchesOneDigitLess", inch, inch_up, 0.0101599, Verdict::kBroken},
  };
}

std::vector<PairCase> shape_cases() {
  const Path once = {circle_arc(10, 0, 2 * kPi)};
  const Path twice = {once.front(), once.front()};
  const Path clockwise = {circle_arc(10, 0, -2 * kPi)};
  const Path on_the_circle = chain({{10, 0, 0}, {10, 0, 0}});
  // Radii 20 and 20.011 about one centre: 0.011 apart.
  const Path half = {circle_arc(20, 0, kPi)};
  const Path wider = {circle_arc(20.011, 0, kPi)};
  const PathPiece bezier =
      CubicBezier{{Point3(0, 0, 0), Point3(3, 9, 1), Point3(-2, 8, 4), Point3(5, 1, 2)}};
  const Path halves = {sub_piece(bezier, 0, 0.5), sub_piece(bezier, 0.5, 1)};
  const Path its_chord = {Line{Point3(0, 0, 0), Point3(5, 1, 2)}};
  const Path short_line = chain({{1, 2, 3}, {1.005, 2, 3}});
  const Path long_line = chain({{1, 2, 3}, {1.5, 2, 3}});
  const Path corner = chain({{0, 0, 0}, {5, 0, 0}, {5, 5, 0}});
  const Path repeated =
      chain({{0, 0, 0}, {0, 0, 0}, {5, 0, 0}, {5, 0, 0}, {5, 0, 0}, {5, 5, 0}, {5, 5, 0}});
  const Path standing = chain({{1, 1, 1}, {1, 1, 1}});
  // The starts differ along the path by more than the tolerance.
  const Path square = chain({{0, 0, 0}, {4, 0, 0}, {4, 4, 0}, {0, 4, 0}, {0, 0, 0}});
  const Path other_start =
      chain({{0.02, 0, 0}, {4, 0, 0}, {4, 4, 0}, {0, 4, 0}, {0, 0, 0}, {0.02, 0, 0}});
  // sqrt(0.006^2 + 0.008^2 + 1e-9^2) is 0.01 + 5e-17 mm: in doubles at 100 mm it is 0.01.
  const Path far = chain({{100, 100, 100}, {101.5, 107, 99}, {100, 110, 103}});
  return {
      {"OneRoundOfACircleTooFew", twice, once, 0.01, Verdict::kBroken},
      {"ACircleTwice", twice, twice, 0.01, Verdict::kProved},
      {"TheOtherWayRoundACircle", once, clockwise, 0.01, Verdict::kBroken},
      {"ATurnInPlaceThatWasNotThere", on_the_circle, once, 0.01, Verdict::kBroken},
      {"AnotherRadius", half, wider, 0.01, Verdict::kBroken},
      {"AnotherRadiusWithin", half, wider, 0.0112, Verdict::kProved},
      {"ABezierPieceAndItsHalves", {bezier}, halves, 0.001, Verdict::kProved},
      {"ABezierPieceAndItsChord", {bezier}, its_chord, 0.1, Verdict::kBroken},
      {"NoPathAndAShortLine", {}, short_line, 0.01, Verdict::kProved},
      {"NoPathAndALongLine", {}, long_line, 0.01, Verdict::kBroken},
      {"NoPathTwice", {}, {}, 0.01, Verdict::kProved, 0},
      {"RepeatedPoints", corner, repeated, 0.01, Verdict::kProved, 0},
      {"PiecesOfNoLength", standing, standing, 0.01, Verdict::kProved, 0},
      {"AClosedPath", square, square, 0.01, Verdict::kProved},
      {"AClosedPathFromAnotherStart", square, other_start, 0.01, Verdict::kBroken},
      {"FarEqual", far, moved(far, {0.006, 0.008, 0}), 0.01, Verdict::kProved},
      {"OnlyExactArithmeticTells", far, moved(far, {0.006, 0.008, 1e-9}), 0.01,
       Verdict::kNotProved},
  };
}

constexpr auto name_of_case = [](const auto& test) { return test.param.name; };
INSTANTIATE_TEST_SUITE_P(LastDigit, Verdicts, testing::ValuesIn(digit_cases()), name_of_case);
INSTANTIATE_TEST_SUITE_P(Shapes, Verdicts, testing::ValuesIn(shape_cases()), name_of_case);

TEST(Matching, IsNoCertificateWhenItStepsBackOrLeavesOut) {
  const ChordPolyline a = cut_into_chords(chain({{0, 0, 0}, {1, 0, 0}, {2, 0, 0}}), 1e-4);
  const ChordPolyline b = cut_into_chords(chain({{0, 0, 0}, {2, 0, 0}}), 1e-4);
  const Matching good{{{0, 0}, {0, 0}}, {{0, 1}, {0, 0.5}}, {{1, 1}, {0, 1}}};
  EXPECT_TRUE(goes_forward(good, a, b));
  Matching back = good;
  back.insert(back.begin() + 1, MatchedPair{{0, 0.5}, {0, 0.6}});
  EXPECT_FALSE(goes_forward(back, a, b));
  Matching jump = good;
  jump[1].a.t = 0.9;  // leaves the edge before its end
  EXPECT_FALSE(goes_forward(jump, a, b));
  EXPECT_FALSE(goes_forward({good[0], good[1]}, a, b));
  EXPECT_FALSE(goes_forward({good[1], good[2]}, a, b));
  EXPECT_FALSE(goes_forward({good[0], good[2]}, a, b));
  EXPECT_FALSE(goes_forward({}, a, b));
}

// --- in order -----------------------------------------------------------------------------------

TEST(ComparePaths, SeesAShortenedZigZagThoughEveryPlaceIsNear) {
  // Forward to 10, back to 2, forward to 12: as sets both are [0, 12] on the x axis. The way
  // back can at best be waited for in its middle: (10 - 2) / 2 = 4 mm.
  const Path folded = chain({{0, 0, 0}, {10, 0, 0}, {2, 0, 0}, {12, 0, 0}});
  const Path straight = chain({{0, 0, 0}, {12, 0, 0}});
  const PathComparison found = compare_paths(folded, straight, 0.01);
  EXPECT_EQ(found.verdict, Verdict::kBroken);
  EXPECT_GT(found.bounds.at_least, 3.5);
  EXPECT_LE(found.bounds.at_least, 4);
  EXPECT_GE(found.bounds.at_most, 4);
  EXPECT_EQ(compare_paths(folded, straight, 4.001).verdict, Verdict::kProved);
  EXPECT_EQ(compare_paths(folded, straight, 3.999).verdict, Verdict::kBroken);
}

TEST(ComparePaths, MeasuresACutCornerAndSaysWhere) {
  // The chamfer from (9, 0) to (10, 1) passes the corner (10, 0) at 1 / sqrt(2).
  const Path corner = chain({{0, 0, 0}, {5, 0, 0}, {10, 0, 0}, {10, 10, 0}});
  const Path cut = chain({{0, 0, 0}, {9, 0, 0}, {10, 1, 0}, {10, 10, 0}});
  const PathComparison found = compare_paths(corner, cut, 0.01);
  EXPECT_EQ(found.verdict, Verdict::kBroken);
  EXPECT_LE(found.bounds.at_least, std::sqrt(0.5));
  EXPECT_GE(found.bounds.at_most, std::sqrt(0.5));
  EXPECT_LT(found.bounds.at_most, 1.1 * found.bounds.at_least);
  EXPECT_LT((found.worst_a - Point3(10, 0, 0)).norm(), 1.1);
  EXPECT_GE(found.worst_piece_a, 1U);
  EXPECT_EQ(compare_paths(corner, cut, 0.7072).verdict, Verdict::kProved);
  EXPECT_EQ(compare_paths(corner, cut, 0.7071).verdict, Verdict::kBroken);
}

TEST(ComparePaths, TellsTheWorstPiecesOfAProof) {
  const Path a = chain({{0, 0, 0}, {1, 0, 0}, {2, 0, 0}, {3, 0, 0}, {4, 0, 0}});
  const Path b = chain({{0, 0, 0}, {2, 0.008, 0}, {4, 0, 0}});
  const PathComparison found = compare_paths(a, b, 0.01);
  ASSERT_EQ(found.verdict, Verdict::kProved);
  EXPECT_NEAR(found.bounds.at_most, 0.008, 1e-9);
  EXPECT_GT(found.bounds.at_least, 0.0078);
  EXPECT_LT((found.worst_b - Point3(2, 0.008, 0)).norm(), 1e-6);
  EXPECT_TRUE(found.worst_piece_a == 1 || found.worst_piece_a == 2);
  EXPECT_GE(found.certificate_size, 4U);
}

// --- arcs ---------------------------------------------------------------------------------------

TEST(ComparePaths, ProvesAnArcAgainstItsChords) {
  // n chords of a half circle of radius 20: sagitta r (1 - cos(pi / 2n)). n = 100: 0.002467 mm.
  constexpr int kChords = 100;
  std::vector<Point3> places;
  for (int k = 0; k <= kChords; ++k) {
    places.emplace_back(20 * std::cos(kPi * k / kChords), 20 * std::sin(kPi * k / kChords), 0);
  }
  const double sagitta = 20 * (1 - std::cos(kPi / (2 * kChords)));
  const Path arc = {circle_arc(20, 0, kPi)};
  const PathComparison found = compare_paths(arc, chain(places), 0.01);
  ASSERT_EQ(found.verdict, Verdict::kProved);
  EXPECT_GE(found.bounds.at_most, sagitta);
  EXPECT_LE(found.bounds.at_most, sagitta + 0.02 * 0.01);
  EXPECT_LE(found.bounds.at_least, sagitta);
  EXPECT_EQ(compare_paths(arc, chain(places), 1.001 * sagitta).verdict, Verdict::kProved);
  EXPECT_EQ(compare_paths(arc, chain(places), 0.999 * sagitta).verdict, Verdict::kBroken);
}

TEST(ComparePaths, ProvesAHelixAgainstTheSameHelixInTwoArcs) {
  Arc whole = circle_arc(7, 0.3, 2.0);
  whole.end.z() = 3;
  const PathPiece piece = whole;
  const Path two = {sub_piece(piece, 0, 0.37), sub_piece(piece, 0.37, 1)};
  const PathComparison found = compare_paths(Path{piece}, two, 0.01);
  EXPECT_EQ(found.verdict, Verdict::kProved);
  EXPECT_LE(found.bounds.at_most, 0.02 * 0.01);
}

// --- strange paths ------------------------------------------------------------------------------

TEST(ComparePaths, TakesSizesFromNanometresToTensOfMetres) {
  const Path unit = chain({{0, 0, 0}, {1, 0.2, 0}, {2, -0.1, 0.5}, {3, 0, 0}});
  for (const double size : {1e-6, 1e-3, 1.0, 1e3, 1e4}) {
    SCOPED_TRACE(size);
    Path scaled;
    for (const PathPiece& piece : unit) {
      scaled.push_back(Line{size * start_point(piece), size * end_point(piece)});
    }
    EXPECT_EQ(compare_paths(scaled, moved(scaled, {0, 0.09 * size, 0}), 0.1 * size).verdict,
              Verdict::kProved);
    EXPECT_EQ(compare_paths(scaled, moved(scaled, {0, 0.11 * size, 0}), 0.1 * size).verdict,
              Verdict::kBroken);
  }
}

TEST(ComparePaths, ThrowsWhenTheToleranceIsNoLength) {
  const Path path = chain({{0, 0, 0}, {1, 0, 0}});
  EXPECT_THROW(static_cast<void>(compare_paths(path, path, 0)), std::invalid_argument);
  EXPECT_THROW(static_cast<void>(compare_paths(path, path, -1)), std::invalid_argument);
  EXPECT_THROW(static_cast<void>(compare_paths(path, path, NAN)), std::invalid_argument);
}

// --- cost ---------------------------------------------------------------------------------------

double seconds_of(const Path& a, const Path& b, double tolerance, Verdict expected) {
  const double begin = processor_seconds();
  EXPECT_EQ(compare_paths(a, b, tolerance).verdict, expected);
  return processor_seconds() - begin;
}

// The limits are some twenty times what an idle machine needs: they find quadratic cost.
TEST(ComparePaths, TakesTimeLinearInThePieces) {
  std::vector<Point3> fine;
  std::vector<Point3> coarse;
  constexpr int kPoints = 200'000;
  for (int k = 0; k <= kPoints; ++k) {
    const double angle = 0.001 * k;  // a spiral of 30 turns, radius 10 to 30
    const double radius = 10 + 20.0 * k / kPoints;
    const Point3 place(radius * std::cos(angle), radius * std::sin(angle), 0.0001 * k);
    fine.push_back(place);
    if (k % 4 == 0) coarse.push_back(place);
  }
  EXPECT_LT(seconds_of(chain(fine), chain(coarse), 0.001, Verdict::kProved), 10);
  EXPECT_LT(seconds_of(chain(fine), moved(chain(coarse), {0, 0.0011, 0}), 0.001, Verdict::kBroken),
            10);
}

TEST(ComparePaths, BoundsItsCostWhereEverythingIsNearEverything) {
  // Each path wanders in a ball that is a little larger than the tolerance.
  const auto wander = [](unsigned seed) {
    std::vector<Point3> places;
    for (int k = 0; k < 10'000; ++k) {
      const auto next = [&seed] {
        seed = seed * 1664525U + 1013904223U;
        return 0.012 * (seed / 4294967296.0 - 0.5);
      };
      const double x = next();
      const double y = next();
      places.emplace_back(x, y, next());
    }
    return chain(places);
  };
  const double begin = processor_seconds();
  const PathComparison found = compare_paths(wander(1), wander(2), 0.01);
  EXPECT_LE(found.bounds.at_least, found.bounds.at_most);
  EXPECT_LT(processor_seconds() - begin, 60);
}

// --- what is really run may be beside the second path ------------------------------------------

TEST(ComparePaths, LeavesLessWhereWhatIsRunIsBesideThePath) {
  const Path old_path = chain({{0, 0, 0}, {10, 0, 0}, {20, 0, 0}, {30, 0, 0}});
  const Path new_path = chain({{0, 0.1, 0}, {10, 0.1, 0}, {20, 0.3, 0}, {30, 0.1, 0}});
  const auto verdict = [&](double tolerance, const std::vector<double>& beside) {
    return compare_paths(old_path, new_path, tolerance, beside).verdict;
  };
  EXPECT_EQ(verdict(0.3, {}), Verdict::kProved);
  EXPECT_EQ(verdict(0.3, {0.19, 0, 0}), Verdict::kProved);  // far from where the distance is 0.3
  EXPECT_EQ(verdict(0.3, {0.21, 0, 0}), Verdict::kNotProved);
  EXPECT_EQ(verdict(0.3, {0, 0.01, 0}), Verdict::kNotProved);
  EXPECT_EQ(verdict(0.29, {0.01, 0, 0}), Verdict::kBroken);
  EXPECT_LE(compare_paths(old_path, new_path, 0.4, std::vector<double>{0, 0.09, 0}).bounds.at_most,
            0.4);
  EXPECT_THROW((void)compare_paths(old_path, new_path, 0.4, std::vector<double>{0.1}),
               std::invalid_argument);
}

// However many chords bends would take, a path that is cut part by part has no more of them than
// one that is cut at once, and as fine ones.
TEST(ChordPolyline, OfAPathInPartsHasNoMoreChordsThanAtOnce) {
  constexpr double kError = 1e-9;
  Path path;
  for (int i = 0; i < 60; ++i) {
    const double x = 200.0 * i;
    path.push_back(Arc{{x, 0, 0}, {x + 200, 0, 0}, {x + 100, 0, 0}, {0, 0, 1}, kPi});
    path.push_back(Line{{x + 200, 0, 0}, {x + 200, 0, 0}});
  }
  const ChordPolyline whole = cut_into_chords(path, kError);
  double wanted = 0;
  for (const PathPiece& piece : path) wanted += chords_wanted(piece, kError);
  ASSERT_GT(wanted, 2.0 * (1 << 20));
  std::size_t in_parts = 0;
  for (const PathPiece& piece : path) {
    if (std::holds_alternative<Line>(piece)) continue;
    in_parts += cut_into_chords({&piece, 1}, affordable_error(wanted, kError)).edge_count();
  }
  EXPECT_EQ(in_parts, whole.edge_count());
  EXPECT_LE(in_parts, (std::size_t{1} << 20) + path.size());
  EXPECT_EQ(affordable_error(100, kError), kError);
}

}  // namespace
}  // namespace batten::geometry
