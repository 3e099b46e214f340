// Which unit the numbers of a program speak for that names none. It is only told: a tolerance in a
// unit that was guessed would be another one.
#pragma once

#include <string>
#include <string_view>

#include "gcode/state/code_table.h"
#include "gcode/text/diagnostic.h"

namespace batten::postproc {

// What messages say.
inline constexpr std::string_view kSpeaksForMillimetres = "its numbers speak for mm";
inline constexpr std::string_view kSpeaksForInches = "its numbers speak for inch";

struct UnitEvidence {
  gcode::Units likely = gcode::Units::kUnknown;  // nothing speaks for one of them clearly
  std::string why;                               // for people: "X to 180.5, F to 1200"
};

// By comments that name a unit, the greatest coordinates, the feeds and the decimals. Linear.
[[nodiscard]] UnitEvidence unit_evidence(std::string_view text);

// Adds it to the message of the error units-missing among these. False: there is none.
bool tell_unit_evidence(std::string_view text, gcode::Diagnostics& found);

// The command again with the units that are likely, or with each of them where neither is, to be
// copied.
[[nodiscard]] std::string commands_with_units(std::string_view command_line, gcode::Units likely);

}  // namespace batten::postproc
