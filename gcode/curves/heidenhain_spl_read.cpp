#include <algorithm>
#include <cmath>
#include <numbers>
#include <string>
#include <utility>

#include "gcode/curves/bezier_chain.h"
#include "gcode/curves/heidenhain_spl.h"
#include "gcode/curves/heidenhain_spl_words.h"
#include "gcode/state/units.h"

namespace batten::gcode {
namespace {

using geometry::CubicBezier;
using geometry::Point3;
using geometry::Vector3;

// Decimals of the same number, as doubles, differ by less (mm).
constexpr double kDecimalNoise = 1e-9;

// The words that a spline of ours has: no rotary axes, no M.
bool only_main_axes(const SplWords& block) {
  return std::all_of(block.words.begin() + 1, block.words.end(), [](const KlartextWord& word) {
    const char axis = word.name.back();
    const bool main = axis >= 'X' && axis <= 'Z';
    return word.is("F") ? word.value.has_value()
                        : main && (is_spl_end(word) || is_spl_coefficient(word));
  });
}

}  // namespace

Point3 SplBlock::point_at(double t) const { return end + t * (k[0] + t * (k[1] + t * k[2])); }

CubicBezier SplBlock::piece() const {
  return {{point_at(1), end + (2 * k[0] + k[1]) / 3, end + k[0] / 3, end}};
}

std::variant<SplText, CurveRefusal> read_spl_text(const Program& program, std::uint32_t first,
                                                  const CurveStart& start) {
  const double unit = millimetres_per(start.units);
  SplText text;
  Point3 place = start.position.mm;
  for (std::uint32_t at = first; at < program.blocks.size();) {
    const SplWords joined = joined_at(program, at);
    if (!joined.is("SPL")) break;
    if (!joined.understood || !spl_word_trouble(joined).empty() || !only_main_axes(joined)) {
      if (text.pieces.empty()) return CurveRefusal{"an SPL block that is not understood"};
      break;
    }
    const SplBlock block = spl_block_of(joined, at, place, unit);
    if (block.feed && !text.pieces.empty()) break;
    for (std::size_t axis = 0; axis < 3; ++axis) {
      if (block.axes[axis] && !start.position.known[axis]) {
        return CurveRefusal{"where the tool stands is not known"};
      }
    }
    if ((block.point_at(1) - place).cwiseAbs().maxCoeff() >= kSplClosure) {
      return CurveRefusal{"a spline that starts 1 um or more from where the tool stands"};
    }
    place = block.end;
    text.blocks += joined.lines;
    at += joined.lines;
    text.pieces.push_back(block);
  }
  if (text.pieces.empty()) return CurveRefusal{"no SPL"};
  return text;
}

CurveResult read_spl(const Program& program, std::uint32_t first, const CurveStart& start) {
  auto read = read_spl_text(program, first, start);
  if (auto* refusal = std::get_if<CurveRefusal>(&read)) return std::move(*refusal);
  const SplText& text = std::get<SplText>(read);
  CurveReading reading;
  reading.blocks = text.blocks;
  reading.feed = text.pieces.front().feed;
  Point3 place = start.position.mm;
  for (const SplBlock& block : text.pieces) {
    CubicBezier piece = block.piece();
    if ((piece.control[0] - place).cwiseAbs().maxCoeff() <= kDecimalNoise) {
      piece.control[0] = place;
    }
    place = block.end;
    reading.motions.push_back({block.block, piece});
    for (std::size_t axis = 0; axis < 3; ++axis) {
      reading.axes[axis] = reading.axes[axis] || block.axes[axis];
    }
  }
  return reading;
}

}  // namespace batten::gcode
