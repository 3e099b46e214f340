#include "postproc/smooth/forms/slow_parts.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numeric>
#include <random>
#include <string>
#include <variant>
#include <vector>

#include "gcode/controls/built_in.h"
#include "geometry/basic/point.h"
#include "tests/support/curve_of.h"
#include "tests/support/one_run.h"

namespace batten::postproc {
namespace {

using geometry::Arc;
using geometry::Line;
using geometry::Point3;

constexpr double kFeed = 3000;
constexpr double kLeg = 20;  // mm

// Straight ways of 20 mm with bends to the left and to the right between them, as lines and arcs,
// and a run of chords of 0.7 mm whose vertices are on them; or the bends alone.
struct BentPath {
  Run run;
  geometry::SmoothCurve fair{geometry::curve_of([](double u) { return Point3(u, 0, 0); }, 0, 1, 10),
                             {}};
  OutputPlan plan;

  explicit BentPath(const std::vector<double>& radii, bool has_ways = true) {
    plan.form = Form::kArcs;
    Point3 place(0, 0, 0);
    Point3 along(1, 0, 0);
    const auto add_way = [&] {
      if (!has_ways) return;
      add(Line{place, place + kLeg * along});
      place += kLeg * along;
    };
    add_way();
    for (std::size_t i = 0; i < radii.size(); ++i) {
      const double side = i % 2 == 0 ? 1 : -1;
      const Point3 left = side * Point3::UnitZ().cross(along);
      const Point3 end = place + radii[i] * (along + left);
      add(Arc{place, end, place + radii[i] * left, Point3::UnitZ(), side * geometry::kPi / 2});
      place = end;
      along = left;
      add_way();
    }
    constexpr double kChord = 0.7;
    const auto count = static_cast<int>(std::ceil(way_ / kChord));
    for (int i = 0; i <= count; ++i) {
      fair.vertex_parameters.push_back(way_ * i / count);
      run.points.push_back(at_way(fair.vertex_parameters.back()));
    }
    run.points.back() = place;
    run.feeds = {{0, kFeed}};
    fair.curve = geometry::curve_of([&](double u) { return at_way(u); }, 0, way_, 400);
    fair.vertex_parameters.back() = fair.curve.last();
  }

  [[nodiscard]] SlowParts parts(const Machine& machine) const {
    return {run, fair, machine, gcode::PathControl{}};
  }

 private:
  void add(const geometry::PathPiece& piece) {
    plan.moves.push_back({piece, kFeed, {}, way_});
    way_ += geometry::length_of(piece);
  }

  [[nodiscard]] Point3 at_way(double way) const {
    const auto after = std::ranges::upper_bound(plan.moves, way, {}, &PlannedMove::start);
    const PlannedMove& move = after == plan.moves.begin() ? plan.moves.front() : *(after - 1);
    return geometry::point_at(move.piece, (way - move.start) / geometry::length_of(move.piece));
  }

  double way_ = 0;
};

double time_of(const OutputPlan& plan, const Machine& machine) {
  std::vector<TimedPiece> pieces;
  for (const PlannedMove& move : plan.moves) pieces.push_back({move.piece, move.feed});
  return cutting_time(pieces, machine, gcode::PathControl{});
}

void expect_path_of(const OutputPlan& plan, const Run& run) {
  ASSERT_FALSE(plan.moves.empty());
  EXPECT_EQ(geometry::start_point(plan.moves.front().piece), run.points.front());
  EXPECT_EQ(geometry::end_point(plan.moves.back().piece), run.points.back());
  for (std::size_t i = 1; i < plan.moves.size(); ++i) {
    EXPECT_EQ(geometry::start_point(plan.moves[i].piece),
              geometry::end_point(plan.moves[i - 1].piece));
    EXPECT_GE(plan.moves[i].start, plan.moves[i - 1].start);
  }
}

std::size_t count_of_arcs(const OutputPlan& plan) {
  return static_cast<std::size_t>(std::ranges::count_if(
      plan.moves, [](const PlannedMove& move) { return std::holds_alternative<Arc>(move.piece); }));
}

// The way between two bends as an arc of 1 m: it meets them at 0.02 rad, which LinuxCNC nearly
// stops for.
BentPath with_kinks(const std::vector<double>& radii, std::size_t move) {
  BentPath path(radii);
  PlannedMove& bad = path.plan.moves[move];
  if (const auto* arc = std::get_if<Arc>(&bad.piece)) {
    const double radius = 1.05 * geometry::radius_of(*arc);
    const Point3 chord = arc->end - arc->start;
    const double side = arc->sweep > 0 ? 1 : -1;
    const Point3 across = side * Point3::UnitZ().cross(chord).normalized();
    const double half = chord.norm() / 2;
    bad.piece = Arc{arc->start, arc->end,
                    arc->start + chord / 2 + std::sqrt(radius * radius - half * half) * across,
                    arc->axis, side * 2 * std::asin(half / radius)};
    return path;
  }
  const Line way = std::get<Line>(bad.piece);
  const Point3 along = (way.end - way.start).normalized();
  const double half = kLeg / 2;
  const double to_center = std::sqrt(1000.0 * 1000.0 - half * half);
  const Point3 left = Point3::UnitZ().cross(along);
  bad.piece = Arc{way.start, way.end, way.start + half * along + to_center * left, Point3::UnitZ(),
                  2 * std::asin(half / 1000)};
  return path;
}

TEST(SlowParts, AreWhereMovesMeetNotQuiteTangent) {
  const Machine& machine = *find_machine("linuxcnc");
  constexpr std::size_t kBad = 6;
  const BentPath path = with_kinks({15, 12, 12, 12, 12, 15}, kBad);
  const SlowParts slow = path.parts(machine);
  const std::vector<SlowPart> found = slow.find(path.plan, slow.lost(path.plan));
  ASSERT_EQ(found.size(), 1U);
  EXPECT_GE(found[0].first, kBad - 1 - kSlowParts.wider_by);
  EXPECT_LE(found[0].first, kBad);
  EXPECT_GE(found[0].last, kBad);
  EXPECT_LE(found[0].last, kBad + 1 + kSlowParts.wider_by);
  EXPECT_GT(found[0].won, 0.01);

  const auto mixed = slow.with_run(path.plan, found);
  ASSERT_TRUE(mixed);
  expect_path_of(*mixed, path.run);
  EXPECT_LT(count_of_arcs(*mixed), count_of_arcs(path.plan));
  EXPECT_NEAR(time_of(path.plan, machine) - time_of(*mixed, machine), found[0].won, 0.002);
}

// 50 mm/s at 500 mm/s^2 take 2.5 mm: three chords of 0.7 mm, and a part of the next.
TEST(SlowParts, GiveTheEndsOfArcsToTheRun) {
  const Machine& machine = *find_machine("linuxcnc");
  const BentPath path({40}, false);
  const auto mixed = path.parts(machine).with_run_at_ends(path.plan);
  ASSERT_TRUE(mixed);
  expect_path_of(*mixed, path.run);
  std::string forms;
  for (const PlannedMove& move : mixed->moves) {
    forms += std::holds_alternative<Arc>(move.piece) ? 'a' : 'l';
  }
  EXPECT_EQ(forms, "llllaaallll");
  for (std::size_t i = 1; i < 4; ++i) {
    EXPECT_EQ(geometry::start_point(mixed->moves[i].piece), path.run.points[i]);
  }
  const auto length = [&](std::size_t i) { return geometry::length_of(mixed->moves[i].piece); };
  EXPECT_NEAR(length(4), 4 * 2.5, 0.01);
  EXPECT_NEAR(length(6), length(4), 0.01);
  EXPECT_GT(length(5), 20);

  // Of a short arc there is less.
  const BentPath small({6}, false);
  const auto less = small.parts(machine).with_run_at_ends(small.plan);
  ASSERT_TRUE(less);
  expect_path_of(*less, small.run);
  const BentPath tiny({3}, false);
  EXPECT_FALSE(tiny.parts(machine).with_run_at_ends(tiny.plan));
  const BentPath straight({15, 12});
  EXPECT_FALSE(straight.parts(machine).with_run_at_ends(straight.plan));
}

// 5 mm/s take 0.025 mm; one chord of 0.6 mm is all of the arc.
TEST(SlowParts, GiveAPartOfALongChordToTheEndsOfArcs) {
  BentPath path({0.4}, false);
  for (PlannedMove& move : path.plan.moves) move.feed = 300;
  const auto mixed = path.parts(*find_machine("linuxcnc")).with_run_at_ends(path.plan);
  ASSERT_TRUE(mixed);
  expect_path_of(*mixed, path.run);
  ASSERT_EQ(mixed->moves.size(), 5U);
  for (const std::size_t i : {0, 4}) {
    ASSERT_TRUE(std::holds_alternative<Line>(mixed->moves[i].piece));
    EXPECT_NEAR(geometry::length_of(mixed->moves[i].piece), 0.025, 0.001);
  }
  EXPECT_EQ(count_of_arcs(*mixed), 3U);
}

TEST(SlowParts, HaveTheFeedsOfThePlan) {
  BentPath path({15, 12});
  auto& moves = path.plan.moves;
  ASSERT_EQ(moves.size(), 5U);
  for (std::size_t i = 2; i < moves.size(); ++i) moves[i].feed = kFeed / 2;
  const std::vector<SlowPart> part = {{1, 2, 1.0}};
  const auto mixed = path.parts(*find_machine("linuxcnc")).with_run(path.plan, part);
  ASSERT_TRUE(mixed);
  expect_path_of(*mixed, path.run);
  for (const PlannedMove& move : mixed->moves) {
    // The edge of the run across the change has the feed on the most of it.
    const double away = move.start - moves[2].start;
    if (std::abs(away) > 0.7) {
      EXPECT_EQ(move.feed, away < 0 ? kFeed : kFeed / 2) << away;
    }
  }
}

TEST(SlowParts, OfTheRunItselfAreNone) {
  const BentPath path({15, 0.5, 12});
  OutputPlan same;
  for (std::size_t i = 1; i < path.run.points.size(); ++i) {
    same.moves.push_back({Line{path.run.points[i - 1], path.run.points[i]},
                          kFeed,
                          {},
                          path.fair.vertex_parameters[i - 1]});
  }
  for (const char* name : {"linuxcnc", "router", "mill", "high-speed"}) {
    SCOPED_TRACE(name);
    const SlowParts slow = path.parts(*find_machine(name));
    const std::vector<double> lost = slow.lost(same);
    for (const double each : lost) EXPECT_NEAR(each, 0, 1e-9);
    EXPECT_TRUE(slow.find(same, lost).empty());
    EXPECT_FALSE(slow.with_run(same, {}));
  }
}

// Whatever the bends: in order, apart from each other, and the faster by them. Two that are near
// to each other may win less together than each of them alone.
TEST(SlowParts, WithTheRunAreFaster) {
  std::mt19937 chance(7);
  std::uniform_real_distribution<double> logarithm(std::log(0.2), std::log(20.0));
  double before = 0;
  double after = 0;
  for (int round = 0; round < 40; ++round) {
    SCOPED_TRACE(round);
    std::vector<double> radii(12);
    for (double& radius : radii) radius = std::exp(logarithm(chance));
    const BentPath path = with_kinks(radii, 2 * (round % 12) + round / 12 % 2);
    for (const char* name : {"linuxcnc", "router", "mill", "high-speed"}) {
      SCOPED_TRACE(name);
      const Machine& machine = *find_machine(name);
      const SlowParts slow = path.parts(machine);
      const std::vector<SlowPart> found = slow.find(path.plan, slow.lost(path.plan));
      for (std::size_t i = 1; i < found.size(); ++i) {
        EXPECT_GT(found[i].first, found[i - 1].last);
      }
      const auto mixed = slow.with_run(path.plan, found);
      if (!mixed) continue;
      expect_path_of(*mixed, path.run);
      const double time = time_of(*mixed, machine);
      EXPECT_LT(time, 1.002 * time_of(path.plan, machine));
      before += time_of(path.plan, machine);
      after += time;
    }
  }
  EXPECT_GT(before - after, 2.25);  // s: less without neighbours that may go with them
}

TEST(SlowParts, KeepCommentsAndFeeds) {
  const Machine& machine = *find_machine("linuxcnc");
  BentPath path = with_kinks({15, 12, 12}, 4);
  for (std::size_t vertex = 1; vertex < path.run.points.size(); ++vertex) {
    CommentAt comment;
    comment.vertex = vertex;
    path.run.comments.push_back(comment);
  }
  path.plan.moves[5].feed = path.plan.moves[6].feed = 2000;  // no part goes across a change of it
  const SlowParts slow = path.parts(machine);
  const std::vector<SlowPart> found = slow.find(path.plan, slow.lost(path.plan));
  ASSERT_FALSE(found.empty());
  for (const SlowPart& part : found) {
    for (std::size_t i = part.first; i <= part.last; ++i) {
      EXPECT_EQ(path.plan.moves[i].feed, path.plan.moves[part.first].feed);
    }
  }
  const auto mixed = slow.with_run(path.plan, found);
  ASSERT_TRUE(mixed);
  std::vector<std::size_t> comments = mixed->comments_after;
  for (const PlannedMove& move : mixed->moves) {
    comments.insert(comments.end(), move.comments_before.begin(), move.comments_before.end());
  }
  std::ranges::sort(comments);
  std::vector<std::size_t> each(path.run.comments.size());
  std::iota(each.begin(), each.end(), std::size_t{0});
  EXPECT_EQ(comments, each);
}

TEST(SlowParts, EnoughAreThoseThatWinTheMost) {
  const std::vector<SlowPart> all = {{0, 0, 0.1}, {2, 2, 0.5}, {4, 4, 0.2}, {6, 6, 0.4}};
  const std::vector<SlowPart> some = enough_of(all, 0.8);
  ASSERT_EQ(some.size(), 2U);
  EXPECT_EQ(some[0].first, 2U);
  EXPECT_EQ(some[1].first, 6U);
  EXPECT_EQ(enough_of(all, 10).size(), all.size());
  EXPECT_TRUE(enough_of(all, 0).empty());
}

}  // namespace
}  // namespace batten::postproc
