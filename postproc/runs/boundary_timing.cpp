#include "postproc/runs/boundary_timing.h"

#include <algorithm>

#include "postproc/runs/run_blocks.h"

namespace batten::postproc {

namespace {

bool ends_chain(const gcode::Interpretation& meaning, std::uint32_t block) {
  const gcode::BlockMeaning& of_block = meaning.blocks[block];
  return !of_block.barrier.empty() ||
         (of_block.motion >= 0 && !meaning.states[of_block.state_after].feed);
}

void add_move_of(std::uint32_t block, const gcode::Program& program,
                 const gcode::Interpretation& meaning, std::vector<TimedPiece>& moves) {
  const gcode::BlockMeaning& of_block = meaning.blocks[block];
  const RunBlocks blocks(program, meaning);
  if (of_block.motion < 0 || !blocks.moves(block)) return;
  moves.push_back({blocks.motion(block).piece, *meaning.states[of_block.state_after].feed});
}

}  // namespace

std::vector<TimedPiece> moves_before(const gcode::Program& program,
                                     const gcode::Interpretation& meaning, std::uint32_t block,
                                     std::uint32_t from) {
  std::uint32_t first = block;
  while (first > from && block - first < kNeighbourBlocks && !ends_chain(meaning, first - 1))
    --first;
  std::vector<TimedPiece> moves;
  for (std::uint32_t i = first; i < block; ++i) add_move_of(i, program, meaning, moves);
  return moves;
}

std::vector<TimedPiece> moves_from(const gcode::Program& program,
                                   const gcode::Interpretation& meaning, std::uint32_t block,
                                   std::uint32_t end) {
  const auto all = static_cast<std::uint32_t>(program.blocks.size());
  const std::uint32_t last = std::min({all, end, block + kNeighbourBlocks});
  std::vector<TimedPiece> moves;
  for (std::uint32_t i = block; i < last && !ends_chain(meaning, i); ++i) {
    add_move_of(i, program, meaning, moves);
  }
  return moves;
}

}  // namespace batten::postproc
