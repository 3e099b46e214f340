// --decimals: what a number without a point means, as the user says.
#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "gcode/control/dialect.h"
#include "gcode/reading/source_kind.h"
#include "gcode/text/decimals.h"

namespace batten::postproc {

// "explicit", "implied", and "implied:0.0001" for the least increment of millimetre programs, which
// is a power of ten. Nothing for "auto", and with a problem for anything else.
[[nodiscard]] std::optional<gcode::Decimals> read_decimals(std::string_view text,
                                                           std::vector<std::string>& problems);

// The same back: "auto" for nothing.
[[nodiscard]] std::string text_of(const std::optional<gcode::Decimals>& declared);

// Why this cannot be so for this source and this target (nullptr: none is named); empty where it
// can.
[[nodiscard]] std::vector<std::string> problems_of_decimals(
    const std::optional<gcode::Decimals>& declared, gcode::SourceKind source,
    const gcode::Dialect* target);

}  // namespace batten::postproc
