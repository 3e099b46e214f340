#include "postproc/proof/event_alignment.h"

#include <algorithm>
#include <cmath>
#include <optional>

#include "geometry/basic/rounding.h"

namespace batten::postproc {
namespace {

// How many events may be lost or added at one place and still be told one by one.
constexpr std::size_t kFurthest = 400;

// Places at which the lists may differ before the rest is given up. A person reads the first
// few; each costs up to kFurthest^2 comparisons.
constexpr std::size_t kMostDifferences = 50;

// mm: half a step of what is printed where the numbers of another language are not the source's:
// Klartext and Siemens words have 4 decimals of a millimetre, 5 of an inch, plain words 3 and 4.
constexpr double kPrintedAnew = 0.00013;
constexpr double kPrintedInPlainMillimetres = 0.0005 + 1e-6;
constexpr double kPrintedInPlainInches = 0.00127 + 1e-6;

double same_place_in(const gcode::Motion& motion, const ReadProgram& read) {
  if (read.program->language != gcode::Language::kRs274) return kPrintedAnew;
  const auto& block = read.interpretation->blocks[motion.block];
  const bool inch = read.interpretation->states[block.state_after].units == gcode::Units::kInch;
  return inch ? kPrintedInPlainInches : kPrintedInPlainMillimetres;
}

bool same_rapid(const gcode::Motion& before, const gcode::Motion& after, double same_place) {
  const geometry::Point3& old_end = before.piece.end();
  const geometry::Point3& new_end = after.piece.end();
  for (int axis = 0; axis < 3; ++axis) {
    const auto i = static_cast<std::size_t>(axis);
    const bool named = before.axes_named[i] || after.axes_named[i];
    if (named && std::abs(old_end[axis] - new_end[axis]) > same_place) return false;
  }
  return true;
}

const gcode::Motion& motion_of(const ProgramEvent& event, const ReadProgram& read) {
  return read.interpretation->motions[static_cast<std::size_t>(event.motion)];
}

// Do two events do the same? Rapids do when every axis that one of them names ends at the same
// place; the axes that none names stand where the path before has left them.
bool same_event(const EventAt& old, const EventAt& now) {
  const ProgramEvent& before = old.event;
  const ProgramEvent& after = now.event;
  if (before.kind != after.kind || before.text != after.text) return false;
  if (before.motion < 0 || after.motion < 0) return before.motion == after.motion;
  const gcode::Motion& old_motion = motion_of(before, old.read);
  const gcode::Motion& new_motion = motion_of(after, now.read);
  const bool printed_anew = old.read.program->language != now.read.program->language;
  return same_rapid(old_motion, new_motion,
                    printed_anew ? same_place_in(new_motion, now.read) : geometry::kSamePlace);
}

class Aligner {
 public:
  Aligner(const ProgramEvents& before, const ReadProgram& old_program, const ProgramEvents& after,
          const ReadProgram& new_program)
      : before_(before), old_(old_program), after_(after), new_(new_program) {}

  EventAlignment run() {
    EventAlignment found;
    EventPair here;
    std::size_t differences = 0;
    while (here.before < before_.events.size() && here.after < after_.events.size()) {
      if (same(here)) {
        found.same.push_back(here);
        here = {here.before + 1, here.after + 1};
        continue;
      }
      const std::optional<EventPair> next = same_again_after(here);
      if (++differences > kMostDifferences || !next) {
        found.complete = differences <= kMostDifferences && at_end_within_reach(here);
        return found;
      }
      here = *next;
    }
    return found;
  }

 private:
  [[nodiscard]] bool same(const EventPair& pair) const {
    return same_event({before_.events[pair.before], old_}, {after_.events[pair.after], new_});
  }

  // Here and one further, where both programs go on.
  [[nodiscard]] bool same_twice(const EventPair& pair) const {
    if (!same(pair)) return false;
    const EventPair next{pair.before + 1, pair.after + 1};
    return next.before >= before_.events.size() || next.after >= after_.events.size() || same(next);
  }

  // The fewest events are left out in both together.
  [[nodiscard]] std::optional<EventPair> same_again_after(const EventPair& here) const {
    for (std::size_t sum = 1; sum <= kFurthest; ++sum) {
      for (std::size_t lost = 0; lost <= sum; ++lost) {
        const EventPair pair{here.before + lost, here.after + (sum - lost)};
        if (pair.before >= before_.events.size() || pair.after >= after_.events.size()) continue;
        if (same_twice(pair)) return pair;
      }
    }
    return {};
  }

  [[nodiscard]] bool at_end_within_reach(const EventPair& here) const {
    return before_.events.size() - here.before <= kFurthest &&
           after_.events.size() - here.after <= kFurthest;
  }

  const ProgramEvents& before_;
  const ReadProgram& old_;
  const ProgramEvents& after_;
  const ReadProgram& new_;
};

}  // namespace

EventAlignment align_events(const ProgramEvents& before, const ReadProgram& old_program,
                            const ProgramEvents& after, const ReadProgram& new_program) {
  return Aligner(before, old_program, after, new_program).run();
}

namespace {

using gcode::ModalState;
using gcode::TriState;

struct SwitchItem {
  TriState ModalState::*item;
  std::string_view name;
};
constexpr SwitchItem kSwitches[] = {
    {&ModalState::cutter_compensation, "cutter compensation"},
    {&ModalState::tool_center_point, "tool centre point control"},
    {&ModalState::tilted_plane, "tilted plane"},
    {&ModalState::scaling, "scaling"},
    {&ModalState::rotation, "rotation"},
    {&ModalState::mirror, "mirroring"},
    {&ModalState::polar, "polar coordinates"},
    {&ModalState::cylindrical, "cylindrical coordinates"},
    {&ModalState::control_smoothing, "smoothing by the control"},
    {&ModalState::modal_macro, "modal macro"},
    {&ModalState::constant_surface_speed, "constant surface speed"},
    {&ModalState::lathe_diameter, "diameter mode"},
    {&ModalState::laser_power_mode, "laser power mode"},
};

std::string_view different_switch(const ModalState& before, const ModalState& after) {
  for (const SwitchItem& one : kSwitches) {
    if (before.*one.item != after.*one.item) return one.name;
  }
  return {};
}

std::string_view different_mode(const ModalState& before, const ModalState& after) {
  if (before.units != after.units) return "units";
  if (before.plane != after.plane) return "plane";
  if (before.distance != after.distance) return "distance mode";
  if (before.arc_distance != after.arc_distance) return "arc distance mode";
  if (before.feed_mode != after.feed_mode) return "feed mode";
  if (before.path != after.path) return "path mode";
  if (const std::string_view item = different_switch(before, after); !item.empty()) return item;
  if (before.spindle_speed != after.spindle_speed) return "spindle speed";
  return {};
}

std::string_view different_feed(const ModalState& before, const ModalState& after) {
  const bool as_written = before.feed_without_point == after.feed_without_point;
  return same_feed(before.feed, after.feed) && as_written ? "" : "feed";
}

const ModalState& state_before(const EventAt& at) {
  return at.read.interpretation->states[at.event.state_before];
}

const ModalState& state_behind(const EventAt& at) {
  const gcode::Interpretation& read = *at.read.interpretation;
  return read.states[read.blocks[at.event.block].state_after];
}

const ModalState& last_state(const ReadProgram& read) {
  const auto& blocks = read.interpretation->blocks;
  return read.interpretation->states[blocks.empty() ? 0 : blocks.back().state_after];
}

}  // namespace

std::string_view different_item(const EventAt& old, const EventAt& now) {
  const ProgramEvent& before = old.event;
  const ProgramEvent& after = now.event;
  const ModalState& old_state = state_before(old);
  const ModalState& new_state = state_before(now);
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
  return different_feed(state_behind(old), state_behind(now));
}

std::string_view different_in_common(const EventAt& before, const EventAt& after) {
  const ModalState& old_state = state_before(before);
  const ModalState& new_state = state_before(after);
  if (old_state.distance != new_state.distance) return "distance mode";
  if (old_state.feed_mode != new_state.feed_mode) return "feed mode";
  return different_switch(old_state, new_state);
}

std::string_view different_item_at_end(const ReadProgram& old_program,
                                       const ReadProgram& new_program) {
  const ModalState& old_state = last_state(old_program);
  const ModalState& new_state = last_state(new_program);
  const std::string_view item = different_mode(old_state, new_state);
  const bool feed_counts = feed_is_new_at_end(old_program) || feed_is_new_at_end(new_program);
  return item.empty() && feed_counts ? different_feed(old_state, new_state) : item;
}

}  // namespace batten::postproc
