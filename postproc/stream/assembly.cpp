#include "postproc/stream/assembly.h"

#include <algorithm>
#include <cstdint>
#include <optional>
#include <utility>
#include <vector>

#include "gcode/text/line_cursor.h"

namespace batten::postproc {
namespace {

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
            std::span<const RunState> works, const Additions& additions)
      : program_(program), sections_(sections), works_(works), additions_(additions) {}

  AssembledText run() {
    const std::string_view source = bytes();
    if (!anything_rewritten()) {
      for (const Section& section : sections_) {
        begins_.push_back(program_.blocks[section.first_block].span.begin -
                          program_.blocks.front().span.begin);
      }
      return {std::string(source), std::move(begins_)};
    }
    text_.reserve(source.size());
    comment_ = additions_.comment;
    header_at_ = header_place();
    footer_at_ = footer_place();
    std::size_t next = 0;
    for (std::size_t i = 0; i < sections_.size(); ++i) {
      const RunState* work =
          next < works_.size() && works_[next].section == i ? &works_[next] : nullptr;
      if (work != nullptr) ++next;
      begins_.push_back(text_.size());
      add(sections_[i], work);
    }
    leave_runs(line_end_);
    if (footer_at_ == end()) {
      if (!additions_.words.footer.empty() && !text_.ends_with('\n')) {
        text_ += line_end_;
      }
      add_lines(additions_.words.footer, line_end_);
    }
    return {std::move(text_), std::move(begins_)};
  }

 private:
  [[nodiscard]] std::uint32_t end() const {
    return program_.blocks.empty() ? 0 : program_.blocks.back().end;
  }
  [[nodiscard]] std::string_view bytes() const {
    const std::uint32_t begin = program_.blocks.empty() ? 0 : program_.blocks.front().span.begin;
    return program_.source.text({begin, end()});
  }

  [[nodiscard]] bool anything_rewritten() const {
    return std::ranges::any_of(works_,
                               [](const RunState& work) { return work.chosen() != nullptr; });
  }

  void add(const Section& section, const RunState* work) {
    const Candidate* chosen = work != nullptr ? work->chosen() : nullptr;
    if (chosen == nullptr) return copy(section);
    line_end_ = work->context.line_end;
    const std::uint32_t begin = program_.blocks[section.first_block].span.begin;
    const bool starts_program =
        header_at_ >= begin && header_at_ < program_.blocks[section.last_block].end;
    if (starts_program) add_lines(additions_.words.header, line_end_);
    std::string text = chosen->text.text;
    if (!comment_.empty()) add_comment(work->context.numbers.first, text);
    if (!std::exchange(in_runs_, true)) add_lines(additions_.words.before_run, line_end_);
    text_ += text;
  }

  // Where blocks have numbers it takes the first one, and those of `text` follow it.
  void add_comment(const std::optional<std::uint32_t>& number, std::string& text) {
    std::string comment = std::exchange(comment_, {}) + std::string(line_end_);
    if (number) {
      comment = with_numbers(comment, *number);
      text = with_numbers(text, *number + 1);
    }
    text_ += comment;
  }

  void copy(const Section& section) {
    leave_runs(line_end_);
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

  void leave_runs(std::string_view line_end) {
    if (std::exchange(in_runs_, false)) add_lines(additions_.words.after_run, line_end);
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

  [[nodiscard]] std::uint32_t header_place() const {
    const auto found = std::ranges::find_if(program_.blocks, says_something);
    return found == program_.blocks.end() ? 0 : found->span.begin;
  }

  [[nodiscard]] std::uint32_t footer_place() const {
    const auto last = std::ranges::find_if(
        program_.blocks.rbegin(), program_.blocks.rend(), [this](const gcode::Block& block) {
          return ends_program(program_, block) && !is_rewritten(block);
        });
    if (last != program_.blocks.rend()) return last->span.begin;
    if (!program_.blocks.empty() &&
        program_.blocks.back().opacity == gcode::ParseStatus::kProgramMark) {
      return program_.blocks.back().span.begin;
    }
    return end();
  }

  const gcode::Program& program_;
  std::span<const Section> sections_;
  std::span<const RunState> works_;
  const Additions& additions_;
  std::string text_;
  std::vector<std::size_t> begins_;
  std::string comment_;
  std::string_view line_end_ = "\n";  // of the last rewritten run
  std::uint32_t header_at_ = 0;
  std::uint32_t footer_at_ = 0;
  bool in_runs_ = false;
};

}  // namespace

AssembledText assemble(const gcode::Program& program, std::span<const Section> sections,
                       std::span<const RunState> works, const Additions& additions) {
  return Assembler(program, sections, works, additions).run();
}

}  // namespace batten::postproc
