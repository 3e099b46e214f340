#include "postproc/proof/state_difference.h"

namespace batten::postproc {
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

const ModalState& state_behind(const ProgramEvent& event, const ReadProgram& read) {
  return read.interpretation->states[read.interpretation->blocks[event.block].state_after];
}

const ModalState& last_state(const ReadProgram& read) {
  const auto& blocks = read.interpretation->blocks;
  return read.interpretation->states[blocks.empty() ? 0 : blocks.back().state_after];
}

}  // namespace

std::string_view different_item(const ProgramEvent& before, const ReadProgram& old_program,
                                const ProgramEvent& after, const ReadProgram& new_program) {
  const ModalState& old_state = old_program.interpretation->states[before.state_before];
  const ModalState& new_state = new_program.interpretation->states[after.state_before];
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
  return different_feed(state_behind(before, old_program), state_behind(after, new_program));
}

std::string_view different_in_common(const ProgramEvent& before, const ReadProgram& old_program,
                                     const ProgramEvent& after, const ReadProgram& new_program) {
  const ModalState& old_state = old_program.interpretation->states[before.state_before];
  const ModalState& new_state = new_program.interpretation->states[after.state_before];
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
