#include "postproc/stream/added_lines.h"

#include <fmt/format.h>

#include <algorithm>
#include <iterator>
#include <utility>

#include "gcode/text/characters.h"
#include "gcode/text/line_cursor.h"

namespace batten::postproc {
namespace {

using Lines = std::vector<std::string>;

std::vector<gcode::LineBounds> lines_in(std::string_view text) {
  std::vector<gcode::LineBounds> lines;
  gcode::LineCursor cursor(text);
  while (const auto line = cursor.next()) lines.push_back(*line);
  return lines;
}

bool contains_ignoring_case(std::string_view text, std::string_view upper_case) {
  const auto same = [](char a, char b) { return gcode::upper(a) == b; };
  return std::search(text.begin(), text.end(), upper_case.begin(), upper_case.end(), same) !=
         text.end();
}

bool has_key(const gcode::Program& program, const gcode::Block& block, const SettingKey& key) {
  if (!key.name.empty()) {
    const bool plain = block.opacity == gcode::ParseStatus::kNone;
    return !plain && contains_ignoring_case(program.source.text(block.span), key.name);
  }
  return std::ranges::any_of(program.words_of(block), [&](const gcode::Word& word) {
    return word.letter == key.letter && gcode::code_of(word) == key.code;
  });
}

class Taker {
 public:
  Taker(std::string_view text, const ProfileWords& words)
      : text_(text), lines_(lines_in(text)), words_(words) {}

  AddedLines run() {
    for (std::size_t i = 0; i < lines_.size();) {
      const std::size_t taken = take_at(i);
      if (taken == 0) copy(i);
      i += std::max<std::size_t>(taken, 1);
    }
    if (open_) {
      result_.violations.push_back({ViolationKind::kEvent, "profile-words-open", 0, open_line_, 0,
                                    "the words before a run without those after it"});
    }
    if (header_taken_ && !words_.footer.empty() && !footer_taken_) {
      result_.violations.push_back({ViolationKind::kEvent, "profile-words-open", 0, 1, 0,
                                    "the profile's header without its footer"});
    }
    return std::move(result_);
  }

 private:
  // Whether all of `wanted` stands from line `at` on.
  [[nodiscard]] bool stands_at(std::size_t at, const Lines& wanted) const {
    if (wanted.empty() || at + wanted.size() > lines_.size()) return false;
    for (std::size_t i = 0; i < wanted.size(); ++i) {
      const gcode::LineBounds& line = lines_[at + i];
      if (text_.substr(line.begin, line.text_end - line.begin) != wanted[i]) return false;
    }
    return true;
  }

  // How many lines were taken.
  std::size_t take_at(std::size_t at) {
    const bool footer_may_come = header_taken_ || words_.header.empty();
    if (!header_taken_ && !anything_taken_ && stands_at(at, words_.header)) {
      header_taken_ = true;
      return empty(at, words_.header.size());
    }
    if (open_ && stands_at(at, words_.after_run)) {
      open_ = false;
      result_.brackets.push_back({open_line_, static_cast<std::uint32_t>(at + 1)});
      return empty(at, words_.after_run.size());
    }
    if (!open_ && !footer_taken_ && stands_at(at, words_.before_run)) {
      open_ = true;
      open_line_ = static_cast<std::uint32_t>(at + words_.before_run.size());
      return empty(at, words_.before_run.size());
    }
    if (!open_ && !footer_taken_ && footer_may_come && stands_at(at, words_.footer)) {
      footer_taken_ = true;
      return empty(at, words_.footer.size());
    }
    return 0;
  }

  // The line ends stay.
  std::size_t empty(std::size_t at, std::size_t count) {
    for (std::size_t i = at; i < at + count; ++i) {
      result_.text += text_.substr(lines_[i].text_end, lines_[i].end - lines_[i].text_end);
    }
    result_.lines += count;
    anything_taken_ = true;
    return count;
  }

  void copy(std::size_t at) {
    result_.text += text_.substr(lines_[at].begin, lines_[at].end - lines_[at].begin);
  }

  std::string_view text_;
  std::vector<gcode::LineBounds> lines_;
  const ProfileWords& words_;
  AddedLines result_;
  bool header_taken_ = false;
  bool footer_taken_ = false;
  bool anything_taken_ = false;
  bool open_ = false;
  std::uint32_t open_line_ = 0;
};

}  // namespace

AddedLines take_added_lines(const gcode::Program& old_program, std::string_view new_text,
                            const ProfileWords& words) {
  AddedLines nothing;
  nothing.text = new_text;
  if (words.empty()) return nothing;
  const std::uint32_t line = line_with_words_of(old_program, words);
  if (line == 0) return Taker(new_text, words).run();
  nothing.violations.push_back(
      {ViolationKind::kEvent, "profile-words-in-program", line, 0, 0,
       "the old program has words of the profile itself; expected them in one of the two"});
  return nothing;
}

std::uint32_t line_with_words_of(const gcode::Program& program, const ProfileWords& words) {
  const std::vector<SettingKey> keys = setting_keys(words);
  if (keys.empty()) return 0;
  for (const gcode::Block& block : program.blocks) {
    for (const SettingKey& key : keys) {
      if (has_key(program, block, key)) return block.line;
    }
  }
  return 0;
}

std::vector<Violation> events_in_brackets(const ReadProgram& read,
                                          const std::vector<LineBracket>& brackets) {
  std::vector<Violation> violations;
  if (brackets.empty()) return violations;
  const ProgramEvents list = list_events(read);
  std::size_t next = 0;
  for (const LineBracket& bracket : brackets) {
    const auto line_of = [&](std::size_t i) {
      return read.program->blocks[list.events[i].block].line;
    };
    while (next < list.events.size() && line_of(next) <= bracket.before) ++next;
    if (next < list.events.size() && line_of(next) < bracket.after) {
      violations.push_back(
          {ViolationKind::kEvent, "profile-words-around-event", 0, line_of(next), 0,
           fmt::format("between the words before and after a run (lines {} and {}) "
                       "something acts that is no cutting move",
                       bracket.before, bracket.after)});
    }
  }
  return violations;
}

}  // namespace batten::postproc
