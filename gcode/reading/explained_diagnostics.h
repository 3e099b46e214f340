// What each diagnostic means and what a user can do about it: the same as docs/diagnostics.md, for
// `batten explain`.
#pragma once

#include <span>
#include <string_view>

namespace batten::gcode {

struct ExplainedDiagnostic {
  std::string_view id;        // Diagnostic::id
  std::string_view severity;  // as it is printed: "error", "warning", "warning or note"
  std::string_view text;      // what it means
  std::string_view advice;    // what to do
};

// Every id that reading and following a program can give, once.
[[nodiscard]] std::span<const ExplainedDiagnostic> explained_diagnostics();

}  // namespace batten::gcode
