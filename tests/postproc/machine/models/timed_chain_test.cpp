// What a chain keeps from one question to the next changes no answer.
#include "postproc/machine/models/cycle_time.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>
#include <vector>

namespace batten::postproc {
namespace {

using gcode::PathMode;
using geometry::Line;
using geometry::Point3;

std::vector<TimedPiece> wandering(unsigned seed) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<double> turn(-0.8, 0.8);
  std::uniform_real_distribution<double> length(0.02, 2);
  std::vector<TimedPiece> chain;
  Point3 at = Point3::Zero();
  double angle = 0;
  for (int i = 0; i < 200; ++i) {
    angle += turn(random);
    const double way = i % 17 == 0 ? 0 : length(random);
    const Point3 next = at + way * Point3(std::cos(angle), std::sin(angle), 0.1);
    TimedPiece piece{Line{at, next}, i % 50 < 40 ? 3000.0 : 0.0};
    piece.bytes = 12;
    chain.push_back(piece);
    at = next;
  }
  return chain;
}

TEST(TimedChain, GivesTheTimesOfCuttingTime) {
  for (const char* name : {"linuxcnc", "router", "grbl"}) {
    const Machine& machine = *find_machine(name);
    Machine unmerged = machine;
    unmerged.naive_cam_tolerance = 0;
    for (unsigned seed = 0; seed < 5; ++seed) {
      SCOPED_TRACE(testing::Message() << name << " " << seed);
      const std::vector<TimedPiece> pieces = wandering(seed);
      TimedChain chain(pieces, machine);
      for (const PathMode path : {PathMode::kBlending, PathMode::kExactPath}) {
        EXPECT_EQ(chain.time(machine, path), cutting_time(pieces, machine, path));
        EXPECT_EQ(chain.time(unmerged, path), cutting_time(pieces, unmerged, path));
        EXPECT_EQ(chain.time(machine, path, ChainEnd::kEndOfMotion),
                  cutting_time(pieces, machine, path, ChainEnd::kEndOfMotion));
      }
      std::vector<TimedPiece> unlimited = pieces;
      for (TimedPiece& piece : unlimited) piece.feed = 0;
      chain.lift_feeds(machine);
      EXPECT_EQ(chain.time(machine, PathMode::kBlending),
                cutting_time(unlimited, machine, PathMode::kBlending));
    }
  }
}

}  // namespace
}  // namespace batten::postproc
