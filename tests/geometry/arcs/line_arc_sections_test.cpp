#include "geometry/arcs/line_arc_sections.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>
#include <vector>

#include "geometry/basic/operations.h"

namespace batten::geometry {
namespace {

constexpr double kChord = 0.009;  // mm, allowed

// Lines and arcs that meet tangentially, cut into chords, with rounded vertices.
struct Cut {
  double rounding = 0.0005;  // mm
  std::vector<Point2> points = {Point2(3, -4)};
  std::vector<std::size_t> joints = {0};
  Point2 place = Point2(3, -4);
  double angle = 0.4;

  void add_line(double length, int edges = 1) {
    for (int i = 1; i <= edges; ++i) add(place + length * i / edges * direction());
    place += length * direction();
    joints.push_back(points.size() - 1);
  }

  void add_arc(double radius, double sweep, int edges) {
    const double side = sweep > 0 ? 1 : -1;
    const Point2 center = place + side * radius * Point2(-direction().y(), direction().x());
    const Point2 out = place - center;
    for (int i = 1; i <= edges; ++i) add(center + Eigen::Rotation2Dd(sweep * i / edges) * out);
    place = center + Eigen::Rotation2Dd(sweep) * out;
    angle += sweep;
    joints.push_back(points.size() - 1);
  }

  [[nodiscard]] auto sections(std::size_t most = 1000,
                              const std::vector<std::size_t>& breaks = {}) const {
    return line_arc_sections(points, {3 * rounding, kChord, most}, breaks);
  }

 private:
  [[nodiscard]] Point2 direction() const { return {std::cos(angle), std::sin(angle)}; }

  void add(const Point2& p) {
    points.push_back((p / (2 * rounding)).array().round() * (2 * rounding));
  }
};

Cut slot() {
  Cut cut;
  for (int half = 0; half < 2; ++half) {
    cut.add_line(30, 6);
    cut.add_arc(5, kPi, 30);
  }
  return cut;
}

TEST(LineArcSections, AreThoseThatTheVerticesWereTakenFrom) {
  const Cut cut = slot();
  const auto sections = cut.sections();
  ASSERT_TRUE(sections);
  ASSERT_EQ(sections->size(), 4U);
  for (std::size_t i = 0; i < 4; ++i) {
    EXPECT_EQ((*sections)[i].first, cut.joints[i]);
    EXPECT_EQ((*sections)[i].last, cut.joints[i + 1]);
    ASSERT_EQ((*sections)[i].circle.has_value(), i % 2 == 1);
    if (i % 2 == 1) {
      EXPECT_NEAR((*sections)[i].circle->radius, 5, 0.001);
    }
  }
}

// Whatever their sizes. Where a chord leaves its arc by less than the limit a section may begin a
// vertex early or late.
TEST(LineArcSections, AreAsManyAsWereCut) {
  std::mt19937 chance(11);
  std::uniform_real_distribution<double> part(0, 1);
  for (int round = 0; round < 200; ++round) {
    SCOPED_TRACE(round);
    Cut cut;
    std::vector<bool> is_arc;
    for (int i = 0; i < 6; ++i) {
      cut.add_line(2 + 20 * part(chance));
      const double radius = std::exp(std::log(1.0) + std::log(60.0) * part(chance));
      const double sweep = (part(chance) < 0.5 ? 1 : -1) * (0.5 + 2.5 * part(chance));
      const double height = 0.003 + 0.005 * part(chance);
      const double step = 2 * std::acos(1 - height / radius);
      cut.add_arc(radius, sweep, std::max(6, static_cast<int>(std::ceil(std::abs(sweep) / step))));
      is_arc.insert(is_arc.end(), {false, true});
    }
    const auto sections = cut.sections();
    ASSERT_TRUE(sections);
    ASSERT_EQ(sections->size(), is_arc.size());
    for (std::size_t i = 0; i < is_arc.size(); ++i) {
      EXPECT_EQ((*sections)[i].circle.has_value(), is_arc[i]) << i;
      EXPECT_LE(std::abs(static_cast<double>((*sections)[i].last) -
                         static_cast<double>(cut.joints[i + 1])),
                1)
          << i;
    }
  }
}

// The first vertices of an arc in short chords are on one line, rounded to the same number.
TEST(LineArcSections, OfShortChordsAreAsFew) {
  Cut cut;
  cut.angle = -kPi / 2;
  cut.add_line(20);
  cut.angle += kPi / 2;
  cut.add_arc(25, 3, 4500);
  const auto sections = cut.sections();
  ASSERT_TRUE(sections);
  ASSERT_EQ(sections->size(), 2U);
  EXPECT_EQ(sections->front().last, 1U);
  EXPECT_TRUE(sections->back().circle);
}

TEST(LineArcSections, EndAtBreaks) {
  const Cut cut = slot();
  const std::vector<std::size_t> breaks = {4, 15};
  const auto sections = cut.sections(1000, breaks);
  ASSERT_TRUE(sections);
  for (const std::size_t each : breaks) {
    EXPECT_TRUE(std::ranges::any_of(*sections, [&](const auto& s) { return s.last == each; }));
  }
  EXPECT_EQ(sections->size(), 6U);
}

TEST(LineArcSections, AreNoMoreThanWereAskedFor) {
  EXPECT_TRUE(slot().sections(4));
  EXPECT_FALSE(slot().sections(3));
}

// Sides in short edges, with turns of 2.5 degrees between them.
TEST(LineArcSections, OfCornersAreNoArcs) {
  Cut cut;
  for (int i = 0; i < 20; ++i) {
    cut.add_line(4, 20);
    cut.angle += 2.5 * kPi / 180;
  }
  const auto sections = cut.sections();
  ASSERT_TRUE(sections);
  EXPECT_EQ(sections->size(), 20U);
  for (const LineArcSection& each : *sections) EXPECT_FALSE(each.circle);
}

// A curve whose bend grows is on no circle, and this is found in a few operations for each vertex.
TEST(LineArcSections, OfOtherCurvesAreManyOrNone) {
  std::vector<Point2> spiral;
  for (int i = 0; i < 3000; ++i) {
    const double turn = 0.003 * i;
    spiral.emplace_back((5 + 4 * turn) * std::cos(turn), (5 + 4 * turn) * std::sin(turn));
  }
  const auto before = operations_so_far();
  EXPECT_FALSE(line_arc_sections(spiral, {0.0003, kChord, 40}));
  EXPECT_LE(operations_so_far() - before, 100 * spiral.size());
}

}  // namespace
}  // namespace batten::geometry
