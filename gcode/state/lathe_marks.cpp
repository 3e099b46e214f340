#include "gcode/state/lathe_marks.h"

#include <fmt/format.h>

#include <algorithm>
#include <span>

#include "gcode/state/code_table.h"
#include "gcode/text/characters.h"

namespace batten::gcode {
namespace {

using enum LatheMarkKind;

// Sets of letters, one bit each.
constexpr std::uint32_t bit(char letter) { return std::uint32_t{1} << (letter - 'A'); }
constexpr std::uint32_t bits(std::string_view letters) {
  std::uint32_t all = 0;
  for (const char letter : letters) all |= bit(letter);
  return all;
}

enum class Beside : std::uint8_t {
  kAnyCode,      // other G words may stand in the block
  kNoOtherCode,  // but G18, the plane of lathes
};

enum class Where : std::uint8_t {
  kPlain,  // plain words alone: Siemens has another use for them
  kSiemensToo,
};

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
  Beside beside = Beside::kAnyCode;
  Where where = Where::kPlain;
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
    {{kCertain, kLimit}, {500}, "S", "", "", "YPIJKM", Beside::kNoOtherCode},
    {{kSpindle, kLimit}, {500}, "S"},
    {{kSpindle, "G50 with X or Z, which sets coordinates (FANUC lathes)"}, {500}, "", "XZUW"},
    {{kSpindle, "G92 with S alone, a limit of the spindle"}, {920}, "S", "", "", "XYZUVWABC"},
    {.mark = {kSpindle, "constant surface speed, G96"},
     .codes = {960},
     .all = "S",
     .where = Where::kSiemensToo},

    // A mill's G70 to G72 are units, or holes in a pattern by I, J, L; its G73 drills to Z.
    {{kCertain, kRoughing}, {700, 710, 720}, "PQ", "", "", "XYZ"},
    {{kCertain, kRoughing}, {730}, "PQ", "UW", "", "XYZ"},
    {{kCertain, kRoughingDepth}, {710, 720, 730}, "R", "UW", "", "XYZPQ"},
    {{kCertain, kRoughingQ}, {700, 710, 711, 712, 720, 721, 722}, "Q", "D", "", "Y"},
    {{kCertain, "a thread, G32 with F (FANUC and controls like it)"}, {320}, "F", "XZUW", "", "Y"},
    // A mill's G76 bores with F, at X and Y.
    {{kCertain, "a threading cycle, G76 P Z I J K (LinuxCNC)"}, {760}, "PZIJK", "", "", "XYF"},

    {{kCycle, kOneCut}, {900, 940}, "F", "XU", "ZW", "YVABCIJKPQ", Beside::kNoOtherCode},
    {{kCycle, kOneCut}, {920, 770, 780, 790}, "F", "XU", "ZW", "YVABC", Beside::kNoOtherCode},
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
    {.mark = {kFeed, "feed per revolution, G95"}, .codes = {950}, .where = Where::kSiemensToo},

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

// Names in blocks that are not plain words; `call`: a ( follows, else = or [, or nothing.
enum class Behind : std::uint8_t { kCall, kValue, kAny };
struct TextRow {
  std::string_view name;  // without blanks
  Behind behind = Behind::kAny;
  std::string_view text;
};

constexpr std::string_view kSiemensCycle = "a turning cycle, CYCLE93 and its like (Siemens)";
constexpr std::string_view kTurning = "turning, FUNCTION MODE TURN and its like (Heidenhain)";

constexpr TextRow kTexts[] = {
    {"LIMS", Behind::kValue, "LIMS, a limit of the spindle (Siemens)"},
    {"CYCLE92", Behind::kCall, kSiemensCycle},
    {"CYCLE93", Behind::kCall, kSiemensCycle},
    {"CYCLE94", Behind::kCall, kSiemensCycle},
    {"CYCLE95", Behind::kCall, kSiemensCycle},
    {"CYCLE96", Behind::kCall, kSiemensCycle},
    {"CYCLE97", Behind::kCall, kSiemensCycle},
    {"CYCLE98", Behind::kCall, kSiemensCycle},
    {"CYCLE99", Behind::kCall, kSiemensCycle},
    {"CYCLE930", Behind::kCall, kSiemensCycle},
    {"CYCLE940", Behind::kCall, kSiemensCycle},
    {"CYCLE951", Behind::kCall, kSiemensCycle},
    {"CYCLE952", Behind::kCall, kSiemensCycle},
    {"FUNCTIONMODETURN", Behind::kAny, kTurning},
    {"FUNCTIONTURNDATA", Behind::kAny, kTurning},
    {"NLAP", Behind::kAny, "NLAP, a contour of a turning cycle (Okuma)"},
};

bool stands_alone(char before) { return !is_letter(before) && before != '_'; }

bool is_followed(std::string_view rest, Behind behind) {
  const char next = rest.empty() ? '\0' : rest.front();
  switch (behind) {
    case Behind::kCall:
      return next == '(';
    case Behind::kValue:
      return next == '=' || next == '[';
    case Behind::kAny:
      return true;
  }
  return false;
}

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

bool says(std::string_view bare, const TextRow& row) {
  const std::size_t at = bare.find(row.name);
  if (at == std::string_view::npos) return false;
  return (at == 0 || stands_alone(bare[at - 1])) &&
         is_followed(bare.substr(at + row.name.size()), row.behind);
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
         (row.beside == Beside::kAnyCode || codes == 1) &&
         (row.codes[0] == 0 || std::ranges::any_of(row.codes, [&](Code code) {
            return code != 0 && has_g(words, code);
          }));
}

// Nearly all blocks of a long program have no others.
constexpr std::uint32_t kPlainLetters = bits("NXYZGF");
constexpr int kLastPlainMotion = 30;  // G0 to G3
constexpr int kLathePlane = 180;      // G18

}  // namespace

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
  for (const TextRow& row : kTexts) {
    if (says(bare, row)) note({kCertain, row.text}, block.span, block.line);
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
    if (siemens && row.where == Where::kPlain) continue;
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
    for (const Found*& place : first) {
      if (next != nullptr && (place == nullptr || next->where.begin < place->where.begin)) {
        std::swap(place, next);
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
