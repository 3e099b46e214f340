// The points of a run follow its arcs and curves, and its pieces are these themselves.
#include "postproc/runs/run_path.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>
#include <vector>

#include "geometry/path/path.h"
#include "tests/support/kinked_arcs.h"

namespace batten::postproc {
namespace {

using geometry::Point3;
using geometry::Vector3;

// From the place where the run stands, about an axis of the coordinate system.
geometry::Arc random_arc(const Point3& start, std::mt19937& random) {
  std::uniform_real_distribution<double> unit(0, 1);
  const int normal = static_cast<int>(3 * unit(random));
  const Vector3 axis = Vector3::Unit(normal);
  const double radius = std::pow(10.0, 4 * unit(random) - 1);
  const double angle = 6.28 * unit(random);
  const double sweep = (unit(random) < 0.5 ? -1 : 1) * (0.01 + 5 * unit(random));
  const Vector3 first = Vector3::Unit((normal + 1) % 3);
  const Vector3 second = axis.cross(first);
  const auto out = [&](double a) {
    return Vector3(radius * (std::cos(a) * first + std::sin(a) * second));
  };
  const double rise = unit(random) < 0.5 ? 0 : radius * unit(random);
  const Point3 center = start - out(angle);
  return {start, center + out(angle + sweep) + rise * axis, center, axis, sweep};
}

// Control points at random steps, some of them none.
geometry::CubicBezier random_cubic(const Point3& start, std::mt19937& random) {
  std::uniform_real_distribution<double> unit(0, 1);
  const double size = std::pow(10.0, 3 * unit(random) - 1);
  geometry::CubicBezier cubic{{start, start, start, start}};
  for (int i = 1; i < 4; ++i) {
    const Vector3 step(unit(random), unit(random) - 0.5, unit(random) - 0.5);
    cubic.control[i] = cubic.control[i - 1] + (unit(random) < 0.1 ? 0 : size) * step;
  }
  return cubic;
}

// Lines, arcs and pieces of curves at random.
Run random_run(unsigned seed) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<double> unit(0, 1);
  Run run;
  run.points = {Point3(unit(random), unit(random), unit(random))};
  const int motions = 3 + static_cast<int>(10 * unit(random));
  for (int i = 0; i < motions; ++i) {
    const double kind = unit(random);
    if (kind < 0.3) {
      run.points.push_back(run.points.back() + Point3(unit(random), 1, -unit(random)));
    } else if (kind < 0.6) {
      append_bend({.piece = random_cubic(run.points.back(), random)}, 1, 4e-4, run);
    } else {
      append_bend({.piece = random_arc(run.points.back(), random)}, 1, 4e-4, run);
    }
  }
  run.feeds = {{0, 100}};
  return run;
}

constexpr unsigned kRuns = 200;

// A curve with weights is many pieces for one block, and short ones.
TEST(AppendBend, PutsAtLeastFourChordsOnABlockNotOnEachOfItsPieces) {
  std::mt19937 random(3);
  postproc::Run run;
  run.points.push_back(Point3::Zero());
  const geometry::CubicBezier cubic = random_cubic(run.points.back(), random);
  append_bend({.piece = cubic}, 1, 1e3, run);
  EXPECT_EQ(run.points.size(), 5U);
  for (const std::size_t pieces : {2, 64}) {
    run.points = {cubic.control[0]};
    run.bends.clear();
    for (std::size_t i = 0; i < pieces; ++i) {
      const auto n = static_cast<double>(pieces);
      const auto k = static_cast<double>(i);
      append_bend({.piece = geometry::sub_piece(cubic, k / n, (k + 1) / n)}, pieces, 1e3, run);
    }
    EXPECT_EQ(run.points.size(), std::max<std::size_t>(pieces, 4) + 1);
    EXPECT_EQ(run.bends.back().last, run.points.size() - 1);
  }
}

TEST(AppendBend, PutsVerticesOnTheBendSoThatChordsMissItByLittle) {
  for (unsigned seed = 0; seed < kRuns; ++seed) {
    SCOPED_TRACE(testing::Message() << "seed " << seed);
    const postproc::Run run = random_run(seed);
    EXPECT_LE(run.chord_error, 4e-4 * (1 + 1e-12));
    for (const RunBend& bend : run.bends) {
      ASSERT_GE(bend.last - bend.first, 4U);
      const auto chords = static_cast<double>(bend.last - bend.first);
      const double size = geometry::length_of(bend.piece);
      for (std::size_t i = bend.first; i < bend.last; ++i) {
        const double t = static_cast<double>(i - bend.first) / chords;
        EXPECT_LT((geometry::point_at(bend.piece, t) - run.points[i]).norm(), 1e-9 * (1 + size));
        const Point3 between = geometry::point_at(bend.piece, t + 0.5 / chords);
        const Point3 middle = 0.5 * (run.points[i] + run.points[i + 1]);
        EXPECT_LE((between - middle).norm(), run.chord_error * (1 + 1e-6));
      }
    }
  }
}

// Wherever the run is cut, the parts are as long together as the whole, and they chain.
TEST(MotionsBetween, AreTheMotionsThemselvesOrPartsOfBendsThatAreCut) {
  const auto length_of = [](const std::vector<RunMotion>& motions) {
    double length = 0;
    for (const RunMotion& motion : motions) length += geometry::length_of(motion.piece);
    return length;
  };
  for (unsigned seed = 0; seed < kRuns; ++seed) {
    SCOPED_TRACE(testing::Message() << "seed " << seed);
    const postproc::Run run = random_run(seed);
    const auto motions = motions_between(run, 0, run.points.size() - 1);
    EXPECT_EQ(motions.size(), motion_count(run));
    std::size_t bends = 0;
    for (const RunMotion& motion : motions) {
      EXPECT_EQ(geometry::start_point(motion.piece), run.points[motion.first]);
      if (const auto* arc = std::get_if<geometry::Arc>(&motion.piece)) {
        EXPECT_EQ(arc->sweep, std::get<geometry::Arc>(run.bends[bends].piece).sweep);
      }
      if (const auto* cubic = std::get_if<geometry::CubicBezier>(&motion.piece)) {
        const auto& whole = std::get<geometry::CubicBezier>(run.bends[bends].piece);
        EXPECT_EQ(cubic->control[1], whole.control[1]);
      }
      if (std::holds_alternative<geometry::Line>(motion.piece)) continue;
      EXPECT_EQ(motion.first, run.bends[bends].first);
      ++bends;
    }
    EXPECT_EQ(bends, run.bends.size());
    EXPECT_EQ(geometry::end_point(motions.back().piece), run.points.back());
    const std::size_t end = run.points.size() - 1;
    std::mt19937 random(seed);
    const std::size_t place = 1 + random() % (end - 1);
    const auto before = motions_between(run, 0, place);
    const auto after = motions_between(run, place, end);
    const double whole = length_of(motions);
    EXPECT_NEAR(length_of(before) + length_of(after), whole, 1e-9 * whole);
    EXPECT_LT((geometry::end_point(before.back().piece) - run.points[place]).norm(), 1e-6);
    EXPECT_LT((geometry::start_point(after.front().piece) - run.points[place]).norm(), 1e-6);
    EXPECT_EQ(after.front().first, place);
  }
}

TEST(ArcScatter, IsNoneOfARunOfLines) {
  postproc::Run run;
  for (int i = 0; i < 9; ++i) run.points.emplace_back(i, i % 2, 0);
  EXPECT_EQ(arc_scatter(run), 0);
}

// A stretch of a clothoid, curvature k' s, by arcs of even length through ends and middles: each is
// off by k' l^3 / 174 rms, which the steps of curvature from arc to arc tell.
TEST(ArcScatter, IsHowFarArcsAreFromAClothoid) {
  constexpr double kChange = 2e-3;  // 1/mm per mm
  constexpr double kLength = 4;     // of an arc
  constexpr int kArcs = 8;
  std::vector<geometry::Vector2> places = {geometry::Vector2::Zero()};  // every 0.01 mm
  constexpr double kStep = 0.01;
  for (int i = 0; i < static_cast<int>(kArcs * kLength / kStep); ++i) {
    const double s = (i + 0.5) * kStep;
    const double heading = 0.5 * kChange * s * s;
    places.emplace_back(places.back() +
                        kStep * geometry::Vector2(std::cos(heading), std::sin(heading)));
  }
  postproc::Run run;
  run.points = {Point3::Zero()};
  double squares = 0;
  constexpr std::size_t kEach = 400;
  for (std::size_t i = 0; i < kArcs; ++i) {
    const std::size_t first = i * kEach;
    const auto arc =
        tests::arc_through(places[first], places[first + kEach / 2], places[first + kEach]);
    const double radius = (arc.start - arc.center).norm();
    for (std::size_t k = 0; k < kEach; ++k) {
      const double off = (places[first + k] - arc.center).norm() - radius;
      squares += off * off;
    }
    const Point3 end(arc.end.x(), arc.end.y(), 0);
    const double sweep = 2 * std::asin(0.5 * (arc.end - arc.start).norm() / radius);
    const geometry::Arc piece{run.points.back(), end, Point3(arc.center.x(), arc.center.y(), 0),
                              Vector3::UnitZ(), arc.clockwise ? -sweep : sweep};
    append_bend({.piece = piece}, 1, 1e-4, run);
  }
  const double truth = std::sqrt(squares / (kArcs * kEach));
  EXPECT_NEAR(arc_scatter(run), truth, 0.1 * truth);
}

}  // namespace
}  // namespace batten::postproc
