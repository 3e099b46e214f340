// Chains of G01, of G02 and G03 that are pieces of a curve, and of the control's own curves, with
// unchanged state become runs; everything else is copied, with a reason. And what the blocks of a
// program are to a run.
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <string_view>
#include <utility>
#include <vector>

#include "gcode/state/motion.h"
#include "gcode/text/program.h"
#include "postproc/runs/intended_arcs.h"
#include "postproc/runs/section.h"

namespace batten::postproc {

struct GroupingOptions {
  std::size_t min_motions = 3;            // chains of fewer motions with a length: too-short
  double tolerance_mm = 0.01;             // the user's: distinguishes segments of a curve from
                                          // intended arcs, and how finely runs follow their arcs
  std::vector<std::string_view> allowed;  // reason ids lifted by --allow
};

// Sections in the order of the program, each block in one of them. A Verbatim section holds
// neighbouring blocks that are kept for one reason; blocks that say nothing (empty lines, comments)
// go with the Verbatim section before them, after a run with the next one. A run is not longer than
// its motions. Which arcs are kept: postproc/runs/intended_arcs.h.
//
// A run ends where the program says another tolerance, of those that are less than
// `options.tolerance_mm`; a block that says it beside its motion is kept.
//
// `cuts`: blocks that begin a section of their own, increasing: what is before them is grouped
// as if the program ended there, and what follows as if it began.
[[nodiscard]] std::vector<Section> group_runs(const gcode::Program& program,
                                              const gcode::Interpretation& interpretation,
                                              const GroupingOptions& options,
                                              std::span<const std::uint32_t> cuts = {});

// Why no motion may be rewritten in this state; empty where it may. G61 (exact path) is lifted by
// --allow exact-stop; G61.1 and G60 are not, their user asked for the stops. --allow
// control-smoothing lifts that state, on or unknown. A motion moves in the state after its block.
[[nodiscard]] std::string_view unsafe_state(const gcode::ModalState& state,
                                            const GroupingOptions& options);

// unsafe_state of the blocks of a program, of which many that follow each other share one state.
class UnsafeStates {
 public:
  explicit UnsafeStates(GroupingOptions options) : options_(std::move(options)) {}
  void begin(const gcode::Interpretation& read);
  [[nodiscard]] std::string_view reason(std::uint32_t state);

 private:
  GroupingOptions options_;
  const gcode::Interpretation* read_ = nullptr;
  std::optional<std::uint32_t> asked_;
  std::string_view answer_;
};

// Blocks that are rewritten together or not at all, both inclusive.
struct BlockRange {
  std::uint32_t first = 0;
  std::uint32_t last = 0;
};

// All that say one curve with this block; the block alone where it says none.
[[nodiscard]] BlockRange together_with(std::uint32_t block, const gcode::Interpretation& read);

// For every edge between two points of a run the block whose motion it belongs to.
[[nodiscard]] std::vector<std::uint32_t> blocks_of_edges(const Section& section,
                                                         const gcode::Interpretation& read);

// What the blocks of a program are to a run that may hold them. Blocks that are asked for their
// motion must have one.
class RunBlocks {
 public:
  // Both must outlive this object.
  RunBlocks(const gcode::Program& program, const gcode::Interpretation& read)
      : program_(program), read_(read) {}

  [[nodiscard]] const gcode::Motion& motion(std::uint32_t block) const {
    return read_.motions[static_cast<std::size_t>(read_.blocks[block].motion)];
  }
  // All of them: of a block of a curve there may be several.
  [[nodiscard]] std::span<const gcode::Motion> motions(std::uint32_t block) const {
    return gcode::motions_of(read_, block);
  }
  // nullptr where it is no arc.
  [[nodiscard]] const geometry::Arc* arc(std::uint32_t block) const;
  [[nodiscard]] bool is_bend(std::uint32_t block) const;  // an arc, or a piece of a curve
  [[nodiscard]] bool moves(std::uint32_t block) const;

  // Whether a block moves straight along Z, in the plane across it, or neither. Pieces of a curve
  // never move along Z: a plunge is a block of its own.
  enum class Heading { kAlongZ, kInPlane, kOther };
  [[nodiscard]] Heading heading(std::uint32_t block) const;

  // Whether it says G0, G1, G2 .. itself, or begins a curve.
  [[nodiscard]] bool names_motion(std::uint32_t block) const;
  // Whether a run may begin with its motion: an arc that says its word, the first piece of a curve,
  // any line that is none.
  [[nodiscard]] bool can_start(std::uint32_t block) const;
  // A speed of the spindle, be it the one that holds.
  [[nodiscard]] bool says_speed(std::uint32_t block) const;

  // Whether a later block takes G2 or G3 from this one, or the word of its curve, or may go on from
  // the curve. Controls refuse a bare G2: it cannot be said again.
  [[nodiscard]] bool lends_motion_word(std::uint32_t block) const;

  // Adds the block's motions that are of some length.
  void add_printed(std::uint32_t block, std::vector<PrintedMotion>& moving) const;
  // As many digits as any of these blocks prints are right.
  [[nodiscard]] PrintedErrors errors_of(std::span<const std::uint32_t> blocks) const;

  // The run of these motions, in order, and what is between them; the first and the last move.
  [[nodiscard]] Run run_of(std::span<const std::uint32_t> blocks, double max_chord_error) const;

 private:
  [[nodiscard]] int decimals_of_places(std::uint32_t block) const;
  [[nodiscard]] int decimals(std::uint32_t block, std::string_view letters) const;
  [[nodiscard]] bool goes_on_as_curve(std::uint32_t block) const;
  [[nodiscard]] bool says_only_functions(std::uint32_t block) const;
  void add_motion(std::uint32_t block, double max_chord_error, Run& run) const;

  const gcode::Program& program_;
  const gcode::Interpretation& read_;
};

}  // namespace batten::postproc
