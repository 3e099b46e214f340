// For libFuzzer, see preset `fuzz` in docs/development.md.
// See docs/diagnostics.md for what the reader may say; here only its promises count.
#include <cstdio>

#include "tests/fuzz/parse_promises.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const std::string_view text(reinterpret_cast<const char*>(data), size);
  for (const auto language : batten::gcode::promises::kLanguages) {
    const std::string broken = batten::gcode::promises::broken_by(text, language);
    if (!broken.empty()) {
      std::fprintf(stderr, "broken promise: %s\n", broken.c_str());
      std::abort();
    }
  }
  return 0;
}
