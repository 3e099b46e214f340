#include "postproc/smooth/forms/output_plan.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include "geometry/basic/rounding.h"

namespace batten::postproc {
namespace {

// Parameters this close are one.
double same_parameter(const geometry::BsplineCurve& curve) {
  return geometry::kSameKnot * (curve.last() - curve.first());
}

}  // namespace

std::vector<FeedSection> feed_sections(const Run& run, const geometry::SmoothCurve& fair) {
  if (fair.vertex_parameters.size() != run.points.size() || run.feeds.empty()) {
    throw std::invalid_argument(
        fmt::format("feed_sections: {} vertex parameters for {} points and {} feeds, expected one "
                    "per point and "
                    "a feed at least",
                    fair.vertex_parameters.size(), run.points.size(), run.feeds.size()));
  }
  const double noise = same_parameter(fair.curve);
  const double last = fair.curve.last();
  std::vector<FeedSection> sections = {{fair.curve.first(), last, run.feeds.front().feed}};
  for (const FeedFrom& change : run.feeds) {
    const double at = fair.vertex_parameters.at(change.vertex);
    if (last - at <= noise) break;  // a feed that nothing is run at
    FeedSection& before = sections.back();
    if (at - before.from <= noise) {  // the feed before it was replaced at once
      before.feed = change.feed;
    } else if (change.feed != before.feed) {
      before.to = at;
      sections.push_back({at, last, change.feed});
    }
    // A replaced feed may leave two sections of one feed.
    if (sections.size() >= 2 && sections.back().feed == sections[sections.size() - 2].feed) {
      sections.pop_back();
      sections.back().to = last;
    }
  }
  return sections;
}

void place_comments(const Run& run, const geometry::SmoothCurve& fair, OutputPlan& plan) {
  const double noise = same_parameter(fair.curve);
  for (std::size_t i = 0; i < run.comments.size(); ++i) {
    const CommentAt& comment = run.comments[i];
    const std::size_t behind = comment.behind_words ? comment.vertex : comment.vertex - 1;
    const double at = fair.vertex_parameters.at(behind);
    const auto next = std::ranges::lower_bound(plan.moves, at - noise, {}, &PlannedMove::start);
    (next == plan.moves.end() ? plan.comments_after : next->comments_before).push_back(i);
  }
}

bool lies_across(const Run& run, int axis) {
  const double height = run.points.front()[axis];
  return std::ranges::all_of(run.points, [&](const geometry::Point3& p) {
    return std::abs(p[axis] - height) <= geometry::kSamePlace;
  });
}

geometry::Path chords_for(const geometry::Arc& arc, double deviation) {
  const double half_angle = std::acos(std::max(1 - deviation / geometry::radius_of(arc), 0.0));
  const auto count = std::max(1, static_cast<int>(std::ceil(std::abs(arc.sweep) / 2 / half_angle)));
  geometry::Path chords;
  geometry::Point3 from = arc.start;
  for (int i = 1; i <= count; ++i) {
    const geometry::Point3 to = geometry::point_at(arc, static_cast<double>(i) / count);
    chords.push_back(geometry::Line{from, to});
    from = to;
  }
  return chords;
}

}  // namespace batten::postproc
