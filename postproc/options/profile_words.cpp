#include "postproc/options/profile_words.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <span>

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
constexpr std::array kSettingWords = {
    SettingWord{50, "P"},    SettingWord{51, "QRXYZABC"}, SettingWord{53, "P"},
    SettingWord{54, "Q"},    SettingWord{80, "P"},        SettingWord{611, ""},
    SettingWord{640, "PQ"},  SettingWord{1300, ""},       SettingWord{1310, "FJEDILRK"},
    SettingWord{1870, "PE"}, SettingWord{6410, ""},       SettingWord{6420, ""},
    SettingWord{6430, ""},   SettingWord{6440, ""},       SettingWord{6450, ""},
};

constexpr std::array<std::string_view, 10> kPlainNames = {
    "COMPON", "COMPCAD", "COMPCURV", "COMPSURF", "COMPOF",
    "SOFT",   "BRISK",   "FFWON",    "FFWOF",    "G642"};

constexpr std::string_view kCycle32 = "CYCL DEF 32.";

constexpr std::string_view kAllowed =
    "expected a comment of the target, a word that sets how this control smooths (G5.1 Q, G5 P, G8 "
    "P, G61.1, G64, G131, G187; Siemens: CYCLE832(..), COMPCAD ..; Klartext: CYCL DEF 32..; ISG: "
    "#HSC ..) or an M word from M100 on";

const SettingWord* setting_word(const gcode::Word& word) {
  const auto found = std::ranges::find(kSettingWords, gcode::code_of(word), &SettingWord::g_code);
  return found == kSettingWords.end() ? nullptr : &*found;
}

// M words below 100 stop, turn spindles, change tools and coolant on every control; of those above,
// the ones that are known to change where the tool is.
bool is_free_m(const gcode::Word& word) {
  const int code = gcode::code_of(word);
  return code >= 1000 && code != 1280 && code != 1290 && code != 1980;
}

bool stands_for_an_axis(const gcode::Word& word) {
  return word.letter >= 'A' && word.letter <= 'Z' &&
         std::string_view("XYZABC").find(word.letter) != std::string_view::npos;
}

// A block of plain words: one setting word with its letters, or M words alone.
bool is_setting(std::span<const gcode::Word> words) {
  const SettingWord* setting = nullptr;
  for (const gcode::Word& word : words) {
    if (word.letter != 'G') continue;
    if (setting != nullptr) return false;
    setting = setting_word(word);
    if (setting == nullptr) return false;
  }
  return std::ranges::all_of(words, [&](const gcode::Word& word) {
    if (word.letter == 'G') return true;
    if (word.letter == 'M') return setting == nullptr && is_free_m(word);
    const bool belongs =
        setting != nullptr && setting->letters.find(word.letter) != std::string_view::npos;
    return belongs && word.is_number && (!stands_for_an_axis(word) || word.value == 0);
  });
}

bool only(std::string_view text, std::string_view more) {
  return std::ranges::all_of(text, [more](char c) {
    return gcode::is_letter(c) || gcode::is_digit(c) || more.find(c) != std::string_view::npos;
  });
}

bool is_number_text(std::string_view text) {
  return !text.empty() && text.find_first_not_of("0123456789.") == std::string_view::npos;
}

// One word of a Siemens block.
bool is_siemens_word(std::string_view word) {
  if (std::ranges::find(kPlainNames, word) != kPlainNames.end()) return true;
  for (const std::string_view name : {"CTOL=", "OTOL="}) {
    if (word.starts_with(name)) return is_number_text(word.substr(name.size()));
  }
  constexpr std::string_view kCycle = "CYCLE832(";
  return word.starts_with(kCycle) && word.ends_with(')') &&
         only(word.substr(kCycle.size(), word.size() - kCycle.size() - 1), "_.,\"");
}

bool is_siemens(std::string_view line) {
  while (!line.empty()) {
    const std::size_t end = std::min(line.find(' '), line.size());
    if (end > 0 && !is_siemens_word(line.substr(0, end))) return false;
    line.remove_prefix(std::min(end + 1, line.size()));
  }
  return true;
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

std::string with_tolerance(std::string line, std::string_view tolerance) {
  for (std::size_t at = line.find(kTolerance); at != std::string::npos;
       at = line.find(kTolerance, at + tolerance.size())) {
    line.replace(at, kTolerance.size(), tolerance);
  }
  return line;
}

std::vector<std::string> filled_in(const std::vector<std::string>& lines,
                                   std::string_view tolerance) {
  std::vector<std::string> filled;
  filled.reserve(lines.size());
  for (const std::string& line : lines) filled.push_back(with_tolerance(line, tolerance));
  return filled;
}

bool any_acts(const std::vector<std::string>& lines) {
  return std::ranges::any_of(lines, [](const std::string& line) { return acts(line); });
}

// The name that a word of another language begins with: CYCLE832, CTOL, #HSC.
std::string name_of_word(std::string_view word) {
  return std::string(word.substr(0, word.find_first_of("(=")));
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
    for (std::size_t at = 0; at < line.size();) {
      const std::size_t end = std::min(line.find(' ', at), line.size());
      if (end > at)
        keys.push_back({0, 0, name_of_word(std::string_view(line).substr(at, end - at))});
      at = end + 1;
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
  const std::string filled = with_tolerance(line, kSomeTolerance);
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
