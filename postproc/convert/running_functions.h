// Spindle and coolant while a program is read.
#pragma once

#include <optional>

#include "gcode/text/source_text.h"

namespace batten::postproc {

// Nothing: the program has not said it.
struct RunningFunctions {
  std::optional<bool> spindle;
  std::optional<bool> coolant;
  std::optional<double> speed;                        // since the tool was put in
  std::optional<gcode::SourceSpan> turned_at_change;  // of the tool; nothing said of it since

  [[nodiscard]] bool may_be_on() const { return spindle != false || coolant == true; }

  // M3, M4, M5, M8 or M9.
  void switch_by(int function) {
    const bool ends = function == 5 || function == 9;
    const bool of_coolant = function == 8 || function == 9;
    (of_coolant ? coolant : spindle) = !ends;
    if (!of_coolant) turned_at_change.reset();
  }

  // `where`: what puts the tool in. Whether the spindle turns behind it is not known.
  void change_tool(gcode::SourceSpan where) {
    turned_at_change = spindle == true ? std::optional(where) : std::nullopt;
    spindle.reset();
    speed.reset();
  }
};

}  // namespace batten::postproc
