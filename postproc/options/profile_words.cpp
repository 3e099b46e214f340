#include "postproc/options/profile_words.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <iterator>
#include <sstream>

#include "gcode/reading/parser.h"
#include "gcode/state/modal_state.h"
#include "gcode/text/characters.h"

namespace batten::postproc {
namespace {

constexpr std::string_view kTolerance = "{tolerance}";

// Stands for the tolerance while a template is looked at.
constexpr std::string_view kSomeTolerance = "0.01";

// Digits of the tolerance: a ten-thousandth of the usual 0.01 mm.
constexpr int kToleranceDecimals = 6;

// A G word that sets how the control runs, and the letters that belong to it. In tenths.
struct SettingWord {
  int g_code = 0;
  std::string_view letters;
};
constexpr SettingWord kSettingWords[] = {
    {50, "P"},  {51, "QRXYZABC"}, {53, "P"},  {54, "Q"},          {80, "P"},
    {611, ""},  {640, "PQ"},      {1300, ""}, {1310, "FJEDILRK"}, {1870, "PE"},
    {6410, ""}, {6420, ""},       {6430, ""}, {6440, ""},         {6450, ""},
};

constexpr std::array<std::string_view, 10> kPlainNames = {
    "COMPON", "COMPCAD", "COMPCURV", "COMPSURF", "COMPOF",
    "SOFT",   "BRISK",   "FFWON",    "FFWOF",    "G642"};

constexpr std::string_view kCycle32 = "CYCL DEF 32.";

constexpr std::string_view kAllowed =
    "expected a comment of the target, a word that sets how this control smooths (G5.1 Q, G5 P, G8 "
    "P, G61.1, G64, G131, G187; Siemens: CYCLE832(..), COMPCAD ..; Klartext: CYCL DEF 32..; ISG: "
    "#HSC ..) or an M word from M100 on";

// A block of plain words: one setting word with its letters, or M words alone. M words below 100
// stop, turn spindles, change tools and coolant on every control; of those above, not the ones that
// are known to change where the tool is.
bool is_setting(std::span<const gcode::Word> words) {
  const SettingWord* setting = nullptr;
  for (const gcode::Word& word : words) {
    if (word.letter != 'G') continue;
    const auto found = std::ranges::find(kSettingWords, gcode::code_of(word), &SettingWord::g_code);
    if (setting != nullptr || found == std::end(kSettingWords)) return false;
    setting = &*found;
  }
  return std::ranges::all_of(words, [&](const gcode::Word& word) {
    const int code = gcode::code_of(word);
    if (word.letter == 'G') return true;
    if (word.letter == 'M') {
      return setting == nullptr && code >= 1000 && code != 1280 && code != 1290 && code != 1980;
    }
    const auto among = [&](std::string_view letters) {
      return letters.find(word.letter) != std::string_view::npos;
    };
    return setting != nullptr && among(setting->letters) && word.is_number &&
           (!among("XYZABC") || word.value == 0);
  });
}

bool only(std::string_view text, std::string_view more) {
  return std::ranges::all_of(text, [more](char c) {
    return gcode::is_letter(c) || gcode::is_digit(c) || more.find(c) != std::string_view::npos;
  });
}

// One word of a Siemens block.
bool is_siemens_word(std::string_view word) {
  if (std::ranges::find(kPlainNames, word) != kPlainNames.end()) return true;
  if (word.starts_with("CTOL=") || word.starts_with("OTOL=")) {
    return word.size() > 5 && word.find_first_not_of("0123456789.", 5) == std::string_view::npos;
  }
  constexpr std::string_view kCycle = "CYCLE832(";
  return word.starts_with(kCycle) && word.ends_with(')') &&
         only(word.substr(kCycle.size(), word.size() - kCycle.size() - 1), "_.,\"");
}

bool is_siemens(std::string_view line) {
  std::istringstream words{std::string(line)};
  return std::all_of(std::istream_iterator<std::string>(words), {}, is_siemens_word);
}

// A word that is none of plain words: of Klartext, of the ISG kernel or of Siemens controls. Those
// of another language than the target's would be an alarm there.
bool is_own_word(std::string_view line, const gcode::Control& target) {
  const gcode::Language language = target.language;
  if (line.starts_with(kCycle32)) {
    return language == gcode::Language::kKlartext && only(line, " .:-");
  }
  if (line.starts_with("#HSC")) {
    constexpr gcode::SourceMarks kHash = gcode::mark(gcode::SourceMark::kHashCommand);
    const bool reads_it = language == gcode::Language::kRs274 && (target.known_marks & kHash) != 0;
    const bool on = line.starts_with("#HSC ON") && only(line.substr(1), " .,=_[]-");
    return reads_it && (on || line == "#HSC OFF");
  }
  return language == gcode::Language::kSiemens && is_siemens(line);
}

std::vector<std::string> filled_in(std::vector<std::string> lines, std::string_view tolerance) {
  for (std::string& line : lines) {
    for (std::size_t at = line.find(kTolerance); at != std::string::npos;
         at = line.find(kTolerance, at + tolerance.size())) {
      line.replace(at, kTolerance.size(), tolerance);
    }
  }
  return lines;
}

bool any_acts(const std::vector<std::string>& lines) {
  return std::ranges::any_of(lines, [](const std::string& line) { return acts(line); });
}

void append_keys(const std::string& line, std::vector<SettingKey>& keys) {
  gcode::Diagnostics ignored;
  const gcode::Program program = gcode::parse(gcode::SourceText("profile", line), ignored);
  const gcode::Block& block = program.blocks.front();
  if (block.opacity == gcode::ParseStatus::kNone) {
    for (const gcode::Word& word : program.words_of(block)) {
      if (word.letter == 'G' || word.letter == 'M')
        keys.push_back({word.letter, gcode::code_of(word), {}});
    }
  } else if (line.starts_with(kCycle32)) {
    keys.push_back({0, 0, std::string(kCycle32)});
  } else if (line.starts_with("#HSC")) {
    keys.push_back({0, 0, "#HSC"});
  } else {
    // The names that words of another language begin with: CYCLE832, CTOL.
    std::istringstream words(line);
    for (std::string word; words >> word;) {
      keys.push_back({0, 0, word.substr(0, word.find_first_of("(="))});
    }
  }
}

}  // namespace

bool ProfileWords::empty() const {
  return header.empty() && footer.empty() && before_run.empty() && after_run.empty();
}

bool acts(std::string_view line) {
  return !line.starts_with(';') && !(line.starts_with('(') && line.find(')') == line.size() - 1);
}

std::string why_not_in_profile(const std::string& line, const gcode::Control& target) {
  const auto printable = [](char c) { return c >= ' ' && c <= '~'; };
  if (line.empty() || !std::ranges::all_of(line, printable)) {
    return "expected one line of printable ASCII characters";
  }
  if (line.front() == ' ' || line.back() == ' ') return "expected no blanks at its ends";
  const std::string filled = filled_in({line}, kSomeTolerance).front();
  if (filled.find_first_of("{}") != std::string::npos) {
    return "expected no {..} but {tolerance}";
  }
  if (line_length(target, filled) > target.max_line_length) {
    return fmt::format("expected at most {} characters", target.max_line_length);
  }
  if (!acts(filled)) {
    const std::size_t text = filled.find_first_not_of("(; ");
    const std::string inside =
        text == std::string::npos ? "" : filled.substr(text, filled.find(')', text) - text);
    const std::string said = comment_line(target, inside);
    if (!said.empty() && said.front() == filled.front()) return {};
    return "expected a comment that the target can say, such as " + comment_line(target, "text");
  }
  gcode::Diagnostics ignored;
  const gcode::Program program = gcode::parse(gcode::SourceText("profile", filled), ignored);
  const gcode::Block& block = program.blocks.front();
  const bool plain = block.opacity == gcode::ParseStatus::kNone && block.comment_count == 0 &&
                     block.word_count > 0 && !block.block_delete && !block.has_checksum;
  if (plain ? is_setting(program.words_of(block)) : is_own_word(filled, target)) return {};
  return std::string(kAllowed);
}

std::vector<SettingKey> setting_keys(const ProfileWords& words) {
  std::vector<SettingKey> keys;
  for (const auto* lines : {&words.header, &words.footer, &words.before_run, &words.after_run}) {
    for (const std::string& line : *lines) {
      if (acts(line)) append_keys(line, keys);
    }
  }
  return keys;
}

std::vector<std::string> problems_of(const ProfileWords& words) {
  std::vector<std::string> problems;
  const auto need = [&](std::string_view one, const std::vector<std::string>& lines,
                        std::string_view other, const std::vector<std::string>& partner) {
    if (any_acts(lines) && !any_acts(partner)) {
      problems.push_back(
          fmt::format("words.{}: acts on the control, expected words.{} to end it", one, other));
    }
  };
  need("before-run", words.before_run, "after-run", words.after_run);
  need("after-run", words.after_run, "before-run", words.before_run);
  if (!words.before_run.empty() && words.before_run == words.after_run) {
    problems.emplace_back("words.after-run: the same as words.before-run, expected its end");
  }
  return problems;
}

ProfileWords filled_in(const ProfileWords& words, double tolerance_mm, gcode::Units units,
                       const gcode::Control& target) {
  const gcode::Units known =
      units == gcode::Units::kInch ? gcode::Units::kInch : gcode::Units::kMillimetre;
  gcode::NumberFormat format = place_format(target, known);
  format.decimals = kToleranceDecimals;
  format.trailing_zeros = false;
  const std::string tolerance =
      gcode::to_text(tolerance_mm / gcode::millimetres_per(known), format);
  return {filled_in(words.header, tolerance), filled_in(words.footer, tolerance),
          filled_in(words.before_run, tolerance), filled_in(words.after_run, tolerance)};
}

}  // namespace batten::postproc
