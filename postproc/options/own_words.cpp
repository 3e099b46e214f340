#include "postproc/options/own_words.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <optional>
#include <span>

#include "gcode/siemens/names.h"
#include "gcode/state/code_table.h"
#include "gcode/text/characters.h"
#include "gcode/text/number_format.h"
#include "postproc/text/words.h"

namespace batten::postproc {
namespace {

using gcode::OwnEffect;

constexpr std::string_view kNamesOfOwnWords =
    "M501, G100, M98 P9001, M198 P9001, G65 P9810, o<name> call, o100 call, L54, CALL PGM name, or "
    "the name of a Siemens program or cycle";

// Upper case, one blank between the parts.
std::string canonical(std::string_view text) {
  std::string name;
  for (const char c : text) {
    const bool blank = gcode::is_blank(c);
    if (!blank) name.push_back(gcode::upper(c));
    if (blank && !name.empty() && name.back() != ' ') name.push_back(' ');
  }
  if (name.ends_with(' ')) name.pop_back();
  return name;
}

bool all_digits(std::string_view text) {
  return !text.empty() && std::ranges::all_of(text, gcode::is_digit);
}

std::string without_zeros(std::string_view digits) {
  const std::size_t at = std::min(digits.find_first_not_of('0'), digits.size() - 1);
  return std::string(digits.substr(at));
}

struct Name {
  std::string text;  // as gcode::OwnWords has it
  bool is_call = false;
  bool chooses_zero = false;  // gcode::may_choose_zero
};

// M501, G05.9
std::optional<Name> code_name(std::string_view name, std::string& problem) {
  const auto number = gcode::read_number(name.substr(1));
  const bool plain = number && name.find_first_not_of("0123456789.", 1) == std::string_view::npos;
  gcode::Word word;
  word.letter = name[0];
  word.value = number ? number->value : 0;
  const gcode::Code code = plain ? gcode::code_of(word) : gcode::kNoCode;
  if (code == gcode::kNoCode) return std::nullopt;
  const gcode::CodeRow& row = name[0] == 'M' ? gcode::row_of_m(code) : gcode::row_of_g(code);
  const std::string text = code % 10 == 0 ? fmt::format("{}{}", name[0], code / 10)
                                          : fmt::format("{}{}.{}", name[0], code / 10, code % 10);
  const bool calls = row.act == gcode::CodeAct::kCalls;
  const bool chooses_zero = name[0] == 'G' && gcode::may_choose_zero(row);
  if (row.code != gcode::kNoCode && !chooses_zero) {
    problem = fmt::format("Batten knows what {} does{}", text,
                          calls ? "; name the program, such as G65 P9810 or M98 P9001" : "");
  }
  return Name{text, false, chooses_zero};
}

// M98 P9001, G65 P9810
std::optional<Name> numbered_call_name(std::string_view name) {
  for (const std::string_view call : {"M98", "M198", "G65"}) {
    if (!name.starts_with(call)) continue;
    std::string_view program = name.substr(call.size());
    if (program.starts_with(' ')) program.remove_prefix(1);
    if (!program.starts_with('P') || program.size() > 9 || !all_digits(program.substr(1))) continue;
    return Name{fmt::format("{} P{}", call, without_zeros(program.substr(1))), true};
  }
  return std::nullopt;
}

// O<PROBE> CALL, O100 CALL; LinuxCNC reads names without their blanks.
std::optional<Name> o_word_name(std::string_view name) {
  std::string bare(name);
  std::erase(bare, ' ');
  if (!bare.starts_with('O') || !bare.ends_with("CALL")) return std::nullopt;
  const std::string program = bare.substr(1, bare.size() - 5);
  const bool named =
      program.size() > 2 && program.front() == '<' && program.find('>') == program.size() - 1;
  if (!named && !all_digits(program)) return std::nullopt;
  return Name{fmt::format("O{} CALL", program), true};
}

std::optional<Name> program_name(std::string_view name, std::string& problem) {
  constexpr std::string_view kCall = "CALL PGM ";
  if (name.starts_with(kCall) && name.size() > kCall.size()) {
    std::string program(name);
    std::erase(program, '"');
    if (program.ends_with(".H")) program.resize(program.size() - 2);
    return Name{program, true};
  }
  if (name[0] == 'L' && all_digits(name.substr(1))) return Name{std::string(name), true};
  const auto of_name = [](char c) { return gcode::is_letter(c) || gcode::is_digit(c) || c == '_'; };
  const bool named = name.size() > 1 && std::ranges::all_of(name, of_name) &&
                     !gcode::is_digit(name[0]) && !gcode::is_digit(name[1]);
  if (!named) return std::nullopt;
  if (gcode::is_known_siemens_name(name)) {
    problem = fmt::format("Batten knows what {} does", name);
  }
  return Name{std::string(name), true};
}

std::optional<Name> word_name_in(std::string_view text, std::string& problem) {
  const std::string name = canonical(text);
  if (name.empty()) return std::nullopt;
  if (auto call = numbered_call_name(name)) return call;
  if (auto call = o_word_name(name)) return call;
  if (name.size() > 1 && (name[0] == 'M' || name[0] == 'G') && gcode::is_digit(name[1])) {
    return code_name(name, problem);
  }
  return program_name(name, problem);
}

std::vector<std::string_view> effect_names() {
  std::vector<std::string_view> names;
  for (const auto& row : gcode::own_effects()) names.push_back(row.name);
  return names;
}

// The phrases of `text`, in small letters.
std::vector<std::string> phrases_in(std::string_view text) {
  std::vector<std::string> phrases(1);
  for (const char c : text) {
    if (c == ',' || c == ';') {
      phrases.emplace_back();
    } else if (!gcode::is_blank(c)) {
      phrases.back().push_back(static_cast<char>(gcode::is_letter(c) ? c | 0x20 : c));
    } else if (!phrases.back().empty() && phrases.back().back() != ' ') {
      phrases.back().push_back(' ');
    }
  }
  for (std::string& phrase : phrases) {
    if (phrase.ends_with(' ')) phrase.pop_back();
  }
  return phrases;
}

}  // namespace

void OwnWordList::add(std::string_view name, std::string_view effects,
                      std::vector<std::string>& problems) {
  const std::size_t problems_before = problems.size();
  std::string known;
  const auto word = word_name_in(name, known);
  if (!word) {
    problems.push_back(
        fmt::format("'{}' is no word; expected one like {}", name, kNamesOfOwnWords));
  }
  if (!known.empty()) {
    problems.push_back(known + "; only words that it does not know can be named");
  }
  OwnEffect effect;
  std::vector<std::string> said;
  bool keeps_all = false;
  bool loses_some = false;
  for (const std::string& phrase : phrases_in(effects)) {
    const auto rows = gcode::own_effects();
    const auto row = std::ranges::find(rows, phrase, &gcode::OwnEffectRow::name);
    if (row == rows.end()) {
      const auto names = effect_names();
      problems.push_back(fmt::format("{}: there is no effect '{}'{}; possible: {}", name, phrase,
                                     suggestion(phrase, names), fmt::join(names, ", ")));
      continue;
    }
    said.push_back(phrase);
    if (row->of_calls) {
      effect.returns = true;
      if (word && !word->is_call) {
        problems.push_back(fmt::format("{}: '{}' is said of calls only", name, phrase));
      }
      continue;
    }
    // What several phrases keep is what each of them keeps.
    const bool first = !effect.keeps_modes;
    keeps_all |= phrase == "keeps state";
    loses_some |= !row->effect.keeps_place;
    effect.keeps_modes = true;
    effect.keeps_motion = row->effect.keeps_motion && (first || effect.keeps_motion);
    effect.keeps_place = row->effect.keeps_place && (first || effect.keeps_place);
  }
  if (keeps_all && loses_some) {
    problems.push_back(fmt::format(
        "{}: '{}' contradicts itself: what keeps the state keeps the position", name, effects));
  }
  if (word && word->chooses_zero && (!effect.keeps_motion || effect.keeps_place)) {
    problems.push_back(fmt::format(
        "{} moves the coordinates: all that can be said of it is 'position unknown', where it "
        "chooses a zero point and neither scales nor turns",
        name));
  }
  if (problems.size() != problems_before) return;
  const auto before = std::ranges::find(words_, word->text, &gcode::OwnWord::name);
  if (before == words_.end()) {
    words_.push_back({word->text, fmt::format("{}", fmt::join(said, ", ")), effect});
  } else if (before->effect != effect) {
    problems.push_back(fmt::format("{}: '{}' here, and '{}' where it was named before", name,
                                   fmt::join(said, ", "), before->effects));
  }
}

void OwnWordList::add(std::string_view text, std::vector<std::string>& problems) {
  const std::size_t equals = text.find('=');
  if (equals == std::string_view::npos) {
    problems.push_back(
        fmt::format("'{}', expected a word and what it does, such as \"M501 = keeps "
                    "state\"; possible: {}",
                    text, fmt::join(effect_names(), ", ")));
    return;
  }
  add(trimmed(text.substr(0, equals), " \"'"), trimmed(text.substr(equals + 1), " \"'"), problems);
}

std::shared_ptr<const gcode::OwnWords> OwnWordList::words() const {
  return words_.empty() ? nullptr : std::make_shared<const gcode::OwnWords>(words_);
}

std::string text_of(const gcode::OwnWord& word) {
  return fmt::format("{}: {}", word.name, word.effects);
}

}  // namespace batten::postproc
