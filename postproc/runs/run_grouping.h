// Chains of G01, and of G02 and G03 that are pieces of a curve, with unchanged state become runs;
// everything else is copied, with a reason. And what the blocks of a program are to a run.
#pragma once

#include <cstdint>
#include <span>
#include <string_view>
#include <vector>

#include "gcode/state/motion.h"
#include "gcode/text/program.h"
#include "postproc/runs/intended_arcs.h"
#include "postproc/runs/section.h"

namespace batten::postproc {

struct GroupingOptions {
  std::size_t min_motions = 3;            // chains of fewer motions with a length: too-short
  double tolerance_mm = 0.01;             // the user's: tells pieces of a curve from arcs that were
                                          // meant, and how finely runs follow their arcs
  std::vector<std::string_view> allowed;  // reason ids lifted by --allow
};

// Sections in the order of the program; together they cover every block once. A Verbatim
// section holds neighbouring blocks that are kept for one reason; blocks that say nothing
// (empty lines, comments) go with the Verbatim section before them, behind a run with the one
// after them. A run is not longer than its motions: what stands around it is copied. Which arcs are
// kept: postproc/runs/intended_arcs.h.
//
// `cuts`: blocks that begin a section of their own, increasing: what stands before them is grouped
// as if the program ended there, and what follows as if it began.
//
// Requires: `interpretation` belongs to `program`.
[[nodiscard]] std::vector<Section> group_runs(const gcode::Program& program,
                                              const gcode::Interpretation& interpretation,
                                              const GroupingOptions& options,
                                              std::span<const std::uint32_t> cuts = {});

// Why no motion may be rewritten in this state; empty where it may: one row per unsafe state.
// G61 (exact path) is lifted by --allow exact-stop; G61.1 and G60 are not, their user asked for
// the stops. --allow control-smoothing lifts that state. Ask with the state after the motion's
// block, which is the one it moves in.
[[nodiscard]] std::string_view unsafe_state(const gcode::ModalState& state,
                                            const GroupingOptions& options);

// What the blocks of a program are to a run that may hold them.

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
