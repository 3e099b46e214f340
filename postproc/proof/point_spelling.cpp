#include "postproc/proof/point_spelling.h"

#include <fmt/format.h>

#include <cstddef>
#include <set>
#include <string_view>
#include <utility>

#include "gcode/reading/part_reading.h"

namespace batten::postproc {

namespace {

constexpr std::size_t kPartBlocks = 8192;

bool is_pointless(const gcode::Word& word) { return word.without_point; }

bool is_pointed(const gcode::Word& word) {
  constexpr std::string_view kNumbers = "XYZUVWIJKRQF";
  return word.has_point && word.is_number && word.value != 0 &&
         kNumbers.find(word.letter) != std::string_view::npos;
}

bool ends_with_point(const gcode::Word& word) { return word.has_point && word.decimals == 0; }

// Calls `look(word, block)` for each length and feed but zeros, as long as it gives true.
template <typename Look>
void for_each_number(const gcode::SourceText& source, const Look& look) {
  gcode::TextCarry carry;
  const gcode::Decimals either{.pointless = gcode::PointlessNumbers::kUndeclared};
  carry.decimals = {either, gcode::Units::kUnknown};
  gcode::Diagnostics of_text;
  for (;;) {
    const std::uint32_t begin = carry.begin;
    const gcode::Program part = gcode::parse_part(source, {.blocks = kPartBlocks}, carry, of_text);
    if (part.blocks.empty()) return;
    for (const gcode::Block& block : part.blocks) {
      for (const gcode::Word& word : part.words_of(block)) {
        if ((is_pointless(word) || is_pointed(word)) && !look(word, block)) return;
      }
    }
    source.release_pages({begin, carry.begin});
  }
}

// How a program writes its lengths, or its feeds.
struct Spelling {
  bool any_point = false;
  bool any_without = false;
  bool any_bare_point = false;
  std::set<std::pair<char, double>> always_with_bare_point;
};

// Many write the ones with a point and the others without.
struct Spellings {
  Spelling lengths;
  Spelling feeds;
  Spelling& of(const gcode::Word& word) { return word.letter == 'F' ? feeds : lengths; }
};

Spellings spellings_of(const gcode::SourceText& source) {
  Spellings all;
  for_each_number(source, [&](const gcode::Word& word, const gcode::Block&) {
    Spelling& found = all.of(word);
    (word.has_point ? found.any_point : found.any_without) = true;
    if (ends_with_point(word)) found.always_with_bare_point.emplace(word.letter, word.value);
    return true;
  });
  bool any_mixed = false;
  for (Spelling* found : {&all.lengths, &all.feeds}) {
    found->any_bare_point = !found->always_with_bare_point.empty();
    any_mixed = any_mixed || (found->any_bare_point && found->any_without);
  }
  if (!any_mixed) return all;
  for_each_number(source, [&](const gcode::Word& word, const gcode::Block&) {
    if (!word.has_point) all.of(word).always_with_bare_point.erase({word.letter, word.value});
    return true;
  });
  return all;
}

bool is_other(const gcode::Word& word, const Spelling& before) {
  if (word.has_point) return ends_with_point(word) && before.any_without && !before.any_point;
  return before.any_bare_point &&
         (!before.any_without || before.always_with_bare_point.contains({word.letter, word.value}));
}

}  // namespace

std::optional<Violation> other_point_spelling(const gcode::SourceText& before,
                                              const gcode::SourceText& after) {
  Spellings spellings = spellings_of(before);
  std::optional<Violation> violation;
  for_each_number(after, [&](const gcode::Word& word, const gcode::Block& block) {
    if (!is_other(word, spellings.of(word))) return true;
    violation.emplace();
    violation->kind = ViolationKind::kNotProved;
    violation->id = "point-spelling";
    violation->new_line = block.line;
    violation->message = fmt::format(
        "found {} {} a decimal point, expected it {} one, as in the old program: some controls "
        "take X5. for 5 mm and X5 for 0.005 mm. Say which control it is for (--target or "
        "--source), or --decimals",
        after.text(word.span), word.has_point ? "with" : "without",
        word.has_point ? "without" : "with");
    return false;
  });
  return violation;
}

}  // namespace batten::postproc
