#include <algorithm>
#include <cmath>
#include <string>
#include <utility>

#include "gcode/curves/bezier_chain.h"
#include "gcode/curves/siemens_poly.h"
#include "gcode/curves/siemens_poly_words.h"
#include "gcode/state/units.h"

namespace batten::gcode {
namespace {

using geometry::Point3;

double value_of(const std::vector<double>& coefficients, double p) {
  double value = 0;
  for (std::size_t i = coefficients.size(); i-- > 0;) value = value * p + coefficients[i];
  return value;
}

class PolyReader {
 public:
  PolyReader(const Program& program, const CurveStart& start)
      : program_(program), unit_(millimetres_per(start.units)), place_(start.position) {}

  std::variant<PolyText, CurveRefusal> read(std::uint32_t first) {
    for (std::uint32_t at = first; at < program_.blocks.size(); ++at) {
      const auto words = read_siemens_words(program_.source.text(program_.blocks[at].span));
      const PolyWords block = poly_words_of(words);
      const bool is_first = at == first;
      if (!block.understood || block.poly != is_first) break;
      if (!is_first && (!block.moves() || block.feed)) break;
      if (is_first) text_.feed = block.feed;
      ++text_.blocks;
      if (!block.moves()) continue;
      if (const auto trouble = add(at, block); !trouble.empty()) return CurveRefusal{trouble};
    }
    if (text_.blocks == 0) return CurveRefusal{"no POLY"};
    return std::move(text_);
  }

 private:
  std::string add(std::uint32_t at, const PolyWords& words) {
    PolyBlock piece;
    piece.block = at;
    piece.length = words.length.value_or(1);
    if (piece.length < kShortestPoly || piece.length > kLongestPoly) return "PL out of range";
    if (words.denominator != nullptr) {
      const std::vector<double>& given = words.denominator->values;
      piece.denominator = polynomial_of(1, given.front(), given, 1, piece.length);
      if (!is_positive_until(piece.denominator, piece.length)) return "a denominator that is 0";
    }
    piece.start = place_.mm;
    piece.end = place_.mm;
    for (std::size_t axis = 0; axis < 3; ++axis) {
      if (!add_axis(axis, words, piece)) return "where the tool stands is not known";
    }
    place_.mm = piece.end;
    text_.pieces.push_back(std::move(piece));
    return {};
  }

  bool add_axis(std::size_t axis, const PolyWords& words, PolyBlock& piece) {
    const auto i = static_cast<int>(axis);
    const SiemensWord* word =
        words.polynomial[axis] != nullptr ? words.polynomial[axis] : words.straight[axis];
    if (word == nullptr) {  // stays where it is, whatever the denominator
      for (const double b : piece.denominator) piece.numerator[axis].push_back(b * piece.end[i]);
      return true;
    }
    if (!place_.known[axis]) return false;
    piece.axes[axis] = true;
    piece.end[i] = word->value() * unit_;
    const double end_of_numerator = piece.end[i] * value_of(piece.denominator, piece.length);
    piece.numerator[axis] =
        polynomial_of(piece.start[i], end_of_numerator, word->values, unit_, piece.length);
    return true;
  }

  const Program& program_;
  double unit_;
  Position place_;
  PolyText text_;
};

}  // namespace

Point3 PolyBlock::point_at(double p) const {
  const double below = value_of(denominator, p);
  return Point3(value_of(numerator[0], p), value_of(numerator[1], p), value_of(numerator[2], p)) /
         below;
}

std::optional<geometry::PathPiece> PolyBlock::piece() const {
  if (std::any_of(denominator.begin() + 1, denominator.end(), [](double b) { return b != 0; })) {
    return std::nullopt;
  }
  CubicCoefficients coefficients;
  for (auto& a : coefficients.a) a.setZero();
  bool straight = true;
  for (int axis = 0; axis < 3; ++axis) {
    const std::vector<double>& a = numerator[static_cast<std::size_t>(axis)];
    for (std::size_t k = 0; k < a.size(); ++k) {
      if (k > 3 && a[k] != 0) return std::nullopt;
      if (k > 3) continue;
      coefficients.a[k][axis] = a[k] * std::pow(length, static_cast<double>(k));
      straight = straight && (k < 2 || a[k] == 0);
    }
  }
  if (straight) return geometry::Line{start, end};
  geometry::CubicBezier bezier = bezier_of(coefficients);
  bezier.control[3] = end;  // the sum of the coefficients, without their rounding
  return bezier;
}

std::variant<PolyText, CurveRefusal> read_poly_text(const Program& program, std::uint32_t first,
                                                    const CurveStart& start) {
  return PolyReader(program, start).read(first);
}

CurveResult read_poly(const Program& program, std::uint32_t first, const CurveStart& start) {
  auto read = read_poly_text(program, first, start);
  if (auto* refusal = std::get_if<CurveRefusal>(&read)) return std::move(*refusal);
  const PolyText& text = std::get<PolyText>(read);
  CurveReading reading;
  reading.blocks = text.blocks;
  reading.feed = text.feed;
  for (const PolyBlock& block : text.pieces) {
    const auto piece = block.piece();
    if (!piece) return CurveRefusal{"a polynomial that is rational or above the third degree"};
    reading.motions.push_back({block.block, *piece});
    for (std::size_t axis = 0; axis < 3; ++axis) reading.axes[axis] |= block.axes[axis];
  }
  return reading;
}

}  // namespace batten::gcode
