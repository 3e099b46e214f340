#include "postproc/stream/assembly.h"

#include <fmt/format.h>

#include <algorithm>
#include <cstdint>
#include <iterator>
#include <limits>
#include <optional>
#include <utility>

#include "gcode/text/characters.h"
#include "gcode/text/line_cursor.h"
#include "gcode/writer/writer.h"

namespace batten::postproc {
namespace {

constexpr std::uint32_t kNowhere = std::numeric_limits<std::uint32_t>::max();

bool says_something(const gcode::Block& block) {
  return block.opacity != gcode::ParseStatus::kProgramMark &&
         (block.word_count > 0 || block.opacity != gcode::ParseStatus::kNone);
}

bool ends_program(const gcode::Program& program, const gcode::Block& block) {
  return std::ranges::any_of(program.words_of(block), [](const gcode::Word& word) {
    return word.letter == 'M' && (word.value == 2 || word.value == 30 || word.value == 99);
  });
}

class Assembler {
 public:
  Assembler(const gcode::Program& program, std::span<const Section> sections,
            std::span<const RunState> works, const Additions& additions,
            const gcode::Control& target)
      : program_(program),
        sections_(sections),
        works_(works),
        additions_(additions),
        target_(target) {}

  AssembledText run() {
    if (program_.blocks.empty()) return {};
    const auto chosen = [](const RunState& work) { return work.chosen() != nullptr; };
    if (std::ranges::any_of(works_, chosen)) {
      header_at_ = header_begin();
      footer_at_ = footer_begin();
    }
    text_.reserve(end() - program_.blocks.front().span.begin);
    std::size_t next = 0;
    for (std::size_t i = 0; i < sections_.size(); ++i) {
      const RunState* work =
          next < works_.size() && works_[next].section == i ? &works_[next] : nullptr;
      if (work != nullptr) ++next;
      begins_.push_back(text_.size());
      add(sections_[i], work);
    }
    leave_runs();
    if (footer_at_ == end()) {
      if (!additions_.words.footer.empty() && !text_.ends_with('\n')) text_ += line_end_;
      add_lines(additions_.words.footer, line_end_);
    }
    return {std::move(text_), std::move(begins_)};
  }

 private:
  [[nodiscard]] std::uint32_t end() const { return program_.blocks.back().end; }

  void add(const Section& section, const RunState* work) {
    const Candidate* chosen = work != nullptr ? work->chosen() : nullptr;
    if (chosen == nullptr) return copy(section);
    line_end_ = work->context.line_end;
    const std::uint32_t begin = program_.blocks[section.first_block].span.begin;
    const bool starts_program =
        header_at_ >= begin && header_at_ < program_.blocks[section.last_block].end;
    if (starts_program) add_lines(additions_.words.header, line_end_);
    std::string text = chosen->text.text;
    if (!std::exchange(commented_, true) && !additions_.comment.empty() &&
        !(chosen->form != Form::kCurves && add_comment_behind(text))) {
      add_comment(work->context.numbers.first, text);
    }
    if (!std::exchange(in_runs_, true)) add_lines(additions_.words.before_run, line_end_);
    text_ += text;
  }

  // Behind the words of the first line. Returns false and changes nothing where it has a comment
  // already or no room for one.
  [[nodiscard]] bool add_comment_behind(std::string& text) const {
    const std::size_t end = text.find(line_end_);
    if (end == 0 || end == std::string::npos) return false;
    const std::string line = text.substr(0, end);
    if (line.find_first_of("(;") != std::string::npos) return false;
    const auto both = with_comment(target_, line, additions_.comment);
    if (both) text.replace(0, end, *both);
    return both.has_value();
  }

  // On a line of its own. Where blocks have numbers it takes the first one, and those of `text`
  // follow it.
  void add_comment(const std::optional<std::uint32_t>& number, std::string& text) {
    std::string comment = additions_.comment + std::string(line_end_);
    if (number) {
      comment = with_numbers(comment, *number);
      text = with_numbers(text, *number + 1);
    }
    text_ += comment;
  }

  void copy(const Section& section) {
    leave_runs();
    std::uint32_t begin = program_.blocks[section.first_block].span.begin;
    const std::uint32_t end = program_.blocks[section.last_block].end;
    for (const auto& [at, lines] : {std::pair(header_at_, &additions_.words.header),
                                    std::pair(footer_at_, &additions_.words.footer)}) {
      if (at < begin || at >= end) continue;
      text_ += program_.source.text({begin, at});
      add_lines(*lines, line_end_near(at));
      begin = at;
    }
    text_ += program_.source.text({begin, end});
  }

  void leave_runs() {
    if (std::exchange(in_runs_, false)) add_lines(additions_.words.after_run, line_end_);
  }

  void add_lines(const std::vector<std::string>& lines, std::string_view line_end) {
    for (const std::string& line : lines) {
      text_ += line;
      text_ += line_end;
    }
  }

  // How the line that begins there ends; the one before it where that is the last and has no end.
  [[nodiscard]] std::string_view line_end_near(std::uint32_t at) const {
    std::string_view ending;
    for (const gcode::Block& block : program_.blocks) {
      if (block.end > block.span.end) ending = program_.source.text({block.span.end, block.end});
      if (block.span.begin >= at) break;
    }
    return gcode::written_line_end(ending);
  }

  [[nodiscard]] bool is_rewritten(const gcode::Block& block) const {
    return std::ranges::any_of(works_, [&](const RunState& work) {
      const Section& section = sections_[work.section];
      return work.chosen() != nullptr &&
             block.span.begin >= program_.blocks[section.first_block].span.begin &&
             block.span.begin < program_.blocks[section.last_block].end;
    });
  }

  [[nodiscard]] std::uint32_t header_begin() const {
    const auto found = std::ranges::find_if(program_.blocks, says_something);
    return found == program_.blocks.end() ? 0 : found->span.begin;
  }

  [[nodiscard]] std::uint32_t footer_begin() const {
    const auto last = std::ranges::find_if(
        program_.blocks.rbegin(), program_.blocks.rend(), [this](const gcode::Block& block) {
          return ends_program(program_, block) && !is_rewritten(block);
        });
    if (last != program_.blocks.rend()) return last->span.begin;
    const gcode::Block& closing = program_.blocks.back();
    return closing.opacity == gcode::ParseStatus::kProgramMark ? closing.span.begin : end();
  }

  const gcode::Program& program_;
  std::span<const Section> sections_;
  std::span<const RunState> works_;
  const Additions& additions_;
  const gcode::Control& target_;
  std::string text_;
  std::vector<std::size_t> begins_;
  std::string_view line_end_ = "\n";  // of the last rewritten run
  std::uint32_t header_at_ = kNowhere;
  std::uint32_t footer_at_ = kNowhere;
  bool commented_ = false;
  bool in_runs_ = false;
};

}  // namespace

AssembledText assemble(const gcode::Program& program, std::span<const Section> sections,
                       std::span<const RunState> works, const Additions& additions,
                       const gcode::Control& target) {
  return Assembler(program, sections, works, additions, target).run();
}

namespace {

std::vector<gcode::LineBounds> lines_in(std::string_view text) {
  std::vector<gcode::LineBounds> lines;
  gcode::LineCursor cursor(text);
  while (const auto line = cursor.next()) lines.push_back(*line);
  return lines;
}

bool has_key(const gcode::Program& program, const gcode::Block& block, const SettingKey& key) {
  if (!key.name.empty()) {  // in capitals
    const auto same = [](char a, char b) { return gcode::upper(a) == b; };
    const std::string_view text = program.source.text(block.span);
    return block.opacity != gcode::ParseStatus::kNone &&
           std::search(text.begin(), text.end(), key.name.begin(), key.name.end(), same) !=
               text.end();
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
    for (std::size_t at = 0; at < lines_.size();) {
      if (take_at(at)) continue;
      result_.text += text_.substr(lines_[at].begin, lines_[at].end - lines_[at].begin);
      ++at;
    }
    if (open_line_ > 0) add_violation(open_line_, "the words before a run without those after it");
    if (header_taken_ && !words_.footer.empty() && !footer_taken_) {
      add_violation(1, "the profile's header without its footer");
    }
    return std::move(result_);
  }

 private:
  void add_violation(std::uint32_t line, const char* message) {
    result_.violations.push_back(
        {ViolationKind::kEvent, "profile-words-open", 0, line, 0, message});
  }

  bool take_at(std::size_t& at) {
    const auto first_line = static_cast<std::uint32_t>(at + 1);
    if (result_.lines == 0 && take(words_.header, at)) return header_taken_ = true;
    if (open_line_ > 0) {
      if (!take(words_.after_run, at)) return false;
      result_.brackets.push_back({std::exchange(open_line_, 0), first_line});
      return true;
    }
    if (footer_taken_) return false;
    if (take(words_.before_run, at)) {
      open_line_ = static_cast<std::uint32_t>(at);
      return true;
    }
    footer_taken_ = (header_taken_ || words_.header.empty()) && take(words_.footer, at);
    return footer_taken_;
  }

  // Where all of `wanted` is from line `at` on: goes past it. The line ends stay.
  bool take(const std::vector<std::string>& wanted, std::size_t& at) {
    if (wanted.empty() || at + wanted.size() > lines_.size()) return false;
    std::string ends;
    for (std::size_t i = 0; i < wanted.size(); ++i) {
      const gcode::LineBounds& line = lines_[at + i];
      if (text_.substr(line.begin, line.text_end - line.begin) != wanted[i]) return false;
      ends += text_.substr(line.text_end, line.end - line.text_end);
    }
    result_.text += ends;
    result_.lines += wanted.size();
    at += wanted.size();
    return true;
  }

  std::string_view text_;
  std::vector<gcode::LineBounds> lines_;
  const ProfileWords& words_;
  AddedLines result_;
  bool header_taken_ = false;
  bool footer_taken_ = false;
  std::uint32_t open_line_ = 0;  // the last line before a run; 0: no words are open
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
  for (const gcode::Block& block : program.blocks) {
    const auto is_in_block = [&](const SettingKey& key) { return has_key(program, block, key); };
    if (std::ranges::any_of(keys, is_in_block)) return block.line;
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
