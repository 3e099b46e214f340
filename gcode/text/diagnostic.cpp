#include "gcode/text/diagnostic.h"

#include <fmt/format.h>

#include <algorithm>

namespace batten::gcode {

std::string_view name_of(Severity severity) {
  constexpr std::string_view kNames[] = {"note", "warning", "error"};
  return kNames[static_cast<std::size_t>(severity)];
}

std::string to_text(const Diagnostic& diagnostic, const SourceText& source) {
  const SourcePlace place = source.place_of(diagnostic.where.begin);
  return fmt::format("{}:{}:{}: {}: {}: {}", source.name(), place.line, place.column,
                     name_of(diagnostic.severity), diagnostic.id, diagnostic.message);
}

bool has_error(const Diagnostics& diagnostics) {
  return std::ranges::count(diagnostics, Severity::kError, &Diagnostic::severity) > 0;
}

}  // namespace batten::gcode
