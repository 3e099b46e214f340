#include "gcode/curves/curve_format.h"

#include <algorithm>
#include <utility>

namespace batten::gcode {
namespace {

// A line that ends with a CR alone goes on behind it on some controls.
bool is_certain(const Program& program, const Block& block, const BlockFlow& flow) {
  return block.opacity != ParseStatus::kUnreadable && !block.block_delete && !block.has_checksum &&
         !flow.jump_target && !flow.label_referenced && !flow.in_body &&
         std::ranges::none_of(
             program.comments_of(block),
             [](const Comment& comment) { return comment.kind == CommentKind::kActive; }) &&
         std::ranges::all_of(program.words_of(block), [&](const Word& word) {
           return word.letter != 'N' || is_block_number(program, block, word);
         });
}

}  // namespace

bool may_start(const CurveFormat& format, const ModalState& state) {
  return path_alone_counts(state) && (!format.only_in_xy || state.plane == Plane::kXY);
}

std::optional<CurveReading> curve_at(const Program& program, std::uint32_t first,
                                     const ControlState& state, const CurveFormat* format,
                                     std::span<const BlockFlow> flow) {
  const bool may_be_followed = format != nullptr && is_known(state.modal) &&
                               state.modal.control_smoothing == TriState::kOff &&
                               may_start(*format, state.modal);
  if (!may_be_followed) return std::nullopt;
  CurveResult result = format->read(program, first, {state.position, state.modal.units});
  auto* curve = std::get_if<CurveReading>(&result);
  if (curve == nullptr || curve->blocks == 0 || curve->motions.empty()) return std::nullopt;
  for (std::uint32_t i = first; i < first + curve->blocks; ++i) {
    if (!is_certain(program, program.blocks[i], flow[i])) return std::nullopt;
  }
  return std::move(*curve);
}

bool is_feed_without_point(const Program& program, std::uint32_t first, const CurveReading& curve) {
  const auto blocks = std::span(program.blocks).subspan(first, curve.blocks);
  return std::ranges::any_of(blocks, [&](const Block& block) {
    return std::ranges::any_of(program.words_of(block), [](const Word& word) {
      return word.letter == 'F' && word.without_point;
    });
  });
}

Motion motion_of(const CurveMotion& piece, const CurveReading& curve) {
  Motion motion;
  motion.block = piece.block;
  motion.kind = MotionKind::kCurve;
  motion.start_known = motion.end_known = true;
  motion.axes_named = curve.axes;
  motion.curve_decimals = static_cast<std::uint8_t>(curve.decimals);
  motion.is_near = curve.is_near;
  motion.arcs = piece.arcs;
  motion.piece = piece.piece;
  return motion;
}

}  // namespace batten::gcode
