// What a chain of moves takes on the machine, under each way in which its control may be set. A
// program rarely says how, and what is faster under one setting must not be slower under another.
#pragma once

#include <span>

#include "gcode/state/modal_state.h"
#include "postproc/machine/machine.h"
#include "postproc/machine/models/cycle_time.h"

namespace batten::postproc {

// Seconds.
struct Times {
  double as_set = 0;           // as the machine's model says
  double without_merging = 0;  // LinuxCNC: G64 P with Q0, lines are not joined before planning
  double flat_out = 0;         // whatever the F words say, as with the feed override turned up
  double exact_path = 0;       // G61: kinks cost stops

  Times& operator+=(const Times& other);
  Times& operator-=(const Times& other);
};

// Of a chain that starts and ends at rest, each when it is asked for.
class SettingTimes {
 public:
  // `path`: as the program says. The machine must live as long. Throws as cutting_time does.
  SettingTimes(std::span<const TimedPiece> chain, const Machine& machine, gcode::PathMode path);

  [[nodiscard]] double as_set() const { return as_set_; }
  [[nodiscard]] double without_merging() const;
  [[nodiscard]] double exact_path() const;
  [[nodiscard]] double flat_out();  // the last of them: the feeds are gone then

 private:
  const Machine& machine_;
  gcode::PathMode path_;
  TimedChain chain_;
  double as_set_;
};

// All of them.
[[nodiscard]] Times times_of(std::span<const TimedPiece> chain, const Machine& machine,
                             gcode::PathMode path);

}  // namespace batten::postproc
