// Where a cubic polynomial is zero between 0 and 1.
#pragma once

#include <vector>

namespace batten::geometry {

// Appends offset + t for every t in [0, 1] where c0 + c1 t + c2 t^2 + c3 t^3 changes its sign or
// is 0 at an end of a stretch on which it only rises or only falls, to about 1e-13 in t. Places
// where it touches 0 without crossing may be missed by rounding. No place at all where every
// coefficient is 0.
void append_cubic_roots(double c0, double c1, double c2, double c3, double offset,
                        std::vector<double>& places);

}  // namespace batten::geometry
