// Programs that go from one language to another, and how they are asked for and proved.
#pragma once

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <random>
#include <string>
#include <string_view>
#include <vector>

#include "gcode/interpreter/interpreter.h"
#include "gcode/reading/parser.h"
#include "gcode/text/diagnostic.h"
#include "postproc/proof/verification.h"
#include "tests/support/klartext_programs.h"
#include "tests/support/wavy_programs.h"

namespace batten::postproc {

inline SmoothOptions ways_to(std::string_view target) {
  SmoothOptions options = options_for(target);
  options.convert = true;
  options.allowed = {"work-offset", "tool-length", "blank-form"};
  options.method = Method::kNone;
  return options;
}

inline bool is_proved(const std::string& before, gcode::Language from, const std::string& after,
                      gcode::Language to, double tolerance_mm = 0.01) {
  const ReadText old_text(before, from);
  return verify(old_text.read(), ReadText(after, to).read(), tolerance_mm).proved();
}

// "line:column: message" of each error.
inline std::vector<std::string> told(const SmoothResult& result, const std::string& text) {
  std::vector<std::string> all;
  for (const gcode::Diagnostic& each : result.diagnostics) {
    if (each.severity != gcode::Severity::kError) continue;
    const std::string before = text.substr(0, each.where.begin);
    const std::size_t line_begin = before.rfind('\n') + 1;
    all.push_back(fmt::format("{}:{}: {}", std::ranges::count(before, '\n') + 1,
                              before.size() - line_begin + 1, each.message));
  }
  return all;
}

// What is written, and proved.
inline std::string proved_text(const std::string& text, const SmoothOptions& options) {
  const SmoothResult result = smoothed(text, options);
  EXPECT_TRUE(result.proved) << testing::PrintToString(told(result, text));
  return result.text;
}
inline std::string proved_text(const std::string& text, const char* target) {
  return proved_text(text, ways_to(target));
}

// What a proof must find.
struct Damage {
  const char* name;
  const char* from;
  const char* to;
};

inline std::string as_klartext(const std::string& lines) {
  return tests::numbered_from_zero(lines_of("BEGIN PGM TEST MM\n" + lines + "END PGM TEST MM\n"));
}

// --- programs as posts and people write them ----------------------------------------------------

inline constexpr const char* kKlartextPart =
    "0 BEGIN PGM PART MM\n1 BLK FORM 0.1 Z X+0 Y+0 Z-20\n2 BLK FORM 0.2 X+100 Y+100 Z+0\n"
    "3 * - roughing\n4 TOOL CALL 5 Z S3000\n5 L X+1,5 Y-2 R0 FMAX M13\n6 L Z+2 FMAX\n"
    "7 L Z-1 F200\n8 l x+10 f500\n9 CC X+15 Y-2\n10 C X+20 Y-2 DR-\n11 CR X+25 Y+3 R+5 DR+\n"
    "12 L Z+50 R0 FMAX M9\n13 L X+0 M5\n14 M30\n15 END PGM PART MM\n";

inline constexpr const char* kSiemensPart =
    "%_N_PART_MPF\n;$PATH=/_N_WKS_DIR\nN10 G17 G40 G71 G90 G94\nN20 G54\nN30 T5\nN40 M6\n"
    "N50 D1 S3000 M3\nN60 G0 X0 Y0\nN70 Z=5\n; cut\nN80 G1 Z-1 F200\nN90 G64\nN100 X=10 F500\n"
    "N110 G2 X20 Y0 CR=5\nN120 G18 G3 X30 Z4 I=5 K5\nN130 G0 Z50\nN140 M5\nN150 M30\n";

inline std::string siemens_part() {
  std::string text = kSiemensPart;
  const std::string arc = "N120 G18 G3 X30 Z4 I=5 K5\n";
  // A quarter in G18, counter-clockwise from the tip of Y: from Z to X, about (20, 4) in X and Z.
  return text.replace(text.find(arc), arc.size(), "N120 G18 G3 X15 Z4 I=0 K5\n");
}

// Lines, arcs, rapids, tools, feeds, speeds and coolant at random, in plain words.
class RandomProgram {
 public:
  explicit RandomProgram(unsigned seed) : random_(seed) {}

  std::string text() {
    std::string text = "G21 G17 G40 G90 G94\n" + tool();
    for (int i = 0; i < 40; ++i) text += block();
    return text + "G0 Z50\nM9\nM5\nM30\n";
  }

 private:
  double number(double low, double high) {
    return std::round(std::uniform_real_distribution<double>(low, high)(random_) * 1000) / 1000;
  }
  int whole(int low, int high) { return std::uniform_int_distribution<int>(low, high)(random_); }

  std::string tool() {
    const int tool = whole(1, 9);
    x_ = number(-50, 50);
    y_ = number(-50, 50);
    return fmt::format("T{} M6\n{}\nS{} M3\nG0 X{} Y{}\nZ{}\nG1 Z-1 F{}\n", tool,
                       whole(0, 3) > 0 ? fmt::format("G43 H{}", tool) : "(as it was)",
                       whole(500, 9000), x_, y_, number(2, 9), whole(100, 900));
  }

  std::string block() {
    switch (whole(0, 9)) {
      case 0:
        return fmt::format("G0 Z{}\n", number(1, 9));
      case 1:
        return fmt::format("F{}\n", whole(100, 900));
      case 2:
        return whole(0, 1) == 0 ? "M8\n" : "M9\n";
      case 3:
        return fmt::format("S{}\n", whole(500, 5000));
      case 4:
      case 5:
        return arc();
      case 6:
        return whole(0, 5) == 0 ? "M5\n" + tool() : "(note)\n";
      default:
        x_ = number(-50, 50);
        y_ = number(-50, 50);
        return fmt::format("G1 X{} Y{}\n", x_, y_);
    }
  }

  // The centre is at (x - radius, y), so that the start stands at the angle 0.
  std::string arc() {
    const double radius = number(2, 20);
    const double angle = number(0.3, 6);
    const bool clockwise = whole(0, 1) == 0;
    const double x = x_ - radius + radius * std::cos(clockwise ? -angle : angle);
    const double y = y_ + radius * std::sin(clockwise ? -angle : angle);
    x_ = std::round(x * 1000) / 1000;
    y_ = std::round(y * 1000) / 1000;
    return fmt::format("G{} X{} Y{} I{} J0\n", clockwise ? 2 : 3, x_, y_, -radius);
  }

  std::mt19937 random_;
  double x_ = 0;
  double y_ = 0;
};

}  // namespace batten::postproc
