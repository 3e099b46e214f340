// What is wrong with a program: a value, collected and never thrown.
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "gcode/text/source_text.h"

namespace batten::gcode {

enum class Severity {
  kNote,     // worth knowing
  kWarning,  // something was left alone because it is doubtful
  kError,    // the program is not understood; nothing is rewritten
};

[[nodiscard]] std::string_view name_of(Severity severity);  // "warning"

struct Diagnostic {
  Severity severity = Severity::kError;
  std::string_view id;  // stable, explained in docs/diagnostics.md: "arc-radius-mismatch"
  SourceSpan where;     // printed as line:column of its begin
  std::string message;  // what was found and what was expected, with units
};

using Diagnostics = std::vector<Diagnostic>;

// "part.nc:120:8: error: arc-radius-mismatch: start radius 10.000 mm, end radius 10.412 mm"
[[nodiscard]] std::string to_text(const Diagnostic& diagnostic, const SourceText& source);

[[nodiscard]] bool has_error(const Diagnostics& diagnostics);

}  // namespace batten::gcode
