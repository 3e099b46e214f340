#include "gcode/interpreter/plain_text.h"

#include <algorithm>
#include <string>
#include <vector>

#include "gcode/state/code_table.h"
#include "gcode/text/characters.h"
#include "gcode/text/number_format.h"

namespace batten::gcode {
namespace {

// Upper case, without comments and without blanks at the ends.
std::string said_in(std::string_view line) {
  std::string said;
  int depth = 0;
  for (const char c : line) {
    if (c == ';' && depth == 0) break;
    depth += c == '(' ? 1 : 0;
    if (depth == 0) said.push_back(is_blank(c) ? ' ' : upper(c));
    depth -= c == ')' && depth > 0 ? 1 : 0;
  }
  const std::size_t first = said.find_first_not_of(' ');
  if (first == std::string::npos) return {};
  return said.substr(first, said.find_last_not_of(' ') + 1 - first);
}

constexpr std::string_view kFileSuffixes[] = {"NC",  "NCC", "NCP", "NGC", "CNC",  "TAP",
                                              "TXT", "EIA", "MIN", "ARC", "PIM",  "ISO",
                                              "ANC", "FNC", "DNC", "PRG", "GCODE"};

bool is_file_name(std::string_view said) {
  const std::size_t point = said.rfind('.');
  if (point == std::string_view::npos || point < 2) return false;
  const std::string_view stem = said.substr(0, point);
  const bool plain = std::ranges::all_of(
      stem, [](char c) { return is_letter(c) || is_digit(c) || c == '-' || c == '_'; });
  // X1.NC is no number of X, but P100.NC might stand behind a word that is not known here.
  const bool named = is_letter(stem[0]) && is_letter(stem[1]);
  return plain && named &&
         std::ranges::find(kFileSuffixes, said.substr(point + 1)) !=
             std::ranges::end(kFileSuffixes);
}

std::vector<std::string_view> split(std::string_view said) {
  std::vector<std::string_view> parts;
  for (std::size_t at = 0; at < said.size();) {
    const std::size_t end = std::min(said.find(' ', at), said.size());
    if (end > at) parts.push_back(said.substr(at, end - at));
    at = end + 1;
  }
  return parts;
}

// What begins a statement on Klartext, Siemens, Fagor, NUM, Okuma, Mazak, Klipper and
// RepRapFirmware controls, or stands in one.
constexpr std::string_view kCommandWords[] = {
    "CALL", "CYCL",    "CYCLE",  "DEF",    "LBL",    "TOOL",   "PLANE",    "FUNCTION", "TRANS",
    "ROT",  "AROT",    "ATRANS", "SCALE",  "ASCALE", "MIRROR", "MODIN",    "MODOUT",   "SET",
    "VAR",  "IF",      "WHILE",  "GLOBAL", "ECHO",   "GOTO",   "WORK",     "EXTERN",   "PROC",
    "FOR",  "LOOP",    "REPEAT", "DATUM",  "SHIFT",  "RTCP",   "TCPM",     "BLK",      "FORM",
    "FN",   "BEGIN",   "END",    "STOP",   "START",  "RUN",    "PATHCTRL", "DRAW",     "COPY",
    "ACT",  "SELECT",  "SPEED",  "FEED",   "UNIT",   "UNITS",  "OFFSET",   "ORIGIN",   "REPOS",
    "SUPA", "TOFRAME", "ABORT",  "BREAK",  "ELIF",   "ELSE",   "EXIT",     "RETURN"};

bool is_title_word(std::string_view word) {
  const bool plain = std::ranges::all_of(
      word, [](char c) { return is_letter(c) || is_digit(c) || c == '.' || c == '-' || c == '/'; });
  const bool of_rs274 = word.size() > 1 && is_letter(word[0]) && !is_letter(word[1]);
  return plain && !of_rs274 &&
         std::ranges::find(kCommandWords, word) == std::ranges::end(kCommandWords);
}

bool is_bracketed(std::string_view said) {
  return said.starts_with('[') && said.find(']') == said.size() - 1;
}

// $110=500, $H and the like.
TextEffect effect_of_dollar_line(std::string_view said) {
  const std::string_view rest = said.substr(1);
  constexpr std::string_view kReports[] = {"X", "$", "#", "G", "I"};
  if (std::ranges::find(kReports, rest) != std::ranges::end(kReports)) return TextEffect::kNothing;
  constexpr std::string_view kHomings[] = {"H", "HX", "HY", "HZ"};
  if (std::ranges::find(kHomings, rest) != std::ranges::end(kHomings)) return TextEffect::kPlace;
  const std::size_t equals = rest.find('=');
  if (equals == 0 || equals == std::string_view::npos) return TextEffect::kAnything;
  const bool number = std::ranges::all_of(rest.substr(0, equals), is_digit);
  const bool value = read_number(rest.substr(equals + 1)).has_value();
  return number && value ? TextEffect::kNothing : TextEffect::kAnything;
}

// The letters and whole numbers of a line, without N; empty where it says anything else.
struct WholeWord {
  char letter = 0;
  int number = 0;
};

std::vector<WholeWord> whole_words(std::string_view said) {
  std::vector<WholeWord> words;
  constexpr std::size_t kMostDigits = 6;
  for (std::size_t at = 0; at < said.size();) {
    const char letter = said[at++];
    if (letter == ' ') continue;
    if (letter == '$' && char_at(said, at) == '-') ++at;  // $-1: all spindles
    const std::size_t end = std::min(said.find_first_not_of("0123456789", at), said.size());
    if (end == at || end - at > kMostDigits) return {};
    int number = 0;
    for (; at < end; ++at) number = number * 10 + (said[at] - '0');
    if (letter != 'N') words.push_back({letter, number});
  }
  return words;
}

// M3 $0 S1000, M5 $1
bool is_for_one_spindle(std::string_view said) {
  const std::vector<WholeWord> words = whole_words(said);
  return !words.empty() && std::ranges::all_of(words, [](const WholeWord& word) {
    const bool turns = word.letter == 'M' && word.number >= 3 && word.number <= 5;
    return turns || word.letter == 'S' || word.letter == '$';
  });
}

// M94/1/2, M26/Z: an M word that only switches something or asks for it.
bool is_m_word_for(std::string_view said) {
  const std::size_t slash = said.find('/');
  if (slash == std::string_view::npos) return false;
  const std::vector<WholeWord> words = whole_words(said.substr(0, slash));
  if (words.size() != 1 || words[0].letter != 'M') return false;
  const CodeAct act = row_of_m(words[0].number * 10).act;
  // Numbers, and letters of axes without one: behind a slash on other controls stand words.
  bool plain = true;
  for (std::size_t at = slash + 1; at < said.size(); ++at) {
    const bool is_new = said[at - 1] == '/';
    const bool is_of_number = is_digit(said[at]) && (is_new || is_digit(said[at - 1]));
    plain &= said[at] == '/' || is_of_number || (is_letter(said[at]) && is_new);
  }
  return plain && (act == CodeAct::kBuilders || act == CodeAct::kSwitches);
}

// M0 Change the tool: two letters next to each other are no words.
bool is_stop_with_text(std::string_view said) {
  for (const std::string_view stop : {"M0 ", "M00 ", "M1 ", "M01 "}) {
    const std::size_t text = stop.size();
    if (said.starts_with(stop) && is_letter(char_at(said, text)) &&
        is_letter(char_at(said, text + 1))) {
      return true;
    }
  }
  return false;
}

}  // namespace

TextEffect text_effect(std::string_view line) {
  const std::string said = said_in(line);
  if (is_bracketed(said) && said.find_first_of("#=") == std::string::npos) {
    return TextEffect::kNothing;
  }
  if (said.starts_with('$')) return effect_of_dollar_line(said);
  if (is_for_one_spindle(said)) return TextEffect::kSpindle;
  constexpr std::string_view kShown[] = {"M117 ", "M118 ", "M291 "};
  const bool is_shown =
      is_stop_with_text(said) || std::ranges::any_of(kShown, [&said](std::string_view begin) {
        return said.starts_with(begin);
      });
  return is_shown || is_m_word_for(said) ? TextEffect::kPlace : TextEffect::kAnything;
}

bool is_letter_name(std::string_view line, char first) {
  constexpr std::size_t kLongest = 5;
  const std::string said = said_in(line);
  return said.starts_with(first) && said.size() <= kLongest && is_letter(char_at(said, 1)) &&
         std::ranges::all_of(said, [](char c) { return is_letter(c) || is_digit(c); });
}

std::string leading_name(std::string_view line) {
  const std::string said = said_in(line);
  std::size_t end = said.starts_with('#') ? 1 : 0;
  while (is_letter(char_at(said, end)) || char_at(said, end) == '_' ||
         (end > 1 && is_digit(char_at(said, end)))) {
    ++end;
  }
  const std::size_t first = std::min(line.find_first_not_of(" \t"), line.size());
  const char next = char_at(line, first + end);  // MSG(5) is no comment behind MSG
  const bool ends = end == said.size() ? next != '(' : is_blank(next) || next == '[' || next == '"';
  return end > 1 && ends ? said.substr(0, end) : std::string();
}

bool is_plain_text(std::string_view line) {
  const std::string said = said_in(line);
  return is_bracketed(said) || is_file_name(said);
}

bool is_open_number(std::string_view line) {
  const std::string said = said_in(line);
  if (!said.starts_with('N') && !said.starts_with('O')) return false;
  const std::size_t open = std::min(said.find_first_not_of("0123456789", 1), said.size());
  const std::string_view places = std::string_view(said).substr(open);
  return places.size() > 1 && places.find_first_not_of('X') == std::string_view::npos;
}

bool is_title(std::string_view line) {
  if (is_open_number(line)) return true;
  const std::string said = said_in(line);
  if (said.size() > 2 && said.starts_with('<') && said.find('>') == said.size() - 1) return true;
  const std::vector<std::string_view> words = split(said);
  return words.size() > 1 && words[0].size() > 1 && is_letter(words[0][0]) &&
         std::ranges::all_of(words, is_title_word);
}

}  // namespace batten::gcode
