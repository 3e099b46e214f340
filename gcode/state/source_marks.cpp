#include "gcode/state/source_marks.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <optional>
#include <span>
#include <string>

#include "gcode/state/code_table.h"
#include "gcode/text/characters.h"

namespace batten::gcode {
namespace {

bool has(std::span<const Word> words, std::string_view letters) {
  return std::ranges::any_of(words, [letters](const Word& word) {
    return letters.find(word.letter) != std::string_view::npos;
  });
}

// A code (in tenths) beside one of these letters, where some are said, and none of those.
// NOLINTNEXTLINE(clang-analyzer-optin.performance.Padding): rows of a table
struct CodeMark {
  char letter;
  Code code;
  std::string_view with;
  std::string_view without;
  SourceMark mark;
};
constexpr CodeMark kCodeMarks[] = {
    {'G', 640, "PQ", "", SourceMark::kBlendTolerance},
    {'G', 52, "", "", SourceMark::kUniformNurbs},
    // G5.3 P is the smoothing of another control, G5.3 alone ends a spline.
    {'G', 53, "", "P", SourceMark::kUniformNurbs},
    {'G', 51, "Q", "", SourceMark::kHighSpeedMode},
    {'G', 50, "P", "XYZIJ", SourceMark::kHighSpeedMode},
    {'G', 1870, "", "", SourceMark::kHaasSmoothness},
    {'G', 1300, "", "", SourceMark::kSuperNurbs},
    {'G', 1310, "", "", SourceMark::kSuperNurbs},
    // Mills have other uses for these, but without a temperature.
    {'M', 1040, "S", "", SourceMark::kHeaterWords},
    {'M', 1090, "S", "", SourceMark::kHeaterWords},
    {'M', 1400, "S", "", SourceMark::kHeaterWords},
    {'M', 1900, "S", "", SourceMark::kHeaterWords},
};

std::optional<SourceMark> mark_of_word(const Word& word, std::span<const Word> words) {
  if (word.letter != 'G' && word.letter != 'M') return std::nullopt;
  const Code code = code_of(word);
  for (const CodeMark& each : kCodeMarks) {
    if (each.letter == word.letter && each.code == code &&
        (each.with.empty() || has(words, each.with)) && !has(words, each.without)) {
      return each.mark;
    }
  }
  return std::nullopt;
}

bool contains_one_of(std::string_view text, std::span<const std::string_view> parts) {
  return std::ranges::any_of(
      parts, [&](std::string_view part) { return text.find(part) != std::string_view::npos; });
}

std::optional<SourceMark> mark_of_text(ParseStatus opacity, std::string_view line) {
  const std::string text = in_capitals(without_blanks(line));
  constexpr std::array<std::string_view, 9> kSubWords = {
      "SUB", "CALL", "ENDSUB", "RETURN", "ENDIF", "ENDWHILE", "REPEAT", "BREAK", "DO"};
  constexpr std::array<std::string_view, 3> kMacroWords = {"GOTO", "WHILE[", "END"};
  if (text.starts_with('$')) return SourceMark::kDollarLine;
  if (text.starts_with('#') && text.size() > 1 && is_letter(text[1])) {
    return SourceMark::kHashCommand;
  }
  if (text.find("#<") != std::string::npos) return SourceMark::kNamedParameters;
  if (opacity != ParseStatus::kFlow) return std::nullopt;
  const std::size_t word = text.starts_with('N') ? text.find_first_not_of("0123456789", 1) : 0;
  const std::string_view rest =
      word == std::string::npos ? std::string_view() : std::string_view(text).substr(word);
  if (rest.starts_with('O')) {
    return contains_one_of(rest, kSubWords) ? std::optional(SourceMark::kSubWords) : std::nullopt;
  }
  return contains_one_of(rest, kMacroWords) ? std::optional(SourceMark::kMacroFlow) : std::nullopt;
}

using enum LatheMarkKind;

// Sets of letters, one bit each.
constexpr std::uint32_t bit(char letter) { return std::uint32_t{1} << (letter - 'A'); }
constexpr std::uint32_t bits(std::string_view letters) {
  std::uint32_t all = 0;
  for (const char letter : letters) all |= bit(letter);
  return all;
}

// A block with one of these G words (in tenths), all letters of `all`, one of `any` and of `or_any`
// where there are such, and none of `none`.
// NOLINTNEXTLINE(clang-analyzer-optin.performance.Padding): in the order in which rows are read
struct WordRow {
  LatheMark mark;
  std::array<Code, 7> codes = {};  // up to the first 0; none: any block
  std::string_view all = {};
  std::string_view any = {};
  std::string_view or_any = {};
  std::string_view none = {};
  bool no_other_code = false;  // in the block, but G18, the plane of lathes
  bool siemens_too = false;    // false: Siemens has another use for these words
};

constexpr std::string_view kLimit = "G50 S, a limit of the spindle (FANUC and controls like it)";
constexpr std::string_view kRoughing =
    "a turning cycle over a contour, G70 to G73 P Q (FANUC and controls like it)";
constexpr std::string_view kRoughingDepth =
    "a turning cycle's depth of cut, G71 to G73 U R (FANUC and controls like it)";
constexpr std::string_view kRoughingQ = "a turning cycle over a contour, G70 to G72 Q (LinuxCNC)";
constexpr std::string_view kOneCut =
    "G90, G92, G94 or G77 to G79 with X, Z and F, as a turning cycle has them (FANUC)";
constexpr std::string_view kGrooving =
    "G74 to G76 with P, Q or R, as a turning cycle has them (FANUC)";
constexpr std::string_view kIncrements = "increments by U and W (FANUC and controls like it)";

constexpr WordRow kRows[] = {
    // On a mill G50 ends scaling, and stands in a line of such words; S stands with M3.
    {{kCertain, kLimit}, {500}, "S", "", "", "YPIJKM", true},
    {{kSpindle, kLimit}, {500}, "S"},
    {{kSpindle, "G50 with X or Z, which sets coordinates (FANUC lathes)"}, {500}, "", "XZUW"},
    {{kSpindle, "G92 with S alone, a limit of the spindle"}, {920}, "S", "", "", "XYZUVWABC"},
    {.mark = {kSpindle, "constant surface speed, G96"},
     .codes = {960},
     .all = "S",
     .siemens_too = true},

    // A mill's G70 to G72 are units, or holes in a pattern by I, J, L; its G73 drills to Z.
    {{kCertain, kRoughing}, {700, 710, 720}, "PQ", "", "", "XYZ"},
    {{kCertain, kRoughing}, {730}, "PQ", "UW", "", "XYZ"},
    {{kCertain, kRoughingDepth}, {710, 720, 730}, "R", "UW", "", "XYZPQ"},
    {{kCertain, kRoughingQ}, {700, 710, 711, 712, 720, 721, 722}, "Q", "D", "", "Y"},
    {{kCertain, "a thread, G32 with F (FANUC and controls like it)"}, {320}, "F", "XZUW", "", "Y"},
    // A mill's G76 bores with F, at X and Y.
    {{kCertain, "a threading cycle, G76 P Z I J K (LinuxCNC)"}, {760}, "PZIJK", "", "", "XYF"},

    {{kCycle, kOneCut}, {900, 940}, "F", "XU", "ZW", "YVABCIJKPQ", true},
    {{kCycle, kOneCut}, {920, 770, 780, 790}, "F", "XU", "ZW", "YVABC", true},
    {{kCycle, kGrooving}, {740}, "PQF", "XZUW", "", "YR"},
    {{kCycle, kGrooving}, {740}, "R", "", "", "XYZPQFK"},
    {{kCycle, kGrooving}, {750}, "PQF", "XZUW", "", "Y"},
    {{kCycle, kGrooving}, {750}, "R", "", "", "XYZPQF"},
    {{kCycle, kGrooving}, {760}, "PQ", "", "", "XYZUW"},
    {{kCycle, kGrooving}, {760}, "PQF", "XU", "ZW", "Y"},

    // Beside a cycle G99 says where it ends.
    {.mark = {kFeed, "G99 beside no cycle: feed per revolution (FANUC lathes)"},
     .codes = {990},
     .none = "XYZRPQKL"},
    {.mark = {kFeed, "feed per revolution, G95"}, .codes = {950}, .siemens_too = true},

    {{kIncrement, kIncrements}, {}, "XW", "", "", "YV"},
    {{kIncrement, kIncrements}, {}, "ZU", "", "", "YV"},
    {{kIncrement, kIncrements}, {}, "UW", "", "", "YV"},
    {{kIncrement, "home by U or W (FANUC and controls like it)"}, {280}, "", "UW", "", "XYZV"},
};

constexpr LatheMark kToolAndOffset = {kTool, "T with the number of an offset, as in T0101"};
constexpr LatheMark kSmallFeed = {kFeed, "a feed that only one per revolution can be"};

// mm/min and in/min: no mill cuts so slowly, and no lathe takes so much in a revolution.
constexpr double kLeastFeed = 1.0;
constexpr double kLeastFeedInches = 0.1;

// Names (without blanks) in blocks that are not plain words, and what follows them: one of these
// characters; empty: anything.
struct TextRow {
  std::array<std::string_view, 12> names;  // up to the first empty one
  std::string_view next;
  std::string_view text;
};

constexpr TextRow kTexts[] = {
    {{"LIMS"}, "=[", "LIMS, a limit of the spindle (Siemens)"},
    {{"CYCLE92", "CYCLE93", "CYCLE94", "CYCLE95", "CYCLE96", "CYCLE97", "CYCLE98", "CYCLE99",
      "CYCLE930", "CYCLE940", "CYCLE951", "CYCLE952"},
     "(",
     "a turning cycle, CYCLE93 and its like (Siemens)"},
    {{"FUNCTIONMODETURN", "FUNCTIONTURNDATA"},
     "",
     "turning, FUNCTION MODE TURN and its like (Heidenhain)"},
    {{"NLAP"}, "", "NLAP, a contour of a turning cycle (Okuma)"},
};

// Upper case, without blanks, up to a comment or a text.
std::string bare_text(std::string_view line) {
  std::string bare;
  for (const char c : line) {
    const bool call = !bare.empty() && (is_letter(bare.back()) || is_digit(bare.back()));
    if (c == ';' || c == '"' || (c == '(' && !call)) break;
    if (!is_blank(c)) bare.push_back(upper(c));
  }
  return bare;
}

bool says(std::string_view bare, std::string_view name, std::string_view next) {
  const std::size_t at = bare.find(name);
  if (at == std::string_view::npos) return false;
  const bool alone = at == 0 || (!is_letter(bare[at - 1]) && bare[at - 1] != '_');
  const char follows = char_at(bare, at + name.size());
  return alone &&
         (next.empty() || (follows != '\0' && next.find(follows) != std::string_view::npos));
}

bool may_hold_names(ParseStatus opacity) {
  return opacity == ParseStatus::kForeign || opacity == ParseStatus::kUnreadable ||
         opacity == ParseStatus::kNamedWords || opacity == ParseStatus::kFlow;
}

// T0101, T010101 and T0100, but not T0012.
bool names_offset(std::string_view word) {
  std::string digits;
  for (const char c : word.substr(1)) {
    if (!is_blank(c)) digits.push_back(c);
  }
  return (digits.size() == 4 || digits.size() == 6) && digits[0] == '0' && digits[1] != '0' &&
         std::ranges::all_of(digits, is_digit);
}

bool has(std::span<const Word> words, char letter, Code code) {
  return std::ranges::any_of(words, [letter, code](const Word& word) {
    return word.letter == letter && code_of(word) == code;
  });
}

bool has_g(std::span<const Word> words, Code code) { return has(words, 'G', code); }

bool fits(const WordRow& row, std::uint32_t letters, std::span<const Word> words, int codes) {
  const std::uint32_t all = bits(row.all);
  return (letters & all) == all && (letters & bits(row.none)) == 0 &&
         (row.any.empty() || (letters & bits(row.any)) != 0) &&
         (row.or_any.empty() || (letters & bits(row.or_any)) != 0) &&
         (!row.no_other_code || codes == 1) &&
         (row.codes[0] == 0 || std::ranges::any_of(row.codes, [&](Code code) {
            return code != 0 && has_g(words, code);
          }));
}

// Nearly all blocks of a long program have no others.
constexpr std::uint32_t kPlainLetters = bits("NXYZGF");
constexpr int kLastPlainMotion = 30;  // G0 to G3
constexpr int kLathePlane = 180;      // G18

}  // namespace

std::string_view describe(SourceMark mark) {
  // In the order of the marks.
  constexpr std::array<std::string_view, 11> kTexts = {
      "O words with sub, call, if, while (LinuxCNC)",
      "a named parameter (LinuxCNC)",
      "G64 with a tolerance (LinuxCNC)",
      "G5.2 or G5.3 (LinuxCNC)",
      "IF, GOTO, WHILE of macro B (FANUC and controls like it)",
      "G5.1 Q or G5 P (FANUC and controls like it)",
      "G187 (Haas)",
      "G130 or G131 (Okuma)",
      "the temperature of a heater (3D printers)",
      "a line that starts with $ (grbl)",
      "a command such as #HSC (Beckhoff, ISG, Fagor)"};
  return kTexts.at(static_cast<std::size_t>(mark));
}

std::vector<FoundMark> source_marks(const Program& program) {
  std::vector<FoundMark> all;
  // IF and GOTOF are words of Siemens programs too.
  if (program.language != Language::kRs274) return all;
  const auto note = [&all](std::optional<SourceMark> found, SourceSpan where) {
    if (found && std::ranges::find(all, *found, &FoundMark::mark) == all.end()) {
      all.push_back({*found, where});
    }
  };
  for (const Block& block : program.blocks) {
    const std::span<const Word> words = program.words_of(block);
    for (const Word& word : words) note(mark_of_word(word, words), word.span);
    if (block.opacity != ParseStatus::kNone && block.opacity != ParseStatus::kProgramMark) {
      note(mark_of_text(block.opacity, program.source.text(block.span)), block.span);
    }
  }
  return all;
}

void LatheWatch::note(const LatheMark& mark, SourceSpan where, std::uint32_t line) {
  auto& first = found_[static_cast<std::size_t>(mark.kind)];
  if (!first) first = Found{mark, where, line};
}

void LatheWatch::see(const Program& part) {
  if (settled_) return;
  for (const Block& block : part.blocks) {
    if (may_hold_names(block.opacity)) look_at_text(part, block);
    if (block.opacity != ParseStatus::kUnreadable && block.opacity != ParseStatus::kProgramMark &&
        block.word_count > 0 && part.language != Language::kKlartext) {
      look_at_words(part, block);
    }
  }
}

void LatheWatch::look_at_text(const Program& part, const Block& block) {
  const std::string bare = bare_text(part.source.text(block.span));
  for (const auto& [names, next, text] : kTexts) {
    for (const std::string_view name : names) {
      if (!name.empty() && says(bare, name, next)) {
        note({kCertain, text}, block.span, block.line);
      }
    }
  }
}

void LatheWatch::look_at_words(const Program& part, const Block& block) {
  const std::span<const Word> words = part.words_of(block);
  std::uint32_t letters = 0;
  int codes = 0;
  bool plain = true;
  const Word* feed = nullptr;
  const Word* tool = nullptr;
  for (const Word& word : words) {
    if (!is_letter(word.letter)) continue;
    letters |= bit(word.letter);
    if (word.letter == 'G') {
      codes += code_of(word) == kLathePlane ? 0 : 1;
      plain = plain && code_of(word) <= kLastPlainMotion;
    } else if (word.letter == 'F') {
      feed = &word;
    } else if (word.letter == 'T') {
      tool = &word;
    }
  }
  names_y_ = names_y_ || (letters & bit('Y')) != 0;
  if (!plain) {
    in_inches_ = in_inches_ || has_g(words, 200) || has_g(words, 700);
    if (has_g(words, 930)) feed_is_a_speed_ = false;
    if (has_g(words, 940) || has_g(words, 950)) feed_is_a_speed_ = true;
  }
  const double least = in_inches_ ? kLeastFeedInches : kLeastFeed;
  if (feed != nullptr && feed->is_number && feed->value > 0 && feed->value < least &&
      feed_is_a_speed_ && !has_g(words, 40)) {
    note(kSmallFeed, feed->span, block.line);
  }
  if (plain && (letters & ~kPlainLetters) == 0) return;
  const bool siemens = part.language == Language::kSiemens;
  for (const WordRow& row : kRows) {
    if (siemens && !row.siemens_too) continue;
    if (fits(row, letters, words, codes)) note(row.mark, block.span, block.line);
  }
  if (!siemens && tool != nullptr && names_offset(part.source.text(tool->span)) &&
      !has(words, 'M', 60)) {
    note(kToolAndOffset, tool->span, block.line);
  }
}

std::array<const LatheWatch::Found*, 2> LatheWatch::first_two() const {
  std::array<const Found*, 2> first{};
  for (const auto& each : found_) {
    const Found* next = each ? &*each : nullptr;
    for (const Found*& known : first) {
      if (next != nullptr && (known == nullptr || next->where.begin < known->where.begin)) {
        std::swap(known, next);
      }
    }
  }
  return first;
}

bool LatheWatch::is_lathe() const {
  return found_[static_cast<std::size_t>(kCertain)] || (!names_y_ && first_two()[1] != nullptr);
}

SourceSpan LatheWatch::where() const {
  const auto& certain = found_[static_cast<std::size_t>(kCertain)];
  return certain ? certain->where : first_two()[0]->where;
}

std::string LatheWatch::evidence() const {
  if (const auto& certain = found_[static_cast<std::size_t>(kCertain)]) {
    return std::string(certain->mark.text);
  }
  const auto [first, second] = first_two();
  return fmt::format("{}, and on line {} {}, and Y nowhere", first->mark.text, second->line,
                     second->mark.text);
}

}  // namespace batten::gcode
