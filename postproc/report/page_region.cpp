#include "postproc/report/page_region.h"

#include <algorithm>
#include <utility>

#include "geometry/band/band_region.h"
#include "geometry/band/tolerance_band.h"

namespace batten::postproc {
namespace {

using geometry::Point2;

// Of the tolerance: less than half a pixel where it is 60 pixels wide. So far off are the chords of
// arcs, and places of the path and of the edge of the region that are left out.
constexpr double kRegionDrawnWithin = 0.005;
// Left out in a row at most: each step asks all of them again.
constexpr std::size_t kMostRegionSkipped = 64;

// The places without those that are near the chord from a kept one to the next. The ends stay.
std::vector<Point2> thinned_places(std::span<const Point2> all, double within) {
  std::vector<Point2> kept = {all.front()};
  for (std::size_t from = 0; from + 1 < all.size();) {
    std::size_t to = from + 1;
    const auto may_skip_to = [&](std::size_t next) {
      const auto is_near = [&](const Point2& place) {
        return geometry::distance_to_segment(place, all[from], all[next]) <= within;
      };
      return std::ranges::all_of(all.subspan(from + 1, next - from - 1), is_near);
    };
    while (to + 1 < all.size() && to - from < kMostRegionSkipped && may_skip_to(to + 1)) ++to;
    kept.push_back(all[to]);
    from = to;
  }
  return kept;
}

}  // namespace

void add_region(std::span<const geometry::PathPiece> before,
                std::span<const geometry::PathPiece> after, double tolerance_mm,
                std::size_t most_edges, PageRegion& region) {
  const double within = kRegionDrawnWithin * tolerance_mm;
  const auto flat = geometry::flat_paths(before, after, within);
  if (!flat) {
    ++region.in_space;
    return;
  }
  const std::vector<Point2> path = thinned_places(flat->before, within);
  const std::size_t edges = path.size() - 1;
  if (region.edges + edges > most_edges) {
    ++region.left_out;
    return;
  }
  region.edges += edges;
  ++region.drawn;
  for (const auto& polygon : geometry::band_outline(path, tolerance_mm)) {
    std::vector<geometry::Point3> corners;
    for (const Point2& corner : thinned_places(polygon, within)) {
      corners.push_back(flat->in_space(corner));
    }
    region.polygons.push_back(std::move(corners));
  }
}

}  // namespace batten::postproc
