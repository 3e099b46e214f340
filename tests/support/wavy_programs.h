// Programs of many short lines along a curve that is known, and what Batten makes of them.
#pragma once

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <random>
#include <string>
#include <string_view>
#include <vector>

#include "gcode/controls/built_in.h"
#include "gcode/interpreter/interpreter.h"
#include "gcode/reading/parser.h"
#include "gcode/text/source_text.h"
#include "postproc/proof/verification.h"
#include "postproc/stream/pipeline.h"

namespace batten::postproc {

struct Wave {
  int lines = 200;
  double step = 0.2;   // in X, in the program's units
  double height = 2;   // of the wave in Y
  double length = 18;  // of one wave
  double noise = 0;    // greatest, in Y
  int decimals = 3;
  double feed = 2000;
  std::string line_end = "\n";
  unsigned seed = 1;
};

// The lines alone, "X0.200 Y0.139" and so on; the first one has the feed. Place 0 is X0 Y0.
inline std::vector<std::string> wave_lines(const Wave& wave) {
  constexpr double kTwoPi = 6.283185307179586;
  std::mt19937 random(wave.seed);
  std::uniform_real_distribution<double> scatter(-wave.noise, wave.noise);
  std::vector<std::string> lines;
  for (int i = 1; i <= wave.lines; ++i) {
    const double x = wave.step * i;
    const double y = wave.height * std::sin(kTwoPi * x / wave.length) + scatter(random);
    std::string line = fmt::format("X{:.{}f} Y{:.{}f}", x, wave.decimals, y, wave.decimals);
    if (i == 1) line = "G1 " + line + fmt::format(" F{}", wave.feed);
    lines.push_back(line);
  }
  return lines;
}

inline std::string joined(const std::vector<std::string>& lines, const std::string& line_end) {
  std::string text;
  for (const std::string& line : lines) text += line + line_end;
  return text;
}

inline std::string head(const std::string& units, const std::string& line_end = "\n") {
  return joined({units + " G90 G17", "S12000 M3", "G0 X0 Y0 Z5", "G1 Z-1 F300"}, line_end);
}

inline std::string tail(const std::string& line_end = "\n") {
  return joined({"G0 Z5", "M5", "M2"}, line_end);
}

// From a rapid down into the cut, along the wave, up again.
inline std::string wave_program(const Wave& wave = {}, const std::string& units = "G21") {
  return head(units, wave.line_end) + joined(wave_lines(wave), wave.line_end) + tail(wave.line_end);
}

// A wave around a circle that bends one way for long, so that every control has curves to say it.
// `middle`: lines that stand in the midst of it.
inline std::string bend_program(const std::string& middle = "") {
  std::string text = "G21 G90 G17\nG0 X40 Y0 Z5\nG1 Z-1 F300\n";
  constexpr int kLines = 240;
  for (int i = 1; i <= kLines; ++i) {
    const double angle = 1.5 * std::numbers::pi * i / kLines;
    const double radius = 40 + 3 * std::sin(2 * angle);
    text += fmt::format("{}X{:.4f} Y{:.4f}{}\n", i == 1 ? "G1 " : "", radius * std::cos(angle),
                        radius * std::sin(angle), i == 1 ? " F2000" : "");
    if (i == kLines / 2) text += middle;
  }
  return text + "G0 Z50\nM2\n";
}

// LinuxCNC runs a fast machine here: what is smoother is faster on it, so that it is written.
inline SmoothOptions options_for(std::string_view target) {
  SmoothOptions options;
  options.target = gcode::find_control(target);
  options.machine = find_machine(target == "linuxcnc" ? "linuxcnc-fast" : options.target->machine);
  options.threads = 1;
  options.decimals = gcode::Decimals{};  // Z5 here is 5 mm for every target
  return options;
}

inline SmoothResult smoothed(const std::string& text, const SmoothOptions& options,
                             const Progress& progress = {}) {
  return smooth_program(gcode::SourceText("test.nc", text), options, progress);
}

// The first `what` that stands in it.
inline std::string replaced(std::string text, std::string_view what, std::string_view by) {
  const std::size_t at = text.find(what);
  EXPECT_NE(at, std::string::npos) << what;
  return text.replace(at, what.size(), by);
}

// A text that was read, for as long as its meaning is needed.
struct ReadText {
  explicit ReadText(const std::string& text, gcode::Language language = gcode::Language::kRs274,
                    const gcode::CurveFormat* curves = nullptr,
                    gcode::DwellForm dwells = gcode::DwellForm::kUnknown)
      : program(gcode::parse(gcode::SourceText("test.nc", text),
                             gcode::Reading{.language = language, .dwells = dwells}, found)),
        meaning(gcode::interpret(program, {.curves = curves}, found)) {}
  [[nodiscard]] ReadProgram read() const { return {&program, &meaning}; }
  gcode::Diagnostics found;
  gcode::Program program;
  gcode::Interpretation meaning;
};

// The verdict on two texts, whatever `smooth_program` said.
inline Verification verdict(const std::string& before, const std::string& after,
                            double tolerance_mm) {
  return verify(ReadText(before).read(), ReadText(after).read(), tolerance_mm);
}

inline std::size_t rewritten_runs(const SmoothResult& result) {
  std::size_t count = 0;
  for (const RunReport& run : result.runs) count += run.status == RunStatus::kRewritten ? 1 : 0;
  return count;
}

// Without their line ends.
inline std::vector<std::string> lines_of(const std::string& text) {
  std::vector<std::string> lines;
  std::size_t begin = 0;
  while (begin < text.size()) {
    const std::size_t end = std::min(text.find('\n', begin), text.size());
    lines.push_back(text.substr(begin, end - begin));
    if (!lines.back().empty() && lines.back().back() == '\r') lines.back().pop_back();
    begin = end + 1;
  }
  return lines;
}

// Lines `first` to `last` (counted from 1) as they stand, line ends included.
inline std::string lines_between(const std::string& text, std::uint32_t first, std::uint32_t last) {
  std::string part;
  std::uint32_t line = 1;
  for (const char c : text) {
    if (line >= first && line <= last) part += c;
    if (c == '\n') ++line;
  }
  return part;
}

// Every stretch of lines outside rewritten runs stands in the output, unchanged and in order.
inline void expect_rest_copied(const std::string& before, const SmoothResult& result) {
  std::size_t from = 0;
  std::uint32_t next = 1;
  const auto expect_next = [&](std::uint32_t last) {
    if (next > last) return;
    const std::string part = lines_between(before, next, last);
    const std::size_t at = result.text.find(part, from);
    ASSERT_NE(at, std::string::npos) << "lines " << next << " to " << last;
    if (from == 0) {
      EXPECT_TRUE(at == 0 || next > 1) << "something stands before the first line";
    }
    from = at + part.size();
  };
  for (const RunReport& run : result.runs) {
    if (run.status != RunStatus::kRewritten) continue;
    expect_next(run.first_line - 1);
    next = run.last_line + 1;
  }
  expect_next(static_cast<std::uint32_t>(lines_of(before).size()));
  EXPECT_EQ(from, result.text.size()) << "something stands behind the last line";
}

}  // namespace batten::postproc
