// The words of one SPL block, whose lines are joined, before what they say is judged.
#pragma once

#include <cstdint>
#include <string_view>
#include <vector>

#include "gcode/curves/heidenhain_spl.h"
#include "gcode/curves/klartext_words.h"
#include "gcode/text/program.h"
#include "geometry/basic/point.h"

namespace batten::gcode {

inline constexpr std::string_view kSplAxes = "XYZUVWABC";

[[nodiscard]] bool is_spl_coefficient(const KlartextWord& word);  // K1X ..
[[nodiscard]] bool is_spl_end(const KlartextWord& word);          // X with a value ..

// The lines of one block, joined.
struct SplWords {
  std::vector<KlartextWord> words;
  std::uint32_t lines = 0;
  bool understood = true;

  [[nodiscard]] bool is(std::string_view keyword) const {
    return !words.empty() && words.front().is(keyword);
  }
};

// The block that begins in line `first`, whether it is an SPL or not.
[[nodiscard]] SplWords joined_at(const Program& program, std::uint32_t first);

// What is wrong with the words of a spline, as the id of an alarm; empty where nothing is.
[[nodiscard]] std::string_view spl_word_trouble(const SplWords& block);

// What the block says that begins in line `at`, where the tool stands at `place` (mm). Requires
// words without trouble.
[[nodiscard]] SplBlock spl_block_of(const SplWords& joined, std::uint32_t at,
                                    const geometry::Point3& place, double unit);

}  // namespace batten::gcode
