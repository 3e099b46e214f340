// What a program does, as a list: events in order, and the cutting motions between them.
// The verifier's view of a program; it knows nothing of runs.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "gcode/state/code_table.h"
#include "gcode/state/motion.h"
#include "gcode/text/program.h"
#include "geometry/basic/point.h"

namespace batten::postproc {

// The modal groups of the words that the reader knows.
inline constexpr std::size_t kCodeGroups =
    static_cast<std::size_t>(gcode::CodeGroup::kModalMacro) + 1;

// What a part of a program takes over from the parts before it, beside the state of the control.
struct EventsBefore {
  // The last word of each modal group, in tenths; -1: none has set it.
  std::array<gcode::Code, kCodeGroups> set_by_word = nothing_set();
  std::optional<geometry::Point3> place;  // mm: where the last motion ends, if that is known
  bool feed_is_new = false;               // feed_is_new_at_end

  bool operator==(const EventsBefore&) const = default;

  static constexpr std::array<gcode::Code, kCodeGroups> nothing_set() {
    std::array<gcode::Code, kCodeGroups> none{};
    none.fill(-1);
    return none;
  }
};

struct ReadProgram {
  const gcode::Program* program = nullptr;
  const gcode::Interpretation* interpretation = nullptr;
  EventsBefore before = {};  // of a part of a program; the whole begins with nothing
  // Blocks before which the moves are compared apart, increasing; as many in both programs. Paths
  // that keep the tolerance piece by piece, each piece from where the one before it has ended, keep
  // it as a whole.
  std::span<const std::uint32_t> cuts = {};
  std::uint32_t line_before = 0;  // of a part: of the last block before it; 0: there is none
};

enum class EventKind : std::uint8_t {
  kWord,   // one word that acts: M8, T3, S1200, G54, G90
  kText,   // a block that must stand in the other program too, word for word
  kRapid,  // a rapid whose place is known
  kCut,    // none of the program: the begin of one of ReadProgram::cuts
};

struct ProgramEvent {
  EventKind kind = EventKind::kWord;
  std::uint32_t block = 0;
  // kWord: the word; with " with motion" where the block also moves, since controls differ in
  // which of the two comes first. kText: the whole text of a block that is not understood, else
  // its words without blanks, N and comments. Empty for rapids.
  std::string text;
  std::int32_t motion = -1;  // of kRapid; of a kText that says no places: where it ends counts
  std::uint32_t state_before = 0;  // Interpretation::states before the block
  // A word has set the plane, the arc distance mode: not only assumed as after power-on.
  bool plane_set = false;
  bool arc_distance_set = false;
  // An F stands before its block, of a kRapid also in it, that no cut has used yet.
  bool feed_is_new = false;
};

// An event, and the program that it is one of.
struct EventAt {
  const ProgramEvent& event;
  const ReadProgram& read;

  [[nodiscard]] std::uint32_t line() const { return read.program->blocks[event.block].line; }
};

// A motion at feed rate whose place is known, in a state in which the path alone counts.
struct Cut {
  std::uint32_t motion = 0;
  std::optional<double> feed;       // as ModalState::feed
  bool feed_without_point = false;  // as ModalState::feed_without_point
};

struct ProgramEvents {
  std::vector<ProgramEvent> events;
  std::vector<Cut> cuts;                 // those that move; in order
  std::vector<std::size_t> cuts_before;  // for each event, and once more for the end

  // Stretch k stands before event k; the last one after all events.
  [[nodiscard]] std::size_t stretch_begin(std::size_t k) const {
    return k > 0 ? cuts_before[k - 1] : 0;
  }
};

// Feeds are the same when they differ by less than a millionth: they are printed again, 39.3701
// in/min for 1000 mm/min.
[[nodiscard]] bool same_feed(const std::optional<double>& a, const std::optional<double>& b);

// And written alike: with a point both, or without.
[[nodiscard]] bool same_feed(const Cut& a, const Cut& b);

// The pieces of curves that are read exactly (gcode::ReadOptions::curves) are cuts as lines are.
//
// No events are: comments that do not act, N words before the others that nothing refers to, F
// where the state after its block has it (state_difference compares it where it counts), motion
// words but a G2 or G3 that goes nowhere, or a cut to nowhere before the first feed, plane and arc distance
// words (they only say how arcs are written), and words of other modal groups and S that repeat
// what a word has set before, unless they do more than that: G43, G54, G64 without its P.
//
// Everything that could depend on more than the path is a kText event: blocks that are not
// understood, other axes, motions from unknown places, loops, labels that are referred to, and
// motions in states where the text is not the path (cutter compensation, inverse time ..).
[[nodiscard]] ProgramEvents list_events(const ReadProgram& read);

// What the next part takes over.
[[nodiscard]] EventsBefore events_before_next(const ReadProgram& read);

// Whether the last F is behind the last cut.
[[nodiscard]] bool feed_is_new_at_end(const ReadProgram& read);

// Whether the block is a rapid whose place is known, and says nothing else.
[[nodiscard]] bool is_plain_rapid(const ReadProgram& read, std::uint32_t block);

}  // namespace batten::postproc
