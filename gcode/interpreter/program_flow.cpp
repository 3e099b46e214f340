#include "gcode/interpreter/program_flow.h"

#include <algorithm>
#include <cmath>
#include <optional>
#include <string>
#include <unordered_set>
#include <vector>

#include "gcode/interpreter/plain_text.h"
#include "gcode/klartext/flow.h"
#include "gcode/siemens/flow.h"
#include "gcode/text/characters.h"

namespace batten::gcode {
namespace {

using Label = std::uint64_t;

// Upper case, without blanks, comments, block delete and the leading N number.
std::string bare_words(std::string_view text) {
  std::string bare;
  bool in_comment = false;
  for (const char c : text) {
    if (c == ';' && !in_comment) break;
    in_comment |= c == '(';
    if (!in_comment && !is_blank(c)) bare.push_back(upper(c));
    in_comment &= c != ')';
  }
  std::size_t from = bare.starts_with('/') ? 1 : 0;
  if (char_at(bare, from) == 'N' && is_digit(char_at(bare, from + 1))) {
    ++from;
    while (is_digit(char_at(bare, from))) ++from;
  }
  return bare.substr(from);
}

bool contains(std::string_view text, std::string_view part) {
  return text.find(part) != std::string_view::npos;
}

bool starts_with_word_and_digit(std::string_view text, std::string_view word) {
  return text.starts_with(word) && is_digit(char_at(text, word.size()));
}

bool is_program_number(std::string_view bare) {
  return bare.size() > 1 && (bare[0] == 'O' || bare[0] == ':') &&
         std::all_of(bare.begin() + 1, bare.end(), is_digit);
}

// Where the bracket at `at` is closed; the end of the text where it is not.
std::size_t closing_bracket(std::string_view text, std::size_t at) {
  int depth = 0;
  for (; at < text.size(); ++at) {
    depth += text[at] == '[' ? 1 : text[at] == ']' ? -1 : 0;
    if (depth == 0) break;
  }
  return at;
}

constexpr std::string_view kOWordKeywords[] = {
    "CALL", "SUB",   "ENDSUB",   "RETURN", "IF",        "ELSEIF", "ELSE",    "ENDIF",
    "DO",   "WHILE", "ENDWHILE", "REPEAT", "ENDREPEAT", "BREAK",  "CONTINUE"};

// Of an O-word the part behind its number or name: CALL.., SUB, ENDIF .. What is named otherwise
// than is known here is given whole: a word anywhere in it counts then.
std::string_view o_word_keyword(std::string_view bare) {
  if (!bare.starts_with('O')) return {};
  std::size_t at = char_at(bare, 1) == '#' ? 2 : 1;
  if (char_at(bare, at) == '<') {
    at = std::min(bare.find('>', at), bare.size() - 1) + 1;
  } else if (char_at(bare, at) == '[') {
    at = std::min(closing_bracket(bare, at), bare.size() - 1) + 1;
  } else {
    while (is_digit(char_at(bare, at))) ++at;
  }
  const std::string_view keyword = bare.substr(at);
  const bool known = std::ranges::any_of(
      kOWordKeywords, [keyword](std::string_view word) { return keyword.starts_with(word); });
  return known ? keyword : bare;
}

// O100, O<PART>: neither computed nor missing.
bool is_plain_name(std::string_view name) {
  return name.size() > 1 && name.find_first_of("#[") == std::string_view::npos;
}

// +1 where a body begins, -1 where it ends.
int body_step(std::string_view bare) {
  if (starts_with_word_and_digit(bare, "END")) return -1;  // macro B: END1
  if (starts_with_word_and_digit(bare, "DO")) return 1;
  if (bare.starts_with("WHILE") && contains(bare, "]DO")) return 1;
  const std::string_view keyword = o_word_keyword(bare);
  const bool unknown = keyword.size() == bare.size();
  const auto says = [&](std::string_view word) {
    return unknown ? contains(keyword, word) : keyword.starts_with(word);
  };
  if (keyword.empty()) return 0;
  for (const std::string_view word : {"ENDSUB", "ENDWHILE", "ENDREPEAT", "ENDIF"}) {
    if (says(word)) return -1;
  }
  // `O1 do` .. `O1 while [..]` and `O1 while [..]` .. `O1 endwhile` cannot be told apart by one
  // line; the end of the first looks like the begin of the second. Bodies then last longer.
  for (const std::string_view word : {"SUB", "WHILE", "REPEAT", "DO"}) {
    if (says(word)) return 1;
  }
  return says("IF") && !says("ELSEIF") ? 1 : 0;
}

std::optional<Label> whole_number(const Word* word) {
  constexpr double kGreatestLabel = 1e15;
  if (word == nullptr || !word->is_number || word->value < 0 || word->value > kGreatestLabel ||
      word->value != std::floor(word->value)) {
    return std::nullopt;
  }
  return static_cast<Label>(word->value);
}

const Word* find_word(std::span<const Word> words, char letter) {
  const auto found = std::ranges::find(words, letter, &Word::letter);
  return found == words.end() ? nullptr : &*found;
}

bool has_code(std::span<const Word> words, char letter, double low, double high) {
  return std::ranges::any_of(words, [=](const Word& word) {
    return word.letter == letter && word.is_number && word.value >= low && word.value <= high;
  });
}

// A G word whose effect the beginning of a main program may not take back when it starts again: all
// but motions, dwells, planes, units, cutter and length compensation, offsets, cycles, G90, G94.
// And M words of calls, of mirroring and of the user, whatever they do.
bool lasts_beyond_end(const Word& word) {
  constexpr double kFirstOfUser = 70;
  if (word.letter == 'M') {
    const bool mirrors = word.value >= 21 && word.value <= 23;
    return !word.is_number || mirrors || (word.value >= kFirstOfUser && word.value != 99);
  }
  static constexpr double kTakenBack[] = {0,  1,  2,  3,  4,  17, 18, 19, 20, 21, 28,
                                          30, 40, 41, 42, 43, 49, 53, 54, 55, 56, 57,
                                          58, 59, 80, 81, 82, 83, 85, 90, 94, 98, 99};
  return word.letter == 'G' &&
         (!word.is_number || std::ranges::find(kTakenBack, word.value) == std::end(kTakenBack));
}

// The letters of labels, calls and cycles: a block without them has no part in the flow.
bool names_flow(const Word& word) {
  return word.letter == 'N' || word.letter == 'M' || word.letter == 'G';
}

class FlowFinder {
 public:
  FlowFinder(const Program& program, Returns returns, const OwnWords* own,
             const Subprograms* called, bool names_blocks)
      : program_(program),
        returns_(returns),
        own_(own),
        called_files_(called),
        names_blocks_(names_blocks),
        flow_(program.blocks.size()) {}

  ProgramFlow find() {
    for (std::size_t i = 0; i < program_.blocks.size(); ++i) read_block(i);
    close_segment(program_.blocks.size());
    judge_calls();
    const bool refers = !jump_targets_.empty() || any_label_ || !contours_.empty();
    reaches_out_ |= refers || by_name_;
    if (refers) mark_blocks_referred_to();
    for (const std::size_t i : named_) flow_[i].jump_target |= by_name_;
    for (const auto& [first, last] : definitions_) mark_definition(first, last);
    return {std::move(flow_), reaches_out_};
  }

 private:
  void read_block(std::size_t i) {
    const Block& block = program_.blocks[i];
    if (block.opacity == ParseStatus::kProgramMark) {
      defined_.clear();  // a % ends the program
      note_program(find_word(program_.words_of(block), 'O'));
      return;
    }
    const auto words = program_.words_of(block);
    if (block.opacity == ParseStatus::kNone && program_.language == Language::kRs274 &&
        std::ranges::none_of(words, names_flow)) {
      flow_[i].in_body |= depth_ > 0;
      return;
    }
    says_more_ |= block.opacity == ParseStatus::kFlow || block.opacity == ParseStatus::kForeign ||
                  block.opacity == ParseStatus::kUnreadable;
    if (block.opacity != ParseStatus::kNone) read_text(i, block.opacity == ParseStatus::kFlow);
    note_own_start(words, block.block_delete);
    if (find_word(words, 'M') != nullptr) read_calls(i, words);
    if (find_word(words, 'G') != nullptr) read_lathe_cycle(words);
    note_call(words);
    flow_[i].in_body |= depth_ > 0;
  }

  void read_text(std::size_t i, bool is_flow) {
    const std::string_view text = program_.source.text(program_.blocks[i].span);
    const std::string bare = bare_words(text);
    find_jumps(bare);
    if (names_blocks_ && is_letter_name(text, 'N')) return named_.push_back(i);
    note_hidden_call(program_.blocks[i].opacity, text, bare);
    follow_definition(i, bare);
    if (!is_flow) return;
    if (is_program_number(bare)) {
      close_segment(i);
      note_program(find_word(program_.words_of(program_.blocks[i]), 'O'));
    }
    const int step = body_step(bare);
    reaches_out_ |= step != 0;
    flow_[i].in_body |= step != 0 || depth_ > 0;
    depth_ = std::max(0, depth_ + step);
  }

  // From o100 sub to o100 endsub, where nothing between them can end the definition or be another.
  void follow_definition(std::size_t i, std::string_view bare) {
    const std::string_view keyword = o_word_keyword(bare);
    const bool is_known = !keyword.empty() && keyword.size() < bare.size();
    const std::string_view name = bare.substr(0, bare.size() - keyword.size());
    const bool may_be_skipped = program_.blocks[i].block_delete;
    if (defined_.empty()) {
      const bool begins = is_known && keyword == "SUB" && is_plain_name(name) && depth_ == 0;
      if (!begins || may_be_skipped) return;
      defined_ = name;
      definition_begin_ = i;
      return;
    }
    const bool is_mine = is_known && name == defined_;
    if (is_mine && keyword.starts_with("RETURN")) return;
    const bool ends = is_mine && keyword.starts_with("ENDSUB") && !may_be_skipped;
    if (ends) definitions_.emplace_back(definition_begin_, i);
    const bool is_unclear =
        is_mine || keyword.starts_with("SUB") || contains(is_known ? keyword : bare, "ENDSUB");
    if (is_unclear) defined_.clear();
  }

  // What a jump can come to from outside goes on behind the definition.
  void mark_definition(std::size_t first, std::size_t last) {
    const auto begin = flow_.begin() + static_cast<std::ptrdiff_t>(first);
    const auto end = flow_.begin() + static_cast<std::ptrdiff_t>(last) + 1;
    if (std::any_of(begin, end, [](const BlockFlow& each) { return each.jump_target; })) return;
    for (auto each = begin; each != end; ++each) each->in_definition = InDefinition::kWithin;
    begin->in_definition = InDefinition::kFirst;
    flow_[last].in_definition = InDefinition::kLast;
  }

  static std::optional<Label> leading_label(std::string_view text) {
    const std::size_t at = std::min(text.find_first_not_of("/ \t"), text.size());
    return upper(char_at(text, at)) == 'N' ? number_at(text, at + 1) : std::nullopt;
  }

  static std::optional<Label> number_at(std::string_view text, std::size_t at) {
    constexpr std::size_t kMaxDigits = 15;
    Label number = 0;
    std::size_t digits = 0;
    for (; at < text.size() && is_digit(text[at]) && digits < kMaxDigits; ++at, ++digits) {
      number = number * 10 + static_cast<Label>(text[at] - '0');
    }
    return digits == 0 ? std::nullopt : std::optional(number);
  }

  // GOTO 100, GOTO N100, IF [..] N100. A computed target can be any label.
  void find_jumps(std::string_view bare) {
    by_name_ |= names_blocks_ && (contains(bare, "GOTO") || contains(bare, "IF"));  // IF [..] NAT01
    for (std::size_t at = bare.find("GOTO"); at != std::string_view::npos;
         at = bare.find("GOTO", at + 4)) {
      std::size_t to = at + 4;
      while (char_at(bare, to) == 'N') ++to;
      if (const auto label = number_at(bare, to)) {
        jump_targets_.insert(*label);
      } else {
        any_label_ |= to < bare.size() && contains("#[(", bare.substr(to, 1));
      }
    }
    for (std::size_t at = bare.find('N'); at != std::string_view::npos;
         at = bare.find('N', at + 1)) {
      if (const auto label = number_at(bare, at + 1)) jump_targets_.insert(*label);
    }
  }

  // M97 P, M99 P and M98 P.. H name a block, and on Haas M96 P Q and M46 P Q, which jump by an
  // input or a pallet; M98 P alone names a program.
  void read_calls(std::size_t i, std::span<const Word> words) {
    const bool ends_subprogram = has_code(words, 'M', 99, 99);
    if (ends_subprogram || has_code(words, 'M', 96, 97) || has_code(words, 'M', 46, 46)) {
      add_target(find_word(words, 'P'));
    }
    if (has_code(words, 'M', 98, 98)) add_target(find_word(words, 'H'));
    if (ends_subprogram) {
      is_left_early_ |= segment_is_subprogram_ || find_word(words, 'P') != nullptr;
      segment_is_subprogram_ = true;
      last_block_ = i;
    }
    reaches_out_ |= ends_subprogram;
  }

  void note_program(const Word* number) {
    if (const auto program = whole_number(number)) programs_.insert(*program);
  }

  // M98 P, G65 P and the like; P may count repetitions in front of the last four digits.
  void note_call(std::span<const Word> words) {
    constexpr Label kPrograms = 10000;
    const bool calls = has_code(words, 'M', 98, 98) || has_code(words, 'M', 198, 198) ||
                       has_code(words, 'G', 65, 65) || has_code(words, 'G', 66, 66.1);
    if (!calls || surely_returns(words)) return;
    const auto program = whole_number(find_word(words, 'P'));
    called_.push_back(program ? std::optional(*program % kPrograms) : std::nullopt);
  }

  [[nodiscard]] bool surely_returns(std::span<const Word> words) const {
    if (own_ == nullptr && called_files_ == nullptr) return false;
    const BlockWords sorted(words);
    if (sorted.problem() != BlockWords::Problem::kNone) return false;
    const std::string call = numbered_call(sorted);
    if (call.empty()) return false;
    const OwnWord* own = own_ == nullptr ? nullptr : own_->find(call);
    if (own != nullptr) return own->effect.returns;
    return called_files_ != nullptr && called_files_->find(call.substr(call.find('P'))) != nullptr;
  }

  // Of a block whose words are not all listed.
  void note_hidden_call(ParseStatus opacity, std::string_view text, std::string_view bare) {
    if (opacity == ParseStatus::kExpression || opacity == ParseStatus::kCornerWord) return;
    const bool foreign =
        opacity == ParseStatus::kForeign && calls_siemens_program(text) && !is_open_number(text);
    if (foreign || contains(bare, "M98") || contains(bare, "G65"))
      called_.emplace_back(std::nullopt);
  }

  // What is called and does not stand here may come back to any label.
  void judge_calls() {
    if (returns_ == Returns::kBehindCalls) return;
    reaches_out_ |= !called_.empty();
    any_label_ |= std::ranges::any_of(called_, [this](const std::optional<Label>& program) {
      return !program || !programs_.contains(*program);
    });
  }

  void add_target(const Word* word) {
    if (const auto label = whole_number(word)) jump_targets_.insert(*label);
    any_label_ |= word != nullptr && !word->is_number;
  }

  // G70 to G73 P Q of lathes name the first and the last block of a contour. On mills G73 drills,
  // with Z or R in the block.
  void read_lathe_cycle(std::span<const Word> words) {
    if (!has_code(words, 'G', 70, 73) || find_word(words, 'Z') != nullptr ||
        find_word(words, 'R') != nullptr) {
      return;
    }
    const auto first = whole_number(find_word(words, 'P'));
    const auto last = whole_number(find_word(words, 'Q'));
    if (first && last) contours_.emplace_back(*first, *last);
  }

  // What a program says for itself before its first cut, and no subprogram does: it depends on
  // nothing that a caller, or its own end when it starts again, could have left.
  void note_own_start(std::span<const Word> words, bool may_be_skipped) {
    says_more_ |= std::ranges::any_of(words, lasts_beyond_end);
    cuts_ |= has_code(words, 'G', 1, 3);
    if (cuts_ || may_be_skipped) return;
    says_plane_ |= has_code(words, 'G', 17, 19);
    says_units_ |= has_code(words, 'G', 20, 21);
    says_distance_ |= has_code(words, 'G', 90, 90);
    says_cutter_ |= has_code(words, 'G', 40, 40);
    changes_tool_ |= has_code(words, 'M', 6, 6);
  }

  // M99 stands behind all of it, once.
  [[nodiscard]] bool is_main_program(std::size_t end) const {
    bool is_over = !is_left_early_;
    for (std::size_t i = last_block_ + 1; i < end; ++i) {
      const Block& block = program_.blocks[i];
      is_over &= block.opacity == ParseStatus::kProgramMark ||
                 (block.opacity == ParseStatus::kNone && program_.words_of(block).empty());
    }
    return is_over && !says_more_ && segment_begin_ == 0 && end == program_.blocks.size() &&
           says_plane_ && says_units_ && says_distance_ && says_cutter_ && changes_tool_;
  }

  // A program with M99 is a subprogram, or starts again from its beginning: its blocks can be
  // entered in a state that we do not see.
  void close_segment(std::size_t end) {
    const bool is_body = segment_is_subprogram_ && !is_main_program(end);
    const bool is_whole = segment_begin_ == 0 && end == program_.blocks.size();
    for (std::size_t i = segment_begin_; is_body && i < end; ++i) {
      if (is_whole) {
        flow_[i].in_called = true;
      } else {
        flow_[i].in_body = true;
      }
    }
    // M98 P1 H5 begins at N5.
    any_label_ |= is_body && is_whole && returns_ == Returns::kToAnyLabel;
    segment_begin_ = end;
    segment_is_subprogram_ = false;
  }

  [[nodiscard]] std::optional<Label> label_of(const Block& block) const {
    if (block.opacity == ParseStatus::kProgramMark) return std::nullopt;
    const auto label = whole_number(find_word(program_.words_of(block), 'N'));
    return label || block.opacity == ParseStatus::kNone
               ? label
               : leading_label(program_.source.text(block.span));
  }

  void mark_blocks_referred_to() {
    std::vector<bool> inside(contours_.size());
    for (std::size_t i = 0; i < flow_.size(); ++i) {
      BlockFlow& flow = flow_[i];
      const std::optional<Label> label = label_of(program_.blocks[i]);
      flow.jump_target = label && (any_label_ || jump_targets_.contains(*label));
      flow.label_referenced = flow.jump_target;
      for (std::size_t k = 0; k < contours_.size(); ++k) {
        const bool is_first = label == contours_[k].first;
        const bool is_last = label == contours_[k].second;
        flow.label_referenced |= is_first || is_last;
        inside[k] = inside[k] || is_first;
        flow.in_body |= inside[k];
        inside[k] = inside[k] && !is_last;
      }
    }
  }

  const Program& program_;
  Returns returns_;
  const OwnWords* own_;
  const Subprograms* called_files_;
  bool names_blocks_;
  std::vector<BlockFlow> flow_;
  std::unordered_set<Label> jump_targets_;
  std::unordered_set<Label> programs_;        // that stand here
  std::vector<std::optional<Label>> called_;  // nothing: by a name or a computed number
  std::vector<std::pair<Label, Label>> contours_;
  std::vector<std::pair<std::size_t, std::size_t>> definitions_;  // first and last block
  std::string defined_;  // O100, O<PART>: of the definition that is not over; empty: none
  std::size_t definition_begin_ = 0;
  std::vector<std::size_t> named_;  // blocks that are names, for jumps (Okuma)
  bool by_name_ = false;            // jumps may name them
  bool any_label_ = false;
  int depth_ = 0;
  std::size_t segment_begin_ = 0;
  bool segment_is_subprogram_ = false;
  bool is_left_early_ = false;  // by an M99 before the last one, or one that names a block
  std::size_t last_block_ = 0;  // with M99
  bool says_more_ = false;
  bool cuts_ = false, says_plane_ = false, says_units_ = false, says_distance_ = false,
       says_cutter_ = false, changes_tool_ = false;
  bool reaches_out_ = false;
};

}  // namespace

std::string o_word_call(std::string_view text) {
  const std::string bare = bare_words(text);
  const std::string_view keyword = o_word_keyword(bare);
  if (!keyword.starts_with("CALL")) return {};
  // Its arguments, if it has any, are all that stands behind it.
  std::string_view rest = keyword.substr(std::string_view("CALL").size());
  while (rest.starts_with('['))
    rest.remove_prefix(std::min(closing_bracket(rest, 0) + 1, rest.size()));
  const std::string name = bare.substr(0, bare.size() - keyword.size());
  return rest.empty() && is_plain_name(name) ? name + " CALL" : std::string();
}

ProgramFlow follow_flow(const Program& program, Returns returns, const OwnWords* own,
                        const Subprograms* called, bool names_blocks) {
  if (program.language == Language::kKlartext) return {find_klartext_flow(program), true};
  if (program.language == Language::kSiemens)
    return {find_siemens_flow(program, returns, own, called), true};
  return FlowFinder(program, returns, own, called, names_blocks).find();
}

FlowEffect flow_effect(std::string_view text) {
  const std::string bare = bare_words(text);
  if (is_program_number(bare)) return FlowEffect::kProgramNumber;
  const bool jumps = bare.starts_with("GOTO") || (bare.starts_with("IF") && contains(bare, "GOTO"));
  const bool assigns = bare.starts_with("IF") && contains(bare, "THEN#");
  if (o_word_keyword(bare).starts_with("CALL")) return FlowEffect::kCall;
  if (assigns) return FlowEffect::kAssignment;
  return jumps ? FlowEffect::kNothing : FlowEffect::kEverything;
}

}  // namespace batten::gcode
