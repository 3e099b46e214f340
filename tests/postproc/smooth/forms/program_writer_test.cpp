#include "postproc/smooth/forms/program_writer.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <iterator>
#include <numbers>
#include <random>
#include <string>

#include "gcode/control/control.h"
#include "gcode/controls/built_in.h"

namespace batten::postproc {
namespace {

using gcode::ModalState;
using gcode::Units;
using geometry::Point3;
using geometry::Vector3;

gcode::Program program_of(std::string text) {
  return {gcode::SourceText("part.nc", std::move(text)), {}, {}, {}};
}

ModalState cutting(Units units = Units::kMillimetre) {
  ModalState modal;
  modal.motion = gcode::MotionMode::kLine;
  modal.units = units;
  modal.feed = 1000;
  return modal;
}

// A run and its plan, built move by move.
struct Planned {
  Run run;
  OutputPlan plan;

  explicit Planned(const Point3& start) { run.points = {start}; }

  void line(const Point3& end, double feed = 1000) {
    plan.moves.push_back({geometry::Line{run.points.back(), end}, feed, {}});
    run.points.push_back(end);
  }
  void arc(const Point3& end, const Point3& center, const Vector3& axis, double sweep) {
    plan.form = Form::kArcs;
    plan.moves.push_back({geometry::Arc{run.points.back(), end, center, axis, sweep}, 1000, {}});
    run.points.push_back(end);
  }
};

std::optional<RunText> written(const Planned& planned, std::string_view target,
                               const ModalState& before, const ModalState& after) {
  return write_run(planned.plan, planned.run, program_of(""), *gcode::find_control(target), before,
                   after, "\n");
}

TEST(WriteRun, WritesMovesCommentsAndWhatTheNextBlockExpects) {
  const gcode::Program program = program_of("X1 (first)\r\n; second\r\nX2\r\n");
  Planned planned({0, 0, 0});
  planned.run.comments = {{1, {3, 10}, true}, {2, {12, 20}}};
  planned.line({1, 0, 0});
  planned.arc({2, 0, 1}, {1, 0, 1}, Vector3::UnitY(), -std::numbers::pi / 2);
  planned.plan.moves[1].comments_before = {0};
  planned.plan.comments_after = {1};
  ModalState before = cutting();
  before.motion = gcode::MotionMode::kRapid;
  const auto out = write_run(planned.plan, planned.run, program, *gcode::find_control("grbl"),
                             before, cutting(), "\r\n");
  ASSERT_TRUE(out);
  EXPECT_EQ(out->text,
            "G1 X1 (first)\r\n"
            "G18 G2 X2 Z1 K1\r\n"
            "; second\r\n"
            "G17 G1\r\n");
  EXPECT_EQ(out->blocks, 4U);
  EXPECT_EQ(out->arcs, 1U);
}

// One behind each block, where the control keeps that many bytes of a line; the order stays.
TEST(WriteRun, PutsTheCommentOfABlockBehindTheBlockThatEndsThere) {
  Planned planned({0, 0, 0});
  planned.line({1, 0, 0});
  planned.line({2, 0, 0});
  planned.run.comments = {{1, {0, 3}, true}, {1, {3, 6}, true}, {2, {6, 36}, true}};
  planned.plan.moves[1].comments_before = {0, 1};
  planned.plan.comments_after = {2};
  const auto text_within = [&](std::size_t bytes) {
    gcode::Control target = *gcode::find_control("linuxcnc");
    target.max_line_length = bytes;
    return write_run(planned.plan, planned.run, program_of("(a)(b)(a long comment of the source)"),
                     target, cutting(), cutting(), "\n")
        ->text;
  };
  EXPECT_EQ(text_within(80), "X1 (a)\n(b)\nX2 (a long comment of the source)\n");
  EXPECT_EQ(text_within(33), "X1 (a)\n(b)\nX2 (a long comment of the source)\n");
  EXPECT_EQ(text_within(32), "X1 (a)\n(b)\nX2\n(a long comment of the source)\n");
}

// A run before this one may have ended in other words than the arc that stood there.
TEST(WriteRun, SaysItsOwnMotionAfterAnArc) {
  Planned planned({0, 0, 0});
  planned.arc({2, 0, 0}, {1, 0, 0}, Vector3::UnitZ(), -std::numbers::pi);
  ModalState after_an_arc = cutting();
  after_an_arc.motion = gcode::MotionMode::kClockwise;
  EXPECT_EQ(written(planned, "linuxcnc", after_an_arc, after_an_arc)->text, "G2 X2 I1\n");
}

TEST(WriteRun, RestoresNothingThatTheNextBlockDoesNotNeed) {
  Planned planned({0, 0, 0});
  planned.arc({2, 0, 0}, {1, 0, 0}, Vector3::UnitZ(), -std::numbers::pi);
  ModalState after = cutting();
  after.motion = gcode::MotionMode::kUnknown;  // it names its own
  EXPECT_EQ(written(planned, "linuxcnc", cutting(), after)->text, "G2 X2 I1\n");
  EXPECT_EQ(written(planned, "linuxcnc", cutting(), cutting())->text, "G2 X2 I1\nG1\n");
}

// Times are of these: what a control reads brakes at turns that the plan does not have.
TEST(WriteRun, HasTheMovesThatItsNumbersSay) {
  Planned planned({0, 0, 0});
  planned.line({1.0004, 0.0004, 0});
  planned.line({1.0004, 0.00041, 0});  // prints nothing
  planned.arc({3.0004, 0.0004, 0}, {2.0004, 0.0003, 0}, Vector3::UnitZ(), -std::numbers::pi);
  planned.line({5.0006, 0.0006, 0}, 500);
  planned.line({6, 0, 0}, 500);
  const auto out = written(planned, "klipper", cutting(), cutting());
  ASSERT_TRUE(out);
  ASSERT_EQ(out->moves.size(), 4U) << out->text;
  const std::array<Point3, 4> ends = {Point3(1, 0, 0), {3, 0, 0}, {5.001, 0.001, 0}, {6, 0, 0}};
  for (std::size_t i = 0; i < ends.size(); ++i) {
    const geometry::PathPiece& piece = out->moves[i].piece;
    const Point3 start = i == 0 ? Point3::Zero() : ends[i - 1];
    EXPECT_LE((geometry::start_point(piece) - start).norm(), 1e-12) << i;
    EXPECT_LE((geometry::end_point(piece) - ends[i]).norm(), 1e-12) << i;
    EXPECT_EQ(out->moves[i].feed, i < 2 ? 1000 : 500);
  }
  ASSERT_TRUE(std::holds_alternative<geometry::Arc>(out->moves[1].piece));
  EXPECT_LE((std::get<geometry::Arc>(out->moves[1].piece).center - Point3(2, 0.0003, 0)).norm(),
            1e-12);
}

// A wave of two pieces, whose joint is printed beside where it is planned.
TEST(WriteRun, HasTheCurvesThatItsNumbersSay) {
  const Point3 joint(5.00012345, 2.00023456, 0);
  const geometry::CubicBezier pieces[] = {
      {{Point3::Zero(), {1.5, 2, 0}, joint - Vector3(2, 0, 0), joint}},
      {{joint, joint + Vector3(2, 0, 0), {8.5, 2, 0}, {10, 0, 0}}}};
  Planned planned({0, 0, 0});
  planned.plan.form = Form::kCurves;
  std::vector<Point3> points;
  for (const geometry::CubicBezier& piece : pieces) {
    planned.plan.moves.push_back({piece, 1000, {}});
    planned.run.points.push_back(piece.control[3]);
    points.insert(points.end(), std::begin(piece.control) + (points.empty() ? 0 : 1),
                  std::end(piece.control));
  }
  const geometry::BsplineBasis basis(3, {0, 0, 0, 0, 1, 1, 1, 2, 2, 2, 2});
  planned.plan.curves = {{0, 2, {basis, points}}};
  for (const char* target : {"linuxcnc", "siemens"}) {
    SCOPED_TRACE(target);
    const auto out = written(planned, target, cutting(), cutting());
    ASSERT_TRUE(out);
    ASSERT_EQ(out->moves.size(), 2U) << out->text;
    const Point3 printed = geometry::end_point(out->moves[0].piece);
    EXPECT_LE((printed - geometry::start_point(out->moves[1].piece)).norm(), 1e-12);
    EXPECT_LE((printed - joint).norm(), 1e-3);
    const Vector3 in_steps = printed / 1e-6;  // six decimals at the most
    EXPECT_LE((in_steps - in_steps.array().round().matrix()).norm(), 1e-6) << out->text;
    EXPECT_EQ(out->moves[1].feed, 1000);
  }
}

TEST(WriteRun, MeetsTheLastPointWithAllItsDecimals) {
  for (const std::string_view target : {"grbl", "linuxcnc"}) {
    for (const double inch : {1.0, 25.4}) {
      Planned planned(inch * Point3(0.123456, 0, -1.5));
      planned.line(inch * Point3(1.1111111, 2.2222222, -1.5));
      planned.line(inch * Point3(4.100001, -0.123456, -1.5));
      planned.run.decimals = 6;
      const ModalState modal = cutting(inch == 1 ? Units::kMillimetre : Units::kInch);
      const auto out = written(planned, target, modal, modal);
      ASSERT_TRUE(out);
      EXPECT_TRUE(out->text.ends_with("X4.100001 Y-0.123456\n")) << out->text;
      EXPECT_EQ(out->text.find("1.1111111"), std::string::npos) << out->text;
    }
  }
}

TEST(WriteRun, MovesNoAxisThatStaysPut) {
  Planned planned({0.123456, 0, 0});
  planned.line({0.123456, 3, 0});
  planned.line({0.123456, 7, 0});
  planned.run.decimals = 6;
  EXPECT_EQ(written(planned, "grbl", cutting(), cutting())->text, "Y3\nY7\n");
}

TEST(WriteRun, WritesNothingWhereTheLastPointCannotBePrinted) {
  Planned planned({0, 0, 0});
  planned.line({1.0 / 3, 0, 0});
  planned.run.decimals = 3;
  EXPECT_FALSE(written(planned, "grbl", cutting(), cutting()));
}

TEST(WriteRun, WritesNothingWhereArcCentersAreNotUnderstood) {
  Planned planned({0, 0, 0});
  planned.arc({2, 0, 0}, {1, 0, 0}, Vector3::UnitZ(), -std::numbers::pi);
  ModalState modal = cutting();
  modal.arc_distance = gcode::DistanceMode::kUnknown;
  EXPECT_FALSE(written(planned, "linuxcnc", modal, modal));
  Planned lines({0, 0, 0});
  lines.line({1, 0, 0});
  EXPECT_TRUE(written(lines, "linuxcnc", modal, modal));
}

// grbl takes no arc of 0.08 mm radius. A chord of a quarter turn is off by 0.08 (1 - cos 45°) =
// 0.023 mm, so it needs several to be within half of 0.001.
TEST(WriteRun, WritesChordsForAnArcThatTheControlRefuses) {
  Planned planned({0.08, 0, 0});
  planned.arc({0, 0.08, 0}, {0, 0, 0}, Vector3::UnitZ(), std::numbers::pi / 2);
  const auto out = written(planned, "grbl", cutting(), cutting());
  ASSERT_TRUE(out);
  EXPECT_EQ(out->arcs, 0U);
  EXPECT_EQ(out->text.find("G3"), std::string::npos);
  EXPECT_GE(out->blocks, 7U);  // pi / 2 / (2 acos(1 - 0.0005 / 0.08)) = 7.02
  EXPECT_LE(out->blocks, 8U);
}

// Lines and arcs to places that no number of a program names.
TEST(WriteRun, WritesNothingOfPlacesBeyondTheNumbersOfAProgram) {
  const auto write = [](const Planned& planned, std::string_view target) {
    return written(planned, target, cutting(), cutting()).has_value();
  };
  for (const char* target : {"linuxcnc", "grbl"}) {
    Planned far({0, 0, 0});
    far.line({-17179869184.0, 3, 0});
    far.line({1, 0, 0});
    EXPECT_FALSE(write(far, target)) << target;
    Planned flat({0, 0, 0});
    flat.arc({1, 0, 0}, {0.5, -1e12, 0}, Vector3::UnitZ(), -1e-12);
    EXPECT_FALSE(write(flat, target)) << target;
    Planned near({0, 0, 0});
    near.line({100000, 3, 0});
    near.line({1, 0, 0});
    EXPECT_TRUE(write(near, target)) << target;
  }
}

TEST(WriteRun, WritesNothingWhereALineWouldBeTooLong) {
  gcode::Control target;
  target.places = {4, 4};
  target.max_line_length = 10;
  Planned planned({0, 0, 0});
  planned.line({1, 2, 0});
  const auto write = [&] {
    return write_run(planned.plan, planned.run, program_of("(a long comment of the source)"),
                     target, cutting(), cutting(), "\r\n");
  };
  EXPECT_EQ(write()->text, "X1 Y2\r\n");
  planned.line({3.5, 4.25, 0});
  EXPECT_EQ(write()->text, "X1 Y2\r\nX3.5 Y4.25\r\n");
  planned.line({3.25, -4.5, 0});
  EXPECT_FALSE(write());  // "X3.25 Y-4.5" has 11 bytes
  planned.plan.moves.pop_back();
  planned.run.points.pop_back();
  planned.run.comments = {{1, {0, 30}}};
  planned.plan.comments_after = {0};  // was too long before
  EXPECT_TRUE(write());
}

// --- promises over random runs ------------------------------------------------------------------

Planned random_run(std::mt19937& random, bool arcs) {
  std::uniform_real_distribution<double> place(-100, 100);
  const auto rounded = [&] { return gcode::rounded(place(random), 3); };
  Planned planned({rounded(), rounded(), rounded()});
  const std::array<double, 3> feeds = {300, 1000, 2500};
  for (int i = 0; i < 20; ++i) {
    const Point3 start = planned.run.points.back();
    if (arcs && i % 2 == 0) {
      const int normal = static_cast<int>(random() % 3);
      const Vector3 axis = Vector3::Unit(normal);
      Vector3 out(place(random), place(random), place(random));
      out[normal] = 0;
      const double sweep = place(random) / 40;
      const Point3 end =
          start + out - (std::cos(sweep) * out + std::sin(sweep) * Vector3(axis.cross(out)));
      planned.arc(end, start + out, axis, sweep);
    } else {
      planned.line({place(random), place(random), place(random)}, feeds[random() % 3]);
    }
  }
  planned.line({rounded(), rounded(), rounded()}, feeds[random() % 3]);
  planned.run.decimals = 3;
  return planned;
}

TEST(WriteRun, CountsBlocksAndLeavesTheLastPointInTheText) {
  std::mt19937 random(1);
  for (int i = 0; i < 300; ++i) {
    const Planned planned = random_run(random, i % 2 == 0);
    ModalState anything = cutting();
    anything.motion = gcode::MotionMode::kUnknown;
    anything.plane = gcode::Plane::kUnknown;
    anything.feed.reset();
    const auto out = written(planned, i % 3 == 0 ? "grbl" : "linuxcnc", cutting(), anything);
    ASSERT_TRUE(out) << "run " << i;
    EXPECT_EQ(out->blocks, static_cast<std::size_t>(std::ranges::count(out->text, '\n')));
    const std::string last = "X" + gcode::to_text(planned.run.points.back().x(), {.decimals = 3});
    EXPECT_NE(out->text.rfind(last), std::string::npos) << last << '\n' << out->text;
  }
}

// Reads plane, motion and feed words as a control would, and nothing else.
ModalState state_after(const std::string& text, ModalState state) {
  for (std::size_t i = 0; i < text.size(); ++i) {
    if (text[i] == 'F') state.feed = std::stod(text.substr(i + 1));
    if (text[i] != 'G') continue;
    const int number = std::stoi(text.substr(i + 1));
    if (number == 1) state.motion = gcode::MotionMode::kLine;
    if (number == 2) state.motion = gcode::MotionMode::kClockwise;
    if (number == 3) state.motion = gcode::MotionMode::kCounterclockwise;
    if (number == 17) state.plane = gcode::Plane::kXY;
    if (number == 18) state.plane = gcode::Plane::kZX;
    if (number == 19) state.plane = gcode::Plane::kYZ;
  }
  return state;
}

TEST(WriteRun, LeavesTheStateThatWasAskedFor) {
  std::mt19937 random(2);
  for (int i = 0; i < 300; ++i) {
    Planned planned = random_run(random, true);
    if (i % 2 == 0) {  // end on an arc
      planned.plan.moves.pop_back();
      planned.run.points.pop_back();
      planned.plan.moves.pop_back();
      planned.run.points.pop_back();
      planned.run.decimals = 9;
      for (double& x : planned.run.points.back()) x = gcode::rounded(x, 9);
      std::get<geometry::Arc>(planned.plan.moves.back().piece).end = planned.run.points.back();
    }
    ModalState after = cutting();
    after.plane = i % 3 == 0 ? gcode::Plane::kZX : gcode::Plane::kXY;
    after.feed = i % 5 == 0 ? 2500 : 300;
    const auto out = written(planned, "linuxcnc", cutting(), after);
    ASSERT_TRUE(out) << "run " << i;
    EXPECT_EQ(state_after(out->text, cutting()), after) << out->text;
  }
}

}  // namespace
}  // namespace batten::postproc
