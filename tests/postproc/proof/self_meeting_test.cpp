// Whether a path meets itself, against a test of each two edges in whole numbers.
#include "postproc/proof/self_meeting.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <random>
#include <vector>

namespace batten::postproc {
namespace {

using geometry::Line;
using geometry::Path;
using geometry::Point3;

constexpr double kStep = 0.001;  // mm
constexpr double kTolerance = 0.01;

struct Place {
  std::int64_t x = 0;
  std::int64_t y = 0;
  std::int64_t z = 0;
};

Path path_of(const std::vector<Place>& places) {
  Path path;
  const auto point = [](const Place& p) {
    return Point3(kStep * static_cast<double>(p.x), kStep * static_cast<double>(p.y),
                  kStep * static_cast<double>(p.z));
  };
  for (std::size_t i = 0; i + 1 < places.size(); ++i) {
    path.push_back(Line{point(places[i]), point(places[i + 1])});
  }
  return path;
}

bool may_meet(const Path& path) {
  SelfMeeting meeting(kTolerance);
  meeting.add(path);
  return meeting.may_meet();
}

bool may_meet(const std::vector<Place>& places) { return may_meet(path_of(places)); }

std::int64_t side(const Place& a, const Place& b, const Place& c) {
  const std::int64_t turn = (b.x - a.x) * (c.y - a.y) - (b.y - a.y) * (c.x - a.x);
  return turn > 0 ? 1 : turn < 0 ? -1 : 0;
}

bool is_between(const Place& a, const Place& b, const Place& c) {
  return std::min(a.x, b.x) <= c.x && c.x <= std::max(a.x, b.x) && std::min(a.y, b.y) <= c.y &&
         c.y <= std::max(a.y, b.y);
}

bool on(const Place& a, const Place& b, const Place& c) {
  return side(a, b, c) == 0 && is_between(a, b, c);
}

// Of a path in the plane.
bool edges_meet(const Place& a, const Place& b, const Place& c, const Place& d) {
  if (side(a, b, c) * side(a, b, d) < 0 && side(c, d, a) * side(c, d, b) < 0) return true;
  return on(a, b, c) || on(a, b, d) || on(c, d, a) || on(c, d, b);
}

bool meets(const std::vector<Place>& p) {
  for (std::size_t i = 0; i + 1 < p.size(); ++i) {
    if (i + 2 < p.size() && (on(p[i], p[i + 1], p[i + 2]) || on(p[i + 1], p[i + 2], p[i]))) {
      return true;
    }
    for (std::size_t k = i + 2; k + 1 < p.size(); ++k) {
      if (edges_meet(p[i], p[i + 1], p[k], p[k + 1])) return true;
    }
  }
  return false;
}

// Steps of a walk that keeps going one way, more or less: some of them meet themselves.
std::vector<Place> random_walk(std::mt19937& random, std::size_t steps) {
  const auto pick = [&](int below) { return static_cast<int>(random() % unsigned(below)); };
  std::vector<Place> places = {{0, 0, 0}};
  const int drift = 10 + pick(60);
  while (places.size() <= steps) {
    Place next = places.back();
    next.x += pick(101) - 50 + drift;
    next.y += pick(201) - 100;
    if (next.x == places.back().x && next.y == places.back().y) continue;
    places.push_back(next);
  }
  return places;
}

TEST(SelfMeeting, IsWhatWholeNumbersSayPieceByPieceToo) {
  std::mt19937 random(3);
  std::array<int, 2> said = {0, 0};
  for (int i = 0; i < 2000; ++i) {
    const std::vector<Place> walk = random_walk(random, 3 + random() % 40);
    const bool expected = meets(walk);
    ASSERT_EQ(may_meet(walk), expected) << i;
    ++said[expected ? 1 : 0];
    const Path path = path_of(walk);
    SelfMeeting pieces(kTolerance);
    for (std::size_t at = 0; at < path.size();) {
      const std::size_t count = std::min<std::size_t>(1 + random() % 9, path.size() - at);
      pieces.add(std::span(path).subspan(at, count));
      at += count;
    }
    ASSERT_EQ(pieces.may_meet(), expected) << i;
  }
  EXPECT_GT(said[0], 200);
  EXPECT_GT(said[1], 200);
}

// A long edge beside short ones, and edges above each other.
TEST(SelfMeeting, LooksThroughSpace) {
  EXPECT_FALSE(may_meet({{0, 0, 0}, {9000, 0, 0}, {9000, 10, 5}, {4000, -10, 5}}));
  EXPECT_TRUE(may_meet({{0, 0, 0}, {9000, 0, 0}, {9000, 10, 0}, {4000, -10, 0}}));
  EXPECT_TRUE(may_meet({{0, 0, 0}, {9000, 0, 0}, {9000, 10, 5}, {5000, 10, 5}, {5000, -10, -5}}));
  EXPECT_TRUE(may_meet({{0, 0, 0}, {50, 0, 0}, {10, 0, 0}}));
  EXPECT_FALSE(may_meet({{0, 0, 0}, {50, 0, 0}, {10, 1, 0}}));
  EXPECT_TRUE(may_meet({{0, 0, 0}, {50, 0, 0}, {50, 50, 0}, {0, 0, 0}}));
}

TEST(SelfMeeting, OfRingsIsSeenOnTheirChords) {
  const geometry::Arc ring{Point3(5, 0, 0), Point3(-5, 0, 0), Point3(0, 0, 0),
                           geometry::Vector3(0, 0, 1), 3.141592653589793};
  EXPECT_FALSE(may_meet(Path{ring, Line{Point3(-5, 0, 0), Point3(0, 4.9, 0)}}));
  EXPECT_TRUE(may_meet(Path{ring, Line{Point3(-5, 0, 0), Point3(0, 5.1, 0)}}));
}

// More edges than are looked at at a time: a spiral, and the same with an end that crosses its last
// turn but one.
TEST(SelfMeeting, IsSeenInAnyNumberOfEdges) {
  const auto place = [](double angle, double radius) {
    return Place{std::llround(radius * std::cos(angle)), std::llround(radius * std::sin(angle)), 0};
  };
  std::vector<Place> spiral;
  for (int i = 0; i < 200000; ++i) spiral.push_back(place(0.01 * i, 1000 + 0.5 * i));
  EXPECT_FALSE(may_meet(spiral));
  const double pitch = 0.5 * 2 * 3.141592653589793 / 0.01;
  for (int i = 0; i < 6; ++i) {
    spiral.resize(200000 - 97 * static_cast<std::size_t>(i));
    const auto turns = static_cast<double>(spiral.size());
    std::vector<Place> crossing = spiral;
    crossing.push_back(place(0.01 * turns, 1000 + 0.5 * turns - 1.5 * pitch));
    EXPECT_TRUE(may_meet(crossing)) << i;
  }
}

// Half turns about two centres, and around the last of them, the upper half, a line that passes it
// by 0.0003 mm.
Path turns_with_line(int half_turns) {
  constexpr double kBetween = 0.05;  // mm, of the centres
  Path path;
  double radius = 10;
  Point3 here(radius, 0, 0);
  double center = 0;
  for (int i = 0; i < half_turns; ++i) {
    const bool upper = i % 2 == 0;
    center = upper ? 0 : kBetween;
    radius = std::abs(here.x() - center);
    const Point3 next(upper ? center - radius : center + radius, 0, 0);
    path.push_back(geometry::Arc{here, next, Point3(center, 0, 0), geometry::Vector3(0, 0, 1),
                                 3.141592653589793});
    here = next;
  }
  const double above = radius + 0.0003;
  for (const Point3& next : {Point3(here.x() - 1, 0, 0), Point3(here.x() - 1, above, 0),
                             Point3(center + radius + 1, above, 0)}) {
    path.push_back(Line{here, next});
    here = next;
  }
  return path;
}

// As a whole a path of very many chords is cut into longer ones, which may meet where these do not:
// what is so near is not certain then.
TEST(SelfMeeting, LeavesRoomForTheChordsOfVeryLongPaths) {
  EXPECT_FALSE(may_meet(turns_with_line(101)));
  Path turns = turns_with_line(1001);
  EXPECT_TRUE(may_meet(turns));
  turns.resize(1001);  // without the line
  EXPECT_FALSE(may_meet(turns));
}

// A step that is shorter than what is not certain, and goes on: on both sides of it are long edges.
TEST(SelfMeeting, IsNoneOfEdgesOnEitherSideOfAShortStep) {
  const auto with_step = [](const Point3& step, const Point3& last) {
    Path turns = turns_with_line(1001);
    turns.resize(1001);
    const Point3 from = geometry::end_point(turns.back());
    const Point3 begin = from + Point3(-1, 0, 0);
    turns.push_back(Line{from, begin});
    turns.push_back(Line{begin, begin + step});
    turns.push_back(Line{begin + step, begin + step + last});
    return turns;
  };
  EXPECT_FALSE(may_meet(with_step({-0.0002, 0, 0}, {-1, 0.2, 0})));
  EXPECT_FALSE(may_meet(with_step({-0.0001, 0.0001, 0}, {-1, 0.2, 0})));
  EXPECT_TRUE(may_meet(with_step({-0.0002, 0, 0}, {1, 0.2, 0}))) << "back";
  EXPECT_TRUE(may_meet(with_step({0, 0.0002, 0}, {-1, 0, 0}))) << "across";
  EXPECT_TRUE(may_meet(with_step({-0.0002, 0, 0}, {-0.0003, 0, 0}))) << "two short ones";
}

}  // namespace
}  // namespace batten::postproc
