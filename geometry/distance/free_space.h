// The decision of Alt and Godau: is there a way through the free space of two chord
// polylines, that is, can both be passed in order with the places never further apart than a
// given distance? H. Alt, M. Godau, Computing the Fréchet distance between two polygonal
// curves, Int. J. Computational Geometry & Applications 5 (1995) 75-91, section 3.1.
//
// Where we differ from the paper: only cells that can be reached are visited, so that the
// cost is linear where the polylines run beside each other; each cell has its own distance,
// since each chord has its own error; the way found is handed back.
#pragma once

#include <cstddef>

#include "geometry/distance/chord_polyline.h"
#include "geometry/distance/in_order_matching.h"

namespace batten::geometry {

enum class Passage {
  kFound,
  kNone,     // no way
  kTooWide,  // more cells than allowed were free
};

// What is asked of the chords, so that an answer holds for the paths they stand for.
enum class ChordErrors {
  kSubtracted,  // a way at distance minus both errors is a way for the paths: to prove
  kAdded,       // no way at distance plus both errors means none for the paths: to refute
};

struct FreeSpaceAnswer {
  Passage passage = Passage::kNone;
  Matching way;          // of kFound
  MatchedPair furthest;  // of kNone: about where the way ends
};

// `distance` in mm. In rounded numbers: an answer kNone holds for every distance that is
// smaller by the rounding of a distance of two places or more; a way has to be measured.
// `most_cells` bounds the cost: some 24 bytes and 50 ns for each.
[[nodiscard]] FreeSpaceAnswer find_passage(const ChordPolyline& a, const ChordPolyline& b,
                                           double distance, ChordErrors errors,
                                           std::size_t most_cells);

}  // namespace batten::geometry
