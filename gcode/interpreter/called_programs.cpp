#include "gcode/interpreter/called_programs.h"

#include <fmt/format.h>

#include <span>

#include "gcode/interpreter/program_flow.h"
#include "gcode/klartext/flow.h"
#include "gcode/klartext/statement.h"
#include "gcode/siemens/flow.h"
#include "gcode/state/own_words.h"
#include "gcode/text/characters.h"

namespace batten::gcode {
namespace {

constexpr double kGreatestNumber = 9999;

bool is_words(const Block& block) {
  return block.opacity == ParseStatus::kNone || block.opacity == ParseStatus::kExpression;
}

// M98 P1234 L3, G65 P1234 A1.
std::optional<CalledProgram> numbered_program(std::span<const Word> all) {
  const BlockWords words(all);
  if (words.problem() != BlockWords::Problem::kNone || numbered_call(words).empty()) return {};
  const bool macro = !words.g_codes().empty();
  const bool alone = macro ? words.g_codes().size() == 1 && words.m_codes().empty()
                           : words.m_codes().size() == 1 && !words.has_any("ABCDEFHIJKQRSTUVWXYZO");
  const Word& number = *words.find('P');
  const Word* times = words.find('L');
  if (!alone || number.value > kGreatestNumber) return {};
  if (times != nullptr && !(times->is_number && times->value >= 1)) return {};
  return CalledProgram{fmt::format("P{:.0f}", number.value), times == nullptr};
}

// "O<PROBE>" of "O<PROBE> CALL".
std::string without_call(std::string name) {
  name.resize(name.size() - std::string_view(" CALL").size());
  return name;
}

// Siemens: how often stands behind the name.
std::optional<CalledProgram> siemens_program(std::string_view line) {
  std::string name = siemens_call(line);
  if (name.empty()) return {};
  const std::string bare = in_capitals(without_blanks(line.substr(0, line.find(';'))));
  const std::size_t times = bare.rfind('P');
  const bool repeats = times != std::string::npos && times + 1 < bare.size() &&
                       bare.find_first_not_of("0123456789", times + 1) == std::string::npos &&
                       times >= bare.find(name) + name.size();
  if (repeats && bare.find_first_not_of('0', times + 1) == std::string::npos) return {};
  return CalledProgram{std::move(name), !repeats};
}

std::string klartext_content(const Program& program, const Block& block) {
  return std::string(
      program.source.text(klartext_parts(program.source.text(), block.span).content));
}

// --- where it begins and ends -----------------------------------------------------------------

class SubprogramReader {
 public:
  SubprogramReader(std::string_view name, const Program& program, std::string& why)
      : name_(name), program_(program), why_(why) {}

  // False: `why` says what is not certain.
  bool read(Subprogram& sub) {
    why_.clear();
    switch (program_.language) {
      case Language::kKlartext:
        read_klartext(sub);
        break;
      case Language::kSiemens:
        read_siemens(sub);
        break;
      default:
        name_.starts_with('P') ? read_numbered(sub) : read_o_word(sub);
    }
    if (why_.empty() && sub.ends.empty()) why_ = "it does not say where it goes back";
    return why_.empty();
  }

 private:
  void refuse(std::string why) {
    if (why_.empty()) why_ = std::move(why);
  }

  [[nodiscard]] std::string capitals_of(const Block& block) const {
    return in_capitals(without_blanks(program_.source.text(block.span)));
  }

  // M words of a block that lists them. What is hidden in others is looked for in their text.
  void check_end_words(const Block& block, bool goes_back) {
    if (is_words(block)) {
      for (const Word& word : program_.words_of(block)) {
        if (word.letter != 'M') continue;
        const bool ends = word.value == 2 || word.value == 30;
        if (!word.is_number) refuse("an M word of it is computed");
        if (ends) refuse("it ends the whole program (M2 or M30)");
        if (word.value == 73) refuse("it takes back what it sets (M73)");
        if (word.value == 99 && !goes_back) {
          refuse("it goes back to a block that it names, or says more beside M99");
        }
      }
      return;
    }
    if (block.opacity == ParseStatus::kProgramMark || block.opacity == ParseStatus::kAssignment) {
      return;
    }
    const std::string text = capitals_of(block);
    for (const std::string_view end : {"M99", "M30", "M2", "M02", "M17", "M73"}) {
      if (text.find(end) != std::string::npos) {
        refuse(fmt::format("where it ends is not certain ({})", end));
      }
    }
  }

  [[nodiscard]] bool is_plain_return(const Block& block) const {
    if (block.opacity != ParseStatus::kNone) return false;
    bool returns = false;
    for (const Word& word : program_.words_of(block)) {
      const bool is_return = word.letter == 'M' && word.value == 99;
      returns |= is_return;
      if (!is_return && word.letter != 'N') return false;
    }
    return returns;
  }

  // O1234 .. M99
  void read_numbered(Subprogram& sub) {
    bool has_number = false;
    for (std::uint32_t i = 0; i < program_.blocks.size(); ++i) {
      const Block& block = program_.blocks[i];
      const bool number =
          (block.opacity == ParseStatus::kProgramMark || block.opacity == ParseStatus::kFlow) &&
          own_number(block).has_value();
      if (number) {
        if (has_number) refuse("it holds several programs");
        has_number = true;
        if (fmt::format("P{:.0f}", *own_number(block)) != name_) {
          refuse(fmt::format("it says that it is O{:.0f}", *own_number(block)));
        }
        continue;
      }
      const bool goes_back = is_plain_return(block);
      if (goes_back) sub.ends.push_back(i);
      check_end_words(block, goes_back);
    }
    // What a control does where it comes to the end of the file is its own.
    if (!sub.ends.empty() && program_.blocks[sub.ends.back()].block_delete) {
      refuse("its M99 may be skipped");
    }
  }

  [[nodiscard]] std::optional<double> own_number(const Block& block) const {
    for (const Word& word : program_.words_of(block)) {
      if (word.letter == 'O' && word.is_number) return word.value;
    }
    return std::nullopt;
  }

  // o<probe> sub .. o<probe> endsub
  void read_o_word(Subprogram& sub) {
    bool inside = false;
    for (std::uint32_t i = 0; i < program_.blocks.size(); ++i) {
      const Block& block = program_.blocks[i];
      const std::string text = block.opacity == ParseStatus::kFlow ? capitals_of(block) : "";
      const bool mine = text.starts_with(name_);
      const std::string_view keyword =
          mine ? std::string_view(text).substr(name_.size()) : std::string_view();
      if (keyword.starts_with("SUB")) {
        if (inside || sub.begin > 0) return refuse("it holds the subprogram twice");
        inside = true;
        sub.begin = i + 1;
        continue;
      }
      if (!inside) continue;
      if (keyword.starts_with("RETURN") || keyword.starts_with("ENDSUB")) sub.ends.push_back(i);
      if (keyword.starts_with("ENDSUB")) {
        inside = false;
        continue;
      }
      check_end_words(block, false);
    }
    if (sub.begin == 0) refuse(fmt::format("it does not hold {} sub", name_));
    if (inside) refuse("its sub has no endsub");
  }

  void read_siemens(Subprogram& sub) {
    for (std::uint32_t i = 0; i < program_.blocks.size(); ++i) {
      const Block& block = program_.blocks[i];
      std::string text = capitals_of(block);
      text.resize(std::min(text.find(';'), text.size()));
      if (text.starts_with("N")) text.erase(0, text.find_first_not_of("0123456789", 1));
      if (text.starts_with("PROC")) {
        if (sub.begin > 0 || !sub.ends.empty()) refuse("it holds several programs");
        if (text.find("SAVE") != std::string::npos) refuse("it takes back what it sets (SAVE)");
        sub.begin = i + 1;
        continue;
      }
      if (text == "M17" || text == "RET") {
        sub.ends.push_back(i);
        continue;
      }
      if (text.find("RET") != std::string::npos && text.find("RET(") != std::string::npos) {
        refuse("it goes back to a block that it names (RET)");
      }
      check_end_words(block, false);
    }
  }

  void read_klartext(Subprogram& sub) {
    for (std::uint32_t i = 0; i < program_.blocks.size(); ++i) {
      const Block& block = program_.blocks[i];
      const std::string content = klartext_content(program_, block);
      const KlartextKind kind = klartext_kind(content);
      if (kind == KlartextKind::kEnd) sub.ends.push_back(i);
      KlartextTokens tokens(content);
      for (std::string_view token = tokens.next(); !token.empty(); token = tokens.next()) {
        if (is_same_word(token, "M2") || is_same_word(token, "M02") || is_same_word(token, "M30")) {
          refuse("it ends the whole program (M2 or M30)");
        }
      }
    }
  }

  std::string name_;
  const Program& program_;
  std::string& why_;
};

}  // namespace

std::optional<CalledProgram> called_program(const Program& program, const Block& block) {
  const std::string_view text = program.source.text(block.span);
  switch (program.language) {
    case Language::kKlartext: {
      if (block.opacity != ParseStatus::kFlow) return {};
      const std::string content = klartext_content(program, block);
      if (klartext_kind(content) != KlartextKind::kCallProgram) return {};
      const std::string name = klartext_call(content);
      if (name.find_first_of("\\/:") != std::string::npos || name.empty()) return {};
      return CalledProgram{name.substr(std::string_view("CALL ").size())};
    }
    case Language::kSiemens:
      return block.opacity == ParseStatus::kForeign || block.opacity == ParseStatus::kNamedWords
                 ? siemens_program(text)
                 : std::nullopt;
    default:
      if (is_words(block)) return numbered_program(program.words_of(block));
      if (block.opacity != ParseStatus::kFlow) return {};
      std::string name = o_word_call(text);
      if (name.empty()) return {};
      return CalledProgram{without_call(std::move(name))};
  }
}

std::vector<std::string> programs_within(const Program& program) {
  std::vector<std::string> names;
  for (const Block& block : program.blocks) {
    const bool mark = block.opacity == ParseStatus::kProgramMark;
    if (program.language != Language::kRs274 || (!mark && block.opacity != ParseStatus::kFlow)) {
      continue;
    }
    for (const Word& word : program.words_of(block)) {
      if (word.letter == 'O' && word.is_number) names.push_back(fmt::format("P{:.0f}", word.value));
    }
    const std::string text = in_capitals(without_blanks(program.source.text(block.span)));
    const std::size_t end =
        text.starts_with("O<") ? text.find('>') + 1 : text.find_first_not_of("0123456789", 1);
    if (text.starts_with('O') && end != std::string::npos && text.substr(end).starts_with("SUB")) {
      names.push_back(text.substr(0, end));
    }
  }
  return names;
}

std::optional<Subprogram> as_subprogram(std::string_view name, Program program, std::string& why) {
  Subprogram sub{std::string(name), std::move(program), 0, {}};
  if (!SubprogramReader(name, sub.program, why).read(sub)) return std::nullopt;
  return sub;
}

}  // namespace batten::gcode
