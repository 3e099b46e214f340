#include "postproc/report/compact_numbers.h"

#include <algorithm>
#include <cstddef>

namespace batten::postproc {
namespace {

constexpr std::string_view kDigits =
    "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";

void append(std::int64_t number, std::string& bytes) {
  const auto shifted = static_cast<std::uint64_t>(number) << 1U;
  std::uint64_t rest = number < 0 ? ~shifted : shifted;
  while (rest > 0x7F) {
    bytes.push_back(static_cast<char>(0x80U | (rest & 0x7FU)));
    rest >>= 7U;
  }
  bytes.push_back(static_cast<char>(rest));
}

std::vector<std::int64_t> steps_of(const std::vector<std::int64_t>& numbers) {
  std::vector<std::int64_t> steps;
  steps.reserve(numbers.size());
  std::int64_t before = 0;
  for (const std::int64_t number : numbers) {
    steps.push_back(number - before);
    before = number;
  }
  return steps;
}

}  // namespace

std::string base64(std::string_view bytes) {
  std::string text;
  text.reserve((bytes.size() + 2) / 3 * 4);
  for (std::size_t i = 0; i < bytes.size(); i += 3) {
    const std::size_t count = std::min<std::size_t>(3, bytes.size() - i);
    std::uint32_t group = 0;
    for (std::size_t k = 0; k < 3; ++k) {
      const auto byte = k < count ? static_cast<unsigned char>(bytes[i + k]) : 0U;
      group = (group << 8U) | byte;
    }
    for (std::size_t k = 0; k < 4; ++k) {
      text.push_back(k <= count ? kDigits[(group >> (18U - 6U * k)) & 0x3FU] : '=');
    }
  }
  return text;
}

std::string packed(const std::vector<std::int64_t>& numbers) {
  std::string bytes;
  for (const std::int64_t number : numbers) append(number, bytes);
  return base64(bytes);
}

std::string packed_steps(const std::vector<std::int64_t>& numbers) {
  return packed(steps_of(numbers));
}

std::string packed_runs(const std::vector<std::int64_t>& numbers) {
  std::vector<std::int64_t> runs;
  for (std::size_t i = 0; i < numbers.size();) {
    std::size_t end = i;
    while (end < numbers.size() && numbers[end] == numbers[i]) ++end;
    runs.push_back(numbers[i]);
    runs.push_back(static_cast<std::int64_t>(end - i));
    i = end;
  }
  return packed(runs);
}

std::string packed_step_runs(const std::vector<std::int64_t>& numbers) {
  return packed_runs(steps_of(numbers));
}

}  // namespace batten::postproc
