// The readers up to sections, events and times, for libFuzzer; see docs/development.md.
#include <cstddef>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <string>
#include <string_view>

#include "tests/fuzz/interpret_promises.h"
#include "tests/fuzz/parse_promises.h"
#include "tests/fuzz/program_mutator.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const std::string_view text = batten::fuzz::text_of(data, size);
  for (const auto language : batten::gcode::promises::kLanguages) {
    const std::string broken = batten::postproc::promises::broken_meaning(text, language);
    if (!broken.empty()) {
      std::fprintf(stderr, "broken promise: %s\n", broken.c_str());
      std::abort();
    }
  }
  return 0;
}
