#include "gcode/klartext/flow.h"

#include <algorithm>
#include <cstddef>
#include <string>
#include <string_view>
#include <unordered_map>

#include "gcode/klartext/statement.h"
#include "gcode/text/characters.h"

namespace batten::gcode {
namespace {

class KlartextFlow {
 public:
  explicit KlartextFlow(const Program& program) : program_(program), flow_(program.blocks.size()) {}

  std::vector<BlockFlow> find() {
    for (std::size_t i = 0; i < program_.blocks.size(); ++i) {
      if (program_.blocks[i].opacity == ParseStatus::kFlow) read_statement(i);
    }
    mark_bodies();
    return std::move(flow_);
  }

 private:
  void read_statement(std::size_t i) {
    const std::string_view text = program_.source.text();
    const std::string_view content =
        program_.source.text(klartext_parts(text, program_.blocks[i].span).content);
    switch (klartext_kind(content)) {
      case KlartextKind::kLabel:
        return add_label(word_of(content, 1), i);
      case KlartextKind::kCallLabel:
        return add_reference(word_of(content, 2), i);
      case KlartextKind::kJump:
        return add_jumps(content, i);
      default:
        return;
    }
  }

  void add_label(std::string name, std::size_t i) {
    if (name == "0") {
      ends_.push_back(i);
    } else {
      labels_.emplace_back(i, std::move(name));
    }
  }

  // FN 9: IF +Q1 EQU +Q3 GOTO LBL 5
  void add_jumps(std::string_view content, std::size_t i) {
    KlartextTokens tokens(content);
    for (std::string_view token = tokens.next(); !token.empty(); token = tokens.next()) {
      if (is_same_word(token, "LBL")) add_reference(as_name(tokens.next()), i);
    }
  }

  void add_reference(const std::string& name, std::size_t i) {
    const bool computed = name.empty() || name.starts_with('Q');
    any_reference_ = std::max(any_reference_, computed ? i + 1 : 0);
    std::size_t& last = references_[name];
    last = std::max(last, i);
  }

  static std::string word_of(std::string_view content, int number) {
    KlartextTokens tokens(content);
    for (int k = 0; k < number; ++k) (void)tokens.next();
    return as_name(tokens.next());
  }

  // Names may be quoted; 01 is 1.
  static std::string as_name(std::string_view token) {
    std::string name = in_capitals(token);
    std::erase(name, '"');
    if (!std::ranges::all_of(name, is_digit)) return name;
    while (name.size() > 1 && name[0] == '0') name.erase(0, 1);
    return name;
  }

  void mark_bodies() {
    std::size_t reach = 0;  // behind the last block of the bodies that have begun
    auto label = labels_.begin();
    for (std::size_t i = 0; i < flow_.size(); ++i) {
      if (label != labels_.end() && label->first == i) {
        reach = std::max(reach, body_end(label->first, label->second));
        ++label;
        flow_[i].jump_target = reach > i;
      }
      flow_[i].in_body = i < reach;
    }
  }

  // Behind the last block of its body; 0 for a label that nothing names.
  [[nodiscard]] std::size_t body_end(std::size_t label, const std::string& name) const {
    const auto named = references_.find(name);
    if (named == references_.end() && any_reference_ == 0) return 0;
    std::size_t end = std::max(label + 1, any_reference_);
    if (named != references_.end()) end = std::max(end, named->second + 1);
    const auto closed = std::ranges::lower_bound(ends_, label);
    return closed == ends_.end() ? end : std::max(end, *closed + 1);
  }

  const Program& program_;
  std::vector<BlockFlow> flow_;
  std::vector<std::pair<std::size_t, std::string>> labels_;  // with their blocks
  std::vector<std::size_t> ends_;                            // LBL 0
  std::unordered_map<std::string, std::size_t> references_;  // the last block that names it
  std::size_t any_reference_ = 0;  // behind the last block that names a computed label
};

}  // namespace

std::string klartext_call(std::string_view content) {
  KlartextTokens tokens(content);
  (void)tokens.next();  // CALL
  const std::string_view pgm = tokens.next();
  const auto begin = static_cast<std::size_t>(pgm.data() + pgm.size() - content.data());
  std::string name = in_capitals(content.substr(begin, content.find(';', begin) - begin));
  std::erase(name, '"');
  while (!name.empty() && is_blank(name.back())) name.pop_back();
  name.erase(0, name.find_first_not_of(" \t"));
  if (name.ends_with(".H")) name.resize(name.size() - 2);
  return name.empty() ? name : "CALL PGM " + name;
}

std::vector<BlockFlow> find_klartext_flow(const Program& program) {
  return KlartextFlow(program).find();
}

}  // namespace batten::gcode
