// A construct of a language between two waves that would be smoothed without it: what is copied,
// why, and whether smoothing goes on behind it.
#pragma once

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <numbers>
#include <sstream>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "postproc/convert/conversion.h"
#include "postproc/smooth/part_runs.h"
#include "postproc/stream/inspect.h"
#include "tests/support/wavy_programs.h"

namespace batten::postproc {

struct Construct {
  std::string name;
  std::string target;
  std::string text;         // lines
  std::string reason = {};  // of its first line; empty: it stands inside a run and goes with it
  bool goes_on = true;      // the wave behind it is smoothed
  std::string state = {};   // otherwise: the reason why that wave is kept
  std::string off = {};     // lines behind that wave, after which smoothing goes on
  // --allow
  std::string allowed = {};
};

inline void PrintTo(const Construct& construct, std::ostream* out) {
  *out << construct.target << ": " << construct.text;
}

// One on each line of `table`, its fields between |; "\\n" ends a line of the program.
inline std::vector<Construct> constructs_in(std::string_view table) {
  std::vector<Construct> constructs;
  std::istringstream lines{std::string(table)};
  for (std::string line; std::getline(lines, line);) {
    if (line.empty()) continue;
    for (std::size_t at = 0; (at = line.find("\\n", at)) != std::string::npos;) {
      line.replace(at, 2, "\n");
    }
    std::array<std::string, 7> field;
    std::istringstream row(line);
    for (std::string& each : field) std::getline(row, each, '|');
    if (field[4] == "=") field[4] = field[3];
    constructs.push_back(
        {field[0], field[1], field[2], field[3], field[4].empty(), field[4], field[5], field[6]});
  }
  return constructs;
}

inline std::string construct_name(const testing::TestParamInfo<Construct>& info) {
  std::string name = info.param.target + "_" + info.param.name;
  std::ranges::replace(name, '-', '_');
  return name;
}

constexpr int kWaveLines = 100;

// The `index`th wave of a program.
inline std::string wave_part(gcode::Language language, int index) {
  std::string text;
  for (int i = 1; i <= kWaveLines; ++i) {
    const double x = 0.3 * (i + kWaveLines * index);
    const double y = 2 * std::sin(2 * std::numbers::pi * x / 18);
    if (language == gcode::Language::kKlartext) {
      text += fmt::format("L X{:+.3f} Y{:+.3f}{}\n", x, y, i == 1 ? " F2000" : "");
    } else {
      text +=
          fmt::format("{}X{:.3f} Y{:.3f}{}\n", i == 1 ? "G1 " : "", x, y, i == 1 ? " F2000." : "");
    }
  }
  return text;
}

inline std::string head_of(gcode::Language language) {
  switch (language) {
    case gcode::Language::kSiemens:
      return "%_N_TEST_MPF\nG71 G90 G17 G94 G40\nS12000 M3\nG0 X0 Y0 Z5\nG1 Z-1 F300.\n";
    case gcode::Language::kKlartext:
      return "BEGIN PGM TEST MM\nTOOL CALL 3 Z S12000\nL X+0 Y+0 Z+5 R0 FMAX M3\nL Z-1 F300\n";
    case gcode::Language::kRs274:
      break;
  }
  return "G21 G90 G17 G94 G40\nS12000 M3\nG0 X0 Y0 Z5.\nG1 Z-1. F300.\n";
}

inline std::string tail_of(gcode::Language language) {
  return language == gcode::Language::kKlartext ? "L Z+50 FMAX\nEND PGM TEST MM\n"
                                                : "G0 Z5.\nM30\n";
}

inline std::uint32_t line_count(const std::string& text) {
  return static_cast<std::uint32_t>(std::ranges::count(text, '\n'));
}

inline bool is_rewritten_within(const SmoothResult& result, std::uint32_t first,
                                std::uint32_t last) {
  return std::ranges::any_of(result.runs, [=](const RunReport& run) {
    return run.status == RunStatus::kRewritten && run.first_line >= first && run.last_line <= last;
  });
}

// What `batten inspect` tells of the program, read as for these options.
inline std::vector<InspectedSection> inspected(const std::string& text,
                                               const SmoothOptions& options) {
  gcode::Diagnostics found;
  const gcode::SourceText source("test.nc", text);
  const auto language = language_read(source, options, found);
  if (!language) return {};
  const PartReading reading{options.source, reading_of(options, *language),
                            read_options_of(options)};
  return inspect(read_whole(source, reading, found), grouping_of(options));
}

inline std::string reason_at(const std::vector<InspectedSection>& sections, std::uint32_t line) {
  for (const InspectedSection& section : sections) {
    if (section.first_line <= line && line <= section.last_line) {
      return std::string(section.reason);
    }
  }
  return "no such line";
}

inline void expect_kept_construct(const Construct& construct) {
  SmoothOptions options = options_for(construct.target);
  if (!construct.allowed.empty()) options.allowed = {construct.allowed};
  const gcode::Language language = options.target->language;
  std::string before = head_of(language);
  const auto add_wave = [&](int index) {
    const std::uint32_t first = line_count(before) + 1;
    before += wave_part(language, index);
    return std::pair(first, line_count(before));
  };
  const auto front = add_wave(0);
  const std::uint32_t place = line_count(before) + 1;
  before += construct.text + "\n";
  const auto behind = add_wave(1);
  std::pair<std::uint32_t, std::uint32_t> last = {0, 0};
  if (!construct.off.empty()) {
    before += construct.off + "\n";
    last = add_wave(2);
  }
  before += tail_of(language);

  const SmoothResult result = smoothed(before, options);
  ASSERT_TRUE(result.understood);
  EXPECT_TRUE(result.proved);
  expect_rest_copied(before, result);
  // Comments go with a run, words are its path.
  const bool is_comment = construct.text.find_first_of("(;*") == 0;
  if (!construct.reason.empty() || is_comment) {
    EXPECT_NE(result.text.find(construct.text), std::string::npos);
  }
  EXPECT_EQ(smoothed(result.text, options).text, result.text) << "a second pass";
  if (construct.reason.empty()) {
    EXPECT_TRUE(is_rewritten_within(result, front.first, behind.second));
    return;
  }
  const std::vector<InspectedSection> sections = inspected(before, options);
  EXPECT_EQ(reason_at(sections, place), construct.reason);
  EXPECT_TRUE(is_rewritten_within(result, front.first, place - 1)) << "in front of it";
  EXPECT_EQ(is_rewritten_within(result, place, behind.second), construct.goes_on) << "behind it";
  if (!construct.goes_on) {
    EXPECT_EQ(reason_at(sections, behind.second), construct.state);
    EXPECT_NE(result.text.find(lines_between(before, place, behind.second)), std::string::npos);
  }
  if (!construct.off.empty()) {
    EXPECT_TRUE(is_rewritten_within(result, last.first, last.second)) << "behind " << construct.off;
  }
}

}  // namespace batten::postproc
