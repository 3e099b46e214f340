#include "gcode/text/diagnostic.h"

#include <algorithm>

namespace batten::gcode {

std::string_view name_of(Severity severity) {
  switch (severity) {
    case Severity::kNote:
      return "note";
    case Severity::kWarning:
      return "warning";
    case Severity::kError:
      return "error";
  }
  return "error";
}

std::string to_text(const Diagnostic& diagnostic, const SourceText& source) {
  const SourcePlace place = source.place_of(diagnostic.where.begin);
  std::string text = source.name();
  text += ':' + std::to_string(place.line) + ':' + std::to_string(place.column) + ": ";
  text += name_of(diagnostic.severity);
  text += ": ";
  text += diagnostic.id;
  text += ": ";
  text += diagnostic.message;
  return text;
}

bool has_error(const Diagnostics& diagnostics) {
  return std::any_of(diagnostics.begin(), diagnostics.end(), [](const Diagnostic& diagnostic) {
    return diagnostic.severity == Severity::kError;
  });
}

}  // namespace batten::gcode
