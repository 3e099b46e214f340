#include <algorithm>
#include <cmath>
#include <string>
#include <utility>

#include "gcode/curves/bezier_chain.h"
#include "gcode/curves/siemens_poly.h"
#include "gcode/curves/siemens_words.h"
#include "gcode/state/units.h"

namespace batten::gcode {
namespace {

using geometry::Point3;

constexpr double kShortestLength = 0.0001;
constexpr double kLongestLength = 99999.9999;
constexpr std::size_t kMostCoefficients = 5;  // the end and a2 .. a5
constexpr std::array<char, 3> kPolyAxes = {'X', 'Y', 'Z'};

double value_of(const std::vector<double>& coefficients, double p) {
  double value = 0;
  for (std::size_t i = coefficients.size(); i-- > 0;) value = value * p + coefficients[i];
  return value;
}

// a0, a1, a2 .. of the polynomial that is `first` at 0 and `last` at `length`, where `given` is the
// end as printed and a2, a3 .. behind it.
std::vector<double> with_linear(double first, double last, const std::vector<double>& given,
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

// Whether the denominator is above 0 on [0, length]: by the Bernstein coefficients of halves, which
// hold the polynomial between them.
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

bool is_positive(const std::vector<double>& a, double length) {
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

// One block's words, sorted.
struct PolyWords {
  bool poly = false;
  bool understood = true;  // nothing else stands in the block
  std::array<const SiemensWord*, 3> polynomial{};
  std::array<const SiemensWord*, 3> straight{};
  const SiemensWord* denominator = nullptr;
  std::optional<double> length;
  std::optional<double> feed;

  [[nodiscard]] bool any_polynomial() const {
    return polynomial[0] != nullptr || polynomial[1] != nullptr || polynomial[2] != nullptr ||
           denominator != nullptr;
  }
  [[nodiscard]] bool moves() const {
    return any_polynomial() || straight[0] != nullptr || straight[1] != nullptr ||
           straight[2] != nullptr;
  }
};

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

PolyWords sorted(const std::optional<std::vector<SiemensWord>>& words) {
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

class PolyReader {
 public:
  PolyReader(const Program& program, const CurveStart& start)
      : program_(program), unit_(millimetres_per(start.units)), place_(start.position) {}

  std::variant<PolyText, CurveRefusal> read(std::uint32_t first) {
    for (std::uint32_t at = first; at < program_.blocks.size(); ++at) {
      const auto words = read_siemens_words(program_.source.text(program_.blocks[at].span));
      const PolyWords block = sorted(words);
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
    if (piece.length < kShortestLength || piece.length > kLongestLength) return "PL out of range";
    if (words.denominator != nullptr) {
      const std::vector<double>& given = words.denominator->values;
      piece.denominator = with_linear(1, given.front(), given, 1, piece.length);
      if (!is_positive(piece.denominator, piece.length)) return "a denominator that is 0";
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
        with_linear(piece.start[i], end_of_numerator, word->values, unit_, piece.length);
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

// --- alarms -------------------------------------------------------------------------------------

namespace {

class PolyAlarms {
 public:
  explicit PolyAlarms(const Program& program) : program_(program) {}

  CurveAlarms all() {
    for (const Block& block : program_.blocks) follow(block);
    return std::move(alarms_);
  }

 private:
  void say(std::uint32_t line, std::string_view id, std::string message) {
    alarms_.push_back({Severity::kError, line, id, std::move(message)});
  }

  void follow(const Block& block) {
    const std::string_view text = program_.source.text(block.span);
    if (text.size() > kSiemensLine) {
      say(block.line, "line-too-long", std::to_string(text.size()) + " characters, expected 512");
    }
    const auto words = read_siemens_words(text);
    if (!words) return;
    for (const SiemensWord& word : *words) set_mode(word);
    check(block.line, words);
  }

  // POLY is ended by the other members of its group.
  void set_mode(const SiemensWord& word) {
    if (word.is("POLY")) active_ = true;
    if (word.is("ASPLINE") || word.is("BSPLINE") || word.is("CSPLINE")) active_ = false;
    if (!word.is("G") || word.values.size() != 1) return;
    const double code = word.value();
    if (code == 0 || code == 1 || code == 2 || code == 3) active_ = false;
    if (code == 40) compensation_ = false;
    if (code == 41 || code == 42) compensation_ = true;
  }

  void check(std::uint32_t line, const std::optional<std::vector<SiemensWord>>& words) {
    const PolyWords block = sorted(words);
    if (block.any_polynomial() && !active_) {
      say(line, "poly-not-active", "PO without POLY: a straight line to the end point");
    }
    if (block.any_polynomial() && compensation_) {
      say(line, "poly-compensation", "POLY under G41 or G42");
    }
    if (!block.any_polynomial()) return;
    const double length = block.length.value_or(1);
    if (length < kShortestLength || length > kLongestLength) {
      say(line, "poly-length", "PL=" + std::to_string(length) + ", expected 0.0001 to 99999.9999");
      return;
    }
    check_degrees(line, block);
    if (block.denominator == nullptr) return;
    const std::vector<double>& given = block.denominator->values;
    if (!is_positive(with_linear(1, given.front(), given, 1, length), length)) {
      say(line, "poly-denominator", "the denominator is 0 inside the block");
    }
  }

  void check_degrees(std::uint32_t line, const PolyWords& block) {
    for (const SiemensWord* word : block.polynomial) {
      if (word == nullptr || word->values.size() <= 3) continue;
      say(line, "poly-degree",
          word->name + " with " + std::to_string(word->values.size()) + " values, expected 3");
    }
  }

  const Program& program_;
  CurveAlarms alarms_;
  bool active_ = false;
  bool compensation_ = false;
};

}  // namespace

CurveAlarms poly_alarms(const Program& program) { return PolyAlarms(program).all(); }

}  // namespace batten::gcode
