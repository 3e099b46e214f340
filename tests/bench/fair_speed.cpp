// Processor time of geometry::fair_path per point of long runs, in microseconds:
//   fair_speed [POINTS]...              made paths of so many points; 10000, 100000 and 1000000
//                                       when none are given
//   fair_speed FILE... [--tolerance T]  all chains of straight cutting moves of these programs
// One line per path: name, points, microseconds per point, control points per point, deviation
// over tolerance, rounds for the machine's need. Linear cost: the time per point stays.
#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <ctime>
#include <numbers>
#include <random>
#include <string>
#include <string_view>
#include <vector>

#include "gcode/interpreter/interpreter.h"
#include "gcode/reading/parser.h"
#include "gcode/text/diagnostic.h"
#include "geometry/fitting/fair/fair.h"

namespace {

using namespace batten;
using geometry::Point3;

Point3 printed(const Point3& p) { return (p * 1000).array().round() / 1000; }

// A spiral pocket: chords of 0.005 mm, 0.4 mm from turn to turn.
std::vector<Point3> spiral(std::size_t count) {
  std::vector<Point3> points;
  double angle = 20;
  while (points.size() < count) {
    const double radius = 0.4 / (2 * std::numbers::pi) * angle;
    points.push_back(printed(Point3(radius * std::cos(angle), radius * std::sin(angle), -1)));
    angle += 2 * std::acos(1 - 0.005 / radius);
  }
  return points;
}

// A ball-nose finish of a wavy surface: rows of 200 mm to and fro, 0.3 mm apart, `noise` mm added.
std::vector<Point3> raster(std::size_t count, double noise) {
  constexpr double kRow = 200;
  constexpr double kStep = 0.25;
  std::mt19937 random(1);
  std::normal_distribution<double> normal(0, noise);
  const auto height = [](double x, double y) {
    return 3 * std::sin(x / 6) * std::cos(y / 9) + 0.8 * std::sin(x / 2.3 + y / 5);
  };
  std::vector<Point3> points;
  for (int row = 0; points.size() < count; ++row) {
    const double y = 0.3 * row;
    for (double s = 0; s <= kRow && points.size() < count; s += kStep) {
      const double x = row % 2 == 0 ? s : kRow - s;
      const double z = height(x, y) + (noise > 0 ? normal(random) : 0);
      points.push_back(printed(Point3(x, y, z)));
    }
  }
  return points;
}

// Teeth with corners and short arcs between them: something to do everywhere.
std::vector<Point3> teeth(std::size_t count) {
  std::vector<Point3> points;
  for (int tooth = 0; points.size() < count; ++tooth) {
    const double x = 6.0 * tooth;
    for (int i = 0; i <= 12; ++i) {
      const double a = std::numbers::pi * i / 12;
      points.push_back(printed(Point3(x + 1.5 - 1.5 * std::cos(a), 1.5 * std::sin(a), 0)));
    }
    points.push_back(printed(Point3(x + 3, 2, 0)));
    points.push_back(printed(Point3(x + 5, 2, 0.5)));
    points.push_back(printed(Point3(x + 5, 0, 0)));
  }
  return points;
}

void report(std::string_view name, const std::vector<std::vector<Point3>>& runs, double tolerance) {
  geometry::FairOptions options;
  options.tolerance = tolerance;
  options.feed = 3000;
  std::size_t points = 0;
  std::size_t controls = 0;
  int rounds = 0;
  double worst = 0;
  const std::clock_t start = std::clock();
  for (const auto& run : runs) {
    const auto path = geometry::fair_path(run, options);
    points += run.size();
    if (!path) continue;
    controls += path->curve.control_points().size();
    rounds = std::max(rounds, path->rounds);
    worst = std::max(worst, path->deviation);
  }
  const double seconds = static_cast<double>(std::clock() - start) / CLOCKS_PER_SEC;
  const auto count = static_cast<double>(std::max<std::size_t>(points, 1));
  fmt::print("{:28} {:9} {:8.2f} {:6.3f} {:6.3f} {:2}\n", name, points, 1e6 * seconds / count,
             static_cast<double>(controls) / count, worst / tolerance, rounds);
}

// Chains of straight cutting moves of three points or more.
std::vector<std::vector<Point3>> runs_of(const gcode::SourceText& source) {
  gcode::Diagnostics found;
  const gcode::Program program = gcode::parse(source, found);
  const gcode::Interpretation meaning = gcode::interpret(program, {}, found);
  std::vector<std::vector<Point3>> runs(1);
  for (const gcode::Motion& motion : meaning.motions) {
    if (motion.kind != gcode::MotionKind::kLine) {
      if (!runs.back().empty()) runs.emplace_back();
      continue;
    }
    if (runs.back().empty()) runs.back().push_back(motion.piece.start());
    runs.back().push_back(motion.piece.end());
  }
  std::erase_if(runs, [](const auto& run) { return run.size() < 3; });
  return runs;
}

}  // namespace

int main(int argument_count, char** argument_words) {
  std::vector<std::size_t> counts;
  std::vector<std::string> files;
  double tolerance = 0.01;
  for (int i = 1; i < argument_count; ++i) {
    const std::string word = argument_words[i];
    if (word == "--tolerance" && i + 1 < argument_count) {
      tolerance = std::atof(argument_words[++i]);
    } else if (std::ranges::all_of(word, [](char c) { return c >= '0' && c <= '9'; })) {
      counts.push_back(std::stoul(word));
    } else {
      files.push_back(word);
    }
  }
  for (const std::string& file : files) {
    std::string error;
    const auto source = gcode::SourceText::map_file(file, error);
    if (!source) {
      fmt::print(stderr, "{}\n", error);
      return 1;
    }
    report(file.substr(file.rfind('/') + 1), runs_of(*source), tolerance);
  }
  if (counts.empty() && files.empty()) counts = {10000, 100000, 1000000};
  for (const std::size_t count : counts) {
    report("spiral", {spiral(count)}, tolerance);
    report("raster", {raster(count, 0)}, tolerance);
    report("raster with noise", {raster(count, 0.002)}, tolerance);
    report("teeth", {teeth(count)}, tolerance);
  }
  return 0;
}
