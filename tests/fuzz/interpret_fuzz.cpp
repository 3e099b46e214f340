// The readers up to sections, events and times, for libFuzzer; see docs/development.md.
#include "tests/fuzz/interpret_promises.h"
#include "tests/fuzz/parse_promises.h"
#include "tests/fuzz/program_mutator.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const std::string_view text = batten::fuzz::text_of(data, size);
  for (const auto language : batten::gcode::promises::kLanguages) {
    batten::fuzz::judge(batten::postproc::promises::broken_meaning(text, language));
  }
  return 0;
}
