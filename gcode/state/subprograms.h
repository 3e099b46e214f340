// Programs that others call, read as files of their own.
#pragma once

#include <algorithm>
#include <cstdint>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "gcode/text/program.h"

namespace batten::gcode {

// One whose end is certain: it comes back to the block behind its call, and to no other.
struct Subprogram {
  std::string name;  // as CalledProgram::name
  Program program;
  std::uint32_t begin = 0;          // the first block that is done
  std::vector<std::uint32_t> ends;  // blocks that go back, in their order; the last one always does
};

class Subprograms {
 public:
  explicit Subprograms(std::vector<Subprogram> programs) : programs_(std::move(programs)) {}

  // nullptr: it was not read.
  [[nodiscard]] const Subprogram* find(std::string_view name) const {
    const auto found = std::ranges::find(programs_, name, &Subprogram::name);
    return found == programs_.end() ? nullptr : &*found;
  }

 private:
  std::vector<Subprogram> programs_;
};

}  // namespace batten::gcode
