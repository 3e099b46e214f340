#include "gcode/curves/siemens_curves.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <string>
#include <utility>

#include "gcode/curves/curve_print.h"
#include "gcode/text/characters.h"
#include "gcode/text/number_format.h"

namespace batten::gcode {
namespace {

using geometry::BsplineBasis;
using geometry::BsplineCurve;
using geometry::CubicBezier;
using geometry::Point3;
using geometry::Vector3;

// Characters of one block.
constexpr std::size_t kSiemensLine = 512;

// PL is in this range.
constexpr double kShortestPoly = 0.0001;
constexpr double kLongestPoly = 99999.9999;

// --- words --------------------------------------------------------------------------------------

// A word as far as polynomials and splines need it: `X10`, `X=10`, `PL=0.5`, `PO[X]=(18,-18,6)`,
// `POLY`, `G1`.
struct SiemensWord {
  std::string name;            // upper case, without blanks: "X", "PO[X]", "PO[]", "POLY"
  std::vector<double> values;  // one, those in parentheses, or none

  [[nodiscard]] bool is(std::string_view other) const { return name == other; }
  [[nodiscard]] double value() const { return values.front(); }  // requires one
};

// Comments (; to the end) are left out. Nothing where the block has anything else than such words:
// expressions, strings, AC(..), exponents, labels.
class SiemensReader {
 public:
  explicit SiemensReader(std::string_view text) : text_(text) {}

  std::optional<std::vector<SiemensWord>> read() {
    std::vector<SiemensWord> words;
    while (skip_blanks() != '\0' && peek() != ';') {
      SiemensWord word;
      if (!read_word(word)) return std::nullopt;
      words.push_back(std::move(word));
    }
    return words;
  }

 private:
  char peek() const { return at_ < text_.size() ? text_[at_] : '\0'; }

  char skip_blanks() {
    while (is_blank(peek())) ++at_;
    return peek();
  }

  bool take(char wanted) {
    if (skip_blanks() != wanted) return false;
    ++at_;
    return true;
  }

  bool read_word(SiemensWord& word) {
    while (is_letter(peek()) || peek() == '_') word.name.push_back(upper(text_[at_++]));
    if (word.name.empty()) return false;
    if (skip_blanks() == '[' && !read_index(word)) return false;
    if (take('=')) return take('(') ? read_list(word) : read_number_into(word);
    if (word.name.size() > 1) return true;  // a keyword
    return read_number_into(word);
  }

  // [X] or [].
  bool read_index(SiemensWord& word) {
    ++at_;
    word.name.push_back('[');
    while (is_letter(skip_blanks())) word.name.push_back(upper(text_[at_++]));
    word.name.push_back(']');
    return take(']') && skip_blanks() == '=';
  }

  bool read_list(SiemensWord& word) {
    do {
      if (!read_number_into(word)) return false;
    } while (take(','));
    return take(')');
  }

  bool read_number_into(SiemensWord& word) {
    skip_blanks();
    // Blanks end a number here.
    std::size_t end = at_;
    while (end < text_.size() && (is_digit(text_[end]) || text_[end] == '.' ||
                                  (end == at_ && (text_[end] == '-' || text_[end] == '+')))) {
      ++end;
    }
    const auto number = read_number(text_.substr(at_, end - at_));
    if (!number || std::abs(number->value) >= kNumberLimit) return false;
    // 1EX3 and G1X5: the first is an exponent, the second are two words.
    if (end + 1 < text_.size() && upper(text_[end]) == 'E' && upper(text_[end + 1]) == 'X') {
      return false;
    }
    at_ = end;
    word.values.push_back(number->value);
    return true;
  }

  std::string_view text_;
  std::size_t at_ = 0;
};

constexpr std::size_t kMostCoefficients = 5;  // the end and a2 .. a5

// One block's words, sorted.
struct CurveBlock {
  bool begins = false;  // POLY, BSPLINE
  std::array<std::optional<SiemensWord>, 3> polynomial;
  std::array<std::optional<SiemensWord>, 3> straight;
  std::optional<SiemensWord> denominator;
  std::optional<double> length;  // PL
  std::optional<double> feed;

  [[nodiscard]] bool is_polynomial() const {
    return polynomial[0] || polynomial[1] || polynomial[2] || denominator;
  }
  [[nodiscard]] bool moves() const {
    return is_polynomial() || straight[0] || straight[1] || straight[2];
  }
};

bool take_word(const SiemensWord& word, std::string_view keyword, CurveBlock& block) {
  const bool poly = keyword == "POLY";
  const bool beside = poly ? word.is("G") && word.value() == 90
                           : word.is("SD") && word.values == std::vector<double>{3};
  if (word.is("N") || beside) return true;
  if (word.is(keyword)) return block.begins = true;
  if ((word.is("PL") || word.is("F")) && word.values.size() == 1) {
    (word.is("F") ? block.feed : block.length) = word.value();
    return true;
  }
  std::optional<SiemensWord>* slot = nullptr;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const std::string name(1, kAxisNames[axis]);
    if (word.is(name)) {
      block.straight[axis] = word;
      return true;
    }
    if (word.is("PO[" + name + "]")) slot = &block.polynomial[axis];
  }
  if (word.is("PO[]")) slot = &block.denominator;
  if (!poly || slot == nullptr) return false;
  *slot = word;
  return !word.values.empty() && word.values.size() <= kMostCoefficients;
}

// Nothing where another word is in the block than those of curves that begin with the keyword.
std::optional<CurveBlock> curve_block(const Program& program, std::uint32_t at,
                                      std::string_view keyword) {
  const auto words = SiemensReader(program.source.text(program.blocks[at].span)).read();
  if (!words) return std::nullopt;
  CurveBlock block;
  const bool understood = std::ranges::all_of(
      *words, [&](const SiemensWord& word) { return take_word(word, keyword, block); });
  return understood ? std::optional(std::move(block)) : std::nullopt;
}

// --- POLY: writing ------------------------------------------------------------------------------

// a[0] + a[1] t + a[2] t^2 + a[3] t^3 for t from 0 to 1.
using Coefficients = std::array<Vector3, 4>;

CubicBezier bezier_of(const Coefficients& a) {
  return {{a[0], a[0] + a[1] / 3, a[0] + (2 * a[1] + a[2]) / 3, a[0] + a[1] + a[2] + a[3]}};
}

bool is_zero(const std::string& digits) {
  return digits.find_first_not_of("0.") == std::string::npos;
}

// The end and the coefficients of p^2 and p^3, without zeros at the end: `PO[X]=(18,-18,6)`.
std::string poly_word(std::size_t axis, const std::string& end, const CubicBezier& piece,
                      const CurveSetting& setting) {
  const auto i = static_cast<int>(axis);
  const Point3* b = piece.control;
  const double unit = millimetres_per(setting.units);
  const double a2 = (3 * (b[0] - 2 * b[1] + b[2]))[i];
  const double a3 = (b[3] - b[0] - 3 * (b[2] - b[1]))[i];
  const std::string second = to_text(a2 / unit, setting.other);
  const std::string third = to_text(a3 / unit, setting.other);
  std::string word = std::string("PO[") + kAxisNames[axis] + "]=(" + end;
  if (!is_zero(third) || !is_zero(second)) word += "," + second;
  if (!is_zero(third)) word += "," + third;
  return word + ")";
}

CurveWriting write_poly(const BsplineCurve& curve, const CurveSetting& setting) {
  const std::vector<CubicBezier> pieces = curve.bezier_pieces();
  const PlacePrinter printer(setting);
  if (!printer.starts_at(pieces.front().control[0])) {
    return CurveRefusal{"the curve does not start at the tool's position"};
  }
  CurveLines lines;
  Point3 place = setting.start;
  for (std::size_t i = 0; i < pieces.size(); ++i) {
    const PrintedPlace end = printer.place(pieces[i].control[3], i + 1 == pieces.size());
    const CubicBezier piece = between(pieces[i], place, end.mm);
    std::string line = i == 0 ? "POLY" : "";
    for (std::size_t axis = 0; axis < 3; ++axis) {
      if (!setting.axes[axis]) continue;
      // A word that starts with a bracketed name needs a blank before it.
      if (!line.empty()) line.push_back(' ');
      line += poly_word(axis, end.digits[axis], piece, setting);
    }
    if (i == 0 && setting.feed) line += " " + feed_word(setting);
    if (line.size() > kSiemensLine) return CurveRefusal{"a block above 512 characters"};
    lines.push_back(std::move(line));
    place = end.mm;
  }
  return lines;
}

// --- POLY: reading ------------------------------------------------------------------------------

// The motion of one axis: a line or a polynomial in p from 0 to `length`, whose end and a2, a3 ..
// are given; in p / length. Nothing above the third degree.
std::optional<std::array<double, 4>> coefficients_of(double start, const SiemensWord& word,
                                                     double unit, double length) {
  std::array<double, 4> a = {start, 0, 0, 0};
  double rest = word.value() * unit - start;
  for (std::size_t k = 2; k <= word.values.size(); ++k) {
    const double given = word.values[k - 1] * unit;
    if (k > 3 && given != 0) return std::nullopt;
    if (k > 3) continue;
    a[k] = given * std::pow(length, static_cast<double>(k));
    rest -= a[k];
  }
  a[1] = rest / length * length;
  return a;
}

class PolyReader {
 public:
  PolyReader(const Program& program, const CurveStart& start)
      : program_(program), unit_(millimetres_per(start.units)), place_(start.position) {}

  CurveResult read(std::uint32_t first) {
    for (std::uint32_t at = first; at < program_.blocks.size(); ++at) {
      const auto block = curve_block(program_, at, "POLY");
      const bool is_first = at == first;
      if (!block || block->begins != is_first) break;
      if (!is_first && (!block->moves() || block->feed)) break;
      if (is_first) reading_.feed = block->feed;
      ++reading_.blocks;
      if (!block->moves()) continue;
      if (const auto trouble = add(at, *block); !trouble.empty()) return CurveRefusal{trouble};
    }
    if (reading_.blocks == 0) return CurveRefusal{"no POLY"};
    return std::move(reading_);
  }

 private:
  std::string add(std::uint32_t at, const CurveBlock& words) {
    constexpr const char* kNoCubic = "a polynomial that is rational or above the third degree";
    const double length = words.length.value_or(1);
    if (length < kShortestPoly || length > kLongestPoly) return "PL out of range";
    if (words.denominator && !is_one(words.denominator->values)) return kNoCubic;
    Coefficients a = {place_.mm, Vector3::Zero(), Vector3::Zero(), Vector3::Zero()};
    Point3 end = place_.mm;
    for (std::size_t axis = 0; axis < 3; ++axis) {
      const auto& word = words.polynomial[axis] ? words.polynomial[axis] : words.straight[axis];
      if (!word) continue;  // stays where it is
      if (!place_.known[axis]) return "the tool's position is not known";
      reading_.axes[axis] = true;
      const auto i = static_cast<int>(axis);
      end[i] = word->value() * unit_;
      const auto of_axis = coefficients_of(place_.mm[i], *word, unit_, length);
      if (!of_axis) return kNoCubic;
      for (std::size_t k = 1; k < a.size(); ++k) a[k][i] = (*of_axis)[k];
    }
    reading_.motions.push_back({at, piece_to(end, a)});
    place_.mm = end;
    return {};
  }

  // A denominator that says nothing.
  static bool is_one(const std::vector<double>& values) {
    return values.front() == 1 &&
           std::all_of(values.begin() + 1, values.end(), [](double value) { return value == 0; });
  }

  [[nodiscard]] geometry::PathPiece piece_to(const Point3& end, const Coefficients& a) const {
    if (a[2].isZero(0) && a[3].isZero(0)) return geometry::Line{place_.mm, end};
    CubicBezier piece = bezier_of(a);
    piece.control[3] = end;  // the sum of the coefficients, without their rounding
    return piece;
  }

  const Program& program_;
  double unit_;
  Position place_;
  CurveReading reading_;
};

// --- BSPLINE ------------------------------------------------------------------------------------
//
// The place where the tool stands is the first control point P0, and one block for each further
// one: P1 .. Pm. The assumed meaning of PL: block i ends the knot interval [t(i+2), t(i+3)] of the
// clamped knots t of a cubic curve, so the first blocks have the lengths of the spans in their
// order and the last two have PL=0. Knots are scaled as for G06.2.

constexpr std::size_t kDegree = 3;

// PL is a length like X; nine digits in all, as for other lengths of the control.
constexpr int kDigits = 9;

// The knots whose intervals the blocks give; empty where they are no clamped cubic.
std::vector<double> knots_of(const std::vector<double>& lengths) {
  if (lengths.size() < kDegree) return {};
  const auto spans = lengths.size() + 1 - kDegree;
  std::vector<double> knots(kDegree + 1, 0.0);
  for (std::size_t i = 0; i < lengths.size(); ++i) {
    if (lengths[i] < 0 || (i >= spans && lengths[i] != 0)) return {};
    if (i < spans) knots.push_back(knots.back() + lengths[i]);
  }
  knots.insert(knots.end(), kDegree, knots.back());
  // Points would be left out where the first or the last span is empty.
  const bool full = lengths.front() > 0 && lengths[spans - 1] > 0;
  return full ? knots : std::vector<double>{};
}

CurveWriting write_bspline(const BsplineCurve& curve, const CurveSetting& setting) {
  if (!is_clamped_cubic(curve)) return CurveRefusal{"BSPLINE is written for clamped cubics only"};
  const PlacePrinter printer(setting);
  const auto& points = curve.control_points();
  if (!printer.starts_at(points.front())) {
    return CurveRefusal{"the curve does not start at the tool's position"};
  }
  const auto knots =
      print_knots(curve, {.digits = kDigits, .decimals = std::min(setting.other.decimals, 4)},
                  printed_step(setting.places, setting.units));
  if (!knots) return CurveRefusal{"distinct knots meet when they are rounded"};
  NumberFormat lengths = setting.other;
  lengths.decimals = knots->decimals;
  CurveLines lines;
  for (std::size_t i = 1; i < points.size(); ++i) {
    std::string line = i == 1 ? "BSPLINE SD=3" : "";
    add_place(line, printer.place(points[i], i + 1 == points.size()), setting);
    const double length = knots->knots[i + kDegree] - knots->knots[i + kDegree - 1];
    line += " PL=" + to_text(length, lengths);
    if (i == 1 && setting.feed) line += " " + feed_word(setting);
    lines.push_back(std::move(line));
  }
  return lines;
}

// Up to the first block that has no PL.
CurveResult read_bspline(const Program& program, std::uint32_t first, const CurveStart& start) {
  const double unit = millimetres_per(start.units);
  CurveReading reading;
  std::vector<Point3> points = {start.position.mm};
  std::vector<double> lengths;
  for (std::uint32_t at = first; at < program.blocks.size(); ++at) {
    const auto block = curve_block(program, at, "BSPLINE");
    if (!block || !block->length || block->begins != (at == first)) break;
    if (at == first) reading.feed = block->feed;
    if (at != first && block->feed) break;
    Point3 place = points.back();
    for (std::size_t axis = 0; axis < 3; ++axis) {
      if (!block->straight[axis]) continue;
      if (!start.position.known[axis]) return CurveRefusal{"the tool's position is not known"};
      reading.axes[axis] = true;
      place[static_cast<int>(axis)] = block->straight[axis]->value() * unit;
    }
    points.push_back(place);
    lengths.push_back(*block->length);
  }
  if (lengths.empty()) return CurveRefusal{"no BSPLINE"};
  const std::vector<double> knots = knots_of(lengths);
  if (knots.empty()) return CurveRefusal{"PL of the blocks is no clamped cubic"};
  reading.blocks = static_cast<std::uint32_t>(lengths.size());
  const BsplineCurve curve(BsplineBasis(static_cast<int>(kDegree), knots), std::move(points));
  std::uint32_t block = 0;
  for (const geometry::CubicBezier& piece : curve.bezier_pieces()) {
    while (lengths[block] == 0) ++block;
    reading.motions.push_back({first + block, piece});
    ++block;
  }
  return reading;
}

}  // namespace

const CurveFormat& siemens_poly() {
  static const CurveFormat kFormat = [] {
    CurveFormat format;
    format.name = "POLY";
    format.is_default = true;
    // Of the size of the piece: half a step moves the piece by less than the rounding of its ends.
    format.other_mm = format.other_inch = {.decimals = 6};
    format.write = write_poly;
    format.read = [](const Program& program, std::uint32_t first, const CurveStart& start) {
      return PolyReader(program, start).read(first);
    };
    return format;
  }();
  return kFormat;
}

const CurveFormat& siemens_bspline() {
  static const CurveFormat kFormat = [] {
    CurveFormat format;
    format.name = "BSPLINE";
    format.caution =
        "BSPLINE is not verified: how PL maps to the knots, what the first and the last blocks "
        "mean and where the curve starts were found in no manual; run the program on the control "
        "or on SinuTrain and compare it with POLY before cutting";
    format.is_block_per_piece = false;
    // PL, in the units of the curve's parameter: scaled as the knots of G06.2 are.
    format.other_mm = format.other_inch = {.decimals = 4};
    format.write = write_bspline;
    format.read = read_bspline;
    return format;
  }();
  return kFormat;
}

}  // namespace batten::gcode
