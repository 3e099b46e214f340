// What the blocks of a program do: motions in millimetres, and for every block whether it
// may stand inside a run of motions that is rewritten.
#pragma once

#include <array>
#include <cstdint>
#include <string_view>
#include <vector>

#include "gcode/modal_state.h"
#include "gcode/program.h"
#include "geometry/path.h"

namespace batten::gcode {

enum class MotionKind : std::uint8_t {
  kRapid,  // G0
  kLine,   // G1
  kArc,    // G2, G3
};

struct Motion {
  std::uint32_t block = 0;  // index into Program::blocks
  MotionKind kind = MotionKind::kLine;
  bool start_known = false;  // every axis that this motion moves was known before it
  std::array<bool, 3> axes_named = {false, false, false};  // X, Y, Z stand in the block
  geometry::PathPiece piece;  // a Line for kRapid and kLine, an Arc for kArc; absolute mm
};

// What a block is, as far as grouping and checking are concerned.
enum class BlockKind : std::uint8_t {
  kEmpty,          // nothing, or comments only
  kMotion,         // one motion of MotionKind, and words that only describe it or change nothing
  kSettings,       // words that change the state or act (M, S, T, G54 ..), without a motion
  kMotionAndMore,  // a motion with words that change the state or act in the same block
  kOpaque,         // not understood
};

struct BlockMeaning {
  BlockKind kind = BlockKind::kEmpty;
  // Why this block itself cannot be part of a run; empty where it can (see reason.h).
  std::string_view barrier;
  std::int32_t motion = -1;       // index into Interpretation::motions, -1: none
  std::uint32_t state_after = 0;  // index into Interpretation::states
  bool label_referenced = false;  // its N number is the target of GOTO, P, M97, M99 ..
};

struct Interpretation {
  std::vector<BlockMeaning> blocks;  // one per block of the program
  std::vector<Motion> motions;       // in order
  std::vector<ModalState> states;    // states[0] is the state before the first block
  bool unit_word_seen = false;       // G20/G21 (G70/G71) stood somewhere, or --units was given
};

}  // namespace batten::gcode
