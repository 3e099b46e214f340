// What the times of a program leave out or had to assume: never silently.
#pragma once

#include <cstddef>
#include <cstdint>
#include <string_view>
#include <vector>

namespace batten::postproc {

// Ids besides the reasons of gcode/state/reason.h, some of which count here too.
namespace not_timed {
inline constexpr std::string_view kPlaceUnknown = "start-unknown";
inline constexpr std::string_view kPlaceAssumed = "position-assumed";
inline constexpr std::string_view kRotaryAxis = "rotary-axis";
inline constexpr std::string_view kPathChanged = "path-changed-by-control";
inline constexpr std::string_view kSpindleUnknown = "spindle-speed-unknown";
inline constexpr std::string_view kDwellUnknown = "dwell-unknown";
inline constexpr std::string_view kDwellAssumed = "dwell-unit-assumed";
inline constexpr std::string_view kReferenceMove = "reference-move";
inline constexpr std::string_view kOperatorStop = "operator-stop";
inline constexpr std::string_view kAfterEnd = "after-end";
}  // namespace not_timed

struct NotTimed {
  std::string_view id;  // stable: "start-unknown"
  std::string_view text;
  std::size_t count = 0;
  std::uint32_t first_line = 0;
};

class NotTimedList {
 public:
  // Once more; the first call of an id says its line.
  void add(std::string_view id, std::uint32_t line);
  [[nodiscard]] const std::vector<NotTimed>& entries() const { return entries_; }

 private:
  std::vector<NotTimed> entries_;
};

}  // namespace batten::postproc
