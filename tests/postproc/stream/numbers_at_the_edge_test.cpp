// Numbers at the edge, through the whole of `smooth_program` and `verify`: coordinates from a
// millionth of a millimetre to a kilometre, tolerances from 0.00001 to 10 mm, places that repeat,
// moves below what is printed, exact retraces, and text that looks like numbers. Whatever is said
// to be proved is so, by a decision without rounding; whatever is no number is copied, and never
// taken for one.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <cstdint>
#include <optional>

#include "gcode/controls/built_in.h"
#include "gcode/state/motion.h"
#include "postproc/stream/pipeline.h"
#include "tests/support/exact_distance.h"
#include "tests/support/wavy_programs.h"

namespace batten::postproc {
namespace {

namespace exact = geometry::exact;

// Whole numbers of this are exact: what is printed has nine decimals at the most.
constexpr double kStepsPerMm = 1e9;

// Of a shape, in units of the program's size: place `i` of 61.
using Place = std::array<double, 3>;

// Out along a wave and home over the same places.
Place retrace(int i) {
  const int at = std::min(i, 60 - i);
  return {0.5 * at, 3 * std::sin(0.2 * at), 0};
}

struct EdgeShape {
  const char* name;
  Place (*place)(int);
};
constexpr EdgeShape kShapes[] = {
    {"Wave",
     [](int i) {
       return Place{0.5 * i, 3 * std::sin(0.2 * i), 0};
     }},
    // Along one line, to and fro, further each time.
    {"Reversals",
     [](int i) {
       return Place{i % 2 == 0 ? 0.5 * i : 0.2 * i, 0, 0};
     }},
    {"Retrace", retrace},
    // One place, and a move and the same back now and then.
    {"Standing",
     [](int i) {
       return Place{i % 20 == 10 ? 1.0 : 0.0, 0, 0};
     }},
    // Short moves, and three that are a thousand times as long.
    {"LongAndShort", [](int i) {
       return Place{i + 1 + 999.0 * ((i + 10) / 20), i % 2 == 0 ? 0.0 : 1.0, 0.25 * (i % 3)};
     }}};

struct EdgeCase {
  const EdgeShape* shape;
  double size;       // mm, of one unit of the shape
  double away;       // mm, of its first place from zero
  double tolerance;  // mm
};

std::vector<EdgeCase> edge_cases() {
  std::vector<EdgeCase> cases;
  constexpr double kTolerances[] = {1e-5, 1e-3, 0.1, 10};
  for (const EdgeShape& shape : kShapes) {
    std::size_t next = 0;
    for (const double size : {1e-6, 1e-4, 1e-2, 1.0, 30.0, 1000.0}) {
      for (const double away : {0.0, 987654.321}) {
        cases.push_back({&shape, size, away, kTolerances[next++ % 4]});
        cases.push_back({&shape, size, away, kTolerances[next++ % 4]});
      }
      ++next;  // so that sizes meet other tolerances
    }
  }
  return cases;
}

std::string program_of(const EdgeCase& test) {
  // As fine as the moves need, and as a double holds far away.
  const int decimals = test.size >= 0.01 ? 4 : test.away > 0 ? 6 : 9;
  std::string text = "G21 G90 G17\nG0 X0 Y0 Z0\nG1 F1000\n";
  for (int i = 0; i <= 60; ++i) {
    const Place p = test.shape->place(i);
    text += fmt::format("X{:.{}f} Y{:.{}f} Z{:.{}f}\n", test.away + test.size * p[0], decimals,
                        test.size * p[1], decimals, test.size * p[2], decimals);
  }
  return text + "M2\n";
}

// The cutting path, without the moves of no length; nothing where it has arcs.
std::optional<exact::Chain> cutting_chain(const std::string& text) {
  const ReadText read(text);
  const auto place = [](const geometry::Point3& p) {
    return exact::Place{std::llround(p.x() * kStepsPerMm), std::llround(p.y() * kStepsPerMm),
                        std::llround(p.z() * kStepsPerMm)};
  };
  exact::Chain chain;
  for (const gcode::Motion& motion : read.meaning.motions) {
    if (motion.kind == gcode::MotionKind::kRapid) continue;
    if (!motion.piece.is_line()) return std::nullopt;
    if (chain.empty()) chain.push_back(place(motion.piece.start()));
    if (place(motion.piece.end()) != chain.back()) chain.push_back(place(motion.piece.end()));
  }
  if (chain.size() == 1) chain.push_back(chain.front());
  return chain;
}

void PrintTo(const EdgeCase& test, std::ostream* out) {
  *out << test.shape->name << " of " << test.size << " mm, " << test.away << " mm away, within "
       << test.tolerance << " mm";
}

SmoothOptions options_of(const EdgeCase& test) {
  SmoothOptions options = options_for("linuxcnc");
  options.tolerance_mm = test.tolerance;
  options.output = Form::kLines;
  return options;
}

class EdgeNumbers : public testing::TestWithParam<EdgeCase> {};

TEST_P(EdgeNumbers, AreProvedTrulyOrKept) {
  const EdgeCase& test = GetParam();
  const std::string text = program_of(test);
  const SmoothResult result = smoothed(text, options_of(test));
  EXPECT_TRUE(result.proved);
  EXPECT_LE(result.deviation_mm, test.tolerance);
  EXPECT_TRUE(verdict(text, result.text, test.tolerance).proved());
  expect_rest_copied(text, result);
  const auto before = cutting_chain(text);
  const auto after = cutting_chain(result.text);
  ASSERT_TRUE(before && after);
  const auto steps = static_cast<std::int64_t>(std::llround(test.tolerance * kStepsPerMm));
  EXPECT_TRUE(*before == *after || exact::within(*before, *after, exact::ratio(steps, 1)));
}

// What is not so is not proved: every place but the ends is moved by 1.01 tolerances across the
// plane.
TEST_P(EdgeNumbers, AreNotProvedWhereThePathIsBeyondTheTolerance) {
  const EdgeCase& test = GetParam();
  const std::string text = program_of(test);
  std::string moved;
  for (const std::string& line : lines_of(text)) {
    const bool cuts = line.find(" Z") != std::string::npos && !line.starts_with("G0");
    const std::size_t z = cuts ? line.find('Z') : line.size();
    moved += line.substr(0, z);
    if (cuts)
      moved += fmt::format("Z{:.9f}", std::stod(line.substr(z + 1)) + 1.01 * test.tolerance);
    moved += '\n';
  }
  EXPECT_FALSE(verdict(text, moved, test.tolerance).proved());
}

INSTANTIATE_TEST_SUITE_P(Pipeline, EdgeNumbers, testing::ValuesIn(edge_cases()));

// The promises above would hold of a Batten that does nothing.
TEST(EdgeNumbersOf, ManyShapesAreRewritten) {
  int rewritten = 0;
  for (const EdgeCase& test : edge_cases()) {
    rewritten += rewritten_runs(smoothed(program_of(test), options_of(test))) > 0 ? 1 : 0;
  }
  EXPECT_GE(rewritten, 10);
}

// Between places that are noise alone, pairs of lines to a joint far away and back look right
// beside the curve, whose part is shorter than the deviation.
constexpr const char* kNoiseAlone[] = {
    "G21\nG17 G90 G94 G40\nG0 X7.1642 Y24.9162 Z5.0000\nG1 Z0.0000 F1000.0000\n"
    "G1 X7.1702 Y24.9165\nG1 X7.1667 Y24.9176\nG1 X7.1698 Y24.9073\nG1 X7.1710 Y24.9098\n"
    "G1 X7.1765 Y24.8935\nG1 X7.1917 Y24.8873\n",
    "G21\nG17 G90 G94 G40\nG0 X2.65519 Y-32.37284 Z5.00000\nG1 Z0.00000 F1000.00000\n"
    "G1 X2.65635 Y-32.36985\nG1 X2.65495 Y-32.37309\nG1 X2.65693 Y-32.37180\n"
    "G1 X2.65877 Y-32.37610\nG1 X2.70280 Y-32.39463\n",
};

TEST(NoiseAlone, BecomesNothingThatGoesFarAwayAndBack) {
  for (const char* text : kNoiseAlone) {
    const gcode::SourceText source("part.nc", text);
    for (const gcode::Control& target : gcode::controls()) {
      if (target.language != gcode::Language::kRs274) continue;
      for (const Prefer prefer : {Prefer::kTime, Prefer::kAccuracy, Prefer::kSize}) {
        SmoothOptions options = options_for(target.name);
        options.tolerance_mm = 0.005;
        options.prefer = prefer;
        SmoothResult result;
        ASSERT_NO_THROW(result = smooth_program(source, options)) << target.name;
        EXPECT_TRUE(result.proved || !result.understood) << target.name;
      }
    }
  }
}

TEST(RepeatedPlaces, ByTheThousandNeitherCountNorCost) {
  const std::string wave_text = wave_program();
  std::vector<std::string> lines = lines_of(wave_text);
  const std::string repeated = lines[49];
  lines.insert(lines.begin() + 49, 5000, repeated);
  const std::string text = joined(lines, "\n");
  const SmoothOptions options = options_for("linuxcnc");
  const SmoothResult result = smoothed(text, options);
  EXPECT_TRUE(result.proved);
  EXPECT_TRUE(verdict(text, result.text, options.tolerance_mm).proved());
  EXPECT_TRUE(verdict(wave_text, text, 1e-5).proved()) << "the same path";
  expect_rest_copied(text, result);
}

class NoNumber : public testing::TestWithParam<std::string_view> {};

// In the middle of a run: the line stands in the new program as it was, and the runs end at it.
TEST_P(NoNumber, IsCopiedAndEndsTheRun) {
  std::vector<std::string> lines = wave_lines({});
  const std::string odd = std::string(GetParam()) + " Y1.5";
  lines.insert(lines.begin() + 100, odd);
  const std::string text = head("G21") + joined(lines, "\n") + tail();
  const SmoothResult result = smoothed(text, options_for("linuxcnc"));
  ASSERT_TRUE(result.understood);
  EXPECT_TRUE(result.proved);
  EXPECT_NE(result.text.find("\n" + odd + "\n"), std::string::npos);
  expect_rest_copied(text, result);
  EXPECT_TRUE(verdict(text, result.text, 0.01).proved());
}

// A new program in which one coordinate is no number, or another number, is not the old one.
TEST_P(NoNumber, IsNeverProvedToBeANumber) {
  const std::string text = wave_program();
  std::vector<std::string> lines = lines_of(text);
  const std::size_t blank = lines[100].find(' ');
  lines[100] = std::string(GetParam()) + lines[100].substr(blank);
  EXPECT_FALSE(verdict(text, joined(lines, "\n"), 0.01).proved());
  EXPECT_FALSE(verdict(joined(lines, "\n"), text, 0.01).proved());
}

INSTANTIATE_TEST_SUITE_P(
    Pipeline, NoNumber,
    testing::Values("Xnan", "XNAN", "X nan", "Xinf", "X-inf", "X+INF", "Xinfinity", "X1e5", "X1E5",
                    "X19.e0", "X1e400", "X--1", "X+-1", "X-+1", "X-", "X+", "X.", "X-.", "X",
                    "X1.2.3", "X1_9", "X0x13", "X1'9", "X19,4", "X1000000000", "X-1000000000",
                    "X99999999999999999999999999999999999999999", "X\xD9\xA1\xD9\xA9",
                    "X\xEF\xBC\x91\xEF\xBC\x99", "X19\xC2\xB0",
                    "X\xE2\x88\x92"
                    "19",
                    "X1/2", "X=19.4",
                    "X\xC2\xA0"
                    "19.4",
                    "X\x01"
                    "9",
                    "X[0/0]", "X[1/0]", "X#0", "X#<nan>"));

// Odd, and numbers all the same.
class OddNumber : public testing::TestWithParam<std::string_view> {};

TEST_P(OddNumber, IsTheNumberThatItIs) {
  const std::string plain = "G21 G90\nG0 X0 Y0 Z0\nG1 X1 Y1 F100\nX19.4 Y2\nX20 Y3\nM2\n";
  std::string odd = plain;
  odd.replace(odd.find("X19.4"), 5, GetParam());
  EXPECT_TRUE(verdict(plain, odd, 1e-5).proved());
}

INSTANTIATE_TEST_SUITE_P(Pipeline, OddNumber,
                         testing::Values("X+19.4", "X019.4", "X19.40000000000000000000000000",
                                         "X 1 9 . 4", "x19.4", "X\t19.4",
                                         "X0000000000000000000000000000000019.4",
                                         "X19.3999999999999999999999999999999999"));

}  // namespace
}  // namespace batten::postproc
