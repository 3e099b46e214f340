// What noise costs and what is left of it: finishing rows of a known surface, +-0.02 mm added to
// their vertices, smoothed at twice the CAM tolerance.
//   noisy_surface [--seeds N] [--noise MM] [--feed MM_PER_MIN]
//
// First table: per CAM tolerance and seed, rms distance from the surface of the chords and of the
// fair curve, the greatest and rms curvature of both (of the chords by the circle through three
// vertices), corners that were kept, and the time of the jerk-limited planner on the limits of the
// built-in machine "high-speed". Second table: of the programs, for each machine, the seconds
// before and after, runs that were rewritten, blocks and rms. Third table: what the need of the
// machine gains at twice the feed, as the curve's own limits on speed tell it and as the quick
// planner does, on rows with and without noise.
#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <string>
#include <string_view>
#include <vector>

#include "gcode/controls/built_in.h"
#include "geometry/fitting/fair/fair_measure.h"
#include "geometry/path/joined_curve.h"
#include "postproc/machine/planner/feed_plan.h"
#include "postproc/smooth/methods/run_curve.h"
#include "postproc/stream/pipeline.h"
#include "tests/support/machine_limits.h"
#include "tests/support/paths.h"
#include "tests/support/sampled_motion.h"
#include "tests/support/surface_programs.h"

namespace {

using namespace batten;
using geometry::Point3;
using Rows = std::vector<std::vector<Point3>>;

struct Settings {
  unsigned seeds = 6;
  double noise = 0.02;  // mm
  double feed = 6000;   // mm/min
};

geometry::SmoothCurve fair_of(const std::vector<Point3>& row, double tolerance,
                              const postproc::Machine& machine, double feed) {
  postproc::CurveRequest request;
  request.tolerance = tolerance;
  request.limits = postproc::limits_of(machine, feed);
  request.jerk = machine.max_jerk();
  return *postproc::fair_curve(row, request);
}

struct CurveFigures {
  double rms = 0;
  double most = 0;  // curvature
  double mean = 0;  // rms of it
  double time = 0;
  int corners = 0;
  int rounds = 0;
  std::size_t points = 0;
};

CurveFigures figures_of(const Rows& rows, double tolerance, const postproc::Machine& machine,
                        double feed) {
  CurveFigures f;
  geometry::SurfaceDistances off;
  double squares = 0;
  double length = 0;
  const auto limits = postproc::path_limits_of(machine, feed / 60);
  for (const auto& row : rows) {
    const geometry::SmoothCurve path = fair_of(row, tolerance, machine, feed);
    geometry::SplineWalk walk(path.curve.basis().knots(), path.curve.control_points());
    constexpr int kSteps = 20000;
    const double step = (path.curve.last() - path.curve.first()) / kSteps;
    for (int k = 0; k < kSteps; ++k) {
      const double u = path.curve.first() + (k + 0.5) * step;
      const double bend = walk.curvature_at(u);
      off.add(geometry::FinishSurface::distance(walk.point_at(u)), step);
      squares += bend * bend * step;
      length += step;
      f.most = std::max(f.most, bend);
    }
    f.time += postproc::planned_time(geometry::beziers_of(path.curve), limits);
    f.corners += path.kept_corners;
    f.rounds += path.rounds;
    f.points += path.curve.control_points().size();
  }
  f.rms = off.rms();
  f.mean = std::sqrt(squares / length);
  return f;
}

void curves(double cam, const Settings& settings) {
  const postproc::Machine& machine = *postproc::find_machine("high-speed");
  const auto limits = postproc::path_limits_of(machine, settings.feed / 60);
  for (unsigned seed = 1; seed <= settings.seeds; ++seed) {
    const Rows rows = geometry::surface_rows(cam, settings.noise, seed);
    double most = 0;
    double time = 0;
    std::size_t points = 0;
    for (const auto& row : rows) {
      most = std::max(most, postproc::greatest_curvature(row));
      time += postproc::planned_time(geometry::path_through(row), limits);
      points += row.size();
    }
    const CurveFigures f = figures_of(rows, 2 * cam, machine, settings.feed);
    fmt::print(
        "{:<6} {:>4} | {:.5f} {:.5f} | {:>7.3f} {:>7.3f} {:>7.3f} {:>4} {:>4} | {:>7.3f} "
        "{:>7.3f} | {:>5} {:>5}\n",
        cam, seed, geometry::rms_of_rows(rows), f.rms, most, f.most, f.mean, f.corners, f.rounds,
        time, f.time, points, f.points);
  }
}

void programs(double cam, std::string_view machine, postproc::Prefer prefer,
              const Settings& settings) {
  for (unsigned seed = 1; seed <= settings.seeds; ++seed) {
    const std::string text =
        geometry::surface_program(geometry::surface_rows(cam, settings.noise, seed), settings.feed);
    postproc::SmoothOptions options;
    options.target = gcode::find_control(machine == "router" || machine == "grbl" ? "grbl"
                                         : machine == "linuxcnc-fast"             ? "linuxcnc"
                                                                                  : "fanuc");
    options.machine = postproc::find_machine(machine);
    options.threads = 1;
    options.decimals = gcode::Decimals{};
    options.tolerance_mm = 2 * cam;
    options.prefer = prefer;
    const auto result = postproc::smooth_program(gcode::SourceText("rows.nc", text), options);
    int rewritten = 0;
    std::string reasons;
    for (const auto& run : result.runs) {
      if (run.status == postproc::RunStatus::kRewritten) ++rewritten;
      if (!run.reason.empty()) reasons = run.reason;
    }
    fmt::print(
        "{:<6} {:<10} {:<8} {:>4} | {:>8.3f} {:>8.3f} {:>6.1f} % | {} {:<8} | {:>5} {:>5} | "
        "{:.5f} {:.5f}\n",
        cam, machine, name_of(prefer), seed, result.runs_before_s, result.runs_after_s,
        100 * (result.runs_after_s / result.runs_before_s - 1), rewritten, reasons,
        result.blocks_in, result.blocks_out, geometry::rms_of_cuts(text),
        geometry::rms_of_cuts(result.text));
  }
}

// Seconds along a curve at the speed that its places allow if it is held there.
double time_by_places(const geometry::BsplineCurve& curve, const geometry::TravelLimits& limits) {
  geometry::SplineWalk walk(curve.basis().knots(), curve.control_points());
  constexpr int kSteps = 20000;
  const double step = (curve.last() - curve.first()) / kSteps;
  double time = 0;
  Point3 before = walk.point_at(curve.first());
  for (int k = 0; k < kSteps; ++k) {
    const double speed = geometry::speed_at(walk, curve.first() + (k + 0.5) * step, limits);
    const Point3 here = walk.point_at(curve.first() + (k + 1) * step);
    time += (here - before).norm() / speed;
    before = here;
  }
  return time;
}

void needs(double cam, double noise, const Settings& settings) {
  const postproc::Machine& machine = *postproc::find_machine("high-speed");
  const double feed = 2 * settings.feed;
  const auto planner = postproc::path_limits_of(machine, feed / 60);
  const geometry::TravelLimits limits{feed / 60, machine.max_acceleration(), machine.max_jerk()};
  double places[2] = {0, 0};
  double planned[2] = {0, 0};
  for (const auto& row : geometry::surface_rows(cam, noise, 1)) {
    for (const int needy : {0, 1}) {
      const auto path = fair_of(row, 2 * cam, machine, needy == 1 ? feed : 60);
      places[needy] += time_by_places(path.curve, limits);
      planned[needy] += postproc::planned_time(geometry::beziers_of(path.curve), planner);
    }
  }
  fmt::print("{:<6} {:<5} | {:>7.3f} {:>7.3f} {:>5.1f} % | {:>7.3f} {:>7.3f} {:>5.1f} %\n", cam,
             noise, places[0], places[1], 100 * (1 - places[1] / places[0]), planned[0], planned[1],
             100 * (1 - planned[1] / planned[0]));
}

Settings settings_of(int count, char** arguments) {
  Settings settings;
  for (int i = 1; i + 1 < count; i += 2) {
    const std::string_view name = arguments[i];
    const char* value = arguments[i + 1];
    if (name == "--seeds") settings.seeds = static_cast<unsigned>(std::atoi(value));
    if (name == "--noise") settings.noise = std::atof(value);
    if (name == "--feed") settings.feed = std::atof(value);
  }
  return settings;
}

}  // namespace

int main(int count, char** arguments) {
  const Settings settings = settings_of(count, arguments);
  constexpr double kCamTolerances[] = {0.002, 0.005, 0.01};
  fmt::print(
      "CAM    seed | rms: chords, curve | curvature: chords, curve, rms; corners, rounds | "
      "planned: chords, curve | points\n");
  for (const double cam : kCamTolerances) curves(cam, settings);
  fmt::print(
      "\nCAM    machine    prefer   seed | seconds: before, after | runs rewritten | "
      "blocks | rms: before, after\n");
  for (const std::string_view machine : {"linuxcnc-fast", "high-speed", "mill", "router"}) {
    for (const double cam : kCamTolerances) {
      programs(cam, machine, postproc::Prefer::kTime, settings);
    }
  }
  for (const double cam : kCamTolerances) {
    programs(cam, "linuxcnc-fast", postproc::Prefer::kAccuracy, settings);
  }
  fmt::print("\nCAM    noise | by places: without need, with, gain | by the planner: the same\n");
  for (const double noise : {0.0, settings.noise}) {
    for (const double cam : kCamTolerances) needs(cam, noise, settings);
  }
}
