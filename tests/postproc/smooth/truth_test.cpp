// The path that was meant: programs made from a known surface, and how far from it what is written
// instead of them is.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>

#include "gcode/controls/built_in.h"
#include "geometry/fitting/fair/fair.h"
#include "postproc/smooth/methods/run_curve.h"
#include "tests/support/surface_programs.h"
#include "tests/support/wavy_programs.h"

namespace batten::postproc {
namespace {

using geometry::FinishSurface;
using geometry::kPlacesPerEdge;
using geometry::Point3;
using geometry::rms_of_cuts;
using geometry::rms_of_rows;
using geometry::surface_program;
using geometry::surface_rows;

geometry::SmoothCurve fair_row(const std::vector<Point3>& row, double tolerance, bool accurate) {
  geometry::FairOptions options;
  options.tolerance = tolerance;
  options.accurate = accurate;
  auto path = geometry::fair_path(row, options);
  EXPECT_TRUE(path);
  return *path;
}

// The distance from the surface at every 0.1 mm of x.
std::vector<double> offsets_along(const geometry::BsplineCurve& curve) {
  std::vector<double> offsets;
  double u = curve.first();
  for (int i = 1; i < 600; ++i) {
    for (int step = 0; step < 30; ++step) {
      u += (0.1 * i - curve.point_at(u).x()) / curve.derivative_at(u, 1).x();
      u = std::clamp(u, curve.first(), curve.last());
    }
    offsets.push_back(FinishSurface::distance(curve.point_at(u)));
  }
  return offsets;
}

double percentile_95(std::vector<double> values) {
  std::sort(values.begin(), values.end());
  return values[values.size() * 95 / 100];
}

struct CurveTruth {
  double rms = 0;         // mm from the surface
  double row_to_row = 0;  // mm, the difference between neighbouring rows, 95th percentile
};

CurveTruth curve_truth(const std::vector<std::vector<Point3>>& rows, double tolerance,
                       bool accurate) {
  geometry::SurfaceDistances fair;
  std::vector<double> differences;
  std::vector<double> last;
  for (const auto& row : rows) {
    const geometry::SmoothCurve path = fair_row(row, tolerance, accurate);
    for (std::size_t i = 0; i + 1 < row.size(); ++i) {
      const double u = path.vertex_parameters[i];
      const double width = path.vertex_parameters[i + 1] - u;
      for (int k = 0; k < kPlacesPerEdge; ++k) {
        fair.add(
            FinishSurface::distance(path.curve.point_at(u + (k + 0.5) / kPlacesPerEdge * width)),
            (row[i + 1] - row[i]).norm() / kPlacesPerEdge);
      }
    }
    const std::vector<double> offsets = offsets_along(path.curve);
    for (std::size_t i = 0; i < last.size(); ++i) {
      differences.push_back(std::abs(offsets[i] - last[i]));
    }
    last = offsets;
  }
  return {fair.rms(), percentile_95(differences)};
}

// Of noise; more with BATTEN_TRUTH_SEEDS=6.
unsigned seeds_to_try() {
  const char* given = std::getenv("BATTEN_TRUTH_SEEDS");
  return given == nullptr ? 2 : static_cast<unsigned>(std::atoi(given));
}

class Truth : public testing::TestWithParam<double> {};

// A coordinate of three decimals is off by 0.0003 mm (rms) of itself, which is a fifth of the
// chords' error at a CAM tolerance of 0.002 mm: there the curve has to be nearer to the surface
// than the printed places that it is made from.
TEST_P(Truth, OfTheCurveIsFiveTimesNearerThanThatOfTheChords) {
  const double cam = GetParam();
  const auto rows = surface_rows(cam);
  for (const bool accurate : {false, true}) {
    const CurveTruth found = curve_truth(rows, 2 * cam, accurate);
    fmt::print("CAM tolerance {}{}: rms chords {:.6f}, curve {:.6f} mm; row to row, 95 %: {:.6f}\n",
               cam, accurate ? ", accurate" : "", rms_of_rows(rows), found.rms, found.row_to_row);
    EXPECT_LE(found.rms, rms_of_rows(rows) / 5);
    EXPECT_LE(found.row_to_row, 0.001);
  }
}

constexpr double kNoise = 0.02;  // mm, the most that vertices are moved

// Noise of 0.02 mm is up to ten times the CAM tolerance and five times the user's: the band about
// the noisy vertices does not even hold the surface. What is possible inside it is nearer to the
// surface than the vertices were.
TEST_P(Truth, OfTheCurveThroughNoiseIsNearerThanThatOfTheNoisyChords) {
  const double cam = GetParam();
  for (unsigned seed = 1; seed <= seeds_to_try(); ++seed) {
    SCOPED_TRACE(testing::Message() << "seed " << seed);
    const auto rows = surface_rows(cam, kNoise, seed);
    const CurveTruth found = curve_truth(rows, 2 * cam, false);
    fmt::print("CAM tolerance {}, noise 0.02, seed {}: rms chords {:.6f}, curve {:.6f} mm\n", cam,
               seed, rms_of_rows(rows), found.rms);
    EXPECT_LT(found.rms, rms_of_rows(rows));
    // Who asks for accuracy does not get the noise itself.
    EXPECT_LT(curve_truth(rows, 2 * cam, true).rms, 1.05 * found.rms);
  }
}

// Without the last chord, which is what was left of the row.
double shortest_edge(const std::vector<Point3>& row) {
  double shortest = HUGE_VAL;
  for (std::size_t i = 1; i + 1 < row.size(); ++i) {
    shortest = std::min(shortest, (row[i] - row[i - 1]).norm());
  }
  return shortest;
}

// Vertices up, down and up again by the noise, less what the tolerance gives back, lie on a circle
// of curvature 4 (noise - tolerance) / edge^2; and the surface bends by 3 / 36 + 0.8 / 2.3^2 at the
// most. A curve that sweeps from one such vertex to the next bends up to three times as hard in
// places; one with corners at noisy vertices did so a hundred times.
TEST_P(Truth, OfTheCurveThroughNoiseHasNoCorners) {
  const double tolerance = 2 * GetParam();
  for (unsigned seed = 1; seed <= seeds_to_try(); ++seed) {
    SCOPED_TRACE(testing::Message() << "seed " << seed);
    for (const auto& row : surface_rows(GetParam(), kNoise, seed)) {
      const geometry::SmoothCurve path = fair_row(row, tolerance, false);
      const double edge = shortest_edge(row);
      const double of_noise = 4 * std::max(0.0, kNoise - tolerance) / (edge * edge);
      const double of_surface = 3.0 / 36 + 0.8 / (2.3 * 2.3);
      const double end = path.vertex_parameters[row.size() - 3];
      EXPECT_LE(CurvatureProfile(path.curve.part(path.curve.first(), end)).greatest(),
                3 * (of_noise + of_surface));
      EXPECT_EQ(path.kept_corners, 0);
    }
  }
}

INSTANTIATE_TEST_SUITE_P(Surface, Truth, testing::Values(0.002, 0.005, 0.01));

// --- as written --------------------------------------------------------------------------------

// Of what is written in place of rows without noise: no farther from the surface than the chords
// were, whatever the control, and far nearer where that is asked for or the form is a curve. Three
// decimals are a fifth of the least tolerance here, and the chords that grbl makes of arcs half of
// it. Times within a period of the control for each run are the same.
TEST_P(Truth, OfWhatIsWrittenIsNearerThanThatOfTheChords) {
  struct Written {
    const char* target;
    Form output;
    Prefer prefer;
    double part;  // of the distance before, at most
  };
  const double cam = GetParam();
  const std::string before = surface_program(surface_rows(cam), 2000);
  const double rms_before = rms_of_cuts(before);
  for (const auto& [target, output, prefer, part] :
       {Written{"linuxcnc", Form::kAuto, Prefer::kTime, 1},
        {"grbl", Form::kAuto, Prefer::kTime, 1},
        {"fanuc", Form::kAuto, Prefer::kTime, 1},
        {"siemens", Form::kAuto, Prefer::kTime, 1. / 3},
        {"siemens", Form::kAuto, Prefer::kAccuracy, 1. / 4},
        {"linuxcnc", Form::kLines, Prefer::kAccuracy, 1. / 3},
        {"grbl", Form::kAuto, Prefer::kAccuracy, cam < 0.003 ? 1 : 0.35},
        {"fanuc", Form::kAuto, Prefer::kAccuracy, 0.8}}) {
    SCOPED_TRACE(testing::Message() << target << ", " << name_of(prefer));
    SmoothOptions options = options_for(target);
    options.tolerance_mm = 2 * cam;
    options.output = output;
    options.prefer = prefer;
    const SmoothResult result = smoothed(before, options);
    EXPECT_TRUE(result.proved);
    const double rms_after = rms_of_cuts(result.text, target);
    fmt::print("CAM tolerance {}, {}, {}: rms {:.6f} -> {:.6f} mm, blocks {} -> {}\n", cam, target,
               name_of(prefer), rms_before, rms_after, result.blocks_in, result.blocks_out);
    EXPECT_LE(rms_after, part * rms_before);
    const double same = options.machine->servo_period * static_cast<double>(rewritten_runs(result));
    EXPECT_LE(result.runs_after_s, result.runs_before_s + same);
    const double most = prefer == Prefer::kAccuracy ? 1.5 : 1;
    EXPECT_LE(static_cast<double>(result.blocks_out), most * static_cast<double>(result.blocks_in));
  }
}

// Rows that a machine with limits on acceleration and jerk cannot run at their feed for noise: it
// nearly stops at each vertex. In the narrowest band some rows keep them, for all that their lines
// and arcs win.
void expect_faster_and_nearer(double cam, double feed) {
  const bool narrow = cam < 0.003;
  const std::size_t rows = narrow ? 5 : geometry::kSurfaceRows;
  for (unsigned seed = 1; seed <= seeds_to_try(); ++seed) {
    SCOPED_TRACE(testing::Message() << "seed " << seed);
    const std::string before = surface_program(surface_rows(cam, kNoise, seed), feed);
    SmoothOptions options = options_for("fanuc");
    options.machine = find_machine("high-speed");
    options.tolerance_mm = 2 * cam;
    const SmoothResult result = smoothed(before, options);
    EXPECT_TRUE(result.proved);
    EXPECT_GE(rewritten_runs(result), rows);
    const double rms_before = rms_of_cuts(before);
    const double rms_after = rms_of_cuts(result.text);
    fmt::print(
        "CAM tolerance {}, noise 0.02, F{}, seed {}: rms {:.6f} -> {:.6f} mm, time {:.3f} -> "
        "{:.3f} s\n",
        cam, feed, seed, rms_before, rms_after, result.runs_before_s, result.runs_after_s);
    EXPECT_LT(result.runs_after_s, (narrow ? 0.9 : 0.5) * result.runs_before_s);
    EXPECT_LT(rms_after, rms_before);
  }
}

TEST_P(Truth, OfNoisyRowsIsCutNearerAndFasterAtAFinishingFeed) {
  expect_faster_and_nearer(GetParam(), 3000);
}

TEST_P(Truth, OfNoisyRowsIsCutNearerAndFasterAtAHighFeed) {
  expect_faster_and_nearer(GetParam(), 6000);
}

// At a feed that noise does not let the machine hold, on a control that rounds corners itself, with
// six times the CAM tolerance to spend: in less time, and a fifth nearer to the surface than the
// noisy chords.
TEST(NoisyTruth, IsCutFasterAndNearer) {
  for (unsigned seed = 1; seed <= seeds_to_try(); ++seed) {
    SCOPED_TRACE(testing::Message() << "seed " << seed);
    const std::string before = surface_program(surface_rows(0.005, kNoise, seed), 10000);
    SmoothOptions options = options_for("linuxcnc");
    options.tolerance_mm = 0.03;
    const SmoothResult result = smoothed(before, options);
    EXPECT_TRUE(result.proved);
    EXPECT_EQ(rewritten_runs(result), static_cast<std::size_t>(geometry::kSurfaceRows));
    const double rms_before = rms_of_cuts(before);
    const double rms_after = rms_of_cuts(result.text);
    fmt::print("noise 0.02, seed {}: rms {:.6f} -> {:.6f} mm, time {:.3f} -> {:.3f} s\n", seed,
               rms_before, rms_after, result.runs_before_s, result.runs_after_s);
    EXPECT_LT(result.runs_after_s, 0.95 * result.runs_before_s);
    EXPECT_LT(rms_after, 0.8 * rms_before);
  }
}

// Rows over a hill as lines, 3 decimals, of chords as high as this.
std::string hill_rows(double height, int count) {
  const auto z = [](double x, double y) {
    return 4 * std::exp(-((x - 30) * (x - 30) + (y - 3) * (y - 3)) / 60) + 0.5 * std::cos(x / 3);
  };
  std::string text = "G21 G90 G17\nG0 X0 Y0 Z30\n";
  for (int row = 0; row < count; ++row) {
    const double y = 0.35 * row;
    text += fmt::format("G0 X0 Y{:.3f}\nG1 Z{:.3f} F3000\n", y, z(0, y));
    for (double x = 0; x < 60;) {
      const auto is_high = [&](double step) {
        const double middle = z(x + step / 2, y) - 0.5 * (z(x, y) + z(x + step, y));
        return std::abs(middle) > height * std::hypot(1, (z(x + step, y) - z(x, y)) / step);
      };
      double step = 0.1;
      while (step < 2.5 && !is_high(step)) step += 0.01;
      x = std::min(60.0, x + step);
      text += fmt::format("X{:.3f} Z{:.3f}\n", x, z(x, y));
    }
    text += "G0 Z30\n";
  }
  return text + "M2\n";
}

// Lines in as many blocks as the program's that lie half as far off: with four decimals where the
// program has three they would be larger, and stay unwritten.
// Where chords are higher than the tolerance, vertices are moved by all of it but what rounding to
// so few decimals takes.
TEST(HillRows, OfAsManyLinesKeepTheirDecimals) {
  for (const double height : {0.005, 0.0125}) {
    SCOPED_TRACE(height);
    const std::string before = hill_rows(height, 8);
    SmoothOptions options = options_for("linuxcnc");
    options.machine = find_machine("linuxcnc");
    options.tolerance_mm = 0.01;
    const SmoothResult result = smoothed(before, options);
    EXPECT_TRUE(result.proved);
    EXPECT_EQ(rewritten_runs(result), 8U);
    EXPECT_LE(result.text.size(), before.size() + 40) << "no more than the comment";
    EXPECT_LE(result.path_after.distance_mm, 0.6 * result.path_before.distance_mm);
  }
}

// Whoever asks for accuracy gets nothing that is farther off than what is fastest.
TEST(HillRows, AreNoFartherByAccuracyThanByTime) {
  for (const double height : {0.002, 0.005, 0.0125}) {
    for (const char* target : {"linuxcnc", "grbl", "fanuc"}) {
      SCOPED_TRACE(testing::Message() << target << ' ' << height);
      const auto distance_by = [&](Prefer prefer) {
        SmoothOptions options = options_for(target);
        options.prefer = prefer;
        options.tolerance_mm = 0.01;
        const SmoothResult result = smoothed(hill_rows(height, 3), options);
        EXPECT_TRUE(result.proved);
        return result.path_after.distance_mm;
      };
      EXPECT_LE(distance_by(Prefer::kAccuracy), 1.001 * distance_by(Prefer::kTime));
    }
  }
}

}  // namespace
}  // namespace batten::postproc
