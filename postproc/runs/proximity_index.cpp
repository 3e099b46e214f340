#include "postproc/runs/proximity_index.h"

#include <algorithm>
#include <cstddef>
#include <utility>

namespace batten::postproc {

namespace {

// The axis across which a cover is.
constexpr int axis_of(std::size_t cover) { return 2 - static_cast<int>(cover); }

}  // namespace

double cluster_width(double tolerance_mm) { return tolerance_mm; }

ProximityIndex::ProximityIndex(double tolerance_mm)
    : tolerance_(tolerance_mm),
      covers_{geometry::ClusterCover(axis_of(0), cluster_width(tolerance_mm)),
              geometry::ClusterCover(axis_of(1), cluster_width(tolerance_mm)),
              geometry::ClusterCover(axis_of(2), cluster_width(tolerance_mm))} {}

void ProximityIndex::add(const geometry::Point3& from, const geometry::Point3& to,
                         std::uint32_t line) {
  if (first_line_ == 0) first_line_ = line;
  last_line_ = line;
  for (geometry::ClusterCover& cover : covers_) cover.add(from, to, line);
}

void ProximityIndex::clear() {
  for (geometry::ClusterCover& cover : covers_) cover.clear();
  first_line_ = 0;
}

std::optional<SelfProximity> ProximityIndex::self_proximity(std::vector<std::uint32_t> cuts) const {
  std::size_t most = 0;
  for (std::size_t i = 1; i < covers_.size(); ++i) {
    if (covers_[i].edges() > covers_[most].edges()) most = i;
  }
  const auto clusters = covers_[most].clusters();
  if (!clusters) return std::nullopt;
  SelfProximity near{first_line_, last_line_, std::move(cuts), axis_of(most), {}};
  const double reach = geometry::reach_between_parts(cluster_width(tolerance_), tolerance_);
  near.clusters = geometry::clusters_near_other_parts(*clusters, near.cuts, reach);
  if (near.clusters.empty()) return std::nullopt;
  return near;
}

std::vector<LineRange> joined(std::vector<LineRange> ranges, std::span<const LineRange> others) {
  ranges.insert(ranges.end(), others.begin(), others.end());
  std::ranges::sort(ranges, {}, &LineRange::first);
  std::vector<LineRange> all;
  for (const LineRange& range : ranges) {
    if (all.empty() || range.first > all.back().last) {
      all.push_back(range);
    } else {
      all.back().last = std::max(all.back().last, range.last);
    }
  }
  return all;
}

std::size_t lines_in(std::span<const LineRange> ranges) {
  std::size_t lines = 0;
  for (const LineRange& range : ranges) lines += range.last - range.first + 1;
  return lines;
}

bool holds(std::span<const LineRange> ranges, std::uint32_t line) {
  const auto found = std::ranges::lower_bound(ranges, line, {}, &LineRange::last);
  return found != ranges.end() && found->first <= line;
}

}  // namespace batten::postproc
