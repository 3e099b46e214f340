// Consecutive blocks of a program and what they do, taken apart and put together again: what of a
// program that is read part by part (gcode/reading/part_reading.h) is held at a time.
#pragma once

#include <cstdint>

#include "gcode/state/motion.h"
#include "gcode/text/program.h"

namespace batten::gcode {

struct ReadPart {
  Program program;
  Interpretation meaning;
};

// The blocks from `first` on become a part of their own, as if it had been read behind the others,
// which stay. No curve of several blocks (BlockMeaning::of_curve) is cut.
[[nodiscard]] ReadPart take_rest(ReadPart& part, std::uint32_t first);

// `more` was read directly behind `part`: both as if they had been read as one.
void append(ReadPart& part, ReadPart more);

}  // namespace batten::gcode
