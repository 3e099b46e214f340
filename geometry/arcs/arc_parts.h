// An arc in several, for controls that do not take long ones.
#pragma once

#include <vector>

#include "geometry/path/path.h"

namespace batten::geometry {

struct ArcPartsOptions {
  double max_sweep = 0;  // radians, > 0
  // Directions from the centre that no part goes across: this one and its quarter turns. A unit
  // vector across the arc's axis, or zero: none.
  Vector3 quadrant_from = Vector3::Zero();
};

// Parts of the same circle or helix that follow each other from the arc's start to its end; the arc
// itself where it is short enough. Where only the sweep counts all parts are alike.
//
// A start or end beside a direction by less than a millionth of a radian counts as on it: a part of
// that length would be none for most controls.
[[nodiscard]] std::vector<Arc> arc_parts(const Arc& arc, const ArcPartsOptions& options);

}  // namespace batten::geometry
