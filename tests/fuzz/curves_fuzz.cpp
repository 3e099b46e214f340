// The readers of curve words (G06.2, POLY, BSPLINE, SPL, Klartext), for libFuzzer; see
// docs/development.md.
#include "tests/fuzz/curves_promises.h"
#include "tests/fuzz/parse_promises.h"
#include "tests/fuzz/program_mutator.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const std::string_view text = batten::fuzz::text_of(data, size);
  for (const auto language : batten::gcode::promises::kLanguages) {
    batten::fuzz::judge(batten::gcode::promises::broken_curves(text, language));
  }
  return 0;
}
