// What the readers behind the parser promise for any bytes whatever: motions, sections, events,
// times. Used by the fuzzer and by the unit tests.
#pragma once

#include <cmath>
#include <cstdint>
#include <string>
#include <string_view>

#include "gcode/interpreter/interpreter.h"
#include "gcode/reading/parser.h"
#include "geometry/path/path.h"
#include "postproc/machine/machine.h"
#include "postproc/machine/program_time/program_time.h"
#include "postproc/proof/verification.h"
#include "postproc/runs/run_grouping.h"

namespace batten::postproc::promises {

inline std::string broken_motions(const gcode::Program& program,
                                  const gcode::Interpretation& meaning) {
  if (meaning.blocks.size() != program.blocks.size()) return "a block without a meaning";
  std::int32_t next = 0;
  for (std::size_t i = 0; i < meaning.blocks.size(); ++i) {
    const gcode::BlockMeaning& block = meaning.blocks[i];
    if (block.state_after >= meaning.states.size()) return "a state that is not there";
    if (block.motion < 0) continue;
    if (block.motion != next++ || meaning.motions.size() < static_cast<std::size_t>(next)) {
      return "motions out of order";
    }
    const gcode::Motion& motion = meaning.motions[static_cast<std::size_t>(block.motion)];
    if (motion.block != i) return "a motion of another block";
    if (!geometry::start_point(motion.piece).allFinite() ||
        !geometry::end_point(motion.piece).allFinite() ||
        !geometry::point_at(motion.piece, 0.3).allFinite()) {
      return "a motion to no place";
    }
  }
  return static_cast<std::size_t>(next) == meaning.motions.size() ? "" : "a motion without a block";
}

inline std::string broken_sections(const gcode::Program& program,
                                   const gcode::Interpretation& meaning) {
  std::uint32_t next = 0;
  for (const Section& section : group_runs(program, meaning, {})) {
    if (section.first_block != next || section.last_block < section.first_block) {
      return "sections do not cover every block once";
    }
    next = section.last_block + 1;
  }
  return next == program.blocks.size() ? "" : "a block in no section";
}

// The promise that does not hold for this text in this language; empty when all do.
inline std::string broken_meaning(std::string_view text, gcode::Language language) {
  gcode::Diagnostics found;
  const gcode::Program program =
      gcode::parse(gcode::SourceText("fuzz", std::string(text)), language, found);
  const gcode::Interpretation meaning =
      gcode::interpret(program, {.units = gcode::Units::kMillimetre}, found);
  if (std::string broken = broken_motions(program, meaning); !broken.empty()) return broken;
  if (std::string broken = broken_sections(program, meaning); !broken.empty()) return broken;
  const Verification same = verify({&program, &meaning}, {&program, &meaning}, 1e-5);
  if (!same.proved()) return "a program is not itself: " + same.violations.front().message;
  const ProgramTime time = time_program(program, meaning, *find_machine("mill"), {});
  const double seconds = time.seconds.sum();
  return std::isfinite(seconds) && seconds >= 0 ? "" : "a time that is none";
}

}  // namespace batten::postproc::promises
