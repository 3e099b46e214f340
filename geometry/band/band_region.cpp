#include "geometry/band/band_region.h"

#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>
#include <CGAL/box_intersection_d.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "geometry/band/tolerance_band.h"
#include "geometry/band/tolerance_band_pairs.h"
#include "geometry/basic/require.h"
#include "geometry/basic/rounding.h"
#include "geometry/distance/chord_polyline.h"

namespace batten::geometry {
namespace {

using RegionKernel = CGAL::Exact_predicates_inexact_constructions_kernel;
using RegionPlace = RegionKernel::Point_2;
using RegionBox = CGAL::Box_intersection_d::Box_with_info_d<double, 2, std::size_t>;

// Of the tolerance: how far chords may be off, and what the region is greater by. The chords of
// both paths fit into it, and nothing within the tolerance touches its edge.
constexpr double kRegionChordPart = 0.02;
constexpr double kGrown = 1.045;

RegionPlace region_place(const Point2& point) { return {point.x(), point.y()}; }

// The axis across which both lie in one plane.
std::optional<int> common_plane(const ChordPolyline& before, const ChordPolyline& after) {
  for (const int axis : {2, 1, 0}) {
    const double height = before.points.front()[axis];
    const auto is_in_plane = [&](const Point3& p) {
      return std::abs(p[axis] - height) <= kSamePlace;
    };
    if (std::ranges::all_of(before.points, is_in_plane) &&
        std::ranges::all_of(after.points, is_in_plane)) {
      return axis;
    }
  }
  return std::nullopt;
}

std::vector<Point2> flattened(const ChordPolyline& chords, int axis) {
  std::vector<Point2> points;
  points.reserve(chords.points.size());
  for (const Point3& p : chords.points) points.push_back(across(p, axis));
  return points;
}

double length_along(std::span<const Point2> points) {
  double length = 0;
  for (std::size_t i = 1; i < points.size(); ++i) length += (points[i] - points[i - 1]).norm();
  return length;
}

// How often the closed polygon turns about the place, counter-clockwise, by exact orientations. The
// place is on none of its edges.
int turns_about(std::span<const Point2> polygon, const RegionPlace& place) {
  int turns = 0;
  for (std::size_t i = 0; i < polygon.size(); ++i) {
    const RegionPlace from = region_place(polygon[i]);
    const RegionPlace to = region_place(polygon[(i + 1) % polygon.size()]);
    const bool begins_below = from.y() <= place.y();
    const bool ends_below = to.y() <= place.y();
    if (begins_below == ends_below) continue;
    const auto side = CGAL::orientation(from, to, place);
    if (begins_below && side == CGAL::LEFT_TURN) ++turns;
    if (!begins_below && side == CGAL::RIGHT_TURN) --turns;
  }
  return turns;
}

double area_of(std::span<const Point2> polygon) {
  double twice = 0;
  const Point2& origin = polygon.front();
  for (std::size_t i = 1; i + 1 < polygon.size(); ++i) {
    const Point2 a = polygon[i] - origin;
    const Point2 b = polygon[i + 1] - origin;
    twice += a.x() * b.y() - a.y() * b.x();
  }
  return twice / 2;
}

struct RegionEdge {
  Point2 from;
  Point2 to;
};

std::vector<RegionBox> boxes_of(std::span<const RegionEdge> edges) {
  std::vector<RegionBox> boxes;
  boxes.reserve(edges.size());
  for (std::size_t i = 0; i < edges.size(); ++i) {
    const Point2 low = edges[i].from.cwiseMin(edges[i].to);
    const Point2 high = edges[i].from.cwiseMax(edges[i].to);
    boxes.emplace_back(CGAL::Bbox_2(low.x(), low.y(), high.x(), high.y()), i);
  }
  return boxes;
}

void add_edges(std::span<const Point2> points, bool closed, std::vector<RegionEdge>& edges) {
  for (std::size_t i = 1; i < points.size(); ++i) edges.push_back({points[i - 1], points[i]});
  if (closed) edges.push_back({points.back(), points.front()});
}

using RegionOutline = std::vector<std::vector<Point2>>;

// Where the chain leaves the region: nothing if nowhere.
std::optional<Point2> way_out(std::span<const Point2> chain, const RegionOutline& region) {
  int around = 0;
  std::vector<RegionEdge> edges;
  for (const std::vector<Point2>& polygon : region) {
    around += turns_about(polygon, region_place(chain.front()));
    add_edges(polygon, true, edges);
  }
  if (around != 1) return chain.front();
  std::vector<RegionEdge> steps;
  add_edges(chain, false, steps);
  std::vector<RegionBox> edge_boxes = boxes_of(edges);
  std::vector<RegionBox> step_boxes = boxes_of(steps);
  std::size_t first = steps.size();
  CGAL::box_intersection_d(
      step_boxes.begin(), step_boxes.end(), edge_boxes.begin(), edge_boxes.end(),
      [&](const RegionBox& step, const RegionBox& edge) {
        if (step.info() >= first) return;
        const RegionEdge& a = steps[step.info()];
        const RegionEdge& b = edges[edge.info()];
        if (CGAL::do_intersect(RegionKernel::Segment_2(region_place(a.from), region_place(a.to)),
                               RegionKernel::Segment_2(region_place(b.from), region_place(b.to)))) {
          first = step.info();
        }
      });
  if (first == steps.size()) return std::nullopt;
  return steps[first].from;
}

}  // namespace

Point3 FlatPaths::in_space(const Point2& flat) const {
  Point3 place = Point3::Constant(height);
  place[axis == 0 ? 1 : 0] = flat.x();  // as across() takes them out
  place[axis == 2 ? 1 : 2] = flat.y();
  return place;
}

std::optional<FlatPaths> flat_paths(std::span<const PathPiece> before,
                                    std::span<const PathPiece> after, double max_error) {
  if (before.empty() || after.empty()) return std::nullopt;
  const ChordPolyline old_chords = cut_into_chords(before, max_error);
  const ChordPolyline new_chords = cut_into_chords(after, max_error);
  const std::optional<int> axis = common_plane(old_chords, new_chords);
  if (!axis) return std::nullopt;
  FlatPaths flat{*axis, old_chords.points.front()[*axis], flattened(old_chords, *axis),
                 flattened(new_chords, *axis)};
  if (length_along(flat.before) <= kSamePlace || length_along(flat.after) <= kSamePlace) {
    return std::nullopt;
  }
  return flat;
}

std::optional<RegionCheck> check_in_region(std::span<const PathPiece> before,
                                           std::span<const PathPiece> after, double tolerance) {
  require(tolerance > 0 && std::isfinite(tolerance), "check_in_region: tolerance", tolerance,
          "a finite number above 0");
  const auto flat = flat_paths(before, after, kRegionChordPart * tolerance);
  if (!flat) return std::nullopt;
  const std::vector<Point2>& old_chain = flat->before;
  const std::vector<Point2>& new_chain = flat->after;
  const RegionOutline region = band_outline(old_chain, kGrown * tolerance);
  RegionCheck check;
  if (const auto place = way_out(new_chain, region)) {
    check.is_inside = false;
    check.place = flat->in_space(*place);
    return check;
  }
  // There and back again: it turns about no hole when both paths pass it alike.
  std::vector<Point2> loop = new_chain;
  loop.insert(loop.end(), old_chain.rbegin(), old_chain.rend());
  for (const std::vector<Point2>& polygon : region) {
    if (area_of(polygon) > 0) continue;
    ++check.holes;
    if (!check.passes_alike || turns_about(loop, region_place(polygon.front())) == 0) continue;
    check.passes_alike = false;
    check.place = flat->in_space(polygon.front());
  }
  return check;
}

}  // namespace batten::geometry
