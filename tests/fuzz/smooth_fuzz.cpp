// The whole pipeline, for libFuzzer; see docs/development.md. The options are those that the first
// line of the program stands for.
#include "tests/fuzz/program_mutator.h"
#include "tests/fuzz/smooth_promises.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using batten::postproc::Method;
  const std::string_view text = batten::fuzz::text_of(data, size);
  auto options = batten::postproc::promises::options_for_text(text);
  // Their searches take seconds to a program under the sanitizers: they are for MutatedPrograms.
  if (options.method == Method::kTimeOptimal || options.method == Method::kOzcan) {
    options.method = Method::kFair;
  }
  return batten::fuzz::judge(batten::postproc::promises::broken_by(text, options));
}
