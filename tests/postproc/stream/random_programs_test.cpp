// Every promise of `smooth_program` on random paths: in the plane and in space, closed, of arcs,
// with noise, with moves of no length and of nearly none, from a millionth of a millimetre to ten
// metres; and on waves with all sorts of things strewn in.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "tests/support/wavy_programs.h"

namespace batten::postproc {
namespace {

using geometry::Point3;
using geometry::Vector3;

struct RandomPath {
  unsigned seed = 0;
  double size = 1;  // mm, of a move
  bool in_space = false;
  bool closed = false;
  bool of_arcs = false;
  bool noisy = false;
  bool stands_still = false;
};

void PrintTo(const RandomPath& path, std::ostream* out) {
  *out << "seed " << path.seed << ", moves of " << path.size << " mm";
}

// As many decimals as the size needs, and as controls read.
int decimals_for(double size) {
  return std::clamp(4 - static_cast<int>(std::floor(std::log10(size))), 3, 9);
}

class ProgramMaker {
 public:
  explicit ProgramMaker(const RandomPath& path)
      : path_(path), random_(path.seed), decimals_(decimals_for(path.size)) {}

  std::string make() {
    const std::vector<Point3> points = path_.closed ? ring() : walk();
    std::string text = "G21 G90 G17\nS12000 M3\n";
    text += "G0 " + place(points.front()) + "\nG1 F1500\n";
    for (std::size_t i = 1; i < points.size(); ++i) {
      text += move(points[i - 1], points[i]) + "\n";
      if (path_.stands_still && i % 9 == 4) text += move(points[i], points[i]) + "\n";
      if (path_.stands_still && i % 11 == 5) {
        const double step = std::pow(10.0, -decimals_);
        text += "G1 " + place(points[i] + Vector3(step, 0, 0)) + "\n";
        text += "G1 " + place(points[i]) + "\n";
      }
    }
    return text + "M5\nM2\n";
  }

 private:
  double uniform() { return std::uniform_real_distribution<double>(-1, 1)(random_); }

  std::vector<Point3> walk() {
    std::vector<Point3> points = {Point3::Zero()};
    double heading = 0;
    double bend = 0;
    double climb = 0;
    for (int i = 0; i < 120; ++i) {
      bend = 0.8 * bend + 0.04 * uniform();
      heading += bend + (i % 40 == 20 ? 1.2 * uniform() : 0);
      climb += path_.in_space ? 0.05 * uniform() : 0;
      const double length = path_.size * (1 + 0.2 * uniform());
      points.push_back(points.back() + length * Vector3(std::cos(heading), std::sin(heading),
                                                        path_.in_space ? std::sin(climb) : 0));
    }
    return shaken(points);
  }

  std::vector<Point3> ring() {
    const double radius = 120 * path_.size / (2 * std::numbers::pi);
    std::vector<Point3> points;
    for (int i = 0; i < 120; ++i) {
      const double a = 2 * std::numbers::pi * i / 120;
      const double r = radius * (1 + 0.05 * std::cos(3 * a));
      points.emplace_back(r * std::cos(a), r * std::sin(a),
                          path_.in_space ? 0.02 * radius * std::sin(2 * a) : 0);
    }
    points = shaken(points);
    points.push_back(points.front());
    return points;
  }

  std::vector<Point3> shaken(std::vector<Point3> points) {
    if (!path_.noisy) return points;
    for (Point3& p : points) p += 0.003 * path_.size * Vector3(uniform(), uniform(), 0);
    return points;
  }

  [[nodiscard]] std::string place(const Point3& p) const {
    return fmt::format("X{:.{}f} Y{:.{}f} Z{:.{}f}", p.x(), decimals_, p.y(), decimals_, p.z(),
                       decimals_);
  }

  // With arcs every second move is one, bent by some degrees.
  std::string move(const Point3& from, const Point3& to) {
    arc_ = path_.of_arcs && !arc_;
    if (!arc_ || (to - from).norm() < 0.1 * path_.size) return "G1 " + place(to);
    const Vector3 chord = to - from;
    const double half_angle = 0.05 + 0.05 * std::abs(uniform());
    const bool left = uniform() > 0;
    const Vector3 aside = Vector3(-chord.y(), chord.x(), 0) * (left ? 0.5 : -0.5);
    const Vector3 center = 0.5 * chord + aside / std::tan(half_angle);
    return fmt::format("{} {} I{:.{}f} J{:.{}f}", left ? "G3" : "G2", place(to), center.x(),
                       decimals_ + 1, center.y(), decimals_ + 1);
  }

  const RandomPath& path_;
  std::mt19937 random_;
  int decimals_;
  bool arc_ = false;
};

std::vector<RandomPath> random_paths() {
  std::vector<RandomPath> paths;
  for (unsigned seed = 0; seed < 44; ++seed) {
    RandomPath path;
    path.seed = seed;
    path.size = std::pow(10.0, -6 + static_cast<int>(seed % 11));
    path.in_space = seed % 2 == 1;
    path.closed = seed % 3 == 1;
    path.of_arcs = !path.in_space && seed % 4 == 2;
    path.noisy = seed % 5 == 3;
    path.stands_still = seed % 7 >= 4;
    paths.push_back(path);
  }
  return paths;
}

// A hundredth of the moves, as far as that is a tolerance.
SmoothOptions options_of(const RandomPath& path) {
  SmoothOptions options = options_for("linuxcnc");
  options.tolerance_mm = std::clamp(0.01 * path.size, 0.002, 10.0);
  return options;
}

// Returns whether something is rewritten.
bool expect_promises(const std::string& text, SmoothOptions options) {
  const SmoothResult result = smoothed(text, options);
  EXPECT_TRUE(result.understood);
  EXPECT_TRUE(result.proved);
  EXPECT_LE(result.deviation_mm, options.tolerance_mm);
  const Verification found = verdict(text, result.text, options.tolerance_mm);
  EXPECT_TRUE(found.proved()) << found.violations.front().message;
  expect_rest_copied(text, result);
  const double costs = options.output == Form::kAuto ? 1.006 : 1.5;  // a form asked for by name
  const auto allowed = [&](double before) { return std::max(costs * before, before + 0.001); };
  EXPECT_LE(result.runs_after_s, allowed(result.runs_before_s));
  for (const RunReport& run : result.runs) {
    EXPECT_EQ(run.reason.empty(), run.status == RunStatus::kRewritten);
    EXPECT_TRUE(run.proved);
    EXPECT_LE(run.deviation_mm, options.tolerance_mm);
    EXPECT_LE(run.time_after_s, allowed(run.time_before_s)) << "line " << run.first_line;
  }
  EXPECT_EQ(smoothed(result.text, options).text, result.text) << "a second pass";
  options.threads = 2;
  EXPECT_EQ(smoothed(text, options).text, result.text) << "two threads";
  return rewritten_runs(result) > 0;
}

class RandomProgram : public testing::TestWithParam<RandomPath> {};

TEST_P(RandomProgram, IsProvedOtherwiseCopiedAndTheSameForTwoThreadsAndASecondPass) {
  (void)expect_promises(ProgramMaker(GetParam()).make(), options_of(GetParam()));
}

INSTANTIATE_TEST_SUITE_P(Pipeline, RandomProgram, testing::ValuesIn(random_paths()));

// Runs with plunges, feeds, comments, coolant and rapids strewn in.
std::string strewn_program(unsigned seed) {
  std::mt19937 random(seed);
  const auto below = [&](int n) { return static_cast<int>(random() % static_cast<unsigned>(n)); };
  Wave wave;
  wave.seed = seed;
  wave.lines = 60 + below(120);
  wave.step = 0.05 + 0.05 * below(10);
  wave.height = 0.5 * below(8);
  wave.length = 4 + below(30);
  wave.noise = 0.002 * below(3);
  std::vector<std::string> lines = wave_lines(wave);
  for (std::string& line : lines) {
    const int what = below(60);
    if (what == 0) line += " (here)";
    if (what == 1) line += fmt::format(" F{}", 500 + 100 * below(20));
    if (what == 2) line += "\nZ-1.5";
    if (what == 3) line += "\nM8";
    if (what == 4) line += "\n";
    if (what == 5) line += "\nG0 Z5\nG1 Z-1 F300\nF1200";
  }
  return head("G21") + joined(lines, "\n") + tail();
}

struct StrewnCase {
  std::string_view target;
  Form form = Form::kAuto;
  Prefer prefer = Prefer::kTime;
  double tolerance_mm = 0.01;
};

TEST(StrewnPrograms, KeepEveryPromise) {
  const StrewnCase cases[] = {{"linuxcnc"},
                              {"linuxcnc", Form::kArcs},
                              {"linuxcnc", Form::kLines},
                              {"linuxcnc", Form::kAuto, Prefer::kSize},
                              {"linuxcnc", Form::kAuto, Prefer::kAccuracy},
                              {"linuxcnc", Form::kAuto, Prefer::kTime, 0.1},
                              {"linuxcnc", Form::kAuto, Prefer::kTime, 0.002},
                              {"grbl"},
                              {"grbl", Form::kArcs, Prefer::kSize},
                              {"grbl", Form::kLines, Prefer::kTime, 0.05}};
  unsigned seed = 0;
  std::size_t rewritten = 0;
  for (const StrewnCase& test : cases) {
    SCOPED_TRACE(++seed);
    SmoothOptions options = options_for(test.target);
    options.output = test.form;
    options.prefer = test.prefer;
    options.tolerance_mm = test.tolerance_mm;
    const std::string text = strewn_program(seed);
    rewritten += expect_promises(text, options) ? 1 : 0;
  }
  EXPECT_GE(rewritten, 7U) << "else a Batten that does nothing would do";
}

// The promises above would hold of a Batten that does nothing. Moves of a tenth of a micrometre and
// less are below what the target prints, and stay.
TEST(RandomPrograms, AreRewrittenWhereTheyCanBe) {
  std::size_t possible = 0;
  std::size_t rewritten = 0;
  std::size_t with_arcs = 0;
  for (const RandomPath& path : random_paths()) {
    const bool again = rewritten_runs(smoothed(ProgramMaker(path).make(), options_of(path))) > 0;
    possible += path.size >= 0.01 ? 1 : 0;
    rewritten += again ? 1 : 0;
    with_arcs += again && path.of_arcs ? 1 : 0;
  }
  EXPECT_GE(2 * rewritten, possible) << "of " << possible;
  EXPECT_GE(with_arcs, 1u);
}

}  // namespace
}  // namespace batten::postproc
