#include "geometry/fitting/fair/fair_knots.h"

#include <algorithm>
#include <cstddef>
#include <utility>

namespace batten::geometry {

namespace {

std::vector<double> in_order(std::vector<double> along, std::vector<double> about_corners) {
  if (!std::is_sorted(along.begin(), along.end())) std::sort(along.begin(), along.end());
  std::sort(about_corners.begin(), about_corners.end());
  const auto middle = static_cast<std::ptrdiff_t>(along.size());
  along.insert(along.end(), about_corners.begin(), about_corners.end());
  std::inplace_merge(along.begin(), along.begin() + middle, along.end());
  return along;
}

}  // namespace

std::vector<double> knots_of(std::vector<double> along, std::vector<double> about_corners,
                             const FitProblem& problem, const ParameterRange& path,
                             double closest) {
  const std::vector<double> wished = in_order(std::move(along), std::move(about_corners));
  const std::vector<double> needed = required_breaks(problem);
  const auto is_needed = [&](double u) {
    return std::binary_search(needed.begin(), needed.end(), u);
  };
  std::vector<double> kept;
  kept.reserve(wished.size());
  std::size_t next = 0;
  std::size_t zone = 0;
  for (const double u : wished) {
    while (next < needed.size() && needed[next] < u) ++next;
    const bool must = next < needed.size() && needed[next] == u;
    if (must) {
      while (!kept.empty() && u - kept.back() < closest && !is_needed(kept.back())) {
        kept.pop_back();
      }
      if (kept.empty() || kept.back() != u) kept.push_back(u);
      continue;
    }
    while (zone < problem.zones.size() && problem.zones[zone].to <= u) ++zone;
    const bool inside = zone < problem.zones.size() && u > problem.zones[zone].from;
    const bool outside_path = u <= path.from || u >= path.to;
    if (inside || outside_path || (!kept.empty() && u - kept.back() < closest)) continue;
    kept.push_back(u);
  }
  return kept;
}

}  // namespace batten::geometry
