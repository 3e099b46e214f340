// The fastest motion over a section of a path that bends: the search (feed_search.h) for speed^2
// and its slope at nodes along it, where each interval between two nodes has speed^2 as a cubic of
// the distance, so that speed and acceleration are continuous and the jerk may jump at nodes.
//
// A long section is searched in windows one after the other. What is kept of a window ends where it
// is slow and several stops before the window does, so the rest of the way changes next to nothing
// there; the next one starts from that state. So what is hard about one place costs no steps at
// others, and the memory of a search does not grow with the section.
#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "postproc/machine/planner/feed_plan_path.h"
#include "postproc/machine/planner/feed_search.h"
#include "postproc/machine/planner/feed_sections.h"

namespace batten::postproc {

// How densely a section is cut into intervals; `density` as plan_feed has it.
[[nodiscard]] GridRule grid_of(double density);

struct SectionWindows {
  std::size_t kept = 1000;  // intervals: at most as many of each window stay
  std::size_t ahead = 150;  // and so many behind them are looked at
};

struct RefineRule;

class BentSection {
 public:
  BentSection(std::span<const geometry::PathPiece> path, const PlannedSection& section,
              LimitsOfPieces limits, double density, const SectionWindows& windows = {});

  // A local optimum. Where no search comes to an end, at a cusp, all goes as slowly as that has to
  // be passed.
  void solve();

  std::vector<FeedInterval> intervals;  // between those from and to rest
  std::vector<double> x;                // q = speed^2 and p = dq/ds of the nodes in turn
  FeedInterval first;                   // from rest, where it is
  FeedInterval last;
  RestMotion start;
  RestMotion end;
  std::size_t windows = 0;  // of the last search: one where it had to be in one piece

 private:
  // Intervals from..to.
  struct Window {
    std::size_t from = 0;
    std::size_t to = 0;
  };

  [[nodiscard]] SearchProblem problem(const Window& window, const std::vector<double>& found) const;
  void add_interval(std::size_t number, std::size_t from, SearchProblem& problem) const;
  [[nodiscard]] std::vector<double> next_start(const Window& window,
                                               const SearchProblem& problem) const;
  [[nodiscard]] std::vector<double> rough_start(const Window& window, const SearchProblem& problem,
                                                const std::vector<double>& found) const;
  [[nodiscard]] bool search();
  [[nodiscard]] bool search_in(const SectionWindows& windows);
  [[nodiscard]] bool is_too_long(std::size_t number, const RefineRule& rule) const;
  std::size_t refine(const RefineRule& rule);

  std::span<const geometry::PathPiece> path_;
  const PlannedSection& section_;
  LimitsOfPieces limits_;
  std::span<const RefineRule> refinements_;
  SectionWindows windows_;
};

}  // namespace batten::postproc
