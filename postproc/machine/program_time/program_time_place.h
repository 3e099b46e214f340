// Where the tool stands as far as a program's text tells, axis by axis.
#pragma once

#include <array>
#include <cstdint>

#include "gcode/state/block_words.h"
#include "gcode/state/modal_state.h"
#include "gcode/state/motion.h"
#include "geometry/basic/point.h"

namespace batten::postproc {

enum class Certainty : std::uint8_t {
  kUnknown,  // never said
  kAssumed,  // as last programmed, but a tool change or an offset came since
  kKnown,
};

class ToolPlace {
 public:
  void set(const geometry::Point3& mm);
  void set_axis(std::size_t axis, double mm, Certainty certainty);
  void forget_axis(std::size_t axis) { certainty_[axis] = Certainty::kUnknown; }
  void forget();
  // From now on it is an assumption that the tool still is there.
  void doubt();

  [[nodiscard]] const geometry::Point3& mm() const { return mm_; }
  [[nodiscard]] Certainty certainty(std::size_t axis) const { return certainty_[axis]; }

 private:
  geometry::Point3 mm_ = geometry::Point3::Zero();
  std::array<Certainty, 3> certainty_ = {Certainty::kUnknown, Certainty::kUnknown,
                                         Certainty::kUnknown};
};

// A motion with its place as sure as it can be.
struct PlacedMotion {
  geometry::PathPiece piece;
  Certainty start = Certainty::kKnown;  // the least over the axes that move
};

// A straight motion along the axis words of a block, in a state of known units.
[[nodiscard]] PlacedMotion line_of_words(const gcode::BlockWords& words,
                                         const gcode::ModalState& state, const ToolPlace& place);

// The interpreter's motion; what it does not know of the start comes from `place`.
[[nodiscard]] PlacedMotion place_motion(const gcode::Motion& motion, const gcode::BlockWords& words,
                                        const gcode::ModalState& state, const ToolPlace& place);

// The tool is at the end of the motion: axes that the block names are known, unless the start
// of an increment was not.
void move_to_end(ToolPlace& place, const PlacedMotion& motion, const gcode::BlockWords& words,
                 const gcode::ModalState& state);

}  // namespace batten::postproc
