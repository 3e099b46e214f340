#include "postproc/system/terminal_colour.h"

#include <fmt/format.h>
#include <unistd.h>

#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <cstdlib>

namespace batten::postproc {
namespace {

std::string_view environment(const char* name) {
  const char* value = std::getenv(name);
  return value == nullptr ? std::string_view() : std::string_view(value);
}

// By Ink.
constexpr std::array<std::string_view, 4> kCodes = {"\x1b[1;31m", "\x1b[1;33m", "\x1b[1m",
                                                    "\x1b[1;32m"};

constexpr std::string_view kReplacement = "\xEF\xBF\xBD";  // U+FFFD

// Bytes of the well-formed character that `bytes` begin with; 0 when there is none. The table of
// RFC 3629, section 4: only the second byte has limits of its own.
std::size_t character_size(std::string_view bytes) {
  const auto is_between = [bytes](std::size_t at, unsigned least, unsigned greatest) {
    const auto byte = at < bytes.size() ? static_cast<std::uint8_t>(bytes[at]) : 0U;
    return byte >= least && byte <= greatest;
  };
  if (is_between(0, 0, 0x7F)) return 1;
  const std::size_t size = is_between(0, 0xC2, 0xDF)   ? 2
                           : is_between(0, 0xE0, 0xEF) ? 3
                           : is_between(0, 0xF0, 0xF4) ? 4
                                                       : 0;
  const auto first = static_cast<std::uint8_t>(bytes[0]);
  const unsigned least = first == 0xE0 ? 0xA0 : first == 0xF0 ? 0x90 : 0x80;
  const unsigned greatest = first == 0xED ? 0x9F : first == 0xF4 ? 0x8F : 0xBF;
  if (size == 0 || !is_between(1, least, greatest)) return 0;
  for (std::size_t i = 2; i < size; ++i) {
    if (!is_between(i, 0x80, 0xBF)) return 0;
  }
  return size;
}

}  // namespace

bool shows_colour() {
  if (!environment("NO_COLOR").empty() || environment("TERM") == "dumb") return false;
  return ::isatty(STDERR_FILENO) == 1;
}

std::string inked(std::string_view text, Ink ink, bool colour) {
  if (!colour) return std::string(text);
  return fmt::format("{}{}\x1b[0m", kCodes.at(static_cast<std::size_t>(ink)), text);
}

std::string rate_text(double bytes_per_second) {
  if (bytes_per_second >= 1e6) return fmt::format("{:.1f} MB/s", bytes_per_second / 1e6);
  return fmt::format("{:.0f} kB/s", bytes_per_second / 1e3);
}

std::string rough_time(double seconds) {
  if (seconds <= 60) return fmt::format("{:.0f} s", std::ceil(seconds));
  const auto minutes = static_cast<long long>(std::ceil(seconds / 60));
  if (minutes < 60) return fmt::format("{} min", minutes);
  return fmt::format("{} h {:02} min", minutes / 60, minutes % 60);
}

std::string as_valid_utf8(std::string_view bytes) {
  std::string text;
  text.reserve(bytes.size());
  while (!bytes.empty()) {
    const std::size_t size = character_size(bytes);
    text += size > 0 ? bytes.substr(0, size) : kReplacement;
    bytes.remove_prefix(size > 0 ? size : 1);
  }
  return text;
}

}  // namespace batten::postproc
