#include "geometry/arcs/arc_spline.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <iostream>
#include <numbers>
#include <random>
#include <stdexcept>
#include <vector>

#include "geometry/distance/path_distance.h"
#include "tests/support/paths.h"

namespace batten::geometry {
namespace {

using std::numbers::pi;
constexpr double kFineGrid = 1e-5;

using Shape = std::function<Point2(double)>;

std::vector<Point2> along(const Shape& shape, double from, double to, int count) {
  std::vector<Point2> points;
  for (int i = 0; i <= count; ++i) points.push_back(shape(from + (to - from) * i / count));
  return points;
}

ArcSplineOptions options_for(const std::vector<Point2>& points) {
  ArcSplineOptions options;
  options.min_radius = 0.05;
  options.grid = kFineGrid;
  const Vector2 first = points[1] - points[0];
  options.direction = std::atan2(first.y(), first.x());
  return options;
}

Path path_of(const std::vector<Point2>& points) {
  std::vector<Point3> places;
  for (const Point2& p : points) places.emplace_back(p.x(), p.y(), 0);
  return path_through(places);
}

Path path_of(const ArcSpline& spline) {
  Path path;
  for (const ArcSplinePiece& piece : spline.pieces) {
    const PlaneArc& a = piece.arc;
    const Point3 start(a.start.x(), a.start.y(), 0);
    const Point3 end(a.end.x(), a.end.y(), 0);
    if (a.is_line()) {
      path.push_back(Line{start, end});
    } else {
      path.push_back(Arc{start, end, {a.center.x(), a.center.y(), 0}, Vector3::UnitZ(), a.sweep});
    }
  }
  return path;
}

double kink_between(const PlaneArc& a, const PlaneArc& b) {
  return std::abs(std::remainder(b.start_angle() - a.start_angle() - a.sweep, 2 * pi));
}

// Joints that turn more than rounding to the grid forces.
int kinks_in(const ArcSpline& spline) {
  int kinks = 0;
  for (std::size_t i = 1; i < spline.pieces.size(); ++i) {
    const PlaneArc& a = spline.pieces[i - 1].arc;
    const PlaneArc& b = spline.pieces[i].arc;
    const double forced = 2 * std::numbers::sqrt2 * kFineGrid / std::min(a.length(), b.length());
    if (kink_between(a, b) > forced + 1e-6) ++kinks;
  }
  return kinks;
}

// What is promised of every spline.
void expect_sound(const ArcSpline& spline, const std::vector<Point2>& points,
                  const ArcSplineOptions& options) {
  ASSERT_FALSE(spline.pieces.empty());
  EXPECT_EQ(spline.pieces.front().arc.start, points.front());
  EXPECT_EQ(spline.pieces.back().arc.end, points.back());
  double station = 0;
  for (std::size_t i = 0; i < spline.pieces.size(); ++i) {
    const PlaneArc& arc = spline.pieces[i].arc;
    if (i > 0) {
      EXPECT_EQ(arc.start, spline.pieces[i - 1].arc.end);
    }
    EXPECT_LE(std::abs(arc.sweep), options.max_sweep + 1e-9);
    if (!arc.is_line()) {
      EXPECT_GE(arc.radius, 0.999 * options.min_radius);
      EXPECT_LE(arc.radius, 1.001 * options.max_radius);
    }
    EXPECT_GE(spline.pieces[i].station, station);
    station = spline.pieces[i].station;
    if (i + 1 < spline.pieces.size()) {
      for (const double c : {arc.end.x(), arc.end.y()}) {
        EXPECT_NEAR(c, std::round(c / kFineGrid) * kFineGrid, 1e-12);
      }
    }
  }
  EXPECT_LE(kinks_in(spline), spline.kinks);
  const Path old_path = path_of(points);
  const Path new_path = path_of(spline);
  EXPECT_EQ(compare_paths(old_path, new_path, options.tolerance).verdict, Verdict::kProved);
}

TEST(ArcSpline, ACircleIsThreeArcsOfItsRadius) {
  for (const int count : {200, 400, 5000}) {
    const auto points =
        along([](double u) { return Point2(20 * unit_vector(u)); }, 0, 2 * pi, count);
    ArcSplineOptions options = options_for(points);
    options.start_angle = pi / 2;
    options.end_angle = pi / 2;
    const auto spline = fit_arc_spline(points, options);
    ASSERT_TRUE(spline);
    expect_sound(*spline, points, options);
    EXPECT_LE(spline->pieces.size(), 4U) << count;
    for (const ArcSplinePiece& piece : spline->pieces) {
      EXPECT_NEAR(piece.arc.radius, 20, options.tolerance) << count;
    }
  }
}

TEST(ArcSpline, MeetsItsEndsAtTheGivenTangents) {
  const auto points = along([](double u) { return Point2(u, 5 * std::sin(u / 10)); }, 0, 60, 300);
  ArcSplineOptions options = options_for(points);
  options.start_angle = std::atan2(0.5, 1);
  options.end_angle = std::atan2(0.5 * std::cos(6), 1);
  const auto spline = fit_arc_spline(points, options);
  ASSERT_TRUE(spline);
  expect_sound(*spline, points, options);
  EXPECT_EQ(spline->kinks, 0);
  const PlaneArc& last = spline->pieces.back().arc;
  EXPECT_NEAR(spline->pieces.front().arc.start_angle(), *options.start_angle, 1e-9);
  const double forced = 3 * kFineGrid / last.length() + 1e-6;
  EXPECT_NEAR(last.start_angle() + last.sweep, *options.end_angle, forced);
}

TEST(ArcSpline, LinesStayLinesAndTheirCornerAKink) {
  const std::vector<Point2> points = {{0, 0}, {50, 0}, {50, 40}};
  const ArcSplineOptions options = options_for(points);
  const auto spline = fit_arc_spline(points, options);
  ASSERT_TRUE(spline);
  expect_sound(*spline, points, options);
  EXPECT_EQ(spline->kinks, 1);
  ASSERT_EQ(spline->pieces.size(), 2U);
  for (const ArcSplinePiece& piece : spline->pieces) EXPECT_TRUE(piece.arc.is_line());
}

// A turn of 20 degrees is rounded by an arc of radius r within r (1 / cos 10 - 1) = 0.0154 r.
TEST(ArcSpline, ABluntCornerIsRoundedInTheBand) {
  const double turn = 20 * pi / 180;
  const std::vector<Point2> points = {{0, 0}, {10, 0}, Point2(10, 0) + 10 * unit_vector(turn)};
  ArcSplineOptions options = options_for(points);
  options.effort = ArcEffort::kThorough;
  const auto spline = fit_arc_spline(points, options);
  ASSERT_TRUE(spline);
  expect_sound(*spline, points, options);
  EXPECT_EQ(spline->kinks, 0);
  EXPECT_LE(spline->pieces.size(), 4U);
}

TEST(ArcSpline, OfMoreArcsThanThereMayBeIsNotLookedFor) {
  const std::vector<Point2> points =
      along([](double u) { return Point2(u, 5 * std::sin(u / 10)); }, 0, 100, 300);
  ArcSplineOptions options = options_for(points);
  const auto any = fit_arc_spline(points, options);
  ASSERT_TRUE(any);
  options.at_most = any->pieces.size();
  const auto enough = fit_arc_spline(points, options);
  ASSERT_TRUE(enough);
  EXPECT_EQ(enough->pieces.size(), any->pieces.size());
  options.at_most = any->pieces.size() / 2;
  EXPECT_FALSE(fit_arc_spline(points, options));
}

// The integral of (|k'| / 124.7 e)^(1/3) over the length: docs/algorithms/arc_fit.md, step 5.
double least_arcs(const Shape& shape, double from, double to, double tolerance) {
  constexpr int kSteps = 20000;
  const double h = (to - from) / kSteps;
  const auto curvature = [&](double u) {
    const double d = 1e-3;
    const Vector2 first = (shape(u + d) - shape(u - d)) / (2 * d);
    const Vector2 second = (shape(u + d) - 2 * shape(u) + shape(u - d)) / (d * d);
    return cross(first, second) / std::pow(first.norm(), 3);
  };
  double sum = 0;
  for (int i = 0; i < kSteps; ++i) {
    const double u = from + (i + 0.5) * h;
    const double length = (shape(u + h / 2) - shape(u - h / 2)).norm();
    const double change = std::abs(curvature(u + h / 2) - curvature(u - h / 2)) / length;
    sum += std::cbrt(change / (124.7 * tolerance)) * length;
  }
  return sum;
}

TEST(ArcSpline, OfAButterflyInBriefTakesFewArcsAndOneKink) {
  std::vector<Point2> points;
  for (const Point3& p : butterfly_path(4, 0.005, 3)) points.emplace_back(p.head<2>());
  ArcSplineOptions options = options_for(points);
  options.min_radius = 0.1;
  options.grid = 0.001;
  options.effort = ArcEffort::kBrief;
  const auto spline = fit_arc_spline(points, options);
  ASSERT_TRUE(spline);
  EXPECT_EQ(spline->kinks, 1);
  EXPECT_LE(spline->pieces.size(), 62U);
}

TEST(ArcSpline, NeedsFewMoreArcsThanTheLeast) {
  struct Row {
    const char* name;
    Shape shape;
    double from;
    double to;
  };
  const Row rows[] = {
      {"spiral, radius 5 to 25, three turns",
       [](double u) { return Point2((5 + 20 * u / (6 * pi)) * unit_vector(u)); }, 0, 6 * pi},
      {"sine 5 sin(x/10), 200 mm", [](double u) { return Point2(u, 5 * std::sin(u / 10)); }, 0,
       200},
      {"ellipse 30 by 5", [](double u) { return Point2(30 * std::cos(u), 5 * std::sin(u)); }, 0.3,
       0.3 + 2 * pi},
  };
  struct Looks {
    ArcEffort effort;
    const char* name;
    double more;
  };
  const Looks efforts[] = {{ArcEffort::kBrief, "brief", 1.35},
                           {ArcEffort::kQuick, "quick", 1.25},
                           {ArcEffort::kThorough, "thorough", 1.15}};
  for (const Row& row : rows) {
    const auto points = along(row.shape, row.from, row.to, 20000);
    ArcSplineOptions options = options_for(points);
    options.tolerance = 0.005;
    const double least = least_arcs(row.shape, row.from, row.to, options.tolerance);
    std::cout << row.name << ": least " << least;
    for (const auto& [effort, name, more] : efforts) {
      options.effort = effort;
      const auto spline = fit_arc_spline(points, options);
      ASSERT_TRUE(spline) << row.name;
      expect_sound(*spline, points, options);
      std::cout << ", " << name << " " << spline->pieces.size();
      EXPECT_EQ(spline->kinks, 0) << row.name;
      const double most = more * least + 2;
      EXPECT_LE(static_cast<double>(spline->pieces.size()), most) << row.name;
    }
    std::cout << "\n";
  }
}

TEST(ArcSpline, HoldsTheBandOfNoisyRandomPaths) {
  std::mt19937 random(20260101);
  std::uniform_real_distribution<double> any(-1, 1);
  for (int round = 0; round < 30; ++round) {
    const double a = 3 * any(random);
    const double b = 2 * any(random);
    const double noise = round % 3 == 0 ? 0 : 0.004;
    const int count = 60 + 40 * (round % 7);
    std::vector<Point2> points;
    for (int i = 0; i <= count; ++i) {
      const double u = 40.0 * i / count;
      points.emplace_back(u + noise * any(random),
                          a * std::sin(u / 4) + b * std::cos(u / 7) + noise * any(random));
    }
    ArcSplineOptions options = options_for(points);
    options.effort = round % 2 == 0 ? ArcEffort::kThorough : ArcEffort::kBrief;
    const auto spline = fit_arc_spline(points, options);
    ASSERT_TRUE(spline) << round;
    expect_sound(*spline, points, options);
    EXPECT_LT(spline->pieces.size(), points.size()) << round;
  }
}

// As grbl runs an arc: in equal chords, as many as fit where each is off by so much.
constexpr double kAimedAt = 0.002;

double chord_count(double radius, double sweep) {
  const double half = std::sqrt(kAimedAt * (2 * radius - kAimedAt));
  return std::max(1.0, std::floor(sweep * radius / 2 / half));
}

double run_off(double radius, double sweep, double /*length*/) {
  return radius * (1 - std::cos(sweep / chord_count(radius, sweep) / 2));
}

Path run_path(const ArcSpline& spline) {
  Path run;
  for (const PathPiece& piece : path_of(spline)) {
    const auto* arc = std::get_if<Arc>(&piece);
    const double chords = arc == nullptr ? 1 : chord_count(radius_of(*arc), std::abs(arc->sweep));
    for (int k = 0; k < static_cast<int>(chords); ++k) {
      run.push_back(Line{point_at(piece, k / chords), point_at(piece, (k + 1) / chords)});
    }
  }
  return run;
}

std::vector<double> run_off(const ArcSpline& spline) {
  std::vector<double> off;
  for (const ArcSplinePiece& piece : spline.pieces) {
    const PlaneArc& arc = piece.arc;
    off.push_back(arc.is_line() ? 0 : run_off(arc.radius, std::abs(arc.sweep), arc.length()));
  }
  return off;
}

class RunArcs : public testing::Test {
 protected:
  static constexpr double kWhole = 0.01;
  const std::vector<Point2> points_ =
      along([](double u) { return Point2(u, 3 * std::sin(u / 4)); }, 0, 40, 160);

  // Nothing is said of how they are run where `error` is 0.
  [[nodiscard]] ArcSpline spline(double error) const {
    ArcSplineOptions options = options_for(points_);
    options.tolerance = kWhole - 1.25 * kAimedAt;
    if (error > 0) {
      options.running.error = [](double r, double sweep, double length) {
        return ArcRunning::Error{run_off(r, sweep, length)};
      };
      options.running.room = [error](double, double) {
        return ArcRunning::Room{kWhole, kWhole, error};
      };
    }
    auto found = fit_arc_spline(points_, options);
    EXPECT_TRUE(found);
    expect_sound(*found, points_, options);
    return *found;
  }

  [[nodiscard]] Verdict verdict_on(const ArcSpline& spline) const {
    return compare_paths(path_of(points_), run_path(spline), kWhole).verdict;
  }
};

TEST_F(RunArcs, StayInTheBandWithWhatRunsThem) {
  const ArcSpline without = spline(0);
  const ArcSpline with = spline(1);
  EXPECT_NE(verdict_on(without), Verdict::kProved);
  EXPECT_EQ(verdict_on(with), Verdict::kProved);
  EXPECT_LE(with.pieces.size(), 1.3 * static_cast<double>(without.pieces.size()));
}

TEST_F(RunArcs, AreRunNoWorseThanTheyMayBe) {
  constexpr double kMost = 1.2 * kAimedAt;
  EXPECT_GT(std::ranges::max(run_off(spline(1))), kMost);
  const ArcSpline found = spline(kMost);
  EXPECT_LE(std::ranges::max(run_off(found)), kMost);
  EXPECT_LE(found.pieces.size(), 1.6 * static_cast<double>(spline(0).pieces.size()));
}

TEST(ArcSpline, TurnedByARightAngleItIsTheSameSpline) {
  const auto points = along([](double u) { return Point2(u, 4 * std::sin(u / 5)); }, 0, 40, 200);
  std::vector<Point2> turned;
  for (const Point2& p : points) turned.emplace_back(-p.y(), p.x());
  const auto spline = fit_arc_spline(points, options_for(points));
  const auto other = fit_arc_spline(turned, options_for(turned));
  ASSERT_TRUE(spline && other);
  EXPECT_NEAR(static_cast<double>(spline->pieces.size()), static_cast<double>(other->pieces.size()),
              1);
}

TEST(ArcSpline, RefusesOptionsOutOfRange) {
  const std::vector<Point2> points = {{0, 0}, {1, 0}};
  for (const int wrong : {0, 1, 2}) {
    ArcSplineOptions options = options_for(points);
    if (wrong == 0) options.tolerance = 0;
    if (wrong == 1) options.max_sweep = 3.2;
    if (wrong == 2) options.max_radius = 0.01;
    EXPECT_THROW((void)fit_arc_spline(points, options), std::invalid_argument) << wrong;
  }
}

}  // namespace
}  // namespace batten::geometry
