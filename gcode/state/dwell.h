// Dwells: what the words of G4 mean on a control, and how a time is said there.
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <string>

#include "gcode/text/program.h"

namespace batten::gcode {

// A time in milliseconds; longer than 0. Nothing where it is not certain: other words beside G4 and
// one of its own (N aside), a time that is finer than a millisecond or longer than
// kLongestDwellMs, or a word whose unit is not known under `form`.
[[nodiscard]] std::optional<std::int32_t> dwell_ms(std::span<const Word> words, DwellForm form);

// The block that waits so long: "G4 P1.5"; empty where the form is not known.
[[nodiscard]] std::string dwell_block(std::int32_t ms, DwellForm form);

// Seconds without zeros behind: "1.5", "2"; with `point`, "2.".
[[nodiscard]] std::string dwell_seconds(std::int32_t ms, bool point);

// An hour: every control that is known takes as much.
inline constexpr std::int32_t kLongestDwellMs = 3'600'000;

}  // namespace batten::gcode
