#include "gcode/curves/siemens_curves.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <functional>
#include <map>
#include <numeric>
#include <string>
#include <utility>

#include "gcode/curves/curve_print.h"
#include "gcode/curves/spline_pieces.h"
#include "gcode/siemens/lexer.h"
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

struct SiemensWordValues {
  std::vector<double> numbers;  // one, those in parentheses, or none
  int decimals = 0;             // of the first one: digits after the point
};

// The words of a block by their names (upper case, without blanks: "X", "PO[X]", "PO[]", "POLY").
using SiemensWords = std::map<std::string, SiemensWordValues, std::less<>>;

std::string_view trimmed(std::string_view text) {
  text = without_blanks_before(text);
  return text.substr(0, text.find_last_not_of(" \t") + 1);
}

// 0.5, or (18,-18, 6).
bool read_values(std::string_view text, SiemensWordValues& values) {
  text = trimmed(text);
  if (text.starts_with('(')) text = text.substr(1, text.size() - 2);
  for (bool more = true; more;) {
    const std::size_t comma = std::min(text.find(','), text.size());
    const std::string_view digits = trimmed(text.substr(0, comma));
    const auto number = read_number(digits);
    if (!number || after_siemens_number(digits, 0) != digits.size()) return false;
    if (std::abs(number->value) >= kNumberLimit) return false;
    if (values.numbers.empty()) values.decimals = number->decimals;
    values.numbers.push_back(number->value);
    more = comma < text.size();
    text = text.substr(more ? comma + 1 : comma);
  }
  return true;
}

// `X10`, `PL=0.5`, `PO[X]=(18,-18,6)`, `POLY`. Nothing where the block has anything else: values
// that are computed, strings, labels, a word twice.
std::optional<SiemensWords> read_siemens_words(std::string_view text) {
  SiemensWords words;
  SiemensLexer lexer(text, {0, static_cast<std::uint32_t>(text.size())});
  for (;;) {
    const SiemensToken token = lexer.next();
    if (token.kind == SiemensTokenKind::kEnd || token.kind == SiemensTokenKind::kComment) break;
    std::string name(1, token.letter);
    SiemensWordValues values{{token.number.value}, token.number.decimals};
    if (token.kind == SiemensTokenKind::kName) {
      const std::string_view whole = text.substr(token.span.begin, token.span.size());
      const std::size_t equals = std::min(whole.find('='), whole.size());
      name = without_blanks(in_capitals(whole.substr(0, equals)));
      values = {};
      if (token.assigned && !read_values(whole.substr(equals + 1), values)) return std::nullopt;
    } else if (token.kind != SiemensTokenKind::kWord) {
      return std::nullopt;
    }
    if (!words.try_emplace(std::move(name), std::move(values)).second) return std::nullopt;
  }
  return words;
}

const SiemensWordValues* find(const SiemensWords& words, const std::string& name) {
  const auto found = words.find(name);
  return found == words.end() ? nullptr : &found->second;
}

// Of a word with one value.
std::optional<double> value_of(const SiemensWords& words, const std::string& name) {
  const auto* values = find(words, name);
  return values != nullptr ? std::optional(values->numbers.front()) : std::nullopt;
}

bool names_axis(std::string_view name) { return name == "X" || name == "Y" || name == "Z"; }

bool is_motion(const SiemensWords::value_type& word) {
  return names_axis(word.first) || word.first.starts_with("PO[");
}

constexpr std::size_t kMostCoefficients = 5;  // the end and a2 .. a5

// Whether the word belongs to curves that begin with the keyword, or may be beside it.
bool is_curve_word(const SiemensWords::value_type& word, std::string_view keyword) {
  const std::string& name = word.first;
  const std::vector<double>& values = word.second.numbers;
  const bool poly = keyword == "POLY";
  if (name == "N" || name == keyword || names_axis(name)) return true;
  if (name == "PL" || name == "F") return values.size() == 1;
  if (name == "PW") return !poly && values.size() == 1 && values.front() > 0;
  if (!poly) return name == "SD" && values == std::vector<double>{3};
  if (name == "G") return values.front() == 90;
  const bool polynomial = name == "PO[X]" || name == "PO[Y]" || name == "PO[Z]" || name == "PO[]";
  return polynomial && !values.empty() && values.size() <= kMostCoefficients;
}

// Nothing where another word is in the block than those of curves that begin with the keyword.
std::optional<SiemensWords> curve_words(const Program& program, std::uint32_t at,
                                        std::string_view keyword) {
  auto words = read_siemens_words(program.source.text(program.blocks[at].span));
  const bool understood = words && std::ranges::all_of(*words, [keyword](const auto& word) {
                            return is_curve_word(word, keyword);
                          });
  return understood ? std::move(words) : std::nullopt;
}

// --- POLY: writing ------------------------------------------------------------------------------

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

// Places where pieces meet have the digits of the coefficients: rounded as other places, they make
// the curvature jump by 6 / length^2 of half a step, for which a machine that limits jerk slows
// down.
CurveWriting write_poly(const BsplineCurve& curve, const CurveSetting& setting) {
  const std::vector<CubicBezier> pieces = curve.bezier_pieces();
  const PlacePrinter printer(setting);
  CurveSetting finer = setting;
  finer.places.decimals = std::max(setting.places.decimals, setting.other.decimals);
  const PlacePrinter joints(finer);
  if (!printer.starts_at(pieces.front().control[0])) {
    return CurveRefusal{"the curve does not start at the tool's position"};
  }
  CurveLines lines;
  Point3 place = setting.start;
  for (std::size_t i = 0; i < pieces.size(); ++i) {
    const bool is_last = i + 1 == pieces.size();
    const PrintedPlace end = (is_last ? printer : joints).place(pieces[i].control[3], is_last);
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

// The coefficients of p / length, p from 0 to `length`, of a polynomial that begins with `start`,
// and has the end and a2, a3 .. that are given.
using Polynomial = std::array<double, kMostCoefficients + 1>;

Polynomial polynomial_of(double start, double end, const std::vector<double>& values, double unit,
                         double length) {
  Polynomial a{start};
  double rest = end - start;
  for (std::size_t k = 2; k <= values.size(); ++k) {
    a[k] = values[k - 1] * unit * std::pow(length, static_cast<double>(k));
    rest -= a[k];
  }
  a[1] = rest;
  return a;
}

std::size_t degree_of(const Polynomial& a) {
  std::size_t degree = a.size() - 1;
  while (degree > 0 && a[degree] == 0) --degree;
  return degree;
}

// The Bernstein coefficients of the polynomials of one block over their whole range.
geometry::RationalBezier bezier_of(const std::array<Polynomial, 3>& axes,
                                   const Polynomial& denominator, std::size_t degree) {
  geometry::RationalBezier piece;
  for (std::size_t i = 0; i <= degree; ++i) {
    geometry::WeightedPoint& point = piece.control.emplace_back(geometry::WeightedPoint::Zero());
    double part = 1;  // binomials (i, k) over (degree, k)
    for (std::size_t k = 0; k <= i; ++k) {
      if (k > 0) part *= static_cast<double>(i - k + 1) / static_cast<double>(degree - k + 1);
      point += part * geometry::WeightedPoint(axes[0][k], axes[1][k], axes[2][k], denominator[k]);
    }
  }
  return piece;
}

// Adds the motion of one block, which moves `position` (mm); why it cannot, or nothing.
std::string add_poly(std::uint32_t at, const SiemensWords& words, double unit, Position& position,
                     CurveReading& reading) {
  const double length = value_of(words, "PL").value_or(1);
  if (length < kShortestPoly || length > kLongestPoly) return "PL out of range";
  Polynomial denominator{1};
  if (const auto* values = find(words, "PO[]")) {
    denominator = polynomial_of(1, values->numbers.front(), values->numbers, 1, length);
  }
  const double end_weight = std::accumulate(denominator.begin(), denominator.end(), 0.0);
  const Point3 start = position.mm;
  std::array<Polynomial, 3> axes{};
  std::size_t degree = degree_of(denominator);
  const bool is_rational = degree > 0;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const auto i = static_cast<int>(axis);
    const std::string name(1, kAxisNames[axis]);
    const auto* polynomial = find(words, "PO[" + name + "]");
    const auto* values = polynomial != nullptr ? polynomial : find(words, name);
    if (values == nullptr) {  // stays where it is: the numerator is as many times the denominator
      for (std::size_t k = 0; k < denominator.size(); ++k)
        axes[axis][k] = start[i] * denominator[k];
      continue;
    }
    if (!position.known[axis]) return "the tool's position is not known";
    reading.axes[axis] = true;
    reading.decimals = std::max(reading.decimals, values->decimals);
    position.mm[i] = values->numbers.front() * unit;
    axes[axis] =
        polynomial_of(start[i], position.mm[i] * end_weight, values->numbers, unit, length);
    degree = std::max(degree, degree_of(axes[axis]));
  }
  const geometry::RationalBezier piece =
      bezier_of(axes, denominator, std::max<std::size_t>(degree, 3));
  if (is_rational || degree > 3) {
    const bool added = add_cubics(at, piece, start, position.mm, reading);
    return added ? "" : "a denominator that changes too much or is not positive";
  }
  CubicBezier cubic;
  for (std::size_t i = 0; i < 4; ++i) cubic.control[i] = piece.control[i].head<3>();
  cubic.control[3] = position.mm;  // the sum of the coefficients, without their rounding
  const geometry::PathPiece line = geometry::Line{start, position.mm};
  reading.motions.push_back({at, degree <= 1 ? line : geometry::PathPiece(cubic)});
  return {};
}

CurveResult read_poly(const Program& program, std::uint32_t first, const CurveStart& start) {
  CurveReading reading;
  Position position = start.position;
  for (std::uint32_t at = first; at < program.blocks.size(); ++at) {
    const auto words = curve_words(program, at, "POLY");
    const bool is_first = at == first;
    if (!words || words->contains("POLY") != is_first) break;
    const bool moves = std::ranges::any_of(*words, is_motion);
    if (!is_first && (!moves || words->contains("F"))) break;
    if (is_first) reading.feed = value_of(*words, "F");
    ++reading.blocks;
    if (!moves) continue;
    auto trouble = add_poly(at, *words, millimetres_per(start.units), position, reading);
    if (!trouble.empty()) return CurveRefusal{std::move(trouble)};
  }
  if (reading.blocks == 0) return CurveRefusal{"no POLY"};
  return reading;
}

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
  std::vector<double> weights = {1};
  std::vector<double> lengths;
  for (std::uint32_t at = first; at < program.blocks.size(); ++at) {
    const auto words = curve_words(program, at, "BSPLINE");
    if (!words || !words->contains("PL") || words->contains("BSPLINE") != (at == first)) break;
    if (at == first) reading.feed = value_of(*words, "F");
    if (at != first && words->contains("F")) break;
    Point3 place = points.back();
    for (std::size_t axis = 0; axis < 3; ++axis) {
      const auto* value = find(*words, std::string(1, kAxisNames[axis]));
      if (value == nullptr) continue;
      if (!start.position.known[axis]) return CurveRefusal{"the tool's position is not known"};
      reading.axes[axis] = true;
      reading.decimals = std::max(reading.decimals, value->decimals);
      place[static_cast<int>(axis)] = value->numbers.front() * unit;
    }
    points.push_back(place);
    weights.push_back(value_of(*words, "PW").value_or(1));
    lengths.push_back(*value_of(*words, "PL"));
  }
  if (lengths.empty()) return CurveRefusal{"no BSPLINE"};
  const std::vector<double> knots = knots_of(lengths);
  if (knots.empty()) return CurveRefusal{"PL of the blocks is no clamped cubic"};
  reading.blocks = static_cast<std::uint32_t>(lengths.size());
  std::vector<std::uint32_t> blocks;
  for (std::uint32_t i = 0; i < reading.blocks; ++i) {
    if (lengths[i] > 0) blocks.push_back(first + i);
  }
  const BsplineBasis basis(static_cast<int>(kDegree), knots);
  if (!add_spline(basis, points, weights, blocks, reading)) {
    return CurveRefusal{"weights that are too far apart"};
  }
  return reading;
}

}  // namespace

const CurveFormat& siemens_poly() {
  static const CurveFormat kFormat = {.name = "POLY",
                                      // Of the size of the piece: half a step moves the piece by
                                      // less than the rounding of its ends.
                                      .other_mm = {.decimals = 6},
                                      .other_inch = {.decimals = 6},
                                      .write = write_poly,
                                      .read = read_poly};
  return kFormat;
}

const CurveFormat& siemens_bspline() {
  static const CurveFormat kFormat = {
      .name = "BSPLINE",
      .caution =
          "BSPLINE is not verified: how PL maps to the knots, what the first and the last blocks "
          "mean and where the curve starts were found in no manual; run the program on the control "
          "or on SinuTrain and compare it with POLY before cutting",
      .is_block_per_piece = false,
      // PL, in the units of the curve's parameter: scaled as the knots of G06.2 are.
      .other_mm = {.decimals = 4},
      .other_inch = {.decimals = 4},
      .write = write_bspline,
      .read = read_bspline};
  return kFormat;
}

}  // namespace batten::gcode
