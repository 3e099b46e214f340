// The decision of Alt and Godau: is there a way through the free space of two chord polylines, that
// is, can both be passed in order, never further apart than a given distance? H. Alt, M. Godau,
// Computing the Fréchet distance between two polygonal curves, Int. J. Computational Geometry &
// Applications 5 (1995) 75-91, section 3.1.
//
// Unlike the paper: only cells that can be reached are visited, so the cost is linear where the
// polylines run beside each other; each cell has its own distance, since each chord has its own
// error; the way found is returned.
#pragma once

#include <cstddef>
#include <vector>

#include "geometry/distance/chord_polyline.h"

namespace batten::geometry {

struct MatchedPair {  // passed at the same moment
  PlaceOnChord a;
  PlaceOnChord b;
};

// Pairs that go forward on both paths, from both starts to both ends, so that between neighbours
// both paths are one chord: the step into pair k runs on the edges named by pair k, and pair k - 1
// lies on them too (at the end of the edge before, or on the same edge).
using Matching = std::vector<MatchedPair>;

// Goes along both and each time takes the nearer of two steps: to the next vertex of `a` and what
// of `b` is nearest to it, or the other way round. Always a matching, linear cost, and the best one
// where the paths run beside each other; where one of them folds, it may be far from the best.
[[nodiscard]] Matching match_nearest(const ChordPolyline& a, const ChordPolyline& b);

// The part of such a matching between two pairs. Of two steps whose squares (mm^2) differ by less
// than |tie| it takes that on `a` where tie > 0, that on `b` where tie < 0. Requires: `to` is not
// before `from` on either.
[[nodiscard]] Matching match_nearest(const ChordPolyline& a, const ChordPolyline& b,
                                     const MatchedPair& from, const MatchedPair& to,
                                     double tie = 0);

// Is it a matching? The part of the certificate that asks no distance.
[[nodiscard]] bool goes_forward(const Matching& matching, const ChordPolyline& a,
                                const ChordPolyline& b);

struct MeasuredMatching {
  double at_most = 0;     // mm, greatest pair distance plus chord errors, rounded up by `noise`
  std::size_t worst = 0;  // index of that pair
};

// `noise`: mm, rounding of a distance.
[[nodiscard]] MeasuredMatching measure(const Matching& matching, const ChordPolyline& a,
                                       const ChordPolyline& b, double noise);

// Sum of the chord errors on the step into pair k or out of it, whichever is larger: both have it
// as an end.
[[nodiscard]] double pair_error(const Matching& matching, std::size_t k, const ChordPolyline& a,
                                const ChordPolyline& b);

enum class Passage {
  kFound,
  kNone,     // no way
  kTooWide,  // more cells than allowed were free
};

// What is asked of the chords, so that an answer holds for the paths.
enum class ChordErrors {
  kSubtracted,  // a way at distance minus both errors is a way for the paths: to prove
  kAdded,       // no way at distance plus both errors means none for the paths: to refute
};

struct FreeSpaceAnswer {
  Passage passage = Passage::kNone;
  Matching way;          // of kFound
  MatchedPair furthest;  // of kNone: about where the way ends
};

// `distance` in mm. In rounded numbers: kNone holds for every distance that is smaller by the
// rounding of a distance or more; a way has to be measured. `most_cells` bounds the cost: some 24
// bytes and 50 ns for each.
[[nodiscard]] FreeSpaceAnswer find_passage(const ChordPolyline& a, const ChordPolyline& b,
                                           double distance, ChordErrors errors,
                                           std::size_t most_cells);

}  // namespace batten::geometry
