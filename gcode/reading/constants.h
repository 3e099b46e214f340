// Variables whose values are certain: #<scale> = 1.0, R2=111.2, DEF REAL Z0=143.35, Q5 = +12; and
// Z[#<scale>*-27.372], X=R2+5, X+Q5 behind them are numbers.
#pragma once

#include "gcode/text/program.h"

namespace batten::gcode {

// Words X Y Z, I J K, R, F and S whose value is an expression become numbers (Word::is_number, with
// Word::computed) where the control finds the same value whenever it comes to the block:
//
//   - each variable was assigned above, in a block that is certainly executed; no label that is
//     jumped to, body of a loop or subprogram, call, or line that is not understood is in between;
//   - it is a name of LinuxCNC's that is no global one (#<name>, not #<_name>), a # number from 1 to
//     999 (those above are windows into the control on some), an R parameter, what DEF REAL
//     declares (a name behind it may get its value), Q0 to Q99 or QL. Numbers are not certain
//     behind tool changes, cycles and M words that may be a builder's: their macros may use them;
//   - the expression has numbers, + - * /, signs and brackets alone. Values are doubles, computed
//     in the order of the text as LinuxCNC does.
//
// Word::decimals are then as many as the value needs, six at most. A block whose words are all
// numbers is one of ParseStatus::kNone. Linear.
void compute_constants(Program& program);

}  // namespace batten::gcode
