#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <optional>
#include <random>
#include <span>
#include <stdexcept>
#include <utility>
#include <variant>
#include <vector>

#include "geometry/distance/path_distance.h"
#include "geometry/fitting/corners/guo_corner.h"
#include "geometry/path/joined_curve.h"
#include "tests/support/corners.h"
#include "tests/support/method_cases.h"
#include "tests/support/paths.h"

namespace batten::geometry {
namespace {

GuoOptions fair(double tolerance, ToleranceKind kind) {
  GuoOptions options;
  options.tolerance = tolerance;
  options.kind = kind;
  return options;
}

std::vector<GuoBlend> blends_of(const GuoPath& path) {
  std::vector<GuoBlend> blends;
  for (const auto& corner : path.corners) {
    if (const auto* blend = std::get_if<GuoBlend>(&corner.outcome)) blends.push_back(*blend);
  }
  return blends;
}

// Figures of a path as docs/algorithms/guo.md has them.
struct Figures {
  std::size_t blends = 0;
  double legs = 0;       // mm, greatest distance from the polyline
  double curvature = 0;  // 1/mm, greatest
  double median = 0;     // 1/mm, of the blends' greatest curvatures
  double least_spacing = std::numeric_limits<double>::infinity();
};

Figures figures_of(const GuoPath& path) {
  Figures found;
  std::vector<double> curvatures;
  for (const GuoBlend& blend : blends_of(path)) {
    found.legs = std::max(found.legs, blend.blend.deviation.legs);
    found.least_spacing = std::min(found.least_spacing, blend.spacing);
    curvatures.push_back(blend.greatest_curvature);
  }
  found.blends = curvatures.size();
  std::sort(curvatures.begin(), curvatures.end());
  if (curvatures.empty()) return found;
  found.curvature = curvatures.back();
  const std::size_t n = curvatures.size();
  found.median = (curvatures[(n - 1) / 2] + curvatures[n / 2]) / 2;
  return found;
}

TEST(GuoPath, GivesTheFiguresOfTheButterfly) {
  const std::vector<Point3> points = guo_butterfly();
  const GuoPath literal = guo_path(points, GuoOptions::literal(0.05, 0.1));
  const Figures paper = figures_of(literal);
  const Figures ours = figures_of(guo_path(points, fair(0.05, ToleranceKind::kBand)));
  const Figures strict = figures_of(guo_path(points, fair(0.05, ToleranceKind::kPath)));
  fmt::print("butterfly, tolerance 0.05    blends  off legs  greatest  median  least L\n");
  for (const auto& [name, f] : {std::pair{"literal, lambda 0.1", paper},
                                std::pair{"fair, band", ours}, std::pair{"fair, path", strict}}) {
    fmt::print("{:28} {:6} {:9.4f} {:9.2f} {:7.3f} {:8.5f}\n", name, f.blends, f.legs, f.curvature,
               f.median, f.least_spacing);
  }
  EXPECT_EQ(paper.blends, 79u);
  EXPECT_NEAR(paper.legs, 0.0420, 0.00005);
  EXPECT_NEAR(paper.curvature, 50.3, 0.05);
  EXPECT_NEAR(paper.median, 0.29, 0.005);
  EXPECT_NEAR(paper.least_spacing, 0.06185, 0.000005);

  EXPECT_EQ(ours.blends, 79u);
  EXPECT_NEAR(ours.legs, 0.05, 1e-9);
  EXPECT_NEAR(ours.curvature, 14.8, 0.05);
  EXPECT_NEAR(ours.median, 0.14, 0.005);

  // How much of the allowed distance the paper's reduced corners use: 0.48 on the average.
  double used = 0;
  int reduced = 0;
  for (const GuoBlend& blend : blends_of(literal)) {
    if (std::abs(blend.blend.deviation.corner - 0.025) > 1e-9) continue;
    ++reduced;
    used += blend.blend.deviation.legs / 0.05;
  }
  EXPECT_EQ(reduced, 72);
  EXPECT_NEAR(used / reduced, 0.48, 0.005);
}

TEST(GuoPath, GivesTheFiguresOfTheHexagon) {
  const GuoPath literal = guo_path(guo_hexagon(), GuoOptions::literal(0.05, 0.1));
  ASSERT_EQ(blends_of(literal).size(), 5u);
  for (const GuoBlend& blend : blends_of(literal)) {
    EXPECT_NEAR(blend.spacing / 0.084102, 1, 1e-4);
    EXPECT_NEAR(blend.blend.deviation.corner / 0.025, 1, 1e-4);
    EXPECT_NEAR(blend.greatest_curvature / 14.58, 1, 4e-4);  // as many digits as given
    const auto& p = blend.blend.curve.control_points();
    const auto frame = std::get<CornerFrame>(frame_of({p.front(), p[2], p.back()}));
    EXPECT_NEAR(std::asin(frame.sin_half) / kDegrees, 53.522, 0.01);
  }
  const GuoPath ours = guo_path(guo_hexagon(), fair(0.05, ToleranceKind::kBand));
  ASSERT_EQ(blends_of(ours).size(), 5u);
  for (const GuoBlend& blend : blends_of(ours)) {
    EXPECT_NEAR(blend.spacing / 0.209188, 1, 1e-4);
    EXPECT_NEAR(blend.blend.deviation.corner / 0.062182, 1, 1e-4);
    EXPECT_NEAR(blend.greatest_curvature / 5.86, 1, 1e-3);
  }
}

// Four segments at right angles, the first a little shorter than the others: the greedy rule
// leaves the second corner a hundredth of what the others have.
std::vector<Point3> almost_equal_steps() {
  return {{0, 0, 0}, {0.198, 0, 0}, {0.198, 0.2, 0}, {0.398, 0.2, 0}, {0.398, 0.4, 0}};
}

std::vector<double> spacings(const GuoPath& path) {
  std::vector<double> found;
  for (const GuoBlend& blend : blends_of(path)) found.push_back(blend.spacing);
  return found;
}

void expect_near(const std::vector<double>& found, const std::vector<double>& expected) {
  ASSERT_EQ(found.size(), expected.size());
  for (std::size_t i = 0; i < found.size(); ++i) EXPECT_NEAR(found[i], expected[i], 1e-9) << i;
}

TEST(GuoPath, SharesShortSegmentsLiterallyOrFairly) {
  const auto steps = almost_equal_steps();
  expect_near(spacings(guo_path(steps, GuoOptions::literal(0.05, 0))), {0.099, 0.001, 0.099});
  expect_near(spacings(guo_path(steps, fair(0.05, ToleranceKind::kBand))), {0.05, 0.05, 0.05});
}

// With all segments 0.2 the first blend, 2L = 0.2, would reach the next corner, so it is halved.
// The other two find 0.1 left before them and take that.
TEST(GuoPath, HalvesABlendThatWouldReachTheNextCorner) {
  const std::vector<Point3> equal = {
      {0, 0, 0}, {0.2, 0, 0}, {0.2, 0.2, 0}, {0.4, 0.2, 0}, {0.4, 0.4, 0}};
  const GuoPath path = guo_path(equal, GuoOptions::literal(0.05, 0));
  expect_near(spacings(path), {0.05, 0.05, 0.05});
  // The last corner is not halved though it reaches the end.
  const std::vector<Point3> one = {{0, 0, 0}, {0.2, 0, 0}, {0.2, 0.2, 0}};
  expect_near(spacings(guo_path(one, GuoOptions::literal(0.1, 0))), {0.1});
}

// Lambda 0.5 takes half of the 0.101 that the first blend leaves: 2L <= 0.0505 there.
TEST(GuoPath, LambdaTakesRoomFromTheNextCorner) {
  const std::vector<Point3> points = {{0, 0, 0}, {0.099, 0, 0}, {0.099, 0.2, 0}, {0.4, 0.2, 0}};
  expect_near(spacings(guo_path(points, GuoOptions::literal(0.05, 0))), {0.0495, 0.0505});
  expect_near(spacings(guo_path(points, GuoOptions::literal(0.05, 0.5))), {0.0495, 0.02525});
}

TEST(GuoPath, GivesAllOfASegmentToTheOnlyCornerThatNeedsIt) {
  // A straight vertex at (4, 0), a reversal at (10, 3).
  const std::vector<Point3> points = {{0, 0, 0},  {4, 0, 0},  {10, 0, 0},
                                      {10, 3, 0}, {10, 0, 0}, {20, 0, 0}};
  const GuoPath path = guo_path(points, fair(50, ToleranceKind::kPath));
  ASSERT_EQ(path.corners.size(), 4u);
  EXPECT_EQ(std::get<NoBlend>(path.corners[0].outcome), NoBlend::kStraight);
  EXPECT_NEAR(std::get<GuoBlend>(path.corners[1].outcome).spacing, 1.5, 1e-12);
  EXPECT_EQ(std::get<NoBlend>(path.corners[2].outcome), NoBlend::kReversal);
  EXPECT_NEAR(std::get<GuoBlend>(path.corners[3].outcome).spacing, 1.5, 1e-12);
}

TEST(GuoPath, PassesOverPointsThatAreOnePlace) {
  const std::vector<Point3> points = {{0, 0, 0}, {0, 0, 0}, {1, 0, 0}, {1, 1e-10, 0},
                                      {1, 1, 0}, {1, 1, 0}, {2, 1, 0}};
  const GuoPath path = guo_path(points, fair(0.01, ToleranceKind::kPath));
  ASSERT_EQ(path.corners.size(), 2u);
  EXPECT_EQ(path.corners[0].vertex, 2u);
  EXPECT_EQ(path.corners[1].vertex, 4u);
  EXPECT_EQ(blends_of(path).size(), 2u);
}

TEST(GuoPath, EndsOnItsOwnPointsWhereBlendsTakeAllOfTheLegs) {
  std::mt19937 random(5);
  for (int seed = 0; seed < 50; ++seed) {
    const Motion motion = random_motion(random);
    const Corner corner = motion(corner_of(10 + seed, 1, 1));
    const std::vector<Point3> points = {corner.before, corner.vertex, corner.after};
    const GuoPath path = guo_path(points, fair(10, ToleranceKind::kPath));
    EXPECT_LE(path.pieces.size(), 4u);
    EXPECT_EQ(start_point(path.pieces.front()), points.front());
    EXPECT_EQ(end_point(path.pieces.back()), points.back());
  }
}

TEST(GuoPath, TakesAnyNumberOfPoints) {
  const std::vector<Point3> points = {{0, 0, 0}, {1, 0, 0}, {0, 0, 0}};
  for (std::size_t n = 0; n <= points.size(); ++n) {
    SCOPED_TRACE(testing::Message() << n << " points");
    const std::span<const Point3> given(points.data(), n);
    for (const GuoSharing sharing : {GuoSharing::kFair, GuoSharing::kLiteral}) {
      GuoOptions options = fair(0.01, ToleranceKind::kPath);
      options.sharing = sharing;
      EXPECT_TRUE(blends_of(guo_path(given, options)).empty());
    }
  }
  EXPECT_EQ(guo_path(points, fair(0.01, ToleranceKind::kPath)).pieces.size(), 2u);
}

// --- properties ---------------------------------------------------------------------------

// Segments of 1e-2 to 10 mm; every tenth vertex or so straight, reversed or doubled.
std::vector<Point3> random_path(std::mt19937& random, int segments) {
  std::uniform_real_distribution<double> unit(0, 1);
  std::normal_distribution<double> normal;
  std::vector<Point3> points = {Point3::Zero()};
  Vector3 direction(1, 0, 0);
  for (int i = 0; i < segments; ++i) {
    const double odd = unit(random);
    if (odd < 0.05) {
      direction = -direction;
    } else if (odd > 0.15) {
      const double wild = std::pow(10, -3 * unit(random));
      const Vector3 next(normal(random), normal(random), normal(random));
      direction = (direction + 3 * wild * next).normalized();
    }
    if (odd > 0.97) points.push_back(points.back());
    points.push_back(points.back() + std::pow(10, -2 + 3 * unit(random)) * direction);
  }
  return points;
}

// Places along each segment of the ends of the blends never go back; blends end on segments.
void expect_joints_in_order(std::span<const Point3> points, const GuoPath& path) {
  const Point3* reached = &points[0];
  double at = 0;  // mm from *reached that are used
  for (const auto& corner : path.corners) {
    const Point3& q = points[corner.vertex];
    const auto* guo = std::get_if<GuoBlend>(&corner.outcome);
    const double length = (q - *reached).norm();
    const double taken = guo ? 2 * guo->spacing : 0;
    EXPECT_LE(at + taken, length + 1e-9) << "before vertex " << corner.vertex;
    reached = &q;
    at = taken;
  }
  EXPECT_LE(at, (points.back() - *reached).norm() + 1e-9);
}

// Neighbours meet; but at vertices without a blend also in direction and curvature.
void expect_smooth_but_at_kept_corners(std::span<const Point3> points, const GuoPath& path) {
  const auto kept = [&](const Point3& p) {
    return std::any_of(path.corners.begin(), path.corners.end(), [&](const auto& corner) {
      return std::holds_alternative<NoBlend>(corner.outcome) &&
             (points[corner.vertex] - p).norm() < 1e-9;
    });
  };
  for (std::size_t i = 0; i + 1 < path.pieces.size(); ++i) {
    const PathPiece& one = path.pieces[i];
    const PathPiece& next = path.pieces[i + 1];
    EXPECT_EQ(end_point(one), start_point(next)) << i;
    if (kept(end_point(one))) continue;
    // Blends as short as 1e-8 mm have ends with rounding of 1e-14 mm.
    EXPECT_LT((direction_at(one, 1) - direction_at(next, 0)).norm(), 1e-5) << i;
    const double here = curvature_at(one, 1);
    const double scale =
        std::max({here, curvature_at(next, 0), curvature_at(one, 0), curvature_at(next, 1)});
    EXPECT_LE(std::abs(here - curvature_at(next, 0)), 1e-5 * scale) << i;
  }
}

double greatest_distance_to(std::span<const Point3> points, const Path& pieces) {
  double worst = 0;
  for (const PathPiece& piece : pieces) {
    for (int k = 0; k <= 16; ++k) {
      const Point3 p = point_at(piece, k / 16.0);
      double least = std::numeric_limits<double>::infinity();
      for (std::size_t i = 0; i + 1 < points.size(); ++i) {
        if (points[i] == points[i + 1]) continue;
        least = std::min(least, segment_distance(p, points[i], points[i + 1]));
      }
      worst = std::max(worst, least);
    }
  }
  return worst;
}

TEST(GuoPath, StaysInTheBandSharesAndJoinsOnRandomPaths) {
  std::mt19937 random(2);
  for (int seed = 0; seed < 60; ++seed) {
    SCOPED_TRACE(testing::Message() << "path " << seed);
    const std::vector<Point3> points = random_path(random, 25);
    const double tolerance = std::pow(10, -4 + 4 * (seed % 7) / 6.0);
    const ToleranceKind kind = seed % 2 ? ToleranceKind::kPath : ToleranceKind::kBand;
    GuoOptions options = fair(tolerance, kind);
    if (seed % 3 == 0) {
      options = GuoOptions::literal(tolerance, 0.1);
      options.kind = kind;
    }
    const GuoPath path = guo_path(points, options);
    EXPECT_FALSE(blends_of(path).empty());
    EXPECT_LE(greatest_distance_to(points, path.pieces), tolerance * (1 + 1e-9) + 1e-9);
    expect_joints_in_order(points, path);
    expect_smooth_but_at_kept_corners(points, path);
    EXPECT_EQ(start_point(path.pieces.front()), points.front());
    EXPECT_EQ(end_point(path.pieces.back()), points.back());
    if (kind == ToleranceKind::kPath) {
      const auto proof = compare_paths(path_through(points), path.pieces, 1.03 * tolerance);
      EXPECT_EQ(proof.verdict, Verdict::kProved);
    }
  }
}

TEST(GuoPath, FollowsMotionsAndReversals) {
  std::mt19937 random(3);
  for (int seed = 0; seed < 40; ++seed) {
    SCOPED_TRACE(testing::Message() << "path " << seed);
    const std::vector<Point3> points = random_path(random, 20);
    const GuoOptions options = fair(0.02, seed % 2 ? ToleranceKind::kPath : ToleranceKind::kBand);
    const Motion motion = random_motion(random);
    std::vector<Point3> moved;
    for (const Point3& p : points) moved.push_back(motion(p));
    const std::vector<Point3> back(points.rbegin(), points.rend());

    const auto given = blends_of(guo_path(points, options));
    const auto turned = blends_of(guo_path(moved, options));
    const auto reversed = blends_of(guo_path(back, options));
    ASSERT_EQ(given.size(), turned.size());
    ASSERT_EQ(given.size(), reversed.size());
    for (std::size_t i = 0; i < given.size(); ++i) {
      for (std::size_t k = 0; k < 5; ++k) {
        const Point3& p = given[i].blend.curve.control_points()[k];
        EXPECT_LT((motion(p) - turned[i].blend.curve.control_points()[k]).norm(), 1e-7);
        const auto& mirrored = reversed[given.size() - 1 - i].blend.curve.control_points();
        EXPECT_LT((p - mirrored[4 - k]).norm(), 1e-7);
      }
    }
  }
}

TEST(GuoPath, LeavesCornersThatTurnMoreThanAsked) {
  // Turns of 5.7 and 84 degrees.
  const std::vector<Point3> points = {{0, 0, 0}, {10, 0, 0}, {20, 1, 0}, {20, 11, 0}};
  for (const GuoSharing sharing : {GuoSharing::kFair, GuoSharing::kLiteral}) {
    GuoOptions options = fair(5, ToleranceKind::kPath);
    options.sharing = sharing;
    options.keep_corner_angle = 1;
    const GuoPath path = guo_path(points, options);
    ASSERT_EQ(path.corners.size(), 2u);
    // The kept one needs nothing of the segment between them: 2L is all of the first leg.
    EXPECT_NEAR(std::get<GuoBlend>(path.corners[0].outcome).spacing, 5, 1e-12);
    EXPECT_EQ(std::get<NoBlend>(path.corners[1].outcome), NoBlend::kKept);
    EXPECT_EQ(start_point(path.pieces.back()), points[2]);
  }
}

TEST(GuoPath, RefusesALambdaThatLeavesNothing) {
  for (const double lambda : {-0.1, 1.0, std::numeric_limits<double>::quiet_NaN()}) {
    EXPECT_THROW(static_cast<void>(guo_path(guo_hexagon(), GuoOptions::literal(0.05, lambda))),
                 std::invalid_argument);
  }
}

// A cubic from `start` to `end` that is pulled towards the vertex between them.
BsplineCurve blend_between(const Point3& start, const Point3& vertex, const Point3& end) {
  return {BsplineBasis::clamped(3, {0, 1}),
          {start, (start + 2 * vertex) / 3, (end + 2 * vertex) / 3, end}};
}

// Corners of 20 to 160 degrees, in space, their legs long and short: through the vertex, joined in
// direction and curvature there and with the legs, and within the tolerance of them.
TEST(SeamBlend, GoesThroughTheVertexWithoutACorner) {
  for (const double turn : {20, 60, 90, 120, 160}) {
    for (const double leg : {0.4, 40.0}) {
      SCOPED_TRACE(testing::Message() << turn << " degrees, legs of " << leg << " mm");
      const double a = turn * kPi / 180;
      const std::vector<Point3> ring = {{0, 0, 0},
                                        {leg, 0, 0},
                                        {leg / 2, leg / 2, 5},
                                        {-leg * std::cos(a), -leg * std::sin(a), 0},
                                        {0, 0, 0}};
      CornerPathOptions options;
      options.tolerance = 0.05;
      EXPECT_FALSE(shared_seam(ring, options));
      options.seam = Seam::kSmooth;
      const auto seam = shared_seam(ring, options);
      ASSERT_TRUE(seam);
      const auto blend = seam_blend(*seam, options.tolerance);
      ASSERT_TRUE(blend);
      const BsplineCurve& curve = blend->curve;
      EXPECT_LE(curve.point_at(2).norm(), 1e-14);
      EXPECT_LE(blend->deviation.in_order, options.tolerance * (1 + 1e-9));
      EXPECT_LE(curve.point_at(0).norm(), seam->share_before + 1e-12);
      if (leg > 1) {
        EXPECT_NEAR(blend->deviation.in_order, options.tolerance, 1e-9);
      }
      EXPECT_NEAR(curve.curvature_at(0), 0, 1e-9);
      EXPECT_NEAR(curve.curvature_at(4), 0, 1e-9);
      EXPECT_LE((curve.direction_at(0) - Vector3(std::cos(a), std::sin(a), 0)).norm(), 1e-12);
      EXPECT_LE((curve.direction_at(4) - Vector3(1, 0, 0)).norm(), 1e-12);
      const Path legs = {Line{curve.point_at(0), {0, 0, 0}}, Line{{0, 0, 0}, curve.point_at(4)}};
      const auto apart = compare_paths(legs, beziers_of(curve), 1.02 * options.tolerance);
      EXPECT_EQ(apart.verdict, Verdict::kProved);
    }
  }
}

// With it every corner of a square is rounded, and no blend meets another one.
TEST(GuoPathOfARing, HasNoCornerAtItsSeamWhereThatIsAsked) {
  const std::vector<Point3> square = {{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}, {0, 0, 0}};
  for (const double tolerance : {0.01, 0.5}) {
    GuoOptions options = fair(tolerance, ToleranceKind::kPath);
    options.seam = Seam::kSmooth;
    const GuoPath path = guo_path(square, options);
    ASSERT_TRUE(path.seam);
    EXPECT_EQ(blends_of(path).size(), 3u);
    EXPECT_EQ(start_point(path.pieces.front()), square.front());
    EXPECT_EQ(end_point(path.pieces.back()), square.front());
    for (std::size_t i = 0; i < path.pieces.size(); ++i) {
      const PathPiece& next = path.pieces[(i + 1) % path.pieces.size()];
      EXPECT_LE((direction_at(path.pieces[i], 1) - direction_at(next, 0)).norm(), 1e-9) << i;
      EXPECT_NEAR(curvature_at(path.pieces[i], 1), curvature_at(next, 0), 1e-6) << i;
    }
    EXPECT_EQ(compare_paths(path_through(square), path.pieces, 1.02 * tolerance).verdict,
              Verdict::kProved);
  }
}

// Blends side by side make one path whose stations go forward, whatever noise their ends have: both
// are to end in the middle of the leg from (10, 0) to (10, 10); the first one misses it backwards,
// not at all, or too far.
TEST(BlendedPath, GoesForwardAlongThePolyline) {
  for (const double miss : {-1e-3, -1e-8, -1e-10, 0.0, 1e-10, 1e-8, 1e-6}) {
    SCOPED_TRACE(testing::Message() << "miss " << miss);
    const std::vector<Point3> points = {{0, 0, 0}, {10, 0, 0}, {10, 10, 0}, {20, 10, 0}};
    std::vector<std::optional<BsplineCurve>> blends(points.size());
    blends[1] = blend_between({5, 0, 0}, points[1], {10, 5 + miss, 0});
    blends[2] = blend_between({10, 5, 0}, points[2], {15, 10, 0});
    const BlendedPath path = blended_path(points, blends);
    ASSERT_EQ(path.stations.size(), path.pieces.size() + 1);
    EXPECT_TRUE(std::ranges::adjacent_find(path.stations, std::greater_equal<>()) ==
                path.stations.end());
    EXPECT_EQ(path.stations.front(), 0);
    EXPECT_NEAR(path.stations.back(), 30, 1e-12);
    for (std::size_t i = 0; i + 1 < path.pieces.size(); ++i) {
      EXPECT_EQ(end_point(path.pieces[i]), start_point(path.pieces[i + 1])) << i;
    }
  }
}

// A knot in the middle of a blend that is off the middle by a rounding step cuts it once, not
// twice.
TEST(BlendedPath, IsCutOnceInTheMiddleOfABlend) {
  const double end = 0.3;
  const double middle = std::nextafter(0.5 * end, 1);
  const BsplineCurve blend(BsplineBasis::clamped(3, {0, middle, end}),
                           {{9, 0, 0}, {9.5, 0, 0}, {10, 0, 0}, {10, 0.5, 0}, {10, 1, 0}});
  const std::vector<Point3> corner = {{0, 0, 0}, {10, 0, 0}, {10, 10, 0}};
  const BlendedPath path = blended_path(
      corner, std::vector<std::optional<BsplineCurve>>{std::nullopt, blend, std::nullopt});
  EXPECT_EQ(path.pieces.size(), 4u) << "line, two halves, line";
  for (std::size_t i = 0; i + 1 < path.stations.size(); ++i) {
    EXPECT_LT(path.stations[i], path.stations[i + 1]);
  }
  EXPECT_NO_THROW((void)curve_of_pieces(path.pieces, path.stations));
}

}  // namespace
}  // namespace batten::geometry
