// What the blocks of a program are to a run that may hold them.
#pragma once

#include <cstdint>
#include <span>
#include <string_view>

#include "gcode/state/motion.h"
#include "gcode/text/program.h"
#include "postproc/runs/intended_arcs.h"
#include "postproc/runs/section.h"

namespace batten::postproc {

// Of blocks that are asked for their motion, each must have one.
class RunBlocks {
 public:
  // Both must outlive this object.
  RunBlocks(const gcode::Program& program, const gcode::Interpretation& read)
      : program_(program), read_(read) {}

  [[nodiscard]] const gcode::Motion& motion(std::uint32_t block) const {
    return read_.motions[static_cast<std::size_t>(read_.blocks[block].motion)];
  }
  // nullptr where it is no arc.
  [[nodiscard]] const geometry::Arc* arc(std::uint32_t block) const;
  [[nodiscard]] bool moves(std::uint32_t block) const;

  // Whether a block moves straight along Z, in the plane across it, or neither.
  enum class Heading { kAlongZ, kInPlane, kOther };
  [[nodiscard]] Heading heading(std::uint32_t block) const;

  // Whether it says G0, G1, G2 .. itself.
  [[nodiscard]] bool names_motion(std::uint32_t block) const;

  // Whether a block behind this one takes G2 or G3 from it. A bare G2 is no block that controls
  // take: it cannot be said again.
  [[nodiscard]] bool lends_arc_word(std::uint32_t block) const;

  [[nodiscard]] PrintedMotion printed(std::uint32_t block) const;
  // As many digits as any of these blocks prints are right.
  [[nodiscard]] PrintedErrors errors_of(std::span<const std::uint32_t> blocks) const;

  // The run of these motions, in order; the first and the last of them move. What stands between
  // them is part of it.
  [[nodiscard]] Run run_of(std::span<const std::uint32_t> blocks, double max_chord_error) const;

 private:
  [[nodiscard]] int decimals(std::uint32_t block, std::string_view letters) const;
  [[nodiscard]] bool says_only_functions(std::uint32_t block) const;
  void add_motion(std::uint32_t block, double max_chord_error, Run& run) const;
  void add_comments(std::uint32_t block, Run& run) const;

  const gcode::Program& program_;
  const gcode::Interpretation& read_;
};

}  // namespace batten::postproc
