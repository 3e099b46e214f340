// The least value of a function of a few variables that has kinks and forbidden places.
#pragma once

#include <functional>
#include <vector>

namespace batten::geometry {

struct PatternSearchOptions {
  std::vector<double> steps;  // first step of each variable, > 0
  int max_evaluations = 1000;
  double finest = 1e-5;  // ends when the steps are this part of the first ones
};

struct PatternSearchResult {
  std::vector<double> at;
  double value;
  int evaluations;
};

// From `start`, looks around in the directions of the variables and in as many others that turn
// from round to round, so that a valley with a kinked floor is followed; goes to the best place
// if it is better, else shortens the steps. Never gives a worse value than at `start`. The same
// numbers come out every time. (V. Torczon 1997; turning directions: M. Abramson, C. Audet et
// al. 2009, here the simplest of their kind.)
//
// Requires as many steps as variables, one or more.
[[nodiscard]] PatternSearchResult pattern_search(
    const std::function<double(const std::vector<double>&)>& f, std::vector<double> start,
    const PatternSearchOptions& options);

}  // namespace batten::geometry
