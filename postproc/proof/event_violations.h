// The events of two programs compared: which event of the new program is which event of the old
// one, whether the control remembers the same there, and what is wrong, in words.
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
  kDistance,   // a section leaves the tolerance
  kNotProved,  // a section could neither be proved nor refuted
  kSide,       // a section comes over to the side that is not allowed
  kCrossing,   // a flat section crosses itself where the old one did not
  kFeed,       // another feed, or a feed that changes at another position
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

// --- which event is which ------------------------------------------------------------------

struct EventPair {
  std::size_t before = 0;  // index into the old program's events
  std::size_t after = 0;
  bool operator==(const EventPair&) const = default;
};

struct EventAlignment {
  std::vector<EventPair> same;  // in order on both sides
  // False: after too many differences the rest was not looked at.
  bool complete = true;
};

struct EventSpan {
  std::span<const ProgramEvent> events;
  const ReadProgram* read = nullptr;
};

// In order; where the lists differ, the nearest position is taken from which two events in a row
// are the same again. Linear where the programs agree.
[[nodiscard]] EventAlignment align_events(const EventSpan& before, const EventSpan& after);

// --- does the control remember the same? ---------------------------------------------------

// Whether what follows may hang on where the tool stands before the event, beyond what is compared
// as a path: G92, G10 L20, G28.1, PRESETON, a macro, what is not understood. Moves, G28 and what
// only switches do not.
[[nodiscard]] bool hangs_on_place(const EventAt& at);

// mm: the tool is at the same place before two events when it is no farther off: what printing the
// numbers anew in another language makes of it, else noise.
[[nodiscard]] double same_place_at(const EventAt& before, const EventAt& after);

// What differs before a pair of events, in words ("units", "plane" ..); empty when nothing does.
// The motion word is asked for at kText events only: other events do not depend on it, and the cuts
// after them have their own. The feed is asked for at kText events, whatever uses it there, and
// where an F is in either program that no cut has used: a rapid may run with it, that of its own
// block too, and after G20, G93 or M2 it is not known any more.
//
// Between programs of two languages: what bends the path, or the meaning of a feed. How arcs and
// units are read does not count, since motions are compared in millimetres.
[[nodiscard]] std::string_view different_item(const EventAt& old, const EventAt& now);

// The same after the last block, without the motion word. `feed_counts`: in either program no cut
// has used the last F.
[[nodiscard]] std::string_view different_item_at_end(const ReadProgram& old_program,
                                                     const ReadProgram& new_program,
                                                     bool feed_counts);

// --- violations ------------------------------------------------------------------------------

struct GapReport {
  std::vector<Violation> violations;
  bool only_words = true;  // neither rapids nor blocks that may move are in the gap
};

// Events between two that are the same in both programs: changed where both have one of a kind,
// else lost or added.
[[nodiscard]] GapReport report_events_between(const EventSpan& before, const EventSpan& after);

// A lost and an added event that say the same become one that was moved.
void merge_moved_events(std::vector<Violation>& violations);

[[nodiscard]] Violation rapid_violation(const EventAt& before, const EventAt& after);

// The event is at another position of the path, at least `moved_mm` away.
[[nodiscard]] Violation moved_event_violation(const EventAt& before, const EventAt& after,
                                              double moved_mm);

// `off_mm`: how far the tool is from where it stood.
[[nodiscard]] Violation place_violation(const EventAt& before, const EventAt& after, double off_mm);

[[nodiscard]] Violation state_violation(std::string_view item, const EventAt& before,
                                        const EventAt& after);
[[nodiscard]] Violation end_state_violation(std::string_view item, const ReadProgram& before,
                                            const ReadProgram& after);

// The programs have so little in common that the rest was not compared: from these events on.
[[nodiscard]] Violation too_many_differences(const EventSpan& before, const EventSpan& after);

}  // namespace batten::postproc
