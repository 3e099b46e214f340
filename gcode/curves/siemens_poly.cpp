#include "gcode/curves/siemens_poly.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <string>
#include <utility>

#include "gcode/curves/bezier_chain.h"
#include "gcode/curves/curve_print.h"
#include "gcode/state/modal_state.h"

namespace batten::gcode {
namespace {

using geometry::CubicBezier;
using geometry::Point3;

// `PO[X]=(18,-18,6)`: the end and the coefficients of p^2 and p^3, without zeros at the end.
class PolyWord {
 public:
  PolyWord(const CurveSetting& setting, double unit) : setting_(setting), unit_(unit) {}

  [[nodiscard]] std::string text(std::size_t axis, const PrintedPlace& end,
                                 const CubicCoefficients& coefficients) const {
    const auto i = static_cast<int>(axis);
    std::string word = std::string("PO[") + kAxisNames[axis] + "]=(" + end.digits[axis];
    const std::string second = digits(coefficients.a[2][i]);
    const std::string third = digits(coefficients.a[3][i]);
    const bool has_third = !is_zero(third);
    if (has_third || !is_zero(second)) word += "," + second;
    if (has_third) word += "," + third;
    return word + ")";
  }

 private:
  [[nodiscard]] std::string digits(double mm) const { return to_text(mm / unit_, setting_.other); }
  [[nodiscard]] static bool is_zero(const std::string& digits) {
    return digits.find_first_not_of("0.") == std::string::npos;
  }

  const CurveSetting& setting_;
  double unit_;
};

}  // namespace

std::string_view poly_complaint(const ModalState& state) {
  if (state.feed_mode != FeedMode::kPerMinute) return "POLY needs feed per minute (G94)";
  if (state.distance != DistanceMode::kAbsolute) return "POLY is written in G90 only";
  const std::array<std::pair<TriState, std::string_view>, 10> items = {{
      {state.cutter_compensation, "POLY under G41 or G42"},
      {state.polar, "POLY in polar coordinates"},
      {state.cylindrical, "POLY in cylindrical interpolation"},
      {state.tool_center_point, "POLY under TRAORI"},
      {state.tilted_plane, "POLY in a tilted plane"},
      {state.scaling, "POLY under SCALE"},
      {state.rotation, "POLY under ROT"},
      {state.mirror, "POLY under MIRROR"},
      {state.constant_surface_speed, "POLY under constant surface speed"},
      {state.lathe_diameter, "POLY with diameters"},
  }};
  for (const auto& [item, complaint] : items) {
    if (item != TriState::kOff) return complaint;
  }
  return {};
}

CurveWriting write_poly(std::span<const CubicBezier> pieces, const CurveSetting& setting) {
  if (pieces.empty()) return CurveRefusal{"no curve"};
  const PlacePrinter printer(setting);
  const double step = printed_step(setting.places, setting.units);
  if ((pieces.front().control[0] - setting.start).cwiseAbs().maxCoeff() > step) {
    return CurveRefusal{"the curve does not start where the tool stands"};
  }
  const PolyWord word(setting, printer.unit());
  CurveLines lines;
  Point3 place = setting.start;
  for (std::size_t i = 0; i < pieces.size(); ++i) {
    const Point3& wanted = pieces[i].control[3];
    const PrintedPlace end =
        i + 1 < pieces.size() ? printer.place(wanted) : printer.last_place(wanted);
    const CubicCoefficients coefficients = coefficients_of(between(pieces[i], place, end.mm));
    std::string line = i == 0 ? "POLY" : "";
    for (std::size_t axis = 0; axis < 3; ++axis) {
      if (!setting.axes[axis]) continue;
      // A word that starts with a bracketed name needs a blank before it.
      if (!line.empty()) line.push_back(' ');
      line += word.text(axis, end, coefficients);
    }
    if (i == 0 && setting.feed) line += " " + feed_word(setting);
    if (line.size() > kSiemensLine) return CurveRefusal{"a block above 512 characters"};
    lines.push_back(std::move(line));
    place = end.mm;
  }
  return lines;
}

namespace {

constexpr std::size_t kMostCoefficients = 5;  // the end and a2 .. a5
constexpr std::array<char, 3> kPolyAxes = {'X', 'Y', 'Z'};

// By the Bernstein coefficients of halves, which hold the polynomial between them.
bool is_positive(std::vector<double> b, int depth) {
  if (std::ranges::all_of(b, [](double value) { return value > 0; })) return true;
  if (!(b.front() > 0) || !(b.back() > 0) || depth == 0) return false;
  std::vector<double> left;
  std::vector<double> right(b.size());
  for (std::size_t n = b.size(); n > 0; --n) {
    left.push_back(b.front());
    right[n - 1] = b[n - 1];
    for (std::size_t i = 0; i + 1 < n; ++i) b[i] = (b[i] + b[i + 1]) / 2;
  }
  return is_positive(std::move(left), depth - 1) && is_positive(std::move(right), depth - 1);
}

double choose(std::size_t n, std::size_t k) {
  double value = 1;
  for (std::size_t i = 1; i <= k; ++i) {
    value *= static_cast<double>(n - k + i) / static_cast<double>(i);
  }
  return value;
}

bool take_axis_word(const SiemensWord& word, PolyWords& sorted) {
  for (std::size_t axis = 0; axis < 3; ++axis) {
    if (word.name == std::string(1, kPolyAxes[axis])) {
      sorted.straight[axis] = &word;
      return true;
    }
    if (word.name == std::string("PO[") + kPolyAxes[axis] + "]") {
      sorted.polynomial[axis] = &word;
      return !word.values.empty() && word.values.size() <= kMostCoefficients;
    }
  }
  return false;
}

}  // namespace

PolyWords poly_words_of(const std::optional<std::vector<SiemensWord>>& words) {
  PolyWords result;
  result.understood = words.has_value();
  if (!words) return result;
  for (const SiemensWord& word : *words) {
    if (word.is("N")) continue;
    if (word.is("POLY")) {
      result.poly = true;
    } else if (word.is("PO[]")) {
      result.denominator = &word;
      if (word.values.empty() || word.values.size() > kMostCoefficients) result.understood = false;
    } else if (word.is("PL") && word.values.size() == 1) {
      result.length = word.value();
    } else if (word.is("F") && word.values.size() == 1) {
      result.feed = word.value();
    } else if (!(word.is("G") && word.value() == 90) && !take_axis_word(word, result)) {
      result.understood = false;
    }
  }
  return result;
}

std::vector<double> polynomial_of(double first, double last, const std::vector<double>& given,
                                  double unit, double length) {
  std::vector<double> a = {first, 0};
  for (std::size_t k = 1; k < given.size(); ++k) a.push_back(given[k] * unit);
  double rest = last - first;
  for (std::size_t k = 2; k < a.size(); ++k) {
    rest -= a[k] * std::pow(length, static_cast<double>(k));
  }
  a[1] = rest / length;
  return a;
}

bool is_positive_until(const std::vector<double>& a, double length) {
  const std::size_t n = a.size() - 1;
  std::vector<double> bernstein(n + 1, 0.0);
  for (std::size_t i = 0; i <= n; ++i) {
    for (std::size_t k = 0; k <= i; ++k) {
      bernstein[i] += choose(i, k) / choose(n, k) * a[k] * std::pow(length, static_cast<double>(k));
    }
  }
  // After 40 halvings an interval is below the rounding of its ends.
  return is_positive(std::move(bernstein), 40);
}

namespace {

class PolyFormat final : public CurveFormat {
 public:
  std::string_view name() const override { return "POLY"; }
  bool is_default() const override { return true; }
  std::string_view complaint(const ModalState& state) const override {
    return poly_complaint(state);
  }
  bool is_block_per_piece() const override { return true; }

  // Of the size of the piece: half a step moves the piece by less than the rounding of its ends.
  NumberFormat other_numbers(Units) const override { return {.decimals = 6}; }

  CurveWriting write(const geometry::BsplineCurve& curve,
                     const CurveSetting& setting) const override {
    return write_poly(curve.bezier_pieces(), setting);
  }

  CurveResult read(const Program& program, std::uint32_t first,
                   const CurveStart& start) const override {
    return read_poly(program, first, start);
  }
};

}  // namespace

const CurveFormat& siemens_poly() {
  static const PolyFormat kFormat;
  return kFormat;
}

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
