// libFuzzer's mutations for programs: half by blocks and words, half by bytes. To be included by
// one file of each fuzzer.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <string>
#include <string_view>

#include "tests/fuzz/program_mutation.h"

extern "C" std::size_t LLVMFuzzerMutate(std::uint8_t* data, std::size_t size, std::size_t most);

namespace batten::fuzz {

inline std::string_view text_of(const std::uint8_t* data, std::size_t size) {
  return {reinterpret_cast<const char*>(data), size};
}

// What a fuzzer says of a text: the promise that does not hold, or nothing.
inline int judge(const std::string& broken) {
  if (broken.empty()) return 0;
  std::fprintf(stderr, "broken promise: %s\n", broken.c_str());
  std::abort();
}

inline std::size_t put(std::string_view text, std::uint8_t* out, std::size_t most) {
  const std::size_t size = std::min(text.size(), most);
  std::memcpy(out, text.data(), size);
  return size;
}

}  // namespace batten::fuzz

extern "C" std::size_t LLVMFuzzerCustomMutator(std::uint8_t* data, std::size_t size,
                                               std::size_t most, unsigned int seed) {
  if (seed % 4 == 0) return LLVMFuzzerMutate(data, size, most);
  const std::string_view text = batten::fuzz::text_of(data, size);
  return batten::fuzz::put(batten::fuzz::ProgramMutator(seed).mutated(text, text), data, most);
}

extern "C" std::size_t LLVMFuzzerCustomCrossOver(const std::uint8_t* one, std::size_t one_size,
                                                 const std::uint8_t* other, std::size_t other_size,
                                                 std::uint8_t* out, std::size_t most,
                                                 unsigned int seed) {
  using batten::fuzz::text_of;
  return batten::fuzz::put(batten::fuzz::ProgramMutator(seed).crossed(text_of(one, one_size),
                                                                      text_of(other, other_size)),
                           out, most);
}
