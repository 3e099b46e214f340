// The path beside another one: every place of it moved sideways by the same distance.
// Method: docs/algorithms/one_side.md.
#pragma once

#include <optional>
#include <span>

#include "geometry/basic/point.h"
#include "geometry/basic/side.h"
#include "geometry/path/path.h"

namespace batten::geometry {

// Unit, level, to the left of a direction seen from above; zero for one that is upright.
[[nodiscard]] Vector3 left_of(const Vector3& direction);

// `distance` (mm, > 0) to that side, at the same height. At a vertex it goes round it on an arc of
// that radius, forwards on the outside and backwards on the inside, so that each of its places
// belongs to one of the path, in order, and a disc of that radius about it touches the path there.
// Where the path goes straight up or down it stays beside the place where it was.
//
// Nothing for paths with Bezier pieces, or with arcs that do not turn about Z, and for
// Side::kBoth.
[[nodiscard]] std::optional<Path> parallel_path(std::span<const PathPiece> path, Side side,
                                                double distance);

}  // namespace batten::geometry
