// How much is computed for one run: by counting operations, not by time.
#include "postproc/smooth/selection/run_budget.h"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>
#include <string>
#include <vector>

#include "postproc/machine/machine.h"
#include "postproc/smooth/curve_forms.h"
#include "postproc/smooth/methods/run_curve.h"
#include "tests/support/one_run.h"
#include "tests/support/wavy_programs.h"

namespace batten::postproc {
namespace {

using geometry::Point3;

struct Shape {
  const char* name;
  std::vector<Point3> points;
};

std::string program_of(const std::vector<Point3>& points) {
  std::string text = "G21 G17 G90 G64\nG0 X0 Y0 Z0\nF2500\n";
  for (const Point3& p : points) {
    text += fmt::format("G1 X{:.3f} Y{:.3f} Z{:.3f}\n", p.x(), p.y(), p.z());
  }
  return text + "G0 Z5\nM2\n";
}

// Paths that take much work: corners everywhere, bends among corners, noise.
std::vector<Shape> costly_shapes() {
  std::mt19937 random(5);
  const auto in = [&](double low, double high) {
    return std::uniform_real_distribution<double>(low, high)(random);
  };
  std::vector<Shape> shapes = {{"zigzag", {}}, {"stairs", {}}, {"letters", {}},
                               {"teeth", {}},  {"relief", {}}, {"noise", {}}};
  Point3 stair(0, 0, 0);
  Point3 center(0, 0, 0);
  for (int i = 1; i <= 300; ++i) {
    const double u = i;
    shapes[0].points.emplace_back(0.2 * u, in(-3, 3), 0);
    stair[i % 2] += i % 3 == 0 ? 0.2 : 0.1;
    shapes[1].points.push_back(stair);
    if (i % 15 == 0) center += Point3(in(-1, 3), in(-2, 2), 0);
    const double angle = 0.3 * u;
    shapes[2].points.push_back(center +
                               in(0.8, 0.82) * Point3(std::cos(angle), std::sin(angle), 0));
    const double turn = 2 * geometry::kPi * u / 300;
    const double radius = 15 + (i / 10 % 2 == 0 ? 1.2 : 0) + 0.2 * std::sin(40 * turn);
    shapes[3].points.push_back(radius * Point3(std::cos(turn), std::sin(turn), 0));
    shapes[4].points.emplace_back(0.1 * u, 0, 0.04 * std::round(25 * std::sin(0.07 * u)));
    shapes[5].points.emplace_back(0.1 * u, 3 * std::sin(0.1 * u) + in(-0.004, 0.004),
                                  in(-0.004, 0.004));
  }
  return shapes;
}

struct Control {
  const char* target;
  const char* machine;  // nothing: the target's own
};
constexpr Control kControls[] = {
    {"linuxcnc", nullptr}, {"grbl", nullptr}, {"siemens", nullptr}, {"siemens", "high-speed"}};

// Of a run that is one of a long program: operations in parts of its budget.
struct Spent {
  double part;
  bool is_cut_short;
};

Spent spent(const std::string& text, const Control& control) {
  const OneRun run(text);
  SmoothOptions options = options_for(control.target);
  if (control.machine != nullptr) options.machine = find_machine(control.machine);
  RunContext context = run.context();
  context.moves_of_program = 1'000'000;
  const std::uint64_t before = geometry::operations_so_far();
  const SmoothedRun smoothed = smooth_run(run.run(), context, options);
  const std::uint64_t operations = geometry::operations_so_far() - before;
  const auto moves = run.run().points.size() - 1;
  return {static_cast<double>(operations) / static_cast<double>(kBudget.per_move * moves),
          smoothed.is_cut_short};
}

TEST(RunBudget, BoundsWhatAnyRunTakes) {
  int cut_short = 0;
  for (const Shape& shape : costly_shapes()) {
    for (const Control& control : kControls) {
      const Spent all = spent(program_of(shape.points), control);
      cut_short += all.is_cut_short ? 1 : 0;
      EXPECT_LT(all.part, 2) << shape.name << " for " << control.target
                             << ": what was begun before may take as much again";
    }
  }
  EXPECT_GE(cut_short, 4);
}

TEST(RunBudget, LeavesPlentyForUsualRuns) {
  for (const std::string& text : {circle_program(300), wave_program()}) {
    for (const Control& control : kControls) {
      const Spent all = spent(text, control);
      EXPECT_LT(all.part, 0.5) << control.target;
      EXPECT_FALSE(all.is_cut_short) << control.target;
    }
  }
}

// A zigzag beside a circle of many chords.
std::string zigzag_in_a_long_program() {
  std::string text = program_of(costly_shapes()[0].points);
  text.erase(text.find("M2"));
  for (int i = 0; i <= 2500; ++i) {
    const double angle = 2 * geometry::kPi * i / 2500;
    text += fmt::format("G1 X{:.3f} Y{:.3f}\n", 80 + 40 * std::cos(angle), 40 * std::sin(angle));
  }
  return text + "M2\n";
}

TEST(RunBudget, IsToldOfWhereItIsSpentAndTheSameForAnyThreads) {
  SmoothOptions options = options_for("siemens");
  options.machine = find_machine("high-speed");
  options.threads = 1;
  const SmoothResult alone = smoothed(zigzag_in_a_long_program(), options);
  options.threads = 3;
  EXPECT_EQ(smoothed(zigzag_in_a_long_program(), options).text, alone.text);
  const auto notes =
      std::ranges::count(alone.diagnostics, "search-cut-short", &gcode::Diagnostic::id);
  EXPECT_EQ(notes, 1);
  EXPECT_EQ(std::ranges::count(alone.runs, true, &RunReport::is_cut_short), 1);
  EXPECT_TRUE(alone.runs.front().is_cut_short);
}

TEST(RunBudget, IsThatOfTheMovesOrAShareOfTheProgram) {
  EXPECT_EQ(RunBudget::operations(300, 1'000'000), 300 * kBudget.per_move);
  EXPECT_EQ(RunBudget::operations(3, 1'000'000), kBudget.least_moves * kBudget.per_move);
  EXPECT_EQ(RunBudget::operations(10, 100), kBudget.per_program / 10);
  EXPECT_EQ(RunBudget::operations(10, 0), kBudget.per_program) << "alone";
}

// What was just found is not for nothing: with nothing left, and another candidate there, one form
// of it is made.
TEST(RunBudget, LeavesOneFormOfACurveThatWasFound) {
  const OneRun run(wave_program());
  const SmoothOptions options = options_for("linuxcnc");
  const RunContext context = run.context();
  const RunTask task{run.run(), context, options};
  const RunTimes times(context, *options.machine);
  CurveRequest request;
  request.tolerance = 0.005;
  const auto curve = curve_of(Method::kFair, run.run().points, request);
  ASSERT_TRUE(curve);
  const CurvatureProfile bends(curve->path.curve);
  const MeantPath meant(curve->path);
  const std::optional<LineArcs> shape;
  SmoothedRun result = run.smooth(options);
  const auto cost = [&](const Candidate& c) {
    return cost_of(c.figures, result.facts.scale, options.prefer);
  };
  std::ranges::sort(result.candidates, std::ranges::greater{}, cost);
  result.candidates.resize(1);  // the dearest
  result.candidates.front().text.text.clear();
  const CandidateBounds bounds(task, result);
  const RunBudget spent(1, 1'000'000);
  geometry::count_operations(RunBudget::operations(1, 1'000'000));
  ASSERT_TRUE(spent.is_spent());
  add_forms({task, times, bounds, meant, shape, spent}, {*curve, bends, 0.002, 0.004}, result);
  EXPECT_EQ(result.candidates.size(), 2u);
  EXPECT_TRUE(result.is_cut_short);
}

// One candidate of the form that was asked for is made with nothing left.
TEST(RunBudget, LeavesTheFormThatIsAskedFor) {
  const OneRun run(program_of(costly_shapes()[1].points));
  SmoothOptions options = options_for("siemens");
  options.machine = find_machine("high-speed");
  RunContext context = run.context();
  context.moves_of_program = 1'000'000;
  for (const Form form : {Form::kLines, Form::kArcs, Form::kCurves}) {
    options.output = form;
    const SmoothedRun smoothed = smooth_run(run.run(), context, options);
    EXPECT_TRUE(std::ranges::any_of(smoothed.candidates,
                                    [&](const Candidate& c) { return c.form == form; }));
  }
}

}  // namespace
}  // namespace batten::postproc
