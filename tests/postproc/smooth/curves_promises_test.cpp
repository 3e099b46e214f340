// What holds for the curves of every target that has them: what is written is read back, and it is
// proved; what is not understood is not touched; a second pass changes nothing.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "gcode/control/control.h"
#include "gcode/controls/built_in.h"
#include "gcode/curves/curve_format.h"
#include "gcode/interpreter/interpreter.h"
#include "gcode/state/modal_state.h"
#include "gcode/state/reason.h"
#include "gcode/writer/writer.h"
#include "geometry/distance/path_distance.h"
#include "postproc/smooth/forms/output_plan.h"
#include "tests/support/paths.h"
#include "tests/support/random_curves.h"
#include "tests/support/wavy_programs.h"

namespace batten::postproc {
namespace {

using geometry::BsplineCurve;
using geometry::CubicBezier;
using geometry::Path;
using geometry::Point3;

std::vector<std::string> targets_with_curves() {
  std::vector<std::string> names;
  for (const gcode::Control& control : gcode::controls()) {
    // Klartext is no language of these programs: klartext_test.cpp.
    const bool klartext = control.language == gcode::Language::kKlartext;
    if (control.curves != nullptr && !klartext) names.emplace_back(control.name);
  }
  return names;
}

class Curves : public testing::TestWithParam<std::string> {
 protected:
  const gcode::Control& target() const { return *gcode::find_control(GetParam()); }
  const gcode::CurveFormat& format() const { return *target().curves; }

  SmoothOptions options() const {
    SmoothOptions wanted = options_for(GetParam());
    // Lines without a G1 of their own, as these programs have them, are none in programs for
    // Marlin.
    if (target().needs_commands) wanted.source = gcode::SourceKind::kNgc;
    wanted.output = Form::kCurves;
    return wanted;
  }
};

INSTANTIATE_TEST_SUITE_P(Targets, Curves, testing::ValuesIn(targets_with_curves()),
                         [](const auto& test) {
                           std::string name = test.param;
                           std::erase(name, '-');
                           return name;
                         });

// A program that stands in the curve's first place, and then what is written.
std::string head_at(const Point3& place) {
  return fmt::format("G21 G90 G17\nG0 X{:.9f} Y{:.9f} Z5\nG1 Z{:.9f} F1000\n", place.x(), place.y(),
                     place.z());
}

// A program as a control with these curves reads it.
struct ReadCurves : ReadText {
  ReadCurves(const std::string& text, const gcode::CurveFormat& format)
      : ReadText(text, gcode::Language::kRs274, &format) {}
};

// The cutting moves after the first one of a program.
Path cuts_of(const std::string& text, const gcode::CurveFormat& format) {
  const gcode::Interpretation read = ReadCurves(text, format).meaning;
  Path path;
  for (std::size_t i = 2; i < read.motions.size(); ++i) path.push_back(read.motions[i].piece);
  const bool all_read = std::ranges::none_of(read.blocks, [](const gcode::BlockMeaning& block) {
    return block.kind == gcode::BlockKind::kOpaque;
  });
  return all_read ? path : Path{};
}

// The parts of a curve that can be said: the whole, or single pieces where each is a block.
std::vector<BsplineCurve> sayable(const BsplineCurve& curve, const gcode::CurveFormat& format) {
  const std::vector<CubicBezier> pieces = curve.bezier_pieces();
  const auto taken = [&](const CubicBezier& piece) { return format.takes(piece); };
  if (std::all_of(pieces.begin(), pieces.end(), taken)) return {curve};
  std::vector<BsplineCurve> parts;
  const std::vector<double> breaks = curve.breakpoints();
  for (std::size_t i = 0; i < pieces.size(); ++i) {
    if (taken(pieces[i])) parts.push_back(curve.part(breaks[i], breaks[i + 1]));
  }
  return parts;
}

// Half a step of the last decimal on each of three axes is sqrt(3) / 2 of it; that of other numbers
// moves a curve by less.
void expect_read_back(const BsplineCurve& curve, const gcode::Control& target) {
  const auto units = gcode::Units::kMillimetre;
  const double step = gcode::printed_step(place_format(target, units), units);
  const Point3 start = curve.control_points().front();
  gcode::ModalState modal;
  modal.motion = gcode::MotionMode::kLine;
  modal.units = units;
  modal.feed = 1000;
  gcode::Writer writer(target, {modal, {start, {true, true, true}}}, "\n");
  const auto printed = writer.curve_to(curve, 2000, 0);
  ASSERT_TRUE(printed);
  writer.end_curve();
  const Path read = cuts_of(head_at(start) + writer.text(), *target.curves);
  ASSERT_FALSE(read.empty()) << writer.text();
  const auto found = geometry::compare_paths(geometry::beziers_of(curve), read, 2 * step);
  EXPECT_EQ(found.verdict, geometry::Verdict::kProved) << found.bounds.at_least << "\n"
                                                       << writer.text();
  EXPECT_LT((writer.state().position.mm - geometry::end_point(read.back())).norm(), 1e-8);
  ASSERT_EQ(printed->size(), read.size());
  for (std::size_t i = 0; i < read.size(); ++i) {
    const geometry::Vector3 off = point_at((*printed)[i], 0.5) - point_at(read[i], 0.5);
    EXPECT_LT(off.norm(), 1e-8) << "piece " << i;
  }
  EXPECT_EQ(writer.state().modal.feed, 2000);
}

TEST_P(Curves, RandomOnesAreReadBackToWithinTheirDigits) {
  std::size_t written = 0;
  for (unsigned seed = 0; seed < 200; ++seed) {
    SCOPED_TRACE(testing::Message() << "seed " << seed);
    for (const BsplineCurve& part : sayable(tests::random_curve(seed, seed % 2 == 1), format())) {
      expect_read_back(part, target());
      ++written;
    }
  }
  EXPECT_GE(written, 200U);
}

// Chords of a curve that leave it by 0.002 mm, three decimals, as CAM writes them.
std::string cam_program(const BsplineCurve& curve) {
  const Point3 start = curve.control_points().front();
  std::string text = head_at(start);
  std::vector<double> at = {curve.first()};
  while (at.back() < curve.last()) {
    const double bend = curve.curvature_at(at.back());
    const double step = std::clamp(std::sqrt(8 * 0.002 / std::max(bend, 1e-3)), 0.1, 3.0);
    at.push_back(std::min(at.back() + step, curve.last()));
  }
  for (std::size_t i = 1; i < at.size(); ++i) {
    const Point3 p = curve.point_at(at[i]);
    text += fmt::format("X{:.3f} Y{:.3f} Z{:.3f}\n", p.x(), p.y(), p.z());
  }
  return text + "G0 Z50\nM2\n";
}

TEST_P(Curves, ProgramsOfRandomOnesAreProvedAndASecondPassChangesNothing) {
  int with_curves = 0;
  for (unsigned seed = 0; seed < 12; ++seed) {
    SCOPED_TRACE(testing::Message() << "seed " << seed);
    const std::string before = cam_program(tests::random_curve(seed, seed % 2 == 1));
    const SmoothResult result = smoothed(before, options());
    EXPECT_TRUE(result.proved);
    EXPECT_LE(result.deviation_mm, options().tolerance_mm);
    for (const RunReport& run : result.runs) {
      if (run.status == RunStatus::kRewritten && run.form == Form::kCurves) ++with_curves;
      EXPECT_NE(run.reason, gcode::reason::kNotProved);
    }
    EXPECT_EQ(smoothed(result.text, options()).text, result.text);
  }
  EXPECT_GT(with_curves, 2);
}

// Whether the program has a curve that its control reads.
std::size_t curve_blocks(const std::string& text, const gcode::CurveFormat& format) {
  const gcode::Interpretation read = ReadCurves(text, format).meaning;
  return static_cast<std::size_t>(
      std::ranges::count_if(read.blocks, &gcode::BlockMeaning::of_curve));
}

TEST_P(Curves, AreWrittenWhereTheyAreAskedFor) {
  const SmoothResult result = smoothed(bend_program(), options());
  EXPECT_TRUE(result.proved);
  EXPECT_EQ(rewritten_runs(result), 1U);
  EXPECT_GT(curve_blocks(result.text, format()), 4U) << result.text;
  EXPECT_LT(result.blocks_out, result.blocks_in / 3);
}

// Twenty waves around a small circle: a G5 for each bend, and LinuxCNC runs each as 32 short arcs,
// which it joins under G64 P Q alone.
TEST(CurvesOfLinuxcnc, AreWrittenForWhoAsksForThemThoughTheyAreSlow) {
  std::string text = "G21 G90 G17\nG0 X10 Y0 Z5\nG1 Z-1 F12000\n";
  for (int i = 1; i <= 2000; ++i) {
    const double angle = 2 * std::numbers::pi * i / 2000;
    const double radius = 10 + 0.15 * std::sin(20 * angle);
    text += fmt::format("X{:.4f} Y{:.4f}\n", radius * std::cos(angle), radius * std::sin(angle));
  }
  text += "G0 Z50\nM2\n";
  Machine joins_nothing = *find_machine("linuxcnc");
  joins_nothing.naive_cam_tolerance = 0;
  SmoothOptions wanted = options_for("linuxcnc");
  wanted.output = Form::kCurves;
  wanted.machine = &joins_nothing;
  const SmoothResult result = smoothed(text, wanted);
  EXPECT_TRUE(result.proved);
  ASSERT_EQ(rewritten_runs(result), 1U);
  EXPECT_EQ(result.runs.back().form, Form::kCurves);
  EXPECT_GT(result.runs_after_s, 1.1 * result.runs_before_s) << "which the report says";
  EXPECT_LT(result.blocks_out, result.blocks_in / 4);
}

// A quarter of a wavy circle to X0 Y40, and another one from there on, to the other side.
std::string cornered_program() {
  std::string text = "G21 G90 G17\nG0 X40 Y0 Z5\nG1 Z-1 F2000\n";
  constexpr int kLines = 80;
  for (const Point3& center : {Point3(0, 0, -1), Point3(-40, 40, -1)}) {
    for (int i = 1; i <= kLines; ++i) {
      const double angle = 0.5 * std::numbers::pi * i / kLines;
      const double radius = 40 + 3 * std::sin(2 * angle);
      text += fmt::format("X{:.4f} Y{:.4f}\n", center.x() + radius * std::cos(angle),
                          center.y() + radius * std::sin(angle));
    }
  }
  return text + "G0 Z50\nM2\n";
}

// A bend in its place would be some thirty control points.
TEST_P(Curves, EndInSharpCornersWhereThatIsAsQuick) {
  const SmoothResult result = smoothed(cornered_program(), options());
  EXPECT_TRUE(result.proved);
  EXPECT_EQ(rewritten_runs(result), 1U);
  const Path cuts = cuts_of(result.text, format());
  const Point3 corner(0, 40, -1);
  EXPECT_TRUE(std::any_of(cuts.begin(), cuts.end(), [&](const geometry::PathPiece& piece) {
    return (geometry::end_point(piece) - corner).norm() < 1e-6;
  })) << result.text;
  EXPECT_LT(result.blocks_out, 60U);
}

TEST_P(Curves, AFeedChangesWhereItChanged) {
  const std::string before = bend_program("F1200\n");
  const SmoothResult result = smoothed(before, options());
  EXPECT_TRUE(result.proved);
  EXPECT_EQ(rewritten_runs(result), 1U);
  EXPECT_GT(curve_blocks(result.text, format()), 8U);
  EXPECT_NE(result.text.find("F1200"), std::string::npos);
}

TEST_P(Curves, CommentsStandBesideThemInOrder) {
  const SmoothResult result = smoothed(bend_program("(first)\n(second)\n"), options());
  EXPECT_TRUE(result.proved);
  EXPECT_GT(curve_blocks(result.text, format()), 4U);
  const std::size_t first = result.text.find("(first)\n(second)\n");
  EXPECT_NE(first, std::string::npos) << result.text;
}

// What has curves already keeps them, byte for byte, and the runs around them are still smoothed.
TEST_P(Curves, ThatAreThereAlreadyAreCopied) {
  SmoothOptions none = options();
  none.method = Method::kNone;
  const std::string curves = smoothed(bend_program(), options()).text;
  EXPECT_EQ(smoothed(curves, none).text, curves);
  SmoothOptions again = options();
  again.allowed = {std::string(gcode::reason::kAlreadySmoothed)};
  const SmoothResult result = smoothed(curves, again);
  EXPECT_TRUE(result.proved);
  EXPECT_EQ(curve_blocks(result.text, format()), curve_blocks(curves, format()));
}

TEST_P(Curves, OfAnotherPathAreABreach) {
  const std::string before = bend_program();
  const std::string after = smoothed(before, options()).text;
  const auto verdict_on = [&](const std::string& text) {
    const ReadCurves old_text(before, format());
    const ReadCurves new_text(text, format());
    return verify({&old_text.program, &old_text.meaning}, {&new_text.program, &new_text.meaning},
                  0.01);
  };
  EXPECT_TRUE(verdict_on(after).proved());
  // The fifth line with an X word is one of the curve: its X is moved.
  std::vector<std::string> lines = lines_of(after);
  std::size_t seen = 0;
  for (std::string& line : lines) {
    const std::size_t x = line.find('X');
    if (x != std::string::npos && ++seen == 5) line.insert(line[x + 1] == '-' ? x + 2 : x + 1, "1");
  }
  EXPECT_FALSE(verdict_on(joined(lines, "\n")).proved());
}

// --- too few digits -------------------------------------------------------------------------

// What is left of knots (PL, K) where no digit of the inner ones is right.
gcode::CurveWriting with_wrong_knots(gcode::CurveWriting written, const std::string& name) {
  auto* lines = std::get_if<gcode::CurveLines>(&written);
  if (lines == nullptr) return written;
  int step = 0;
  for (std::string& line : *lines) {
    const bool alone = line.find(' ') == std::string::npos;  // an ending knot
    if (alone || line.find(name) == std::string::npos) continue;
    const auto at = line.find(name) + name.size();
    const auto end = std::min(line.find(' ', at), line.size());
    const std::string knot = line.substr(at, end - at);
    if (knot == "0" || knot == "0.") continue;
    line.replace(at, end - at,
                 name == "K"       ? fmt::format("{}.", ++step)
                 : ++step % 2 == 0 ? "1"
                                   : "5");
  }
  return written;
}

// The same format with no digit behind the point of coefficients and offsets, or with wrong knots.
gcode::CurveFormat coarse_format(const gcode::CurveFormat& fine) {
  gcode::CurveFormat coarse = fine;
  coarse.other_mm.decimals = 0;
  if (fine.is_block_per_piece) return coarse;
  coarse.write = [&fine](const BsplineCurve& curve, const gcode::CurveSetting& setting) {
    return with_wrong_knots(fine.write(curve, setting), fine.name == "BSPLINE" ? "PL=" : "K");
  };
  return coarse;
}

TEST_P(Curves, ThatAreNotVerifiedAreToldOf) {
  const SmoothResult result = smoothed(bend_program(), options());
  const bool told = std::ranges::any_of(result.diagnostics, [](const gcode::Diagnostic& found) {
    return found.id == "curves-unverified" && found.severity == gcode::Severity::kWarning;
  });
  EXPECT_EQ(told, GetParam() == "siemens-bspline");
}

TEST_P(Curves, OfTooFewDigitsAreNotProvedAndGoBack) {
  const gcode::CurveFormat coarse = coarse_format(format());
  gcode::Control coarse_target;
  coarse_target.centers = {5, 5};
  coarse_target.places = coarse_target.arc_ends = {4, 4};
  coarse_target.curves = &coarse;
  SmoothOptions wanted = options();
  wanted.target = &coarse_target;
  const std::string before = bend_program();
  const SmoothResult result = smoothed(before, wanted);
  ASSERT_EQ(result.runs.size(), 2U);  // the plunge is kept too
  EXPECT_EQ(result.text, before);
  EXPECT_EQ(result.runs.back().reason, gcode::reason::kNotProved);
}

}  // namespace
}  // namespace batten::postproc
