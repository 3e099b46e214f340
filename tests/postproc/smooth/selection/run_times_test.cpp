// What a run takes where it stands, and what moves with smaller kinks could take less.
#include "postproc/smooth/selection/run_times.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <vector>

#include "tests/support/one_run.h"

namespace batten::postproc {
namespace {

// So many equal chords of half a circle.
std::vector<TimedPiece> chords_of(int chords, double radius, double feed) {
  std::vector<TimedPiece> moves;
  const auto at = [&](int i) {
    const double angle = std::numbers::pi * i / chords;
    return geometry::Point3(radius * std::cos(angle), radius * std::sin(angle), 0);
  };
  for (int i = 0; i < chords; ++i) {
    moves.push_back({geometry::Line{at(i), at(i + 1)}, feed});
  }
  return moves;
}

class LessKinks : public testing::Test {
 protected:
  RunTimes times_on(const char* machine) {
    machine_ = *find_machine(machine);
    return {context_, machine_};
  }

  OneRun run_{circle_program(100)};
  RunContext context_ = run_.context();
  Machine machine_;
};

// Twice as many chords have half the kinks, and are shorter, which makes nothing quicker: chords
// that take longer than two block periods, as plan_lines makes them. Times are good to a percent.
TEST_F(LessKinks, TakeNoMoreThanIsSaidOfThem) {
  const RunTimes times = times_on("linuxcnc");
  int said = 0;
  for (const double radius : {2.0, 10.0, 50.0}) {
    for (const int chords : {20, 60, 200}) {
      for (const int times_less : {2, 3, 5}) {
        SCOPED_TRACE(testing::Message() << chords << " chords of radius " << radius << ", "
                                        << times_less << " times less");
        const int more = times_less * chords;
        const double finer_chord = std::numbers::pi * radius / more;
        const double feed = std::min(12000.0, 60 * finer_chord / (2 * machine_.block_period));
        const auto moves = chords_of(chords, radius, feed);
        const Times finer = times_of(chords_of(more, radius, feed), machine_, context_.after.path);
        const double as_set = times.as_set_with_less_kinks(moves, times_less);
        const double exact_path = times.exact_path_with_less_kinks(moves, times_less);
        EXPECT_LE(as_set, 1.01 * finer.as_set);
        EXPECT_LE(exact_path, 1.01 * finer.exact_path);
        if (as_set > 0.5 * finer.as_set && exact_path > 0.5 * finer.exact_path) ++said;
      }
    }
  }
  EXPECT_GE(said, 5) << "what says nearly nothing is of no use";
}

TEST_F(LessKinks, AreNotKnownOnOtherControls) {
  const RunTimes times = times_on("grbl");
  const auto moves = chords_of(60, 10, 3000);
  EXPECT_EQ(times.as_set_with_less_kinks(moves, 2), 0);
  EXPECT_EQ(times.exact_path_with_less_kinks(moves, 2), 0);
}

}  // namespace
}  // namespace batten::postproc
