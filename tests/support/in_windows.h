// Programs smoothed window by window beside the same ones as one window.
#pragma once

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <fstream>
#include <limits>
#include <sstream>
#include <string>
#include <string_view>
#include <tuple>
#include <utility>
#include <vector>

#include "gcode/text/diagnostic.h"
#include "gcode/text/source_text.h"
#include "postproc/stream/pipeline.h"
#include "tests/support/places.h"
#include "tests/support/wavy_programs.h"

namespace batten::postproc {

struct InWindows {
  SmoothResult result;
  std::string text;
  std::size_t parts = 0;  // windows; 1 where the program was not cut
  std::size_t restarts = 0;
  [[nodiscard]] bool cut() const { return parts > 1; }
};

inline InWindows in_windows(const std::string& text, const SmoothOptions& options,
                            const WindowLimits& limits, bool mend_windows = false) {
  InWindows done;
  const ProgramSink sink = {[&](std::string_view part) {
                              done.text += part;
                              ++done.parts;
                              return true;
                            },
                            [&] {
                              done.text.clear();
                              done.parts = 0;
                              ++done.restarts;
                              return true;
                            }};
  const gcode::SourceText source("part.nc", text);
  done.result = smooth_program(source, options, sink, {}, {0, limits, mend_windows});
  return done;
}

inline InWindows in_windows(const std::string& text, const SmoothOptions& options,
                            std::size_t least_blocks) {
  return in_windows(text, options, WindowLimits{.least_blocks = least_blocks});
}

inline SmoothResult as_a_whole(const std::string& text, const SmoothOptions& options,
                               const LongRunLimits& long_runs = {}) {
  constexpr std::size_t kNever = std::numeric_limits<std::size_t>::max();
  return smooth_program(gcode::SourceText("part.nc", text), options, {},
                        {kNever, {.long_runs = long_runs}});
}

inline std::vector<std::string> words_of(const gcode::Diagnostics& diagnostics) {
  std::vector<std::string> words;
  for (const gcode::Diagnostic& each : diagnostics) {
    words.push_back(fmt::format("{} {} {}-{} {}", static_cast<int>(each.severity), each.id,
                                each.where.begin, each.where.end, each.message));
  }
  return words;
}

// Every field, the numbers to their last bit.
inline std::string words_of(const RunReport& run) {
  std::string text = fmt::format(
      "{}-{} {} {:a} {} {} {} {} {}->{} {:a} {} {:a} {:a} {:a} {:a} {:a} {:a}", run.first_line,
      run.last_line, run.points, run.tolerance_mm, static_cast<int>(run.status), run.reason,
      run.method, static_cast<int>(run.form), run.blocks_in, run.blocks_out, run.deviation_mm,
      run.proved, run.noise_mm, run.coarse_part, run.max_curvature_before, run.max_curvature_after,
      run.time_before_s, run.time_after_s);
  for (const MethodTime& each : run.methods) {
    text += fmt::format(" {} {:a}", each.method, each.time_s);
  }
  return text;
}

inline void expect_same(const InWindows& windows, const SmoothResult& whole) {
  const SmoothResult& parts = windows.result;
  ASSERT_EQ(windows.text, whole.text);
  EXPECT_EQ(words_of(parts.diagnostics), words_of(whole.diagnostics));
  ASSERT_EQ(parts.runs.size(), whole.runs.size());
  for (std::size_t i = 0; i < whole.runs.size(); ++i) {
    EXPECT_EQ(words_of(parts.runs[i]), words_of(whole.runs[i])) << "run " << i;
  }
  const auto stated = [](const SmoothResult& r) {
    std::vector<std::pair<std::uint32_t, double>> lines;
    for (const StatedFrom& from : r.stated) {
      lines.emplace_back(from.line, from.tolerance_mm.value_or(-1));
    }
    return lines;
  };
  EXPECT_EQ(stated(parts), stated(whole));
  const auto figures = [](const SmoothResult& r) {
    return std::tuple(r.understood, r.units, r.blocks_in, r.blocks_out, r.bytes_out, r.added_lines,
                      r.deviation_mm, r.deviation_line, r.corner_mm, r.runs_before_s,
                      r.runs_after_s, r.program_before.seconds, r.program_before.slow_s,
                      r.program_after.seconds, r.program_after.slow_s, r.proved);
  };
  EXPECT_EQ(figures(parts), figures(whole));
}

// The programs of samples/ in the order of their names, by which a failure names them.
inline std::vector<std::pair<std::string, std::string>> sample_programs() {
  std::vector<std::pair<std::string, std::string>> programs;
  const std::filesystem::path root = std::filesystem::path(BATTEN_SOURCE_DIR) / "samples";
  for (const auto& entry : std::filesystem::recursive_directory_iterator(root)) {
    const std::string suffix = entry.path().extension().string();
    if (suffix != ".nc" && suffix != ".ngc" && suffix != ".gcode") continue;
    std::ostringstream text;
    text << std::ifstream(entry.path(), std::ios::binary).rdbuf();
    programs.emplace_back(entry.path().string(), text.str());
  }
  std::ranges::sort(programs);
  return programs;
}

// Controls, methods, tolerances and threads in turn.
inline SmoothOptions options_of_seed(unsigned seed) {
  static const std::vector<std::string> kTargets = {"linuxcnc", "fanuc", "grbl", "haas"};
  SmoothOptions options = options_for(kTargets[seed % kTargets.size()]);
  options.threads = 1 + static_cast<int>(seed % 2);
  options.share_work = false;  // among the runs of a window
  if (seed % 6 != 1) options.method = Method::kFair;
  if (seed % 5 == 2) options.tolerance_kind = geometry::ToleranceKind::kBand;
  if (seed % 7 == 3) options.allowed = {"exact-stop"};
  return options;
}

}  // namespace batten::postproc
