// A reason of gcode/state/reason.h in one byte, for what is held once per block.
#pragma once

#include <cstdint>
#include <string_view>

namespace batten::gcode {

// Reads as its id, empty where there is none.
class ReasonId {
 public:
  ReasonId() = default;
  // Requires an id that is explained in reason::explanations(), or none; throws
  // std::invalid_argument for another.
  ReasonId(std::string_view id);

  [[nodiscard]] bool empty() const { return place_ == 0; }
  [[nodiscard]] std::string_view id() const;
  operator std::string_view() const { return id(); }

  friend bool operator==(ReasonId, ReasonId) = default;
  friend bool operator==(ReasonId a, std::string_view b) { return a.id() == b; }

 private:
  std::uint8_t place_ = 0;  // in reason::explanations(), from 1; 0: none
};

}  // namespace batten::gcode
