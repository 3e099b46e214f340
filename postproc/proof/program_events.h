// What a program does, as a list: events in order, and the cutting motions between them.
// The verifier's view of a program; it knows nothing of runs.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "gcode/state/code_table.h"
#include "gcode/state/motion.h"
#include "gcode/text/program.h"
#include "geometry/basic/point.h"

namespace batten::postproc {

// What a part of a program takes over from the parts before it, beside the state of the control.
struct EventsBefore {
  // The last word of each modal group, in tenths; -1: none has set it.
  std::array<gcode::Code, gcode::kCodeGroups> set_by_word = nothing_set();
  std::optional<geometry::Point3> place;  // mm: where the last motion ends, if that is known
  bool feed_is_new = false;               // the last F is after the last cut

  bool operator==(const EventsBefore&) const = default;

  static constexpr std::array<gcode::Code, gcode::kCodeGroups> nothing_set() {
    std::array<gcode::Code, gcode::kCodeGroups> none{};
    none.fill(-1);
    return none;
  }
};

struct ProgramEvents;

struct ReadProgram {
  const gcode::Program* program = nullptr;
  const gcode::Interpretation* interpretation = nullptr;
  EventsBefore before = {};  // of a part of a program; the whole begins with nothing
  // Blocks before which the moves are compared apart, increasing; as many in both programs. Paths
  // that keep the tolerance piece by piece, each piece from where the one before it has ended, keep
  // it as a whole.
  std::span<const std::uint32_t> cuts = {};
  std::uint32_t line_before = 0;  // of a part: of the last block before it; 0: there is none
  const ProgramEvents* events = nullptr;  // what list_events gives, where that is at hand
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
  // Of an event that has one.
  [[nodiscard]] const gcode::Motion& motion() const {
    return read.interpretation->motions[static_cast<std::size_t>(event.motion)];
  }
  // Of the control, before and after the event's block.
  [[nodiscard]] const gcode::ModalState& state_before() const {
    return read.interpretation->states[event.state_before];
  }
  [[nodiscard]] const gcode::ModalState& state_after() const {
    return read.interpretation->states[read.interpretation->blocks[event.block].state_after];
  }
};

// A motion at feed rate whose place is known, in a state in which the path alone counts.
struct Cut {
  std::optional<double> feed;  // as ModalState::feed
  std::uint32_t motion = 0;
  bool feed_without_point = false;  // as ModalState::feed_without_point
};

struct ProgramEvents {
  std::vector<ProgramEvent> events;
  std::vector<Cut> cuts;                 // those that move; in order
  std::vector<std::size_t> cuts_before;  // for each event, and once more for the end
  EventsBefore at_end;                   // what the next part takes over; of list_events

  // Section k stands before event k; the last one after all events.
  [[nodiscard]] std::size_t section_begin(std::size_t k) const {
    return k > 0 ? cuts_before[k - 1] : 0;
  }
};

// Feeds are the same when they differ by less than a millionth: they are printed again, 39.3701
// in/min for 1000 mm/min.
[[nodiscard]] bool same_feed(const std::optional<double>& a, const std::optional<double>& b);

// And written alike: with a point both, or without.
[[nodiscard]] bool same_feed(const Cut& a, const Cut& b);

// Whether they are equal to the last bit: neighbouring cuts like that are compared together.
[[nodiscard]] bool is_one_feed(const Cut& a, const Cut& b);

// The pieces of curves that are read exactly (gcode::ReadOptions::curves) are cuts as lines are.
//
// No events are: comments that do not act, N words before the others that nothing refers to, F
// where the state after its block has it (different_item compares it where it counts), motion
// words but a G2 or G3 that goes nowhere, or a cut to nowhere before the first feed, plane and arc
// distance words (they only say how arcs are written), and words of other modal groups and S that
// repeat what a word has set before, unless they do more than that: G43, G54, G64 without its P.
//
// Everything that could depend on more than the path is a kText event: blocks that are not
// understood, other axes, motions from unknown positions, loops, labels that are referred to, and
// motions in states where the text is not the path (cutter compensation, inverse time ..).
[[nodiscard]] ProgramEvents list_events(const ReadProgram& read);

// What a program does in words that all languages have, to compare programs of different ones: as
// list_events, but for:
//   tool 5           T5 M6, TOOL CALL 5 Z
//   speed 3000       S3000, TOOL CALL Z S3000: another one, or the first behind a tool
//   M3, M4, M8       before the motion of their block, as LinuxCNC and Klartext do them; M13 and
//                    M14 of Klartext are two of them
//   M5, M9           in a block without motion; in Klartext behind the motion of their block, too
//   G54              also a Klartext comment that its datum is active; the same one again is none
//   G49              before the first motion behind it; also Siemens D0, and a Klartext comment
//                    that lengths count
//   length not said  before the first motion along Z behind a tool, where neither G43 (Siemens: D1)
//                    nor G49 stands between; also a Klartext comment that says so
//   BLK FORM ..      a Klartext statement, or a comment that begins so, in capitals
//   line of X F500   motions from a place that is not known, by the axes that they name; where they
//                    go is compared as that of rapids
// No events: program marks and names, words that say how others are read (units, planes, G90, G94,
// G40 ..; what they change is compared where it counts), G64 without a tolerance, G43 and Siemens
// D1 behind the change of their tool as long as nothing moved along Z, and M30 behind a comment END
// PGM. Everything else is an event of its own text, which no other language has; G70 too, which
// leaves feeds in millimetres.
[[nodiscard]] ProgramEvents list_common_events(const ReadProgram& read);

// What the next part takes over.
[[nodiscard]] EventsBefore events_before_next(const ReadProgram& read);

// Whether the block is a rapid whose ends are known, and says nothing else.
[[nodiscard]] bool is_plain_rapid(const ReadProgram& read, std::uint32_t block);

// What list_events and list_common_events make their lists with.
class EventLister {
 protected:
  explicit EventLister(const ReadProgram& read)
      : program_(*read.program), interpretation_(*read.interpretation) {}

  // Of the block `block_index_`.
  ProgramEvent& add_event(EventKind kind);
  void add_word(std::string text) { add_event(EventKind::kWord).text = std::move(text); }
  void add_text(std::string text) { add_event(EventKind::kText).text = std::move(text); }
  void add_cut(const gcode::Motion& motion, bool feed_without_point);  // one of the interpretation
  static bool goes_on(const gcode::Motion& motion) {
    return !motion.piece.is_line() || motion.piece.start() != motion.piece.end();
  }
  // A rapid or a cut between known positions. False: it goes nowhere, and nothing is added.
  bool add_motion(const gcode::BlockMeaning& meaning, bool feed_without_point);

  [[nodiscard]] const gcode::Motion& motion_of(const gcode::BlockMeaning& meaning) const {
    return interpretation_.motions[static_cast<std::size_t>(meaning.motion)];
  }
  [[nodiscard]] std::uint32_t state_index_before() const {
    return block_index_ > 0 ? interpretation_.blocks[block_index_ - 1].state_after : 0;
  }
  [[nodiscard]] const gcode::ModalState& state_after() const {
    return interpretation_.states[interpretation_.blocks[block_index_].state_after];
  }

  const gcode::Program& program_;
  const gcode::Interpretation& interpretation_;
  ProgramEvents list_;
  std::uint32_t block_index_ = 0;
  std::array<gcode::Code, gcode::kCodeGroups> set_by_word_ = EventsBefore::nothing_set();
  bool feed_is_new_ = false;  // before the block that is listed
};

}  // namespace batten::postproc
