// Does the new program do what the old one did, within the tolerance? Believes only text:
// it takes two programs as they were read and knows nothing of how the new one was made.
//
// What is compared, in order: every block that acts (M, S, T words, coordinate systems,
// dwells, opaque blocks ..) must stand in both, the same; rapids must have the same ends; and
// between them each stretch of cutting moves at one feed must keep the tolerance, both ways
// and in order (geometry/distance/path_distance). What counts as an event:
// postproc/proof/program_events.h.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "gcode/state/motion.h"
#include "gcode/text/program.h"
#include "geometry/basic/side.h"
#include "geometry/basic/tolerance_kind.h"
#include "geometry/distance/path_distance.h"
#include "postproc/proof/program_events.h"

namespace batten::postproc {

enum class ViolationKind {
  kDistance,   // a stretch leaves the tolerance
  kNotProved,  // a stretch could neither be proved nor refuted
  kSide,       // a stretch comes over to the side that is not allowed
  kCrossing,   // a flat stretch crosses itself where the old one did not
  kFeed,       // another feed, or a feed that changes at another place
  kRapid,      // a rapid with another start or end, lost or added
  kEvent,      // an acting word or block lost, added, moved or changed
  kState,      // plane, units, distance mode .. differ where a copied block depends on them
  kTarget,     // a new block that the target refuses: asked where text for a target is proved
};

struct Violation {
  ViolationKind kind = ViolationKind::kDistance;
  std::string id;  // stable, all listed in docs/diagnostics.md: "distance", "event-lost" ..
  std::uint32_t old_line = 0;  // of the breach itself, as near as it is known; 0: none
  std::uint32_t new_line = 0;
  double deviation_mm = 0;  // kDistance: at least this much
  std::string message;      // found and expected
};

// What the paths must keep.
struct Promise {
  double tolerance_mm = 0.01;  // > 0
  geometry::ToleranceKind kind = geometry::ToleranceKind::kPath;
  // Where the new path may be: on the other side it may be by kOverSide of the tolerance.
  geometry::Side side = geometry::Side::kBoth;

  // The strict reading, when nothing else is said.
  Promise(double tolerance, geometry::ToleranceKind reading = geometry::ToleranceKind::kPath,
          geometry::Side allowed = geometry::Side::kBoth)
      : tolerance_mm(tolerance), kind(reading), side(allowed) {}
};

// Printing rounds a place on the path itself to either side of it.
inline constexpr double kOverSide = 0.1;

// One stretch of cutting moves at one feed that was compared, without the moves at its ends
// that are the same in both programs.
struct Stretch {
  std::uint32_t old_first_block = 0, old_last_block = 0;
  std::uint32_t new_first_block = 0, new_last_block = 0;
  // Their lines; where one program has no moves there, that of the event before.
  std::uint32_t old_first_line = 0, old_last_line = 0;
  std::uint32_t new_first_line = 0, new_last_line = 0;
  geometry::PathComparison comparison;
  double corner_mm = 0;  // band reading: greatest distance of a corner that was cut; 0: none was
  std::uint32_t old_worst_line = 0;  // where the greatest distance was met
  std::uint32_t new_worst_line = 0;
};

struct Verification {
  std::vector<Violation> violations;  // empty: proved
  std::vector<Stretch> stretches;     // in order; identical ones are not listed
  double deviation_mm = 0;            // greatest proved bound
  std::uint32_t deviation_line = 0;   // of the old program
  double corner_mm = 0;               // greatest of the stretches
  std::size_t events_compared = 0;
  [[nodiscard]] bool proved() const { return violations.empty(); }
};

// Feeds are the same when they differ by less than a millionth: they are printed again.
// Requires a tolerance > 0 (throws std::invalid_argument otherwise).
[[nodiscard]] Verification verify(const ReadProgram& before, const ReadProgram& after,
                                  const Promise& promise);

}  // namespace batten::postproc
