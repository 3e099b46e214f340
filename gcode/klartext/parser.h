// Heidenhain Klartext to blocks and words. L, CC, C and M functions become the words of RS-274
// that mean the same, so that all that follows reads both languages:
//
//   12 L X+1,5 Y-2 R0 F500 M3   N12 G1 X1.5 Y-2 G40 F500 M3
//   13 L Z+50 FMAX              N13 G0 Z50
//   14 CC X+10 Y+0              N14, and X10 Y0 are kept for the next C
//   15 C X+20 Y+0 DR-           N15 G2 X20 Y0 I10 J0, absolute centres; the spans of I and J lie in
//                               the block of the CC
//   16 CR X+0 Y+0 R+20 DR+      N16 G3 X0 Y0 R20
//
// RL and RR are G41 and G42. Everything else is copied: such blocks are opaque, and
// state.h says what they may have changed. Where a later block bends the end of a motion
// (RND, CHF) or takes its direction (CT, DEP), the motion before it is ParseStatus::kCornerWord.
#pragma once

#include "gcode/text/diagnostic.h"
#include "gcode/text/program.h"
#include "gcode/text/source_text.h"

namespace batten::gcode {

// Adds to `found` what is worth telling. Linear time; one pass. Every byte of the source is in one
// block, a block is a line.
[[nodiscard]] Program parse_klartext(const SourceText& source, Diagnostics& found);

}  // namespace batten::gcode
