// Room for the feed: where the curve is too tight for it, vertices may scatter more.
// Method: docs/algorithms/fair.md, section Need.
#pragma once

#include "geometry/fitting/fair/fair.h"
#include "geometry/fitting/fair/fair_band.h"

namespace batten::geometry {

// Widens the scatter where the curve is too tight for the feed, a few times, and keeps that where
// it saves time. Every stretch is judged for itself. Returns the number of rounds that anything
// was kept of.
[[nodiscard]] int widen_for_feed(BandFit& fit, const FairOptions& options);

}  // namespace batten::geometry
