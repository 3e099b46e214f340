// Where control can come from elsewhere, as values: what the readers of each language find and the
// interpreter asks of every block.
#pragma once

#include <cstdint>
#include <vector>

namespace batten::gcode {

// What a line of flow words does to the state of the blocks after it.
enum class FlowEffect : std::uint8_t {
  kNothing,        // GOTO, IF .. GOTO: falls through with the state that it found
  kAssignment,     // IF .. THEN #1=5
  kProgramNumber,  // O1234: the beginning of a program
  kCall,           // LinuxCNC: o100 call, o<name> call
  kEverything,     // loops, branches: the state after it depends on what was executed
};

// LinuxCNC: o100 sub .. o100 endsub is passed over where it stands; only a call runs what it says.
enum class InDefinition : std::uint8_t { kNo, kFirst, kWithin, kLast };

struct BlockFlow {
  bool label_referenced : 1 = false;  // its N number is, or may be, named elsewhere
  bool jump_target : 1 = false;       // control can come to it from another place
  bool in_body : 1 = false;           // of a loop, a subprogram, or a contour that a cycle names
  bool in_called : 1 = false;         // the whole program is one that others call
  InDefinition in_definition : 2 = InDefinition::kNo;
};

struct ProgramFlow {
  std::vector<BlockFlow> blocks;  // one per block
  // Something of it could be meant for blocks elsewhere: the target of a jump, the begin or the end
  // of a body, a contour, the end of a subprogram. Where no part of a program reaches out, nothing
  // is said of any block.
  bool reaches_out = false;
};

// Where subprograms come back to that are called and stand in another file: `M99 P100` and
// `RET("N100")` go on at a block of the program that called.
enum class Returns : std::uint8_t {
  kBehindCalls,
  kToAnyLabel,
};

}  // namespace batten::gcode
