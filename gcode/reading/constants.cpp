#include "gcode/reading/constants.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "gcode/interpreter/program_flow.h"
#include "gcode/state/block_words.h"
#include "gcode/text/characters.h"
#include "gcode/text/number_format.h"

namespace batten::gcode {
namespace {

constexpr int kLastCertain = 999;
constexpr std::string_view kComputed = "XYZIJKRFS";

// A variable as RS-274 names it: upper case, without blanks; "12" for #12, "<NAME>" for #<name>.
using Name = std::string;

bool is_numbered(const Name& name) { return name[0] != '<'; }

// Variables whose values are known; those that were assigned something else have none.
using Values = std::map<Name, double>;

// Reads what stands at a position of a text, and goes behind it. Blanks are skipped.
class Reader {
 public:
  Reader(std::string_view text, const Values& values, const Decimals& decimals)
      : text_(text), values_(values), decimals_(decimals) {}

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

  // #12, #<name>; nothing where it is named in another way or no certain one.
  std::optional<Name> name() {
    if (!take('#')) return std::nullopt;
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
    const auto found = next() == '#'   ? variable()
                       : next() == '[' ? bracketed()
                       : with_numbers  ? number()
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

  std::optional<double> variable() {
    const auto named = name();
    const auto known = named ? values_.find(*named) : values_.end();
    return known == values_.end() ? std::nullopt : std::optional(known->second);
  }

  std::optional<double> bracketed() {
    if (depth_ == kDeepest || !take('[')) return std::nullopt;
    ++depth_;
    const auto inside = sum();
    --depth_;
    return inside && take(']') ? inside : std::nullopt;
  }

  std::optional<double> number() {
    const auto scanned = scan_number(text_.substr(at_));
    if (!scanned) return std::nullopt;
    at_ += scanned->length;
    const ReadNumber& read = scanned->number;
    const bool certain =
        read.has_point || read.value == 0 || decimals_.pointless == PointlessNumbers::kUnits;
    return certain ? std::optional(read.value) : std::nullopt;
  }

  static constexpr int kDeepest = 32;

  std::string_view text_;
  const Values& values_;
  const Decimals& decimals_;
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
      if (flow.jump_target || flow.in_body) values_.clear();
      if (!flow.in_body) read(program_.blocks[i]);
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
    const std::string_view text = program_.source.text(word.span).substr(1);
    Reader reader(text, values_, program_.decimals);
    const auto value = reader.value(false);
    if (!value || reader.next() != '\0' || !(std::abs(*value) < kNumberLimit)) return;
    word.value = *value == 0 ? 0 : *value;  // no -0
    word.decimals = decimals_of(word.value);
    word.is_number = true;
    word.has_point = true;
    word.computed = true;
  }

  // All right sides are read before any variable is set.
  void assign(const Block& block) {
    std::vector<std::pair<Name, std::optional<double>>> assigned;
    std::string text(program_.source.text(block.span));
    for (const Comment& comment : program_.comments_of(block)) {
      std::fill_n(text.begin() + (comment.span.begin - block.span.begin), comment.span.size(), ' ');
    }
    const std::size_t begin = text.find('#');
    Reader reader(
        begin == std::string::npos ? std::string_view() : std::string_view(text).substr(begin),
        values_, program_.decimals);
    while (reader.next() != '\0') {
      const auto name = reader.name();
      if (!name && assigned.empty() && sets_another(text)) return;
      if (!name || !reader.take('=')) return values_.clear();
      assigned.emplace_back(*name, reader.sum());
      const char next = reader.next();
      if (next == '\0' || (assigned.back().second && next == '#')) continue;
      // The rest cannot be read: it may set others.
      if (std::string_view(text).substr(begin + reader.at()).find('=') != std::string_view::npos) {
        return values_.clear();
      }
      assigned.back().second.reset();
      break;
    }
    if (assigned.empty()) return values_.clear();  // R1=5
    const bool alone = assigned.size() == 1;
    for (const auto& [name, value] : assigned) {
      values_.erase(name);
      // Of several, some controls may take the new value of one for the next.
      const bool known = value && !block.block_delete && std::abs(*value) < kNumberLimit;
      if (known && (alone || !refers(text))) values_.emplace(name, *value);
    }
  }

  // Whether its one assignment is to a global name, or a number above those that may be certain.
  static bool sets_another(std::string_view text) {
    if (std::ranges::count(text, '=') != 1) return false;
    const std::string bare = without_blanks(text.substr(text.find('#')));
    const std::size_t end = bare.find_first_not_of("0123456789", 1);
    return bare[1] == '<' || (char_at(bare, end) == '=' && end > 4 && bare[1] != '0');
  }

  // Whether any right side names a variable.
  static bool refers(std::string_view text) {
    return std::ranges::count(text, '#') > std::ranges::count(text, '=');
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
    if (forgets_numbered) {
      std::erase_if(values_, [](const auto& each) { return is_numbered(each.first); });
    }
  }

  Program& program_;
  ProgramFlow flow_;
  Values values_;
  bool ended_ = false;
};

bool has_block_of(const Program& program, ParseStatus status) {
  return std::ranges::find(program.blocks, status, &Block::opacity) != program.blocks.end();
}

}  // namespace

void compute_constants(Program& program) {
  if (program.language != Language::kRs274) return;
  if (!has_block_of(program, ParseStatus::kAssignment) ||
      !has_block_of(program, ParseStatus::kExpression)) {
    return;
  }
  ConstantFinder(program).compute();
}

}  // namespace batten::gcode
