#include "gcode/reading/part_reading.h"

#include <algorithm>
#include <iterator>
#include <string_view>
#include <utility>
#include <vector>

namespace batten::gcode {

std::optional<std::uint32_t> end_of_lines(const SourceText& source, std::uint32_t begin,
                                          std::size_t bytes, std::size_t longest_rest) {
  const std::string_view text = source.text();
  if (text.size() - begin <= bytes) return static_cast<std::uint32_t>(text.size());
  const std::size_t from = begin + bytes;
  const std::size_t feed = text.substr(from, longest_rest).find('\n');
  if (feed == std::string_view::npos) return std::nullopt;
  return static_cast<std::uint32_t>(from + feed + 1);
}

namespace {

template <typename Item>
void move_rest(std::vector<Item>& items, std::size_t first, std::vector<Item>& rest) {
  const auto begin = items.begin() + static_cast<std::ptrdiff_t>(first);
  rest.assign(std::make_move_iterator(begin), std::make_move_iterator(items.end()));
  items.erase(begin, items.end());
}

template <typename Item>
void move_behind(std::vector<Item>& items, std::vector<Item>& more) {
  items.insert(items.end(), std::make_move_iterator(more.begin()),
               std::make_move_iterator(more.end()));
}

// Where the words, comments, states, motions and blocks of a part begin that is put behind another
// one; subtracted, they become its own.
struct Offsets {
  std::uint32_t words = 0;
  std::uint32_t comments = 0;
  std::uint32_t states = 0;
  std::uint32_t motions = 0;
  std::uint32_t blocks = 0;
};

// `sign`: 1 or -1; unsigned numbers wrap.
void move_by(const Offsets& by, std::uint32_t sign, ReadPart& part) {
  for (Block& block : part.program.blocks) {
    block.first_word += sign * by.words;
    block.first_comment += sign * by.comments;
  }
  for (BlockMeaning& block : part.meaning.blocks) {
    block.state_after += sign * by.states;
    if (block.motion >= 0) block.motion += static_cast<std::int32_t>(sign * by.motions);
  }
  for (Motion& each : part.meaning.motions) each.block += sign * by.blocks;
  for (StatedAt& each : part.meaning.stated) each.block += sign * by.blocks;
}

}  // namespace

ReadPart take_rest(ReadPart& part, std::uint32_t first) {
  auto& [program, meaning] = part;
  const bool any = first < program.blocks.size();
  Offsets at;
  at.words =
      any ? program.blocks[first].first_word : static_cast<std::uint32_t>(program.words.size());
  at.comments = any ? program.blocks[first].first_comment
                    : static_cast<std::uint32_t>(program.comments.size());
  at.states = first > 0 ? meaning.blocks[first - 1].state_after : 0;
  at.motions = static_cast<std::uint32_t>(
      std::ranges::lower_bound(meaning.motions, first, {}, &Motion::block) -
      meaning.motions.begin());
  at.blocks = first;
  ReadPart rest{{program.source, {}, {}, {}, program.language, program.decimals, program.dwells},
                {}};
  move_rest(program.blocks, first, rest.program.blocks);
  move_rest(program.words, at.words, rest.program.words);
  move_rest(program.comments, at.comments, rest.program.comments);
  move_rest(meaning.blocks, first, rest.meaning.blocks);
  move_rest(meaning.motions, at.motions, rest.meaning.motions);
  const auto stated = std::ranges::lower_bound(meaning.stated, first, {}, &StatedAt::block);
  move_rest(meaning.stated, static_cast<std::size_t>(stated - meaning.stated.begin()),
            rest.meaning.stated);
  rest.meaning.states.assign(meaning.states.begin() + at.states, meaning.states.end());
  meaning.states.resize(at.states + 1);
  rest.meaning.unit_word_seen = meaning.unit_word_seen;
  move_by(at, -1U, rest);
  return rest;
}

void append(ReadPart& part, ReadPart more) {
  auto& [program, meaning] = part;
  if (program.blocks.empty()) {
    part = std::move(more);
    return;
  }
  const auto size = [](const auto& items) { return static_cast<std::uint32_t>(items.size()); };
  // The first state of `more` is the last one of the part.
  move_by({size(program.words), size(program.comments), size(meaning.states) - 1,
           size(meaning.motions), size(meaning.blocks)},
          1, more);
  move_behind(program.blocks, more.program.blocks);
  move_behind(program.words, more.program.words);
  move_behind(program.comments, more.program.comments);
  move_behind(meaning.blocks, more.meaning.blocks);
  move_behind(meaning.motions, more.meaning.motions);
  move_behind(meaning.stated, more.meaning.stated);
  meaning.states.insert(meaning.states.end(), more.meaning.states.begin() + 1,
                        more.meaning.states.end());
  meaning.unit_word_seen = more.meaning.unit_word_seen;
}

}  // namespace batten::gcode
