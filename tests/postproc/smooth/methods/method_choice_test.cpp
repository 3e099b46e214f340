// Every method from the command line's choice to the proved text, and what `best` makes of them.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <span>
#include <vector>

#include "geometry/path/parameter_samples.h"
#include "postproc/smooth/selection/selection.h"
#include "tests/support/interpreted.h"
#include "tests/support/machine_limits.h"
#include "tests/support/method_cases.h"
#include "tests/support/naseath_cases.h"
#include "tests/support/one_run.h"
#include "tests/support/paths.h"
#include "tests/support/wavy_programs.h"

namespace batten::postproc {
namespace {

// Down into the cut, through the points, up again. The first point is X.. Y.. of the plunge.
std::string program_through(const std::vector<geometry::Point3>& points, double feed) {
  std::string text = "G21 G90 G17\n";
  text += fmt::format("G0 X{:.4f} Y{:.4f} Z5\nG1 Z0 F300\n", points[0].x(), points[0].y());
  for (std::size_t i = 1; i < points.size(); ++i) {
    text += fmt::format("G1 X{:.4f} Y{:.4f}{}\n", points[i].x(), points[i].y(),
                        i == 1 ? fmt::format(" F{}", feed) : "");
  }
  return text + "G0 Z5\nM2\n";
}

std::string star_program() { return program_through(geometry::star_path(), 3000); }

// 0.02 mm of noise on a gentle wave: a line of chords that every method can better.
std::string noisy_program() {
  return wave_program({.lines = 300, .height = 1, .length = 40, .noise = 0.008, .feed = 6000});
}

// A router with motors of 1600 steps/mm: on those of the target's machine, 40 steps/mm, the rounded
// ends leave little to gain at a corner.
const Machine& fine_router() {
  static const Machine machine = [] {
    Machine m = *find_machine("router");
    set_xyz(m, &AxisLimits::steps, 1600);
    return m;
  }();
  return machine;
}

SmoothOptions options_with(Method method, std::string_view target, double tolerance = 0.05) {
  SmoothOptions options = options_for(target);
  if (target == "grbl") options.machine = &fine_router();
  options.method = method;
  options.tolerance_mm = tolerance;
  return options;
}

const RunReport& rewritten_run(const SmoothResult& result) {
  const auto run = std::ranges::find(result.runs, RunStatus::kRewritten, &RunReport::status);
  EXPECT_NE(run, result.runs.end()) << "nothing was rewritten";
  return run == result.runs.end() ? result.runs.front() : *run;
}

struct MethodOnProgram {
  Method method;
  std::string name;
  std::string (*program)();
  const char* target;
  Form output = Form::kAuto;
};

void PrintTo(const MethodOnProgram& m, std::ostream* out) { *out << m.name; }

// Two lines.
std::string corner_program() {
  return "G21 G90 G17 G94\nG0 X0 Y0 Z0\nG1 X13 Y13 F3000\nX26 Y0\nG0 Z5\nM2\n";
}

class MethodEndToEnd : public testing::TestWithParam<MethodOnProgram> {};

TEST_P(MethodEndToEnd, IsWrittenAndProvedWithinTheTolerance) {
  const std::string before = GetParam().program();
  SmoothOptions options = options_with(GetParam().method, GetParam().target);
  options.output = GetParam().output;
  const SmoothResult result = smoothed(before, options);
  EXPECT_TRUE(result.proved);
  EXPECT_EQ(rewritten_runs(result), 1u);
  EXPECT_EQ(rewritten_run(result).method, name_of(GetParam().method));
  EXPECT_LE(result.deviation_mm, 0.05);
  EXPECT_LE(result.runs_after_s, 1.005 * result.runs_before_s);
  EXPECT_TRUE(verdict(before, result.text, 0.05).proved());
  expect_rest_copied(before, result);
}

INSTANTIATE_TEST_SUITE_P(
    Methods, MethodEndToEnd,
    testing::Values(
        MethodOnProgram{Method::kFair, "Fair", noisy_program, "linuxcnc"},
        MethodOnProgram{Method::kNaseath, "Naseath", noisy_program, "linuxcnc"},
        MethodOnProgram{Method::kNaseathLiteral, "NaseathLiteral", noisy_program, "linuxcnc"},
        // LinuxCNC rounds corners itself; grbl slows down for each of them.
        MethodOnProgram{Method::kGuo, "Guo", star_program, "grbl"},
        MethodOnProgram{Method::kGuoLiteral, "GuoLiteral", star_program, "grbl", Form::kArcs},
        MethodOnProgram{Method::kOzcan, "Ozcan", star_program, "grbl"},
        MethodOnProgram{Method::kOzcanUsual, "OzcanUsual", star_program, "grbl"},
        MethodOnProgram{Method::kGuo, "GuoOneCorner", corner_program, "grbl"},
        MethodOnProgram{Method::kTimeOptimal, "Racing", star_program, "grbl"}),
    [](const auto& test) { return test.param.name; });

// A star that begins in one of its tips.
std::string star_from_a_tip() {
  std::vector<geometry::Point3> points = geometry::star_path();
  points.erase(points.begin());
  points.back() = points.front();
  return program_through(points, 3000);
}

// Radians between the directions in which a written ring, level at Z0, arrives at its begin and
// leaves it.
double turn_at_seam(const std::string& text) {
  const tests::Interpreted program(text);
  geometry::Path level;
  for (const gcode::Motion& motion : program.read.motions) {
    const geometry::PathPiece piece = motion.piece;
    const double end = geometry::end_point(piece).z();
    if (geometry::start_point(piece).z() == 0 && end == 0) level.push_back(piece);
  }
  const geometry::Vector3 leaves = geometry::direction_at(level.front(), 0);
  const geometry::Vector3 arrives = geometry::direction_at(level.back(), 1);
  return std::atan2(arrives.cross(leaves).norm(), arrives.dot(leaves));
}

// The tip turns by 144 degrees; rounded, by no more than arcs of three decimals show.
TEST(SmoothSeam, IsWrittenWithoutACornerWhereAClosedProgramBegins) {
  const std::string before = star_from_a_tip();
  SmoothOptions options = options_with(Method::kOzcan, "grbl");
  const SmoothResult corner = smoothed(before, options);
  EXPECT_EQ(rewritten_runs(corner), 1u);
  EXPECT_GT(turn_at_seam(corner.text), 140 * geometry::kPi / 180);
  options.seam = geometry::Seam::kSmooth;
  const SmoothResult result = smoothed(before, options);
  EXPECT_EQ(rewritten_runs(result), 1u);
  EXPECT_LT(turn_at_seam(result.text), 5 * geometry::kPi / 180);
  EXPECT_TRUE(result.proved);
  EXPECT_TRUE(verdict(before, result.text, 0.05).proved());
  EXPECT_LE(result.runs_after_s, result.runs_before_s);
  expect_rest_copied(before, result);
}

bool notes_no_seam(const SmoothResult& result) {
  return std::ranges::count(result.diagnostics, "seam-not-rounded", &gcode::Diagnostic::id) == 1;
}

// The tip turns by 144 degrees; as lines it is rounded where each turns by less than half of that.
TEST(SmoothSeam, IsNotedWhereNoWrittenRunHasOne) {
  const std::vector<geometry::Point3> half = [] {
    std::vector<geometry::Point3> points = geometry::star_path();
    points.resize(points.size() / 2);
    return points;
  }();
  for (const auto& choice : methods()) {
    if (!may_round_seams(choice.value)) continue;
    for (const std::string& before :
         {star_from_a_tip(), program_through(half, 3000), noisy_program()}) {
      SCOPED_TRACE(choice.name);
      SmoothOptions options = options_with(choice.value, "grbl");
      EXPECT_FALSE(notes_no_seam(smoothed(before, options)));
      options.seam = geometry::Seam::kSmooth;
      const SmoothResult result = smoothed(before, options);
      const bool rounded =
          before == star_from_a_tip() && turn_at_seam(result.text) < 72 * geometry::kPi / 180;
      EXPECT_EQ(notes_no_seam(result), !rounded);
    }
  }
}

// --- which one wins -----------------------------------------------------------------------------

double time_of_star(Method method, Form output) {
  SmoothOptions options = options_with(method, "grbl");
  options.output = output;
  return smoothed(star_program(), options).runs_after_s;
}

// Times of one method that differ by less than a percent are equal, and then other merits count.
TEST(BestMethod, IsNotSlowerThanAnyOnAStarAndThreePerCentFasterThanGuoLiteral) {
  const double best = time_of_star(Method::kBest, Form::kAuto);
  EXPECT_LT(best, 0.97 * time_of_star(Method::kGuoLiteral, Form::kAuto));
  EXPECT_LT(time_of_star(Method::kBest, Form::kArcs),
            0.97 * time_of_star(Method::kGuoLiteral, Form::kArcs));
  for (const Method method :
       {Method::kFair, Method::kGuo, Method::kOzcan, Method::kTimeOptimal, Method::kNaseath}) {
    EXPECT_LT(best, 1.01 * time_of_star(method, Form::kAuto)) << name_of(method);
  }
}

Machine machine_with_jerk(double velocity, double acceleration, double jerk) {
  Machine machine = *find_machine("high-speed");
  set_xyz(machine, &AxisLimits::velocity, velocity);
  set_xyz(machine, &AxisLimits::acceleration, acceleration);
  set_xyz(machine, &AxisLimits::jerk, jerk);
  return machine;
}

// One of Naseath's curves, at 24 m/min.
std::string program_of_case(const std::string& name, int samples) {
  const geometry::BsplineCurve curve = geometry::curve_of_case(name);
  std::vector<geometry::Point3> points;
  for (const auto& sample : geometry::parameter_samples(curve, samples)) {
    points.push_back(curve.point_at(sample.parameter));
  }
  return program_through(points, 24000);
}

// On his machine, which limits its jerk, or on the same without.
SmoothResult best_of_case(const std::string& name, double jerk, int samples = 8) {
  const Machine machine = machine_with_jerk(400, 4000, jerk);
  SmoothOptions options = options_with(Method::kBest, "siemens", 0.125);
  options.machine = &machine;
  return smoothed(program_of_case(name, samples), options);
}

// A noisy line; and a smooth curve, in which by the speeds that bends could be held at tube and
// fair would take the same.
TEST(BestMethod, TakesTheTubeWhereJerkIsLimitedAndItsPlanIsFaster) {
  for (const auto& [name, samples, part] :
       {std::tuple("tc5b", 8, 0.8), std::tuple("tc2", 30, 0.95)}) {
    SCOPED_TRACE(name);
    const SmoothResult result = best_of_case(name, 20000, samples);
    EXPECT_TRUE(result.proved);
    const RunReport& run = rewritten_run(result);
    EXPECT_EQ(run.method, "tube");
    const auto fair = std::ranges::find(run.methods, "fair", &MethodTime::method);
    ASSERT_NE(fair, run.methods.end());
    EXPECT_LT(run.time_after_s, part * fair->time_s);
  }
}

// Its plans take more than all that so short a run has in a long program; that is told.
TEST(BestMethod, LeavesOutATubeThatTakesMoreThanTheBudget) {
  const Machine machine = machine_with_jerk(400, 4000, 20000);
  SmoothOptions options = options_with(Method::kBest, "siemens", 0.125);
  options.machine = &machine;
  const OneRun run(program_of_case("tc5b", 3));
  const auto has_tube = [](const SmoothedRun& smoothed) {
    return std::ranges::any_of(smoothed.candidates,
                               [](const Candidate& c) { return c.method == "tube"; });
  };
  RunContext context = run.context();
  const SmoothedRun alone = smooth_run(run.run(), context, options);
  EXPECT_TRUE(has_tube(alone));
  context.moves_of_program = 1'000'000;
  const SmoothedRun in_long_program = smooth_run(run.run(), context, options);
  EXPECT_FALSE(has_tube(in_long_program));
  EXPECT_TRUE(in_long_program.is_cut_short);
}

// Six corners of 90 degrees on the machine of Ozcan 2018: rounded by two pieces each, with lines
// between them, where the fair curve takes three times as many blocks.
TEST(BestMethod, WritesCornersAsCurvesWhereTheTargetHasThem) {
  const Machine machine = machine_with_jerk(25, 2500, 5000);
  SmoothOptions options = options_with(Method::kBest, "siemens", 0.1);
  options.machine = &machine;
  constexpr const char* kCorners =
      "G90 G17\nG0 X0 Y0 Z0\nG1 X20. F1500.\nY20.\nX40.\nY0\nX60.\nY20.\nX80.\nM30\n";
  const SmoothResult result = smoothed(std::string("G71 ") + kCorners, options);
  const RunReport& run = rewritten_run(result);
  EXPECT_EQ(run.method, "guo");
  EXPECT_LE(run.blocks_out, 20U);
  EXPECT_LT(run.time_after_s, 0.95 * run.time_before_s);
  // G06.2 is an option of the control: the user says that it is there.
  gcode::Control fanuc = *gcode::find_control("fanuc");
  options.target = &fanuc;
  const SmoothResult without = smoothed(std::string("G21 ") + kCorners, options);
  EXPECT_EQ(without.text.find("G06.2"), std::string::npos);
  fanuc.curves_in_auto = true;
  const SmoothResult with = smoothed(std::string("G21 ") + kCorners, options);
  EXPECT_NE(with.text.find("G06.2"), std::string::npos);
  const RunReport& by_nurbs = rewritten_run(with);
  EXPECT_LT(by_nurbs.time_after_s, 0.95 * by_nurbs.time_before_s);
}

TEST(BestMethod, DoesNotTryTheTubeWhereNothingLimitsJerk) {
  const SmoothResult result = best_of_case("tc5b", std::numeric_limits<double>::infinity());
  for (const RunReport& run : result.runs) {
    EXPECT_EQ(std::ranges::find(run.methods, "tube", &MethodTime::method), run.methods.end());
  }
}

TEST(BestMethod, TellsWhichMethodsItTried) {
  const SmoothResult result = smoothed(star_program(), options_with(Method::kBest, "grbl"));
  const RunReport& run = rewritten_run(result);
  EXPECT_GE(run.methods.size(), 2u);
  const auto won = std::ranges::find(run.methods, run.method, &MethodTime::method);
  ASSERT_NE(won, run.methods.end());
  for (const MethodTime& each : run.methods) EXPECT_LE(won->time_s, 1.01 * each.time_s);
}

// A smooth program: nothing but fair has a chance, and nothing else is tried.
TEST(BestMethod, TriesNothingElseOnSmoothRuns) {
  const SmoothResult result = smoothed(wave_program(), options_with(Method::kBest, "grbl"));
  EXPECT_EQ(rewritten_run(result).methods.size(), 1u);
}

// A short bend in chords of 0.3 mm, which `fair` runs much faster than any rounding of its corners.
TEST(BestMethod, SearchesForNoCornersWhereRoundingThemIsFarFromTheFastest) {
  SmoothOptions options = options_with(Method::kBest, "fanuc");
  options.machine = find_machine("high-speed");
  const SmoothResult result = smoothed(
      "G21 G90 G94\nG0 X0 Y0 Z5\nG1 Z0 F1000\nF2500\nG1 X12.098 Y13.640 Z-0.5\n"
      "X11.984 Y13.362\nX11.985 Y13.050\nX12.107 Y12.740\nX12.348 Y12.466\nX12.696 Y12.264\nM2\n",
      options);
  for (const RunReport& run : result.runs) {
    for (const std::string_view search : {"ozcan", "racing"}) {
      EXPECT_EQ(std::ranges::find(run.methods, search, &MethodTime::method), run.methods.end());
    }
  }
}

// LinuxCNC rounds corners itself, within as much: a zigzag gains nothing by any that round them, as
// its farthest lines show, and their arcs are not made. Where these lines are nearly the best form,
// they are.
TEST(BestMethod, WritesWhatRoundsCornersInFullOnlyWhereItsFarthestLinesMayLead) {
  struct Made {
    std::ptrdiff_t lines = 0;
    std::ptrdiff_t arcs = 0;
  };
  const auto made_of = [](const std::vector<geometry::Point3>& points) {
    std::string text = "G21 G17 G90 G64 P0.01\nG0 X0 Y0 Z0\nF1800\n";
    for (const geometry::Point3& p : std::span(points).subspan(1)) {
      text += fmt::format("G1 X{:.3f} Y{:.3f}\n", p.x(), p.y());
    }
    SmoothOptions options = options_for("linuxcnc");
    options.machine = find_machine("linuxcnc");
    const SmoothedRun run = OneRun(text + "G0 Z5\nM2\n").smooth(options);
    Made made;
    for (const Candidate& c : run.candidates) {
      if (c.method != name_of(Method::kGuo)) continue;
      ++(c.form == Form::kLines ? made.lines : made.arcs);
    }
    return made;
  };
  const Made zigzag = made_of(geometry::zigzag_line(30, 0.15, 2));
  EXPECT_EQ(zigzag.lines, 1);
  EXPECT_EQ(zigzag.arcs, 0);
  // Four bends one way, four the other, and so on.
  const auto winding = [&](int edges, double degrees) {
    std::vector<geometry::Point3> points = {{0, 0, 0}};
    double heading = 0;
    for (int i = 0; i < edges; ++i) {
      const geometry::Vector3 way(std::cos(heading), std::sin(heading), 0);
      points.push_back(points.back() + 0.4 * way);
      heading += (i / 4 % 2 == 0 ? degrees : -degrees) * geometry::kPi / 180;
    }
    return made_of(points);
  };
  const Made gentle = winding(16, 20);
  EXPECT_EQ(gentle.lines, 1);
  EXPECT_EQ(gentle.arcs, 1);
  const Made sharp = winding(8, 30);
  EXPECT_EQ(sharp.lines, 1);
  EXPECT_EQ(sharp.arcs, 0);
}

// Each form that is made of a run of corners has a key of its own, and where the control blends
// corners itself none of them is of a curve that rounds all of them to win time.
TEST(BestMethod, KnowsEachFormOfARunOfCornersByItsKey) {
  std::string text = "G21 G17 G90\nG0 X0 Y0 Z0\nF1800\n";
  const std::vector<geometry::Point3> stairs = geometry::staircase_path(100, 0.3);
  for (const geometry::Point3& p : std::span(stairs).subspan(1)) {
    text += fmt::format("G1 X{:.3f} Y{:.3f}\n", p.x(), p.y());
  }
  for (const char* target : {"linuxcnc", "grbl"}) {
    const SmoothedRun run = OneRun(text + "G0 Z5\nM2\n").smooth(options_for(target));
    std::vector<FormKey> keys;
    for (const TriedForm& form : run.tried) keys.push_back(form.key);
    std::ranges::sort(keys);
    EXPECT_TRUE(std::ranges::adjacent_find(keys) == keys.end()) << target;
    const auto has = [&](CurveRole role) {
      return std::ranges::find(keys, role, &FormKey::role) != keys.end();
    };
    EXPECT_TRUE(has(CurveRole::kCorners)) << target;
    EXPECT_EQ(has(CurveRole::kRounding), std::string_view(target) == "grbl");
  }
}

// --- which methods were tried -------------------------------------------------------------------

Candidate candidate(std::string_view method, double time) {
  Candidate c;
  c.method = method;
  c.figures.times.programmed = time;
  return c;
}

TEST(MethodTimes, AreThoseOfTheFastestCandidateOfEachMethod) {
  SmoothedRun run;
  run.candidates = {candidate("fair", 3), candidate("fair", 2), candidate("guo", 2.5)};
  const std::vector<MethodTime> times = method_times(run);
  ASSERT_EQ(times.size(), 2u);
  EXPECT_EQ(times[0].method, "fair");
  EXPECT_EQ(times[0].time_s, 2);
  EXPECT_EQ(times[1].method, "guo");
  EXPECT_EQ(times[1].time_s, 2.5);
}

// 3 + 1 s, tried as 2.5 + 0.75 s with fair; guo was tried on the second section only.
TEST(MethodTimes, OfTwoSectionsAreSumsAndLeaveWhatWasNotTriedAsItWas) {
  const TriedSection first = {{{"fair", 2.5}, {"racing", 2.75}}, 3};
  const TriedSection second = {{{"fair", 0.75}, {"guo", 0.5}}, 1};
  const std::vector<MethodTime> times = joined_times(first, second);
  ASSERT_EQ(times.size(), 3u);
  EXPECT_EQ(times[0].method, "fair");
  EXPECT_DOUBLE_EQ(times[0].time_s, 3.25);
  EXPECT_EQ(times[1].method, "racing");
  EXPECT_DOUBLE_EQ(times[1].time_s, 3.75);
  EXPECT_EQ(times[2].method, "guo");
  EXPECT_DOUBLE_EQ(times[2].time_s, 3.5);
}

TEST(MethodTimes, SayHowFarTheChosenOneLeads) {
  const std::vector<MethodTime> times = {{"fair", 2}, {"guo", 2.5}, {"ozcan", 2.25}};
  EXPECT_DOUBLE_EQ(lead_of("fair", 2, times), 0.25);
  EXPECT_DOUBLE_EQ(lead_of("guo", 2.5, times), -0.5);
  EXPECT_EQ(lead_of("fair", 2, {MethodTime{"fair", 2}}), 0);
}

}  // namespace
}  // namespace batten::postproc
