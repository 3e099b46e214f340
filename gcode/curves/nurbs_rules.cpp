#include "gcode/curves/nurbs_rules.h"

#include <array>
#include <utility>

namespace batten::gcode {

NurbsRules fanuc_nurbs(Units units) {
  NurbsRules rules;
  rules.control = "FANUC";
  // Nine digits in the least increment of the reference axis: +-999999.999 in millimetres at IS-B,
  // +-99999.9999 in inches.
  rules.knots = {.digits = 9, .decimals = units == Units::kInch ? 4 : 3};
  return rules;
}

NurbsRules syntec_nurbs(Units units) {
  NurbsRules rules = fanuc_nurbs(units);
  rules.control = "Syntec";
  rules.weights = true;
  rules.framed = true;
  return rules;
}

NurbsRules mitsubishi_nurbs() {
  NurbsRules rules;
  rules.control = "Mitsubishi";
  // The manual limits the decimals only. Eight digits in all are what its axis words have.
  rules.knots = {.digits = 8, .decimals = 4};
  rules.three_axes = true;
  rules.framed = true;
  rules.missing_knot = "P33";
  rules.wrong_mode = "P29";
  rules.wrong_start = "start-differs";
  rules.decreasing = "P551";
  rules.axis_too_late = "P32";
  rules.too_many_decimals = "P33";
  return rules;
}

std::string_view nurbs_complaint(const ModalState& state) {
  if (state.feed_mode != FeedMode::kPerMinute) return "G06.2 needs feed per minute (G94)";
  if (state.distance != DistanceMode::kAbsolute) return "G06.2 is written in G90 only";
  const std::array<std::pair<TriState, std::string_view>, 11> items = {{
      {state.cutter_compensation, "G06.2 is an alarm under G41 and G42"},
      {state.polar, "G06.2 is an alarm under G12.1, and polar coordinates are no places"},
      {state.cylindrical, "G06.2 in cylindrical interpolation"},
      {state.tool_center_point, "G06.2 under tool centre point control"},
      {state.tilted_plane, "G06.2 in a tilted plane"},
      {state.scaling, "G06.2 under scaling"},
      {state.rotation, "G06.2 under rotation"},
      {state.mirror, "G06.2 under mirror image"},
      {state.modal_macro, "G06.2 under a modal macro call"},
      {state.constant_surface_speed, "G06.2 under constant surface speed"},
      {state.lathe_diameter, "G06.2 with diameters"},
  }};
  for (const auto& [item, complaint] : items) {
    if (item != TriState::kOff) return complaint;
  }
  return {};
}

}  // namespace batten::gcode
