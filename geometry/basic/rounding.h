// Sizes of rounding noise. None of these is a promise to the user: a promise is a
// tolerance and comes from the options. Each constant says why it has its size.
#pragma once

namespace batten::geometry {

// Two places this close are one place (mm). Programs carry at most six decimals of a
// millimetre or of an inch, so distinct programmed places are 1e-6 mm apart or more;
// coordinates of 1e4 mm in double precision are exact to 2e-12 mm.
inline constexpr double kSamePlace = 1e-9;

// Two curve parameters this close are one knot, relative to the length of the knot
// vector: some 4,500 rounding steps of a double, far below the spacing of knots of the
// longest run (1e7 points).
inline constexpr double kSameKnot = 1e-12;

// Two unit directions whose difference is this small are the same direction. Above the
// rounding of normalised differences of coordinates, below any kink that a machine feels.
inline constexpr double kSameDirection = 1e-9;

}  // namespace batten::geometry
