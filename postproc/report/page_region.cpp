#include "postproc/report/page_region.h"

#include <utility>

#include "geometry/band/band_region.h"
#include "geometry/band/tolerance_band.h"

namespace batten::postproc {
namespace {

// Of the tolerance: less than half a pixel where it is 60 pixels wide. So far off are the chords of
// arcs, and places of the edge of the region that are left out.
constexpr double kRegionDrawnWithin = 0.005;

// The polygon without corners on the straight way from the corner before to the one after.
std::vector<geometry::Point2> without_straight_corners(const std::vector<geometry::Point2>& all,
                                                       double within) {
  std::vector<geometry::Point2> kept;
  for (std::size_t i = 0; i < all.size(); ++i) {
    if (kept.empty() || i + 1 == all.size()) {
      kept.push_back(all[i]);
      continue;
    }
    const geometry::Vector2 along = all[i + 1] - kept.back();
    const geometry::Vector2 off = all[i] - kept.back();
    const double across = along.x() * off.y() - along.y() * off.x();
    const bool goes_on = off.dot(along) > 0;
    if (!goes_on || across * across > within * within * along.squaredNorm()) kept.push_back(all[i]);
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
  const std::size_t edges = flat->before.size() - 1;
  if (region.edges + edges > most_edges) {
    ++region.left_out;
    return;
  }
  region.edges += edges;
  ++region.drawn;
  for (const auto& polygon : geometry::band_outline(flat->before, tolerance_mm)) {
    std::vector<geometry::Point3> corners;
    for (const geometry::Point2& corner : without_straight_corners(polygon, within)) {
      corners.push_back(flat->in_space(corner));
    }
    region.polygons.push_back(std::move(corners));
  }
}

}  // namespace batten::postproc
