// What a feed plan costs, and the models of controls by which `smooth`
// chooses between forms: processor time on ever longer paths of each kind.
//   feed_plan_cost [most pieces]        1000000 unless given; the plan stops at a hundredth of it
#include <fmt/format.h>

#include <cmath>
#include <cstdlib>
#include <ctime>
#include <string_view>
#include <vector>

#include "geometry/path/bspline_curve.h"
#include "geometry/path/joined_curve.h"
#include "geometry/path/path.h"
#include "postproc/machine/models/cycle_time.h"
#include "postproc/machine/planner/feed_plan.h"
#include "tests/support/feed_rows.h"
#include "tests/support/sampled_motion.h"

namespace {

using namespace batten;
using geometry::BsplineCurve;
using geometry::Path;
using geometry::Point3;
using geometry::Vector3;

Path chords(int pieces) { return postproc::row_of_chords(0.2 * pieces, 0.2); }
Path row(int pieces) { return geometry::beziers_of(postproc::row_as_curve(0.5 * pieces, 0.5)); }

// Bends of all sizes, each piece as long as a bend: the most expensive kind.
Path wave(int pieces) {
  std::vector<Point3> control;
  std::vector<double> knots;
  for (int i = -1; i < pieces + 2; ++i) {
    control.emplace_back(2 * i, 4 * std::sin(0.7 * i) + std::sin(2.3 * i), std::sin(1.1 * i));
    if (i >= 0 && i <= pieces) knots.push_back(i);
  }
  return geometry::beziers_of({geometry::BsplineBasis::clamped(3, knots), control});
}

// Left and right in turn, tangent, radii from 1 to 4 mm.
Path arcs(int pieces) {
  Path path;
  Point3 at = Point3::Zero();
  double angle = 0;
  for (int i = 0; i < pieces; ++i) {
    const double side = i % 2 == 0 ? 1 : -1;
    const double radius = 2.5 + 1.5 * std::sin(1.7 * i);
    const double sweep = side * (0.8 + 0.4 * std::cos(0.9 * i));
    const Point3 center = at + side * radius * Vector3(-std::sin(angle), std::cos(angle), 0);
    angle += sweep;
    const Point3 end = center - side * radius * Vector3(-std::sin(angle), std::cos(angle), 0);
    path.emplace_back(geometry::Arc{at, end, center, {0, 0, 1}, sweep});
    at = end;
  }
  return path;
}

struct Kind {
  std::string_view name;
  Path (*make)(int pieces);
};

constexpr Kind kKinds[] = {{"chords of .2 mm", chords},
                           {"row, curve pieces of .5 mm", row},
                           {"wave, curve pieces of 2 mm", wave},
                           {"arcs", arcs}};

template <typename Run>
double seconds_of(const Run& run) {
  const std::clock_t start = std::clock();
  run();
  return static_cast<double>(std::clock() - start) / CLOCKS_PER_SEC;
}

// The pieces per second of each control's model, on what programs are made of.
void print_controls(int most) {
  fmt::print("{:28} {:>8} {:>14} {:>14} {:>14}  pieces/s\n", "path", "pieces", "linuxcnc-fast",
             "grbl", "high-speed");
  for (const Kind& kind : {kKinds[0], kKinds[3]}) {
    for (int pieces = 1000; pieces <= most; pieces *= 10) {
      std::vector<postproc::TimedPiece> chain;
      for (const geometry::PathPiece& piece : kind.make(pieces)) chain.push_back({piece, 6000});
      fmt::print("{:28} {:8}", kind.name, pieces);
      for (const std::string_view name : {"linuxcnc-fast", "grbl", "high-speed"}) {
        const postproc::Machine& machine = *postproc::find_machine(name);
        const int times = std::max(1, 20000 / pieces);
        const double seconds = seconds_of([&] {
          for (int i = 0; i < times; ++i) {
            (void)postproc::cutting_time(chain, machine, gcode::PathMode::kBlending);
          }
        });
        fmt::print(" {:14.0f}", pieces * times / seconds);
      }
      fmt::print("\n");
    }
  }
}

}  // namespace

int main(int argc, char** argv) {
  const int most = argc > 1 ? std::atoi(argv[1]) : 1000000;
  print_controls(most);
  const auto limits = postproc::even_limits(100, 3000, 50000);
  fmt::print("{:28} {:>8} {:>10} {:>10} {:>11}\n", "path", "pieces", "plan", "pieces/s",
             "nodes/piece");
  for (const Kind& kind : kKinds) {
    for (int pieces = 100; pieces <= most / 100; pieces *= 10) {
      const Path path = kind.make(pieces);
      postproc::FeedPlan plan;
      const double seconds = seconds_of([&] { plan = postproc::plan_feed(path, limits); });
      fmt::print("{:28} {:8} {:8.1f}ms {:10.0f} {:11.1f}\n", kind.name, pieces, 1e3 * seconds,
                 pieces / seconds, static_cast<double>(plan.nodes.size()) / pieces);
    }
  }
}
