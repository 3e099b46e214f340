// The % lines that bound a program on tape: what stands outside them is not its text.
#pragma once

#include <cstddef>
#include <cstdint>

#include "gcode/text/diagnostic.h"
#include "gcode/text/program.h"

namespace batten::gcode {

// Makes the blocks outside the % marks opaque. A control that knows the marks skips these
// blocks, one that does not runs them; so nothing may be concluded from them.
//
// The first % line begins the program when blocks with words follow it; otherwise it ends it.
void close_program_marks(Program& program, Diagnostics& found);

// What close_program_marks does with a block behind the mark that ends the program.
void close_behind_marks(Block& block);

// Sees a program part by part, from its begin, before any marks are closed.
class PercentMarkScanner {
 public:
  void see(const Program& part);

  // Whether close_program_marks would leave all blocks seen so far that say anything as they are.
  [[nodiscard]] bool closes_nothing() const {
    return !(words_before_ && words_behind_first_) && !words_behind_second_;
  }
  // The line of the mark that ends the program, from 1; 0: none was seen. close_program_marks makes
  // all blocks behind it opaque, also those that say nothing.
  [[nodiscard]] std::uint32_t last_mark() const { return last_mark_; }

 private:
  std::size_t marks_ = 0;
  bool words_before_ = false;
  bool words_behind_first_ = false;
  bool words_behind_second_ = false;
  std::uint32_t last_mark_ = 0;
};

}  // namespace batten::gcode
