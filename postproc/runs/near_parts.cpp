#include "postproc/runs/near_parts.h"

#include <algorithm>
#include <cstddef>
#include <utility>

namespace batten::postproc {

namespace {

// The axis across which a cover is.
constexpr int axis_of(std::size_t cover) { return 2 - static_cast<int>(cover); }

}  // namespace

double strand_width(double tolerance_mm) { return tolerance_mm; }

RunStrands::RunStrands(double tolerance_mm)
    : tolerance_(tolerance_mm),
      covers_{geometry::StrandCover(axis_of(0), strand_width(tolerance_mm)),
              geometry::StrandCover(axis_of(1), strand_width(tolerance_mm)),
              geometry::StrandCover(axis_of(2), strand_width(tolerance_mm))} {}

void RunStrands::add(const geometry::Point3& from, const geometry::Point3& to, std::uint32_t line) {
  if (first_line_ == 0) first_line_ = line;
  last_line_ = line;
  for (geometry::StrandCover& cover : covers_) cover.add(from, to, line);
}

void RunStrands::clear() {
  for (geometry::StrandCover& cover : covers_) cover.clear();
  first_line_ = 0;
}

std::optional<NearParts> RunStrands::near_parts(std::vector<std::uint32_t> cuts) const {
  std::size_t most = 0;
  for (std::size_t i = 1; i < covers_.size(); ++i) {
    if (covers_[i].edges() > covers_[most].edges()) most = i;
  }
  const auto strands = covers_[most].strands();
  if (!strands) return std::nullopt;
  NearParts near{first_line_, last_line_, std::move(cuts), axis_of(most), {}};
  const double reach = geometry::reach_between_parts(strand_width(tolerance_), tolerance_);
  near.strands = geometry::strands_near_other_parts(*strands, near.cuts, reach);
  if (near.strands.empty()) return std::nullopt;
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
