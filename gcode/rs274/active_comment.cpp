#include "gcode/rs274/active_comment.h"

#include <algorithm>
#include <array>
#include <cstddef>

#include "gcode/text/characters.h"

namespace batten::gcode {
namespace {

// What the text of an active comment starts with, blanks left out. A comma is part of it
// where controls ask for one: (print this first) is only text.
constexpr std::array<std::string_view, 17> kBeginnings = {
    "MSG,",     "DEBUG,",    "PRINT,",  "LOG,",     "LOGOPEN", "LOGAPPEND",
    "LOGCLOSE", "PROBEOPEN", "PROBECL", "PY,",      "PYRUN,",  "PYRELOAD",
    "ABORT,",   "SYSTEM,",   "AXIS,",   "WARNING,", "ERROR,"};

constexpr std::size_t kLongest = 9;

}  // namespace

bool is_active_comment(std::string_view comment) {
  std::array<char, kLongest> beginning{};
  std::size_t length = 0;
  for (std::size_t at = 1; at < comment.size() && length < kLongest; ++at) {
    if (!is_blank(comment[at])) {
      beginning[length++] = upper(comment[at]);
    }
  }
  const std::string_view text(beginning.data(), length);
  return std::any_of(kBeginnings.begin(), kBeginnings.end(),
                     [&](std::string_view name) { return text.starts_with(name); });
}

}  // namespace batten::gcode
