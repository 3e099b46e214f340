#include "gcode/siemens/flow.h"

#include <algorithm>
#include <optional>
#include <string>
#include <unordered_set>

#include "gcode/siemens/lexer.h"
#include "gcode/siemens/names.h"
#include "gcode/text/characters.h"

namespace batten::gcode {
namespace {

// "LABEL" for LABEL:, ":10", "N10" whatever zeros stand in front of the digits.
using LabelName = std::string;

// Upper case, strings and comments blanked.
std::string plain_text(std::string_view text) {
  std::string plain;
  bool in_string = false;
  for (const char c : text) {
    if (c == ';' && !in_string) break;
    in_string ^= c == '"';
    plain.push_back(in_string ? ' ' : upper(c));
  }
  return plain;
}

bool is_name_start(char c) { return is_letter(c) || c == '_' || c == '$'; }

LabelName without_zeros(LabelName name) {
  const bool numbered = is_numbered(name) && (name[0] == 'N' || name[0] == ':');
  while (numbered && name.size() > 2 && name[1] == '0') name.erase(1, 1);
  return name;
}

// The label that is named at this place; nothing where a value is computed.
std::optional<LabelName> label_at(std::string_view text, std::size_t at) {
  std::size_t end = at + (char_at(text, at) == ':' ? 1 : 0);
  end = after_siemens_name(text, end);
  if (end <= at || text[at] == '$') return std::nullopt;
  return without_zeros(LabelName(text.substr(at, end - at)));
}

// The names of a line, one after the other, with the place behind each.
struct Name {
  std::string_view text;
  std::size_t end = 0;
};

std::vector<Name> names_in(std::string_view text) {
  std::vector<Name> names;
  for (std::size_t at = 0; at < text.size();) {
    if (!is_name_start(text[at])) {
      ++at;
      continue;
    }
    const std::size_t end = after_siemens_name(text, at);
    names.push_back({text.substr(at, end - at), end});
    at = end;
  }
  return names;
}

bool is_jump(std::string_view name) {
  return name == "GOTO" || name == "GOTOF" || name == "GOTOB" || name == "GOTOC";
}

bool contains_jump(std::string_view plain) {
  return std::ranges::any_of(names_in(plain), [](const Name& name) { return is_jump(name.text); });
}

// Behind block number, skip sign and label.
std::string_view statement_in(std::string_view plain) {
  std::size_t at = after_blanks(plain, 0);
  if (char_at(plain, at) == '/') at = after_blanks(plain, at + 1);
  for (;;) {
    if (at >= plain.size()) return {};
    const std::size_t end = after_siemens_name(plain, at);
    const std::string_view name = plain.substr(at, end - at);
    const bool number = is_numbered(name) && name[0] == 'N';
    const std::size_t behind = after_blanks(plain, end);
    const bool label = !name.empty() && char_at(plain, behind) == ':';
    if (!number && !label) return plain.substr(at);
    at = after_blanks(plain, label ? behind + 1 : end);
  }
}

std::string_view first_name(std::string_view statement) {
  return statement.substr(0, after_siemens_name(statement, 0));
}

// +1 where a body begins, -1 where it ends. IF with a jump has none, nor has REPEAT with a label.
int siemens_body_step(std::string_view statement) {
  const std::string_view name = first_name(statement);
  const bool begins = name == "WHILE" || name == "FOR" || name == "LOOP";
  const bool ends = name == "ENDIF" || name == "ENDWHILE" || name == "ENDFOR" || name == "ENDLOOP";
  if (ends || name == "UNTIL") return -1;
  if (begins) return 1;
  if (name == "IF") return contains_jump(statement) ? 0 : 1;
  const bool alone = after_blanks(statement, name.size()) >= statement.size();
  return name == "REPEAT" && alone ? 1 : 0;
}

bool calls_program(std::string_view statement) {
  const std::string_view name = first_name(statement);
  const std::string_view behind =
      statement.substr(std::min(after_blanks(statement, name.size()), statement.size()));
  if (name == "MCALL") return calls_program(behind);
  if (name == "CALL" && first_name(behind) == "BLOCK") return false;  // a part of this one
  if (is_numbered(name)) return name[0] == 'L';
  const bool is_set = behind.starts_with('=') || behind.starts_with('[');
  return name.size() > 1 && name[0] != '$' && !is_set && !is_known_siemens_name(name);
}

class FlowReader {
 public:
  FlowReader(const Program& program, Returns returns, const OwnWords* own,
             const Subprograms* called)
      : program_(program),
        returns_(returns),
        own_(own),
        called_(called),
        flow_(program.blocks.size()),
        labels_(program.blocks.size()) {}

  std::vector<BlockFlow> run() {
    for (std::size_t i = 0; i < program_.blocks.size(); ++i) {
      if (program_.blocks[i].opacity != ParseStatus::kProgramMark) read_block(i);
    }
    mark_targets();
    for (BlockFlow& each : flow_) each.in_called = is_subprogram_;
    return std::move(flow_);
  }

 private:
  [[nodiscard]] std::string_view text_of(const Block& block) const {
    return program_.source.text(block.span);
  }

  void read_block(std::size_t i) {
    const Block& block = program_.blocks[i];
    note_labels(i);
    const bool flow = block.opacity == ParseStatus::kFlow;
    const bool unreadable = block.opacity == ParseStatus::kUnreadable;
    const bool named =
        block.opacity == ParseStatus::kForeign || block.opacity == ParseStatus::kNamedWords;
    const std::string plain =
        flow || unreadable || named ? plain_text(text_of(block)) : std::string();
    const int step = flow ? siemens_body_step(statement_in(plain)) : 0;
    depth_ = std::max(0, depth_ + step);
    flow_[i].in_body |= step != 0 || depth_ > 0;
    if (flow || unreadable) note_jumps(plain);
    if (named) is_subprogram_ |= ends_subprogram(plain);
    if (named || unreadable) {
      note_repeated_part(plain);
      any_label_ |= returns_ == Returns::kToAnyLabel && calls_program(statement_in(plain)) &&
                    !surely_returns(text_of(block));
    }
  }

  [[nodiscard]] bool surely_returns(std::string_view line) const {
    const std::string call = siemens_call(line);
    const OwnWord* own = own_ == nullptr || call.empty() ? nullptr : own_->find(call);
    if (own != nullptr) return own->effect.returns;
    return called_ != nullptr && called_->find(call) != nullptr;
  }

  // A block may have a number and a name.
  void note_labels(std::size_t i) {
    const Block& block = program_.blocks[i];
    for (const Word& word : program_.words_of(block)) {
      if (word.letter != 'N') continue;
      labels_[i].push_back(
          without_zeros(without_blanks(plain_text(program_.source.text(word.span)))));
    }
    const bool may_have_name = block.opacity == ParseStatus::kNamedWords ||
                               block.opacity == ParseStatus::kFlow ||
                               block.opacity == ParseStatus::kForeign;
    if (!may_have_name || text_of(block).find(':') == std::string_view::npos) return;
    SiemensLexer lexer(program_.source.text(), block.span);
    for (;;) {
      const SiemensToken token = lexer.next();
      const bool in_front = token.kind == SiemensTokenKind::kSkip || token.letter == 'N';
      if (token.kind == SiemensTokenKind::kLabel) {
        labels_[i].push_back(without_zeros(plain_text(program_.source.text(token.name))));
      } else if (!in_front) {
        return;
      }
    }
  }

  void note_jumps(std::string_view plain) {
    const std::vector<Name> names = names_in(plain);
    for (std::size_t k = 0; k < names.size(); ++k) {
      if (names[k].text == "GOTOS") {
        starts_again_ = true;
      } else if (is_jump(names[k].text)) {
        note_target(label_at(plain, after_blanks(plain, names[k].end)));
      } else if (names[k].text == "REPEAT" || names[k].text == "REPEATB") {
        // All names behind it but P=3: the first and the last label of what is done again.
        for (std::size_t other = k + 1; other < names.size(); ++other) {
          if (names[other].text != "P") note_target(without_zeros(LabelName(names[other].text)));
        }
        if (names.size() > k + 1) return;
      }
    }
  }

  // CALL BLOCK N100 TO N110
  void note_repeated_part(std::string_view plain) {
    const std::vector<Name> names = names_in(plain);
    const auto is = [](std::string_view text) {
      return [text](const Name& name) { return name.text == text; };
    };
    const auto begins = std::ranges::find_if(names, is("BLOCK"));
    if (std::ranges::none_of(names.begin(), begins, is("CALL")) || begins == names.end()) return;
    note_target(label_at(plain, after_blanks(plain, begins->end)));
    const auto ends = std::find_if(begins, names.end(), is("TO"));
    if (ends != names.end()) note_target(label_at(plain, after_blanks(plain, ends->end)));
  }

  void note_target(const std::optional<LabelName>& label) {
    if (label) targets_.insert(*label);
    any_label_ |= !label;
  }

  static bool ends_subprogram(std::string_view plain) {
    return std::ranges::any_of(names_in(plain), [](const Name& name) {
      return name.text == "M17" || name.text == "RET" || name.text == "PROC";
    });
  }

  void mark_targets() {
    std::unordered_set<LabelName> all;
    for (const auto& labels : labels_) all.insert(labels.begin(), labels.end());
    any_label_ |= std::ranges::any_of(
        targets_, [&all](const LabelName& target) { return !all.contains(target); });
    for (std::size_t i = 0; i < labels_.size(); ++i) {
      const bool target = std::ranges::any_of(labels_[i], [this](const LabelName& label) {
        return any_label_ || targets_.contains(label);
      });
      flow_[i].label_referenced = flow_[i].jump_target = target;
    }
    if (starts_again_ && !flow_.empty()) flow_.front().jump_target = true;
  }

  const Program& program_;
  Returns returns_;
  const OwnWords* own_;
  const Subprograms* called_;
  std::vector<BlockFlow> flow_;
  std::vector<std::vector<LabelName>> labels_;
  std::unordered_set<LabelName> targets_;
  bool any_label_ = false;
  bool starts_again_ = false;
  bool is_subprogram_ = false;
  int depth_ = 0;
};

}  // namespace

std::vector<BlockFlow> find_siemens_flow(const Program& program, Returns returns,
                                         const OwnWords* own, const Subprograms* called) {
  return FlowReader(program, returns, own, called).run();
}

std::string siemens_call(std::string_view line) {
  std::string plain = plain_text(line);
  std::ranges::replace(plain, '"', ' ');  // strings are blanks here
  const std::string_view statement = statement_in(plain);
  const std::string_view name = first_name(statement);
  if (!calls_program(statement) || name == "MCALL" || name == "CALL") return {};
  std::size_t at = after_blanks(statement, name.size());
  if (char_at(statement, at) == '(') {
    at = after_siemens_brackets(statement, at).value_or(at);
  } else if (char_at(statement, at) == 'P' && is_digit(char_at(statement, at + 1))) {
    ++at;
    while (is_digit(char_at(statement, at))) ++at;
  }
  return after_blanks(statement, at) < statement.size() ? std::string() : std::string(name);
}

bool calls_siemens_program(std::string_view line) {
  return calls_program(statement_in(plain_text(line)));
}

FlowEffect siemens_flow_effect(std::string_view text) {
  // CASE too: falls through with the state that it found.
  return contains_jump(plain_text(text)) ? FlowEffect::kNothing : FlowEffect::kEverything;
}

}  // namespace batten::gcode
