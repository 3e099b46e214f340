#include "gcode/reading/constants.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <optional>
#include <set>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "gcode/interpreter/program_flow.h"
#include "gcode/siemens/block.h"
#include "gcode/siemens/names.h"
#include "gcode/state/block_words.h"
#include "gcode/text/characters.h"
#include "gcode/text/number_format.h"

namespace batten::gcode {
namespace {

constexpr int kLastCertain = 999;
constexpr std::string_view kComputed = "XYZIJKRFS";

// A variable in upper case, without blanks: "12" for #12, "R5", "Q5"; in <> those that no program
// sees that is called: #<name>, what DEF REAL declares, QL5.
using Name = std::string;

bool is_numbered(const Name& name) { return name[0] != '<'; }

// Variables whose values are known; those that were assigned something else have none.
using Values = std::map<Name, double>;

// Reads what stands at a position of a text, and goes behind it. Blanks are skipped.
class Reader {
 public:
  Reader(std::string_view text, const Values& values, const Program& program)
      : text_(text),
        values_(values),
        language_(program.language),
        with_points_(program.decimals.pointless != PointlessNumbers::kUnits) {}

  [[nodiscard]] std::size_t at() const { return at_; }

  // After blanks.
  [[nodiscard]] char next() {
    at_ = after_blanks(text_, at_);
    return char_at(text_, at_);
  }
  bool take(char c) {
    if (next() != c) return false;
    ++at_;
    return true;
  }

  // Whether a variable's name may begin here.
  [[nodiscard]] bool at_name() {
    const char c = upper(next());
    return language_ == Language::kRs274      ? c == '#'
           : language_ == Language::kKlartext ? c == 'Q'
                                              : is_letter(c) || c == '_';
  }
  // Whether any value so far was that of a variable.
  [[nodiscard]] bool uses_variable() const { return uses_variable_; }

  // The variable that is named here; nothing where it is named in another way or no certain one.
  std::optional<Name> name() {
    if (!at_name()) return std::nullopt;
    return language_ == Language::kRs274      ? name_of_rs274()
           : language_ == Language::kKlartext ? name_of_klartext()
                                              : name_of_siemens();
  }

 private:
  // #12, #<name>
  std::optional<Name> name_of_rs274() {
    ++at_;
    Name name;
    if (next() == '<') {
      const std::size_t close = text_.find('>', at_);
      if (close == std::string_view::npos) return std::nullopt;
      name = in_capitals(without_blanks(text_.substr(at_, close + 1 - at_)));
      at_ = close + 1;
      return name.size() > 2 && name[1] != '_' ? std::optional(name) : std::nullopt;
    }
    int number = 0;
    for (; is_digit(next()) && number <= kLastCertain; ++at_) number = 10 * number + (next() - '0');
    if (number < 1 || number > kLastCertain || next() == '.') return std::nullopt;
    return std::to_string(number);
  }

  // Q5, QL5. Parameters from Q100 on belong to cycles.
  std::optional<Name> name_of_klartext() {
    constexpr std::size_t kMostDigits = 2;
    ++at_;
    const bool local = upper(char_at(text_, at_)) == 'L';
    if (local) ++at_;
    const std::size_t begin = at_;
    while (is_digit(char_at(text_, at_))) ++at_;
    const std::string digits(text_.substr(begin, at_ - begin));
    if (digits.empty() || digits.size() > kMostDigits) return std::nullopt;
    return local ? "<QL" + digits + ">" : "Q" + digits;
  }

  // R5, or a name; functions and fields are none.
  std::optional<Name> name_of_siemens() {
    const std::size_t begin = at_;
    while (is_name_character(char_at(text_, at_))) ++at_;
    const std::string name = in_capitals(text_.substr(begin, at_ - begin));
    if (next() == '(' || next() == '[') return std::nullopt;
    const bool numbered =
        name.size() > 1 && name[0] == 'R' && std::all_of(name.begin() + 1, name.end(), is_digit);
    return numbered ? name : "<" + name + ">";
  }

 public:
  // Values joined by + - * /; nothing where it is not certain.
  std::optional<double> sum() {
    std::optional<double> left = product();
    while (left && (next() == '+' || next() == '-')) {
      const bool adds = text_[at_++] == '+';
      const auto right = product();
      if (!right) return std::nullopt;
      *left = adds ? *left + *right : *left - *right;
    }
    return left;
  }

  // With a sign or not: #12, [sum], and a number where `with_numbers`.
  std::optional<double> value(bool with_numbers) {
    const bool negative = next() == '-';
    if (negative || next() == '+') ++at_;
    const auto found = at_name()             ? variable()
                       : next() == opening() ? bracketed()
                       : with_numbers        ? number()
                                             : std::nullopt;
    return found && negative ? std::optional(-*found) : found;
  }

 private:
  std::optional<double> product() {
    std::optional<double> left = value(true);
    while (left && (next() == '*' || next() == '/')) {
      const bool multiplies = text_[at_++] == '*';
      if (char_at(text_, at_) == '*') return std::nullopt;  // a power
      const auto right = value(true);
      if (!right || (!multiplies && *right == 0)) return std::nullopt;
      *left = multiplies ? *left * *right : *left / *right;
    }
    return left;
  }

  [[nodiscard]] char opening() const { return language_ == Language::kRs274 ? '[' : '('; }
  [[nodiscard]] char closing() const { return language_ == Language::kRs274 ? ']' : ')'; }

  std::optional<double> variable() {
    uses_variable_ = true;
    const auto named = name();
    const auto known = named ? values_.find(*named) : values_.end();
    return known == values_.end() ? std::nullopt : std::optional(known->second);
  }

  std::optional<double> bracketed() {
    if (depth_ == kDeepest || !take(opening())) return std::nullopt;
    ++depth_;
    const auto inside = sum();
    --depth_;
    return inside && take(closing()) ? inside : std::nullopt;
  }

  std::optional<double> number() {
    const auto scanned = scan_number(text_.substr(at_));
    if (!scanned) return std::nullopt;
    at_ += scanned->length;
    const ReadNumber& read = scanned->number;
    const bool certain = read.has_point || read.value == 0 || !with_points_;
    return certain ? std::optional(read.value) : std::nullopt;
  }

  static constexpr int kDeepest = 32;

  std::string_view text_;
  const Values& values_;
  Language language_;
  bool with_points_;  // numbers without one are not certain
  bool uses_variable_ = false;
  std::size_t at_ = 0;
  int depth_ = 0;
};

// Of a control's number; as many as it needs.
std::uint8_t decimals_of(double value) {
  constexpr int kMost = 6;
  const std::string text = to_text(value, {.decimals = kMost});
  const std::size_t point = text.find('.');
  return static_cast<std::uint8_t>(point == std::string::npos ? 0 : text.size() - point - 1);
}

// M words that no builder's macro stands behind, as a rule of all controls: stops, spindle,
// coolant, the end.
bool keeps_numbered(const CodeRow& row) {
  if (row.is(trait::kLosesPlace)) return false;  // another tool, another pallet
  switch (row.act) {
    case CodeAct::kSpindleOn:
    case CodeAct::kSwitches:
    case CodeAct::kStops:
    case CodeAct::kEnds:
    case CodeAct::kOverride:
      return true;
    default:
      return false;
  }
}

bool may_run_other_blocks(const CodeRow& row) {
  return row.act == CodeAct::kCalls ||
         row.is(trait::kCallsAtEnd | trait::kUnknownBehind | trait::kNotUnderstood);
}

// (PY, ..) and (SYSTEM, ..) run what may set any variable.
bool runs_more(std::string_view comment) {
  const std::string text = in_capitals(without_blanks(comment.substr(1)));
  return text.starts_with("PY") || text.starts_with("SYSTEM");
}

class ConstantFinder {
 public:
  explicit ConstantFinder(Program& program)
      : program_(program), flow_(follow_flow(program, Returns::kToAnyLabel)) {}

  void compute() {
    for (std::size_t i = 0; i < program_.blocks.size() && !ended_; ++i) {
      const BlockFlow& flow = flow_.blocks[i];
      const bool in_body = flow.in_body || flow.in_called;
      if (flow.jump_target || in_body) values_.clear();
      if (!in_body) read(program_.blocks[i]);
    }
  }

 private:
  void read(Block& block) {
    switch (block.opacity) {
      case ParseStatus::kNone:
      case ParseStatus::kExpression:
      case ParseStatus::kCornerWord:
        if (!block.block_delete && !values_.empty()) compute_words(block);
        forget_behind(block);
        break;
      case ParseStatus::kAssignment:
        assign(block);
        break;
      case ParseStatus::kNamedWords:
        read_named(block);
        break;
      case ParseStatus::kProgramMark:
        break;
      default:
        values_.clear();
    }
    for (const Comment& comment : program_.comments_of(block)) {
      const bool acts =
          comment.kind == CommentKind::kActive && runs_more(program_.source.text(comment.span));
      if (acts || comment.kind == CommentKind::kUncertain) values_.clear();
    }
  }

  void compute_words(Block& block) {
    if (block.opacity == ParseStatus::kNone) return;
    bool all_numbers = true;
    for (std::uint32_t i = 0; i < block.word_count; ++i) {
      Word& word = program_.words[block.first_word + i];
      if (!word.is_number && kComputed.find(word.letter) != std::string_view::npos) compute(word);
      all_numbers &= word.is_number;
    }
    if (all_numbers && block.opacity == ParseStatus::kExpression)
      block.opacity = ParseStatus::kNone;
  }

  void compute(Word& word) {
    const std::string text = expression_of(word);
    Reader reader(text, values_, program_);
    const auto value = program_.language == Language::kSiemens ? reader.sum() : reader.value(false);
    if (!value || reader.next() != '\0' || !(std::abs(*value) < kNumberLimit)) return;
    word.value = *value == 0 ? 0 : *value;  // no -0
    word.decimals = decimals_of(word.value);
    word.is_number = true;
    word.has_point = true;
    word.computed = true;
  }

  // What stands behind the letter: of Siemens X=R1, CR=R1.
  [[nodiscard]] std::string expression_of(const Word& word) const {
    std::string_view text = program_.source.text(word.span);
    if (program_.language != Language::kSiemens) return std::string(text.substr(1));
    text.remove_prefix(word.letter == 'R' ? std::min<std::size_t>(2, text.size()) : 1);
    const std::size_t equals = after_blanks(text, 0);
    return char_at(text, equals) == '=' ? std::string(text.substr(equals + 1)) : std::string();
  }

  // The block without comments, its number and the / before it.
  [[nodiscard]] std::string said_in(const Block& block) const {
    std::string text(program_.source.text(block.span));
    for (const Comment& comment : program_.comments_of(block)) {
      std::fill_n(text.begin() + (comment.span.begin - block.span.begin), comment.span.size(), ' ');
    }
    const bool klartext = program_.language == Language::kKlartext;
    if (klartext) std::ranges::replace(text, ',', '.');
    std::size_t begin = program_.language == Language::kRs274 ? text.find('#')
                        : klartext                            ? text.find_first_of("Qq")
                                                              : text.find_first_not_of("/ \t");
    begin = std::min(begin, text.size());
    if (program_.language == Language::kSiemens && upper(char_at(text, begin)) == 'N' &&
        is_digit(char_at(text, begin + 1))) {
      begin = std::min(text.find_first_not_of("0123456789", begin + 1), text.size());
    }
    return text.substr(begin);
  }

  // All right sides are read before any variable is set.
  void assign(const Block& block) {
    const std::string text = said_in(block);
    Reader reader(text, values_, program_);
    std::vector<std::pair<Name, std::optional<double>>> assigned;
    while (reader.next() != '\0') {
      const auto name = reader.name();
      if (!name && assigned.empty() && sets_another(text)) return;
      if (!name || !reader.take('=')) return values_.clear();
      assigned.emplace_back(*name, reader.sum());
      if (reader.next() == '\0' || (assigned.back().second && reader.at_name())) continue;
      // The rest cannot be read: it may set others.
      if (std::string_view(text).substr(reader.at()).find('=') != std::string_view::npos) {
        return values_.clear();
      }
      assigned.back().second.reset();
      break;
    }
    if (assigned.empty()) return values_.clear();  // R1=5 in a program of the RS-274 family
    // Of several, some controls may take the new value of one for the next.
    const bool certain = assigned.size() == 1 || !reader.uses_variable();
    for (const auto& [name, value] : assigned) {
      set(name, certain && !block.block_delete ? value : std::nullopt);
    }
  }

  void set(const Name& name, std::optional<double> value) {
    values_.erase(name);
    if (value && std::abs(*value) < kNumberLimit) values_.emplace(name, *value);
  }

  // Whether its one assignment is to a global name, or a number above those that may be certain.
  [[nodiscard]] bool sets_another(std::string_view text) const {
    if (program_.language != Language::kRs274 || std::ranges::count(text, '=') != 1) return false;
    const std::string bare = without_blanks(text);
    const std::size_t end = bare.find_first_not_of("0123456789", 1);
    return bare[1] == '<' || (char_at(bare, end) == '=' && end > 4 && bare[1] != '0');
  }

  // A block of a Siemens program with words of several letters.
  void read_named(Block& block) {
    // Those that set no variable and call nothing.
    static constexpr std::string_view kSilent =
        " D SOFT BRISK FFWON FFWOF G601 G602 G603 G641 G642 G643 G644 G645 COMPON COMPCURV COMPCAD "
        "COMPSURF COMPOF CYCLE832 CTOL G70 G71 G700 G710 G500 TRANS ATRANS MSG STOPRE DYNNORM "
        "DYNFINISH "
        "DYNROUGH ";
    const auto names = siemens_names_in(program_.source.text(), block.span);
    if (!names.empty() && names.front().name == "DEF") return declare(block);
    const bool silent = std::ranges::all_of(names, [](const SiemensName& each) {
      return kSilent.find(" " + each.name + " ") != std::string_view::npos;
    });
    if (silent) {
      if (!block.block_delete) compute_words(block);
      return forget_behind(block);
    }
    // Tools and cycles of the control see no variables that the program has declared.
    const bool known = std::ranges::all_of(names, [](const SiemensName& each) {
      return is_known_siemens_name(each.name) || each.name == "T";
    });
    if (!known || names.empty()) return set_declared(block);
    forget_numbered();
    forget_behind(block);
  }

  // DEF REAL NAME=5, OTHER=2.5
  void declare(const Block& block) {
    const std::string text = said_in(block);
    Reader reader(text, values_, program_);
    const auto def = reader.name();
    const auto type = reader.name();
    if (def != "<DEF>" || block.block_delete) return values_.clear();
    if (type != "<REAL>") return;
    do {
      const auto name = reader.name();
      if (!name) return values_.clear();
      declared_.insert(*name);
      set(*name, reader.take('=') ? reader.sum() : std::nullopt);
    } while (reader.take(','));
    if (reader.next() != '\0') values_.clear();
  }

  // NAME=5 of a name that was declared; anything else may set any.
  void set_declared(const Block& block) {
    const std::string text = said_in(block);
    Reader reader(text, values_, program_);
    const auto name = reader.name();
    const bool known = name && declared_.contains(*name) && reader.take('=');
    const auto value = known ? reader.sum() : std::nullopt;
    if (!value || reader.next() != '\0') return values_.clear();
    set(*name, block.block_delete ? std::nullopt : value);
  }

  void forget_behind(const Block& block) {
    bool forgets_numbered = false;
    for (const Word& word : program_.words_of(block)) {
      if (word.letter == 'T') forgets_numbered = true;
      if (word.letter != 'G' && word.letter != 'M') continue;
      const bool is_g = word.letter == 'G';
      const Code code = code_of(word);
      const CodeRow& row = is_g ? row_of_g(code) : row_of_m(code);
      if (code == kNoCode || may_run_other_blocks(row) ||
          (is_g && row.group == CodeGroup::kUnknown)) {
        values_.clear();
      }
      // From here on each motion calls a macro.
      ended_ |= row.group == CodeGroup::kModalMacro;
      forgets_numbered |= !is_g && !keeps_numbered(row);
    }
    if (forgets_numbered) forget_numbered();
  }

  void forget_numbered() {
    std::erase_if(values_, [](const auto& each) { return is_numbered(each.first); });
  }

  Program& program_;
  ProgramFlow flow_;
  Values values_;
  std::set<Name> declared_;  // by DEF REAL
  bool ended_ = false;
};

bool has_block_of(const Program& program, ParseStatus status) {
  return std::ranges::find(program.blocks, status, &Block::opacity) != program.blocks.end();
}

}  // namespace

void compute_constants(Program& program) {
  const bool assigns =
      has_block_of(program, ParseStatus::kAssignment) || program.language == Language::kSiemens;
  if (!assigns || !has_block_of(program, ParseStatus::kExpression)) return;
  ConstantFinder(program).compute();
}

}  // namespace batten::gcode
