#include "gcode/state/path_state.h"

#include <algorithm>
#include <array>

namespace batten::postproc {

bool path_alone_counts(const gcode::ModalState& state) {
  const std::array switches = {
      state.cutter_compensation,
      state.tool_center_point,
      state.tilted_plane,
      state.scaling,
      state.rotation,
      state.mirror,
      state.polar,
      state.cylindrical,
      state.modal_macro,
      state.constant_surface_speed,
      state.lathe_diameter,
  };
  return std::ranges::all_of(switches,
                             [](gcode::TriState item) { return item == gcode::TriState::kOff; }) &&
         state.control_smoothing != gcode::TriState::kUnknown &&
         state.units != gcode::Units::kUnknown && state.feed_mode == gcode::FeedMode::kPerMinute &&
         state.distance == gcode::DistanceMode::kAbsolute;
}

}  // namespace batten::postproc
