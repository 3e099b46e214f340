// Controls cut arcs into chords of their own: what new arcs are run like, beside those of the
// program.
#include <gtest/gtest.h>

#include <cmath>

#include "gcode/controls/arc_rules.h"
#include "tests/support/wavy_programs.h"

namespace batten::postproc {
namespace {

using geometry::Arc;
using geometry::Point3;

// Along a noisy wave, arcs through every second of its points: they meet at small angles.
std::string arcs_along_a_wave(double step) {
  const auto place = [](double x) {
    constexpr double kNoise = 0.002;
    return Point3(x, 4 * std::sin(x / 7) + kNoise * std::sin(1000 * x), 0);
  };
  std::string text = "G21 G90 G17\nG0 X0 Y0 Z5\nG1 Z-1 F300\n";
  constexpr double kEnd = 80;
  for (double x = 0; x + 2 * step < kEnd; x += 2 * step) {
    const Point3 a = place(x);
    const Point3 b = place(x + step);
    const Point3 c = place(x + 2 * step);
    const double turn = (b - a).cross(c - b).z();
    const double d =
        2 * (a.x() * (b.y() - c.y()) + b.x() * (c.y() - a.y()) + c.x() * (a.y() - b.y()));
    if (std::abs(turn) < 1e-4) {
      text += fmt::format("G1 X{:.3f} Y{:.3f} F2000\n", c.x(), c.y());
      continue;
    }
    const double aa = a.squaredNorm();
    const double bb = b.squaredNorm();
    const double cc = c.squaredNorm();
    const double i = (aa * (b.y() - c.y()) + bb * (c.y() - a.y()) + cc * (a.y() - b.y())) / d;
    const double j = (aa * (c.x() - b.x()) + bb * (a.x() - c.x()) + cc * (b.x() - a.x())) / d;
    text +=
        fmt::format("G{} X{:.3f} Y{:.3f} I{:.3f} J{:.3f} F2000\n", turn < 0 ? 2 : 3, c.x(), c.y(),
                    i - std::round(1000 * a.x()) / 1000, j - std::round(1000 * a.y()) / 1000);
  }
  return text + "G0 Z5\nM2\n";
}

std::vector<Arc> arcs_of(const std::string& text) {
  const ReadText read(text);
  std::vector<Arc> arcs;
  for (const gcode::Motion& motion : read.meaning.motions) {
    if (const Arc* arc = motion.piece.arc()) arcs.push_back(*arc);
  }
  return arcs;
}

double distance_to(const Arc& arc, const Point3& point) {
  constexpr int kParts = 60;
  double nearest = 1e9;
  for (int i = 0; i <= kParts; ++i) {
    nearest = std::min(nearest,
                       (geometry::point_at(arc, static_cast<double>(i) / kParts) - point).norm());
  }
  return nearest;
}

// The greatest error of the old arcs that are beside this one, or meet those in their ends.
double error_there(const std::vector<Arc>& old, const Arc& arc, const gcode::ArcChords& chords) {
  constexpr double kBeside = 0.1;
  double greatest = 0;
  for (const double t : {0.0, 0.25, 0.5, 0.75, 1.0}) {
    const Point3 place = geometry::point_at(arc, t);
    for (const Arc& other : old) {
      if (distance_to(other, place) > kBeside) continue;
      greatest = std::max(greatest, gcode::chord_error(chords, other));
    }
  }
  return greatest;
}

class OwnChordsOf : public testing::TestWithParam<const char*> {};

TEST_P(OwnChordsOf, NewArcsLeaveThemNoFurtherThanThoseThatTheyReplace) {
  const std::string before = arcs_along_a_wave(0.35);
  SmoothOptions options = options_for(GetParam());
  options.output = Form::kArcs;
  options.prefer = Prefer::kSize;
  const SmoothResult result = smoothed(before, options);
  ASSERT_EQ(rewritten_runs(result), 1U);
  const gcode::ArcChords& chords = options.target->chords;
  const double usual = gcode::usual_chord_error(chords);
  const std::vector<Arc> old = arcs_of(before);
  const std::vector<Arc> now = arcs_of(result.text);
  EXPECT_GE(now.size(), 20U);
  for (const Arc& arc : now) {
    const double most = std::max(std::isfinite(usual) ? usual : 0, error_there(old, arc, chords));
    EXPECT_LE(gcode::chord_error(chords, arc), most * (1 + 1e-6)) << arc.start.transpose();
  }
}

INSTANTIATE_TEST_SUITE_P(Targets, OwnChordsOf,
                         testing::Values("grbl", "klipper", "marlin", "smoothieware",
                                         "reprapfirmware"),
                         [](const auto& info) { return std::string(info.param); });

}  // namespace
}  // namespace batten::postproc
