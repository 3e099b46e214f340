// On which side of a path another one may be.
#pragma once

namespace batten::geometry {

// Of the way of travel, seen from above (against Z).
enum class Side { kBoth, kLeft, kRight };

}  // namespace batten::geometry
