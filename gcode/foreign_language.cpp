#include "gcode/foreign_language.h"

#include <array>
#include <cstddef>

#include "gcode/characters.h"

namespace batten::gcode {
namespace {

constexpr std::string_view kKlartext = "Heidenhain Klartext";
constexpr std::string_view kSiemens = "Siemens Sinumerik";

constexpr std::array<std::string_view, 7> kSiemensTypes = {"REAL",   "INT",  "BOOL", "CHAR",
                                                           "STRING", "AXIS", "FRAME"};

// Takes the next word (letters, digits and _) off the front of the line.
std::string_view next_word(std::string_view& line) {
  while (!line.empty() && is_blank(line.front())) {
    line.remove_prefix(1);
  }
  std::size_t length = 0;
  while (length < line.size() &&
         (is_letter(line[length]) || is_digit(line[length]) || line[length] == '_')) {
    ++length;
  }
  const std::string_view word = line.substr(0, length);
  line.remove_prefix(length);
  return word;
}

bool is_number(std::string_view word) {
  return !word.empty() && word.find_first_not_of("0123456789") == std::string_view::npos;
}

bool same(std::string_view word, std::string_view upper_case) {
  if (word.size() != upper_case.size()) {
    return false;
  }
  for (std::size_t i = 0; i < word.size(); ++i) {
    if (upper(word[i]) != upper_case[i]) {
      return false;
    }
  }
  return true;
}

bool is_type(std::string_view word) {
  for (const std::string_view type : kSiemensTypes) {
    if (same(word, type)) {
      return true;
    }
  }
  return false;
}

}  // namespace

std::optional<ForeignLanguage> foreign_language_of(std::string_view line) {
  if (line.starts_with("%_N_")) {
    return ForeignLanguage{kSiemens, "%_N_"};
  }
  if (line.starts_with(";$PATH")) {
    return ForeignLanguage{kSiemens, ";$PATH"};
  }
  std::string_view first = next_word(line);
  if (is_number(first) ||
      (first.size() > 1 && upper(first[0]) == 'N' && is_number(first.substr(1)))) {
    first = next_word(line);
  }
  const std::string_view second = next_word(line);
  if (same(first, "BEGIN") && same(second, "PGM")) {
    return ForeignLanguage{kKlartext, "BEGIN PGM"};
  }
  if (same(first, "DEF") && is_type(second)) {
    return ForeignLanguage{kSiemens, "DEF with a type"};
  }
  return std::nullopt;
}

}  // namespace batten::gcode
