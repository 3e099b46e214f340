// What may be wrong with a new program, and violations of the order and the contents of events in
// words.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <vector>

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
  std::uint32_t old_line = 0;  // of the violation itself, as near as it is known; 0: none
  std::uint32_t new_line = 0;
  double deviation_mm = 0;  // kDistance: at least this much
  std::string message;      // found and expected
};

struct EventSpan {
  std::span<const ProgramEvent> events;
  const ReadProgram* read = nullptr;
};

struct GapReport {
  std::vector<Violation> violations;
  bool only_words = true;  // neither rapids nor blocks that may move stand in the gap
};

// Events between two that are the same in both programs: changed where both have one of a kind,
// else lost or added.
[[nodiscard]] GapReport report_events_between(const EventSpan& before, const EventSpan& after);

// A lost and an added event that say the same become one that was moved.
void merge_moved_events(std::vector<Violation>& violations);

[[nodiscard]] Violation rapid_violation(const EventAt& before, const EventAt& after);

// The event stands at another place of the path, at least `moved_mm` away.
[[nodiscard]] Violation moved_event_violation(const EventAt& before, const EventAt& after,
                                              double moved_mm);

[[nodiscard]] Violation state_violation(std::string_view item, const EventAt& before,
                                        const EventAt& after);
[[nodiscard]] Violation end_state_violation(std::string_view item, const ReadProgram& before,
                                            const ReadProgram& after);

// The programs have so little in common that the rest was not compared: from these events on.
[[nodiscard]] Violation too_many_differences(const EventSpan& before, const EventSpan& after);

}  // namespace batten::postproc
