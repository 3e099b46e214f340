// Marks by which programs of other languages are known for certain.
#pragma once

#include <optional>
#include <string_view>

namespace batten::gcode {

struct ForeignLanguage {
  std::string_view name;      // for people: "Heidenhain Klartext"
  std::string_view evidence;  // what was found: "BEGIN PGM"
};

// What the line says, when it is one that only such a language has: `0 BEGIN PGM NAME MM`,
// `%_N_NAME_MPF`, `;$PATH=..`, `DEF REAL ..`.
[[nodiscard]] std::optional<ForeignLanguage> foreign_language_of(std::string_view line);

}  // namespace batten::gcode
