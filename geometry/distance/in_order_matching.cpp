#include "geometry/distance/in_order_matching.h"

#include <algorithm>

namespace batten::geometry {
namespace {

// Is `to` on the edge of the step that ends there, not before `from`?
bool forward(const PlaceOnChord& from, const PlaceOnChord& to) {
  if (to.t < 0 || to.t > 1) return false;
  if (from.edge == to.edge) return from.t <= to.t;
  return from.edge + 1 == to.edge && from.t == 1;
}

// Where on its edge a path stands that may have just come to the edge's end.
PlaceOnChord leave_end(const PlaceOnChord& place, const ChordPolyline& polyline) {
  if (place.t < 1 || place.edge + 1 == polyline.edge_count()) return place;
  return {place.edge + 1, 0};
}

}  // namespace

Matching match_nearest(const ChordPolyline& a, const ChordPolyline& b) {
  Matching matching;
  matching.reserve(a.points.size() + b.points.size());
  MatchedPair here{{0, 0}, {0, 0}};
  matching.push_back(here);
  while (true) {
    const PlaceOnChord on_a = leave_end(here.a, a);
    const PlaceOnChord on_b = leave_end(here.b, b);
    const Point3& next_a = a.points[on_a.edge + 1];
    const Point3& next_b = b.points[on_b.edge + 1];
    const MatchedPair to_a{{on_a.edge, 1},
                           {on_b.edge, nearest_parameter(b, on_b.edge, next_a, on_b.t, 1)}};
    const MatchedPair to_b{{on_a.edge, nearest_parameter(a, on_a.edge, next_b, on_a.t, 1)},
                           {on_b.edge, 1}};
    // A path at its end waits there: the other one can only come to it.
    const bool a_waits = on_a.t == 1;
    const bool b_waits = on_b.t == 1;
    if (a_waits && b_waits) return matching;
    const double step_a = (next_a - point_at(b, to_a.b)).squaredNorm();
    const double step_b = (next_b - point_at(a, to_b.a)).squaredNorm();
    here = !a_waits && (b_waits || step_a <= step_b) ? to_a : to_b;
    matching.push_back(here);
  }
}

bool goes_forward(const Matching& matching, const ChordPolyline& a, const ChordPolyline& b) {
  if (matching.empty()) return false;
  const MatchedPair& first = matching.front();
  const MatchedPair& last = matching.back();
  if (first.a.edge != 0 || first.a.t != 0 || first.b.edge != 0 || first.b.t != 0) return false;
  if (last.a.edge + 1 != a.edge_count() || last.a.t != 1) return false;
  if (last.b.edge + 1 != b.edge_count() || last.b.t != 1) return false;
  for (std::size_t k = 1; k < matching.size(); ++k) {
    if (!forward(matching[k - 1].a, matching[k].a)) return false;
    if (!forward(matching[k - 1].b, matching[k].b)) return false;
  }
  return true;
}

double pair_error(const Matching& matching, std::size_t k, const ChordPolyline& a,
                  const ChordPolyline& b) {
  const double into = step_error(matching, k, a, b);
  if (k + 1 == matching.size()) return into;
  return std::max(into, step_error(matching, k + 1, a, b));
}

MeasuredMatching measure(const Matching& matching, const ChordPolyline& a, const ChordPolyline& b,
                         double noise) {
  MeasuredMatching found;
  for (std::size_t k = 0; k < matching.size(); ++k) {
    const double apart = (point_at(a, matching[k].a) - point_at(b, matching[k].b)).norm();
    // Equal coordinates are one place, without noise.
    const double bound = (apart > 0 ? apart + noise : 0) + pair_error(matching, k, a, b);
    if (bound > found.at_most) found = {bound, k};
  }
  return found;
}

}  // namespace batten::geometry
