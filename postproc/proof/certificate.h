// The evidence of a proof, as text that others can check: docs/certificates.md has the format, and
// tools/check_certificate.py is a checker that shares nothing with this program.
#pragma once

#include <string>
#include <string_view>

#include "postproc/proof/program_events.h"

namespace batten::postproc {

struct Certificate {
  std::string text;     // empty where there is none
  std::string problem;  // why there is none, and where
};

// Of the strict reading. `before` and `after`: whole programs in one language, of which the second
// was proved. `new_text`: the second as it is written, where lines of a profile stand in it that
// `after` has empty.
//
// Each range of lines that differs is matched for itself; where that is not proved, together with
// the lines up to the next event.
[[nodiscard]] Certificate certificate_of(const ReadProgram& before, const ReadProgram& after,
                                         std::string_view new_text, double tolerance_mm);

}  // namespace batten::postproc
