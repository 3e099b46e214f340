// What could be had of a program: its figures under many settings of `smooth`, and the one to take.
#pragma once

#include <array>
#include <optional>
#include <vector>

#include "gcode/text/source_text.h"
#include "postproc/options/options.h"
#include "postproc/stream/smooth_result.h"

namespace batten::postproc {

// In parts of the programmed feeds: the feed override, or another F.
inline constexpr std::array<double, 4> kExploredFeeds = {1, 1.5, 2, 4};

struct ExploredFigures {
  double time_s = 0;                  // of the program
  double blocks = 0;                  // of the program
  PathFigures path;                   // of the runs that may be rewritten
  bool rewritten = false;             // any of these
  std::vector<double> at_feeds = {};  // s of the program, of what is proved alone

  [[nodiscard]] std::array<double, 4> four() const {
    return {time_s, blocks, path.distance_mm, path.roughness};
  }
};

struct ExploredRow {
  SmoothOptions options;
  ExploredFigures before;
  ExploredFigures after;
  bool dominated = false;          // another one is no worse in all four figures, and better in one
  bool proved = false;             // the figures are those of the proved text that `smooth` writes
  std::size_t runs = 0;            // that may be rewritten
  std::size_t runs_looked_at = 0;  // where they are fewer, these stand for all of them
};

struct Exploration {
  SmoothResult read;              // not understood: stopped, or its diagnostics say why; no rows
  std::vector<ExploredRow> rows;  // one for each setting, in their order
  std::optional<std::size_t> recommended;  // proved; nothing: none is worth it
};

// `settings` differ in tolerance, output and prefer only; those of a tolerance are neighbours,
// whose curves and candidates are made once. Forms of few moves take most of the effort of `smooth`
// and get less here: with prefer size or a named output it may find fewer blocks than are shown;
// what is shown for output auto and the other preferences is what it chooses. Nothing is written,
// and nothing proved but the recommended setting, which is smoothed as `smooth` does.
//
// Of many runs some stand for all (postproc/stream/run_sample.h): then the figures of settings that
// are not proved are estimates, and the first proved one that nothing speaks against is
// recommended.
//
// Deterministic for any number of threads. A long program is explored window by window.
[[nodiscard]] Exploration explore_program(const gcode::SourceText& source,
                                          const std::vector<SmoothOptions>& settings,
                                          const Progress& progress = {});

void mark_dominated(std::vector<ExploredRow>& rows);

// Of the rows that nothing speaks against, the one of the least cost, as between forms of a run
// (postproc/smooth/selection/cost.h); a larger tolerance has to win half a percent more. By time,
// unless all rows have another preference. `proved`: of those alone.
[[nodiscard]] std::optional<std::size_t> recommended_row(const std::vector<ExploredRow>& rows,
                                                         bool proved = false);

}  // namespace batten::postproc
