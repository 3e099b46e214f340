// The certificate of two programs (postproc/proof/certificate.h), from files to a file.
#pragma once

#include "gcode/text/source_text.h"
#include "postproc/commands/commands.h"

namespace batten::postproc {

// Reads both as `verify` does, and writes the certificate that the command asks for. Requires: the
// new program was proved. 0 where none is asked for or it is written; else says why and returns the
// exit code.
[[nodiscard]] int write_certificate(const VerifyCommand& command,
                                    const gcode::SourceText& old_source,
                                    const gcode::SourceText& new_source);

}  // namespace batten::postproc
