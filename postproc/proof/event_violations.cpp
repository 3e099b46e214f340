#include "postproc/proof/event_violations.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
#include <string>

#include "gcode/state/code_table.h"
#include "gcode/state/modal_state.h"
#include "gcode/state/reason.h"
#include "geometry/basic/rounding.h"

namespace batten::postproc {
namespace {

using gcode::ModalState;
namespace reason = gcode::reason;

// How many events may be lost or added at one position and still be reported one by one.
constexpr std::size_t kFurthest = 400;

// Positions at which the lists may differ before the rest is given up. A person reads the first
// few; each costs up to kFurthest^2 comparisons.
constexpr std::size_t kMostDifferences = 50;

// More of one gap say nothing new.
constexpr std::size_t kMostPerGap = 20;

// mm: half a step of what is printed where the numbers of another language are not the source's:
// Klartext and Siemens words have 4 decimals of a millimetre, 5 of an inch, plain words 3 and 4.
constexpr double kPrintedAnew = 0.00013;
constexpr double kPrintedInPlainMillimetres = 0.0005 + 1e-6;
constexpr double kPrintedInPlainInches = 0.00127 + 1e-6;

bool of_two_languages(const EventAt& old, const EventAt& now) {
  return old.read.program->language != now.read.program->language;
}

}  // namespace

double same_place_at(const EventAt& before, const EventAt& after) {
  if (!of_two_languages(before, after)) return geometry::kSamePlace;
  if (after.read.program->language != gcode::Language::kRs274) return kPrintedAnew;
  const bool inch = after.state_after().units == gcode::Units::kInch;
  return inch ? kPrintedInPlainInches : kPrintedInPlainMillimetres;
}

namespace {

// Do two events do the same? Rapids do when every axis that one of them names ends at the same
// position; the axes that none names stay where the path before has left them.
bool same_event(const EventAt& old, const EventAt& now) {
  if (old.event.kind != now.event.kind || old.event.text != now.event.text) return false;
  if (old.event.motion < 0 || now.event.motion < 0) return old.event.motion == now.event.motion;
  const gcode::Motion& before = old.motion();
  const gcode::Motion& after = now.motion();
  const double allowed = same_place_at(old, now);
  for (std::size_t i = 0; i < 3; ++i) {
    const auto axis = static_cast<Eigen::Index>(i);
    const bool named = before.axes_named[i] || after.axes_named[i];
    if (named && std::abs(before.piece.end()[axis] - after.piece.end()[axis]) > allowed) {
      return false;
    }
  }
  return true;
}

class Aligner {
 public:
  Aligner(const EventSpan& before, const EventSpan& after) : before_(before), after_(after) {}

  EventAlignment run() {
    EventAlignment found;
    EventPair here;
    std::size_t differences = 0;
    while (is_in_both(here)) {
      if (same(here)) {
        found.same.push_back(here);
        here = {here.before + 1, here.after + 1};
        continue;
      }
      const std::optional<EventPair> next = same_again_after(here);
      if (++differences > kMostDifferences || !next) {
        found.complete = differences <= kMostDifferences &&
                         before_.events.size() - here.before <= kFurthest &&
                         after_.events.size() - here.after <= kFurthest;
        return found;
      }
      here = *next;
    }
    return found;
  }

 private:
  [[nodiscard]] bool is_in_both(const EventPair& pair) const {
    return pair.before < before_.events.size() && pair.after < after_.events.size();
  }

  [[nodiscard]] bool same(const EventPair& pair) const {
    return same_event({before_.events[pair.before], *before_.read},
                      {after_.events[pair.after], *after_.read});
  }

  // The fewest events are left out in both together. Of the next pair the same is asked, where both
  // programs go on.
  [[nodiscard]] std::optional<EventPair> same_again_after(const EventPair& here) const {
    for (std::size_t sum = 1; sum <= kFurthest; ++sum) {
      for (std::size_t lost = 0; lost <= sum; ++lost) {
        const EventPair pair{here.before + lost, here.after + (sum - lost)};
        if (!is_in_both(pair) || !same(pair)) continue;
        const EventPair next{pair.before + 1, pair.after + 1};
        if (!is_in_both(next) || same(next)) return pair;
      }
    }
    return {};
  }

  const EventSpan& before_;
  const EventSpan& after_;
};

std::string_view different_switch(const ModalState& before, const ModalState& after) {
  for (const gcode::ModalSwitch& each : gcode::kModalSwitches) {
    if (before.*each.item != after.*each.item) return each.name;
  }
  return {};
}

std::string_view different_mode(const ModalState& before, const ModalState& after) {
  if (before.units != after.units) return "units";
  if (before.plane != after.plane) return "plane";
  if (before.distance != after.distance) return "distance mode";
  if (before.arc_distance != after.arc_distance) return "arc distance mode";
  if (before.feed_mode != after.feed_mode) return "feed mode";
  if (before.path.mode != after.path.mode) return "path mode";
  if (const std::string_view item = different_switch(before, after); !item.empty()) return item;
  if (before.spindle_speed != after.spindle_speed) return "spindle speed";
  return {};
}

std::string_view different_feed(const ModalState& before, const ModalState& after) {
  const bool as_written = before.feed_without_point == after.feed_without_point;
  return same_feed(before.feed, after.feed) && as_written ? "" : "feed";
}

std::string_view different_in_common(const ModalState& before, const ModalState& after) {
  if (before.distance != after.distance) return "distance mode";
  if (before.feed_mode != after.feed_mode) return "feed mode";
  return different_switch(before, after);
}

const ModalState& last_state(const ReadProgram& read) {
  const auto& blocks = read.interpretation->blocks;
  return read.interpretation->states[blocks.empty() ? 0 : blocks.back().state_after];
}

std::string describe(const EventAt& at) {
  if (at.event.motion < 0) return at.event.text;
  const geometry::Point3 end = at.motion().piece.end();
  const std::string what = at.event.kind == EventKind::kRapid ? "rapid" : at.event.text;
  return fmt::format("{} to X{:.6g} Y{:.6g} Z{:.6g} mm", what, end.x(), end.y(), end.z());
}

// With the id "rapid-lost", "event-changed" ..
Violation of_event(const EventAt& at, std::string_view what, std::uint32_t old_line,
                   std::uint32_t new_line, std::string message) {
  const bool rapid = at.event.kind == EventKind::kRapid;
  return {rapid ? ViolationKind::kRapid : ViolationKind::kEvent,
          fmt::format("{}-{}", rapid ? "rapid" : "event", what),
          old_line,
          new_line,
          0,
          std::move(message)};
}

bool moves(const EventSpan& span) {
  return std::ranges::any_of(span.events,
                             [](const ProgramEvent& e) { return e.kind != EventKind::kWord; });
}

// G28, G30, G53 and nothing else that uses axis words: the axes that are named end at a place of
// the machine's.
bool only_goes_home(const gcode::Block& block, const ReadProgram& read) {
  using gcode::CodeAct;
  bool goes = false;
  for (const gcode::Word& word : read.program->words_of(block)) {
    if (word.letter != 'G' || !word.is_number) continue;
    const gcode::CodeRow& row = gcode::row_of_g(gcode::code_of(word));
    if (row.act == CodeAct::kHome || row.act == CodeAct::kMachinePlace) {
      goes = true;
    } else if (row.why == reason::kCoordinateChange) {
      return false;
    }
  }
  return goes;
}

bool is_one_of(const Violation& violation, std::string_view id, std::string_view other) {
  return violation.id == id || violation.id == other;
}

}  // namespace

EventAlignment align_events(const EventSpan& before, const EventSpan& after) {
  return Aligner(before, after).run();
}

bool hangs_on_place(const EventAt& at) {
  if (at.event.kind != EventKind::kText) return false;
  const gcode::Block& block = at.read.program->blocks[at.event.block];
  const gcode::BlockMeaning& meaning = at.read.interpretation->blocks[at.event.block];
  if (meaning.motion >= 0) return false;
  const bool is_plain = block.opacity == gcode::ParseStatus::kNone &&
                        meaning.kind != gcode::BlockKind::kOpaque && !block.block_delete;
  if (!is_plain) return true;
  if (at.event.text.starts_with('(') || at.event.text.starts_with(';')) return false;
  const std::string_view why = meaning.barrier;
  if (why == reason::kCoordinateChange) return !only_goes_home(block, at.read);
  constexpr std::array kOnlySwitch = {reason::kDwell,       reason::kStateChange,
                                      reason::kSpindle,     reason::kCoolant,
                                      reason::kToolChange,  reason::kProgramEnd,
                                      reason::kCannedCycle, reason::kControlSmoothing,
                                      reason::kExactStop,   reason::kCutterCompensation};
  return std::ranges::find(kOnlySwitch, why) == kOnlySwitch.end();
}

std::string_view different_item(const EventAt& old, const EventAt& now) {
  const ProgramEvent& before = old.event;
  const ProgramEvent& after = now.event;
  const ModalState& old_state = old.state_before();
  const ModalState& new_state = now.state_before();
  if (of_two_languages(old, now)) return different_in_common(old_state, new_state);
  if (const std::string_view item = different_mode(old_state, new_state); !item.empty()) {
    return item;
  }
  if (before.plane_set && !after.plane_set) return "plane (no word has set it)";
  if (before.arc_distance_set && !after.arc_distance_set) {
    return "arc distance mode (no word has set it)";
  }
  if (before.kind == EventKind::kText && old_state.motion != new_state.motion) {
    return "motion word";
  }
  const bool counts = before.kind == EventKind::kText || before.feed_is_new || after.feed_is_new;
  if (!counts) return {};
  if (before.kind != EventKind::kRapid) return different_feed(old_state, new_state);
  return different_feed(old.state_after(), now.state_after());
}

std::string_view different_item_at_end(const ReadProgram& old_program,
                                       const ReadProgram& new_program, bool feed_counts) {
  const ModalState& old_state = last_state(old_program);
  const ModalState& new_state = last_state(new_program);
  const std::string_view item = different_mode(old_state, new_state);
  return item.empty() && feed_counts ? different_feed(old_state, new_state) : item;
}

GapReport report_events_between(const EventSpan& before, const EventSpan& after) {
  GapReport gap;
  gap.only_words = !moves(before) && !moves(after);
  const bool one_to_one =
      before.events.size() == after.events.size() &&
      std::ranges::equal(before.events, after.events, {}, &ProgramEvent::kind, &ProgramEvent::kind);
  for (std::size_t i = 0; i < before.events.size() && i < kMostPerGap; ++i) {
    const EventAt old{before.events[i], *before.read};
    if (!one_to_one) {
      gap.violations.push_back(of_event(old, "lost", old.line(), 0, describe(old)));
      continue;
    }
    const EventAt now{after.events[i], *after.read};
    gap.violations.push_back(
        of_event(old, "changed", old.line(), now.line(),
                 fmt::format("found {}, expected {}", describe(now), describe(old))));
  }
  for (std::size_t i = 0; !one_to_one && i < after.events.size() && i < kMostPerGap; ++i) {
    const EventAt now{after.events[i], *after.read};
    gap.violations.push_back(of_event(now, "added", 0, now.line(), describe(now)));
  }
  return gap;
}

void merge_moved_events(std::vector<Violation>& violations) {
  for (std::size_t i = 0; i < violations.size(); ++i) {
    if (!is_one_of(violations[i], "event-lost", "rapid-lost")) continue;
    const auto twin = std::ranges::find_if(violations, [&](const Violation& other) {
      return is_one_of(other, "event-added", "rapid-added") && other.kind == violations[i].kind &&
             other.message == violations[i].message;
    });
    if (twin == violations.end()) continue;
    violations[i].id = "event-moved";
    violations[i].new_line = twin->new_line;
    violations[i].message += ": moved past other events";
    const auto at = static_cast<std::size_t>(twin - violations.begin());
    violations.erase(twin);
    if (at < i) --i;
  }
}

Violation rapid_violation(const EventAt& before, const EventAt& after) {
  const std::string message = fmt::format("{} starts or ends at another position; expected {}",
                                          describe(after), describe(before));
  return {ViolationKind::kRapid, "rapid-changed", before.line(), after.line(), 0, message};
}

Violation moved_event_violation(const EventAt& before, const EventAt& after, double moved_mm) {
  const std::string message =
      describe(before) + ": the path is the same, but it is at another position on it";
  return {ViolationKind::kEvent, "event-moved", before.line(), after.line(), moved_mm, message};
}

Violation place_violation(const EventAt& before, const EventAt& after, double off_mm) {
  return {ViolationKind::kEvent,
          "place-moved",
          before.line(),
          after.line(),
          off_mm,
          fmt::format("the tool is {:.6g} mm from where it stood before '{}', which may take over "
                      "where it stands",
                      off_mm, describe(before))};
}

Violation state_violation(std::string_view item, const EventAt& before, const EventAt& after) {
  const std::string message = fmt::format("another {} than before at {}", item, describe(before));
  return {ViolationKind::kState, "state-changed", before.line(), after.line(), 0, message};
}

Violation end_state_violation(std::string_view item, const ReadProgram& before,
                              const ReadProgram& after) {
  const auto last_line = [](const ReadProgram& read) {
    return read.program->blocks.empty() ? 0 : read.program->blocks.back().line;
  };
  const std::string message = fmt::format("another {} than before at the end of the program", item);
  return {ViolationKind::kState, "state-changed", last_line(before), last_line(after), 0, message};
}

Violation too_many_differences(const EventSpan& before, const EventSpan& after) {
  const auto line = [](const EventSpan& span) {
    return span.events.empty() ? 0U : EventAt{span.events.front(), *span.read}.line();
  };
  return {ViolationKind::kEvent,
          "too-many-differences",
          line(before),
          line(after),
          0,
          "the rest of the programs was not compared"};
}

}  // namespace batten::postproc
