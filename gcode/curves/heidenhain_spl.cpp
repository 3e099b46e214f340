#include "gcode/curves/heidenhain_spl.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <numbers>
#include <string_view>
#include <utility>

#include "gcode/curves/curve_print.h"
#include "gcode/klartext/statement.h"
#include "gcode/text/characters.h"
#include "gcode/text/number_format.h"

namespace batten::gcode {
namespace {

using geometry::CubicBezier;
using geometry::Point3;
using geometry::Vector3;

// What the numbers of an SPL block may be (iTNC 530 manual, 60642x-04, p. 541).
constexpr double kGreatestMantissa = 9.99999999;  // of a coefficient
constexpr int kMantissaDecimals = 8;
constexpr double kGreatestEnd = 99999.9999;  // of an end point, mm

// The control stops, or slows down, where one spline meets the next under this angle or more
// (radians).
constexpr double kSplKink = 0.1 * std::numbers::pi / 180;

// --- writing ------------------------------------------------------------------------------------

std::string with_sign(const std::string& digits) {
  return digits.starts_with('-') ? digits : "+" + digits;
}

// K1 to K3 of one axis, in units of the program: K3 and K2 as given, and K1 so that they add up to
// `way`, from the printed end to the start.
using AxisCoefficients = std::array<PrintedCoefficient, 3>;

std::optional<AxisCoefficients> print_axis(double third, double second, double way, int decimals) {
  const auto k3 = print_spl_coefficient(third, decimals);
  const auto k2 = print_spl_coefficient(second, decimals);
  if (!k3 || !k2) return std::nullopt;
  const auto k1 = print_spl_coefficient(way - k3->value - k2->value, decimals);
  return k1 ? std::optional(AxisCoefficients{*k1, *k2, *k3}) : std::nullopt;
}

CurveWriting print_spl(const std::vector<CubicBezier>& pieces, const CurveSetting& setting,
                       int decimals) {
  const PlacePrinter printer(setting);
  const double unit = printer.unit();
  CurveLines lines;
  CubicBezier before;  // as read
  Point3 start = setting.start;
  for (std::size_t i = 0; i < pieces.size(); ++i) {
    const PrintedPlace end = printer.place(pieces[i].control[3], i + 1 == pieces.size());
    if (end.mm.cwiseAbs().maxCoeff() > kGreatestEnd * unit) {
      return CurveRefusal{"a position beyond 99999.9999"};
    }
    const CubicBezier wanted = between(pieces[i], start, end.mm);
    const Point3* b = wanted.control;
    const Vector3 third = b[0] - 3 * b[1] + 3 * b[2] - b[3];
    const Vector3 second = 3 * (b[1] - 2 * b[2] + b[3]);
    const Vector3 way = start - end.mm;
    CubicBezier piece = {{end.mm, end.mm, end.mm, end.mm}};
    std::string line = "SPL";
    for (std::size_t axis = 0; axis < 3; ++axis) {
      if (!setting.axes[axis]) continue;
      line += std::string(" ") + kAxisNames[axis] + with_sign(end.digits[axis]);
    }
    for (int axis = 0; axis < 3; ++axis) {
      const auto name = kAxisNames[static_cast<std::size_t>(axis)];
      if (!setting.axes[static_cast<std::size_t>(axis)]) continue;
      const auto k =
          print_axis(third[axis] / unit, second[axis] / unit, way[axis] / unit, decimals);
      if (!k) return CurveRefusal{"a coefficient beyond the control's range"};
      const auto& [k1, k2, k3] = *k;
      lines.push_back(line + " ~");
      line = fmt::format("  K3{0}{1} K2{0}{2} K1{0}{3}", name, k3.digits, k2.digits, k1.digits);
      piece.control[2][axis] += unit * k1.value / 3;
      piece.control[1][axis] += unit * (2 * k1.value + k2.value) / 3;
      piece.control[0][axis] += unit * (k1.value + k2.value + k3.value);
    }
    if (i == 0 && setting.feed) line += " " + feed_word(setting);
    lines.push_back(std::move(line));
    if ((piece.control[0] - start).cwiseAbs().maxCoeff() >= kSplClosure) {
      return CurveRefusal{"a block that does not close to within 1 um"};
    }
    if (i > 0 && kink_between(before, piece) >= kSplKink &&
        kink_between(pieces[i - 1], pieces[i]) < kSplKink) {
      return CurveRefusal{"rounding bends a joint by 0.1 degrees or more"};
    }
    before = piece;
    start = end.mm;
  }
  return lines;
}

CurveWriting write_spl(const geometry::BsplineCurve& curve, const CurveSetting& setting) {
  const std::vector<CubicBezier> pieces = curve.bezier_pieces();
  if (std::ranges::count(setting.axes, true) < 2) {
    return CurveRefusal{"SPL names two axes or more"};
  }
  if (!PlacePrinter(setting).starts_at(pieces.front().control[0])) {
    return CurveRefusal{"the curve does not start at the tool's position"};
  }
  for (int decimals = std::min(setting.other.decimals, kMantissaDecimals);; ++decimals) {
    CurveWriting written = print_spl(pieces, setting, decimals);
    const bool refused = std::holds_alternative<CurveRefusal>(written);
    if (!refused || decimals == kMantissaDecimals) return written;
  }
}

// --- reading ------------------------------------------------------------------------------------

// One block, whose lines are joined, in the program's units.
struct SplBlock {
  std::uint32_t lines = 0;
  std::string ends;          // "XY"
  std::string coefficients;  // "3X2X1X3Y2Y1Y"
  std::array<double, 3> end{};
  int decimals = 0;  // of the end: most digits after the point
  std::array<Vector3, 3> k = {Vector3::Zero(), Vector3::Zero(), Vector3::Zero()};  // K1, K2, K3
  std::optional<double> feed;
};

SourceSpan content_of(const Program& program, std::uint32_t block) {
  return klartext_parts(program.source.text(), program.blocks[block].span).content;
}

bool starts_spline(const Program& program, std::uint32_t block) {
  return klartext_kind(program.source.text(content_of(program, block))) == KlartextKind::kSpline;
}

// The axis of this name: 0 to 2; nothing for rotary axes and others.
std::optional<std::size_t> main_axis(const std::string& name) {
  if (name.size() != 1 || name[0] < 'X' || name[0] > 'Z') return std::nullopt;
  return static_cast<std::size_t>(name[0] - 'X');
}

// -4.688E-002, also with a blank before the E.
std::optional<double> read_coefficient(KlartextScanner& words) {
  const auto mantissa = words.number();
  if (!mantissa) return std::nullopt;
  KlartextScanner ahead = words;
  if (ahead.at_end() || upper(ahead.peek()) != 'E') return mantissa->value;
  ahead.skip();
  words = ahead;
  const bool negative = words.peek() == '-';
  const auto exponent = words.number();
  if (!exponent || exponent->decimals > 0 || std::abs(exponent->value) > 308) return std::nullopt;
  // Dividing by a power of ten that is exact rounds once.
  const double power = std::pow(10.0, std::abs(exponent->value));
  return negative ? mantissa->value / power : mantissa->value * power;
}

// K3X-4.688E-002, behind its K.
bool read_k_word(KlartextScanner& words, SplBlock& block) {
  const char k = words.peek();
  if (k < '1' || k > '3') return false;
  words.skip();
  const auto axis = main_axis(words.letters());
  const auto value = axis ? read_coefficient(words) : std::nullopt;
  if (!value) return false;
  block.k[static_cast<std::size_t>(k - '1')][static_cast<int>(*axis)] = *value;
  block.coefficients += {k, kAxisNames[*axis]};
  return true;
}

// The words of one line. False where it has any that no spline of ours has.
bool read_words(KlartextScanner words, bool is_first, SplBlock& block) {
  if (is_first) (void)words.letters();  // SPL
  while (!words.at_end()) {
    const std::string name = words.letters();
    if (name == "K") {
      if (!read_k_word(words, block)) return false;
      continue;
    }
    const auto axis = main_axis(name);
    const bool is_end = axis && block.coefficients.empty();
    const auto value = is_end || name == "F" ? words.number() : std::nullopt;
    if (!value) return false;
    if (is_end) {
      block.ends += name;
      block.end[*axis] = value->value;
      block.decimals = std::max(block.decimals, value->decimals);
    } else {
      block.feed = value->value;
    }
  }
  return true;
}

// Two axes or more, each with K3, K2 and K1 in this order.
bool has_its_words(const SplBlock& block) {
  std::string left = block.ends;
  if (left.size() < 2 || block.coefficients.size() != 6 * left.size()) return false;
  for (std::size_t at = 0; at < block.coefficients.size(); at += 6) {
    const char axis = block.coefficients[at + 1];
    const std::string three = {'3', axis, '2', axis, '1', axis};
    if (block.coefficients.substr(at, 6) != three || std::erase(left, axis) == 0) return false;
  }
  return true;
}

// The block that begins in line `first`; nothing where it is no spline as ours are.
std::optional<SplBlock> spl_block_at(const Program& program, std::uint32_t first) {
  SplBlock block;
  const std::string_view text = program.source.text();
  bool continues = true;
  for (std::uint32_t at = first; at < program.blocks.size(); ++at) {
    const KlartextParts parts = klartext_parts(text, program.blocks[at].span);
    const bool numbered = at > first && parts.number.size() > 0;
    const bool goes_on = !numbered && is_coefficient_line(program.source.text(parts.content));
    if (!continues && !goes_on) break;
    if (parts.skipped || numbered) return std::nullopt;
    if (!read_words({text, parts.content}, at == first, block)) return std::nullopt;
    ++block.lines;
    continues = parts.continues;
  }
  return has_its_words(block) ? std::optional(block) : std::nullopt;
}

// What the block says where the tool is at `position`.
CubicBezier piece_of(const SplBlock& block, const Point3& position, double unit) {
  Point3 end = position;
  for (const char axis : block.ends) {
    end[axis - 'X'] = block.end[static_cast<std::size_t>(axis - 'X')] * unit;
  }
  const Vector3 k1 = block.k[0] * unit;
  const Vector3 k2 = block.k[1] * unit;
  const Point3 begin = end + (k1 + (k2 + block.k[2] * unit));
  return {{begin, end + (2 * k1 + k2) / 3, end + k1 / 3, end}};
}

// Decimals of the same number, as doubles, differ by less (mm).
constexpr double kDecimalNoise = 1e-9;

// They start where their K words say, so they chain to within 1 um, and to the rounding of doubles
// where Batten wrote them.
CurveResult read_spl(const Program& program, std::uint32_t first, const CurveStart& start) {
  const bool may_be = program.blocks[first].opacity == ParseStatus::kForeign;
  if (!may_be || !starts_spline(program, first)) return CurveRefusal{"no SPL"};
  CurveReading reading;
  Point3 position = start.position.mm;
  for (std::uint32_t at = first; at < program.blocks.size() && starts_spline(program, at);) {
    const auto block = spl_block_at(program, at);
    if (!block && at == first) return CurveRefusal{"an SPL block that is not understood"};
    if (!block || (block->feed && at != first)) break;
    for (const char name : block->ends) {
      const auto axis = static_cast<std::size_t>(name - 'X');
      if (!start.position.known[axis]) return CurveRefusal{"the tool's position is not known"};
      reading.axes[axis] = true;
    }
    CubicBezier piece = piece_of(*block, position, millimetres_per(start.units));
    const double off = (piece.control[0] - position).cwiseAbs().maxCoeff();
    if (off >= kSplClosure) {
      return CurveRefusal{"a spline that starts 1 um or more from the tool's position"};
    }
    if (off <= kDecimalNoise) piece.control[0] = position;
    if (at == first) reading.feed = block->feed;
    reading.decimals = std::max(reading.decimals, block->decimals);
    reading.motions.push_back({at, piece});
    at += block->lines;
    position = piece.control[3];
    reading.blocks = at - first;
  }
  return reading;
}

}  // namespace

std::optional<PrintedCoefficient> print_spl_coefficient(double value, int decimals) {
  const double plain = rounded(value, decimals);
  if (std::abs(plain) <= kGreatestMantissa && decimals <= kMantissaDecimals) {
    return PrintedCoefficient{with_sign(to_text(plain, {.decimals = decimals})), plain};
  }
  int exponent = static_cast<int>(std::floor(std::log10(std::abs(value))));
  double power = std::pow(10.0, exponent);
  const auto mantissa_of = [&] {
    return rounded(value / power, std::min(kMantissaDecimals, decimals + exponent));
  };
  double mantissa = mantissa_of();
  if (std::abs(mantissa) > kGreatestMantissa) {  // 9.9999.. became 10
    ++exponent;
    power *= 10;
    mantissa = mantissa_of();
  }
  if (exponent > 99) return std::nullopt;
  std::string digits = with_sign(to_text(mantissa, {.decimals = kMantissaDecimals}));
  const std::string size = std::to_string(exponent);
  digits += "E+" + std::string(3 - size.size(), '0') + size;
  return PrintedCoefficient{std::move(digits), mantissa * power};
}

const CurveFormat& heidenhain_spl() {
  static const CurveFormat kFormat = {
      .name = "SPL",  // a software option on the iTNC 530: no default
      // Of the size of the piece; more where a joint would have a kink.
      .other_mm = {.decimals = 6},
      .other_inch = {.decimals = 6},
      .write = write_spl,
      .read = read_spl};
  return kFormat;
}

}  // namespace batten::gcode
