#include "postproc/smooth/forms/output_plan.h"

#include <algorithm>
#include <stdexcept>
#include <string>

#include "geometry/basic/rounding.h"

namespace batten::postproc {
namespace {

// Parameters this close are one place of the curve.
double same_parameter(const geometry::BsplineCurve& curve) {
  return geometry::kSameKnot * (curve.last() - curve.first());
}

void check(const Run& run, const geometry::SmoothCurve& fair) {
  if (fair.vertex_parameters.size() != run.points.size()) {
    throw std::invalid_argument("feed_stretches: " + std::to_string(fair.vertex_parameters.size()) +
                                " vertex parameters, expected " +
                                std::to_string(run.points.size()) + " (one per point of the run)");
  }
  if (run.feeds.empty()) {
    throw std::invalid_argument("feed_stretches: run without a feed, expected one at least");
  }
}

}  // namespace

std::vector<FeedStretch> feed_stretches(const Run& run, const geometry::SmoothCurve& fair) {
  check(run, fair);
  const double noise = same_parameter(fair.curve);
  const double last = fair.curve.last();
  std::vector<FeedStretch> stretches = {{fair.curve.first(), last, run.feeds.front().feed}};
  for (const FeedFrom& change : run.feeds) {
    const double at = fair.vertex_parameters.at(change.vertex);
    if (last - at <= noise) break;  // a feed that nothing is run at
    FeedStretch& before = stretches.back();
    if (at - before.from <= noise) {  // the feed before it was replaced at once
      before.feed = change.feed;
    } else if (change.feed != before.feed) {
      before.to = at;
      stretches.push_back({at, last, change.feed});
    }
    // A replaced feed may leave two stretches of one feed.
    if (stretches.size() >= 2 && stretches.back().feed == stretches[stretches.size() - 2].feed) {
      stretches.pop_back();
      stretches.back().to = last;
    }
  }
  return stretches;
}

void place_comments(const Run& run, const geometry::SmoothCurve& fair,
                    std::span<const double> starts, OutputPlan& plan) {
  const double noise = same_parameter(fair.curve);
  for (std::size_t i = 0; i < run.comments.size(); ++i) {
    const double at = fair.vertex_parameters.at(run.comments[i].vertex);
    const auto next = std::ranges::lower_bound(starts, at - noise);
    if (next == starts.end()) {
      plan.comments_after.push_back(i);
    } else {
      plan.moves[static_cast<std::size_t>(next - starts.begin())].comments_before.push_back(i);
    }
  }
}

}  // namespace batten::postproc
