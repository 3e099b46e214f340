#include "gcode/reading/part_reading.h"

#include <algorithm>
#include <cstddef>
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

void take_rest_of_text(Program& program, std::uint32_t first, Program& rest) {
  const bool any = first < program.blocks.size();
  const std::size_t word = any ? program.blocks[first].first_word : program.words.size();
  const std::size_t comment = any ? program.blocks[first].first_comment : program.comments.size();
  move_rest(program.blocks, first, rest.blocks);
  move_rest(program.words, word, rest.words);
  move_rest(program.comments, comment, rest.comments);
  for (Block& block : rest.blocks) {
    block.first_word -= static_cast<std::uint32_t>(word);
    block.first_comment -= static_cast<std::uint32_t>(comment);
  }
}

void take_rest_of_meaning(Interpretation& meaning, std::uint32_t first, Interpretation& rest) {
  const std::uint32_t state = first > 0 ? meaning.blocks[first - 1].state_after : 0;
  const auto motion = static_cast<std::size_t>(
      std::ranges::lower_bound(meaning.motions, first, {}, &Motion::block) -
      meaning.motions.begin());
  move_rest(meaning.blocks, first, rest.blocks);
  move_rest(meaning.motions, motion, rest.motions);
  rest.states.assign(meaning.states.begin() + state, meaning.states.end());
  meaning.states.resize(state + 1);
  rest.unit_word_seen = meaning.unit_word_seen;
  for (BlockMeaning& block : rest.blocks) {
    block.state_after -= state;
    if (block.motion >= 0) block.motion -= static_cast<std::int32_t>(motion);
  }
  for (Motion& each : rest.motions) each.block -= first;
}

void append_text(Program& program, Program& more) {
  const auto words = static_cast<std::uint32_t>(program.words.size());
  const auto comments = static_cast<std::uint32_t>(program.comments.size());
  for (Block& block : more.blocks) {
    block.first_word += words;
    block.first_comment += comments;
  }
  move_behind(program.blocks, more.blocks);
  move_behind(program.words, more.words);
  move_behind(program.comments, more.comments);
}

// The first state of `more` is the last one of the part.
void append_meaning(Interpretation& meaning, Interpretation& more) {
  const auto blocks = static_cast<std::uint32_t>(meaning.blocks.size());
  const auto motions = static_cast<std::int32_t>(meaning.motions.size());
  const auto states = static_cast<std::uint32_t>(meaning.states.size() - 1);
  for (BlockMeaning& block : more.blocks) {
    block.state_after += states;
    if (block.motion >= 0) block.motion += motions;
  }
  for (Motion& each : more.motions) each.block += blocks;
  move_behind(meaning.blocks, more.blocks);
  move_behind(meaning.motions, more.motions);
  meaning.states.insert(meaning.states.end(), more.states.begin() + 1, more.states.end());
  meaning.unit_word_seen = more.unit_word_seen;
}

}  // namespace

ReadPart take_rest(ReadPart& part, std::uint32_t first) {
  ReadPart rest{{part.program.source,
                 {},
                 {},
                 {},
                 part.program.language,
                 part.program.decimals,
                 part.program.dwells},
                {}};
  take_rest_of_text(part.program, first, rest.program);
  take_rest_of_meaning(part.meaning, first, rest.meaning);
  return rest;
}

void append(ReadPart& part, ReadPart more) {
  if (part.program.blocks.empty()) {
    part = std::move(more);
    return;
  }
  append_text(part.program, more.program);
  append_meaning(part.meaning, more.meaning);
}

}  // namespace batten::gcode
