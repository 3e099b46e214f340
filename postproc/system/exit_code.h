// How the program ends; scripts and CAM systems depend on these numbers.
#pragma once

namespace batten::postproc {

enum class ExitCode {
  kDone = 0,
  kUsage = 1,          // wrong options; no file was touched
  kNotUnderstood = 2,  // the input program is not understood; nothing was written
  kNotProved = 3,      // not proved under --strict, or `verify` found a violation
  kFileError = 4,
  kInternalError = 5,
  // 128 + signal after an interrupt; see interrupt.h
};

}  // namespace batten::postproc
