// What the readers of curve words promise for any program whatever, from any of its blocks on. Used
// by the fuzzer and by the unit tests.
#pragma once

#include <algorithm>
#include <cstdint>
#include <string>
#include <string_view>
#include <variant>

#include "gcode/curves/g5_curve.h"
#include "gcode/curves/heidenhain_spl.h"
#include "gcode/curves/nurbs.h"
#include "gcode/curves/siemens_curves.h"
#include "gcode/reading/parser.h"
#include "geometry/path/path.h"

namespace batten::gcode::promises {

// Pieces of blocks of the program, each behind the one before it, at places that are some.
inline std::string broken_reading(const CurveResult& result, std::uint32_t first,
                                  const Program& program) {
  if (const auto* refusal = std::get_if<CurveRefusal>(&result)) {
    return refusal->why.empty() ? "a refusal without a reason" : "";
  }
  const auto& reading = std::get<CurveReading>(result);
  if (reading.blocks > program.blocks.size() - first) return "blocks that are not there";
  std::uint32_t from = first;
  for (const CurveMotion& motion : reading.motions) {
    if (motion.block < from || motion.block >= first + reading.blocks) {
      return "a piece of a block that does not say the curve";
    }
    from = motion.block + 1;
    for (const double t : {0.0, 0.37, 1.0}) {
      if (!geometry::point_at(motion.piece, t).allFinite()) return "a piece to no place";
    }
  }
  return "";
}

inline std::string broken_readers_at(const Program& program, std::uint32_t first,
                                     const CurveStart& start) {
  for (const CurveFormat* format :
       {&linuxcnc_g5(), &chopped_g5(), &fanuc_curves(), &syntec_curves(), &mitsubishi_curves(),
        &siemens_poly(), &siemens_bspline(), &heidenhain_spl()}) {
    std::string broken = broken_reading(format->read(program, first, start), first, program);
    if (!broken.empty()) return std::string(format->name) + ": " + broken;
  }
  return "";
}

// The promise that does not hold for this text in this language; empty when all do.
inline std::string broken_curves(std::string_view text, Language language) {
  Diagnostics found;
  const Program program = parse(SourceText("fuzz", std::string(text)), language, found);
  // Each reader goes on to the end of its curve: many blocks times all of them would take long.
  constexpr std::size_t kMostBlocks = 200;
  const std::size_t blocks = std::min(program.blocks.size(), kMostBlocks);
  CurveStart start;
  start.position.known = {true, true, true};
  for (std::uint32_t first = 0; first < blocks; ++first) {
    start.units = first % 5 == 4 ? Units::kInch : Units::kMillimetre;
    std::string broken = broken_readers_at(program, first, start);
    if (!broken.empty()) return broken;
  }
  return "";
}

}  // namespace batten::gcode::promises
