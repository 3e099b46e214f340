#include "gcode/plain_line.h"

#include <array>
#include <cstddef>
#include <utility>

#include "gcode/reason.h"

namespace batten::gcode {
namespace {

bool is_plain_state(const ModalState& modal) {
  const bool line = modal.motion == MotionMode::kLine || modal.motion == MotionMode::kRapid;
  return line && modal.distance == DistanceMode::kAbsolute && modal.polar == Tri::kOff &&
         modal.modal_macro == Tri::kOff;
}

bool is_plain_block(const Block& block, const BlockFlow& flow) {
  return block.opacity == Opacity::kNone && !block.block_delete && !block.has_checksum &&
         block.comment_count == 0 && block.word_count > 0 && !flow.label_referenced &&
         !flow.jump_target && !flow.in_body;
}

}  // namespace

bool read_plain_line(const Program& program, std::uint32_t index, const BlockFlow& flow,
                     ControlState& now, Interpretation& read) {
  const Block& block = program.blocks[index];
  const ModalState& modal = now.modal;
  if (program.language != Language::kRs274 || !is_plain_state(modal) ||
      !is_plain_block(block, flow)) {
    return false;
  }
  const double unit = modal.units == Units::kInch ? kMillimetresPerInch : 1;
  Position end = now.position;
  std::array<bool, 3> named = {false, false, false};
  for (const Word& word : program.words_of(block)) {
    if (word.letter < 'X' || word.letter > 'Z' || !word.is_number) return false;
    const auto axis = static_cast<std::size_t>(word.letter - 'X');
    if (std::exchange(named[axis], true)) return false;  // twice: the interpreter tells of it
    end.mm[static_cast<Eigen::Index>(axis)] = word.value * unit;
    end.known[axis] = true;
  }
  const bool rapid = modal.motion == MotionMode::kRapid;
  BlockMeaning meaning;
  meaning.kind = BlockKind::kMotion;
  meaning.motion = static_cast<std::int32_t>(read.motions.size());
  meaning.state_after = static_cast<std::uint32_t>(read.states.size() - 1);
  if (rapid) meaning.barrier = reason::kRapid;
  read.blocks.push_back(meaning);
  Motion& motion = read.motions.emplace_back();
  motion.block = index;
  motion.kind = rapid ? MotionKind::kRapid : MotionKind::kLine;
  motion.axes_named = named;
  motion.end_known = true;
  motion.start_known = true;
  for (std::size_t axis = 0; axis < named.size(); ++axis) {
    motion.start_known &= !named[axis] || now.position.known[axis];
  }
  motion.piece = geometry::Line{now.position.mm, end.mm};
  now.position = end;
  return true;
}

}  // namespace batten::gcode
