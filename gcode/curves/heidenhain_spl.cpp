#include "gcode/curves/heidenhain_spl.h"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <cstddef>
#include <string>
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

// --- words --------------------------------------------------------------------------------------

class KlartextReader {
 public:
  explicit KlartextReader(std::string_view text) : text_(text) {}

  std::optional<KlartextLine> read() {
    KlartextLine line;
    if (is_digit(skip_blanks())) {
      line.number = digits();
      if (!line.number) return std::nullopt;
    }
    while (skip_blanks() != '\0' && peek() != ';') {
      if (peek() == '~') {
        ++at_;
        line.continues = true;
        if (skip_blanks() != '\0') return std::nullopt;
        break;
      }
      KlartextWord word;
      if (!read_word(word)) return std::nullopt;
      line.words.push_back(std::move(word));
    }
    return line;
  }

 private:
  char peek(std::size_t ahead = 0) const {
    return at_ + ahead < text_.size() ? text_[at_ + ahead] : '\0';
  }

  char skip_blanks() {
    while (is_blank(peek())) ++at_;
    return peek();
  }

  std::optional<int> digits() {
    int value = 0;
    const char* begin = text_.data() + at_;
    const auto read = std::from_chars(begin, text_.data() + text_.size(), value);
    if (read.ec != std::errc{}) return std::nullopt;
    at_ += static_cast<std::size_t>(read.ptr - begin);
    return value;
  }

  bool is_spline_word() const {
    return upper(peek()) == 'K' && peek(1) >= '1' && peek(1) <= '3' && is_letter(peek(2));
  }

  bool read_word(KlartextWord& word) {
    if (is_spline_word()) {
      word.name = {'K', peek(1), upper(peek(2))};
      at_ += 3;
      return read_value(word) && read_exponent(word);
    }
    while (is_letter(peek())) word.name.push_back(upper(text_[at_++]));
    if (word.name.empty()) return false;
    // The sense of an arc; with digits behind it, a difference of the tool's radius.
    if (word.is("DR") && (peek() == '+' || peek() == '-') && !is_digit(peek(1)) && peek(1) != '.') {
      word.name.push_back(text_[at_++]);
      return true;
    }
    const char next = peek();
    const bool has_value = is_digit(next) || next == '+' || next == '-' || next == '.';
    return !has_value || read_value(word);
  }

  bool read_value(KlartextWord& word) {
    std::string digits;
    while (is_digit(peek()) || peek() == '.' || peek() == ',' ||
           (digits.empty() && (peek() == '+' || peek() == '-'))) {
      digits.push_back(peek() == ',' ? '.' : peek());
      ++at_;
    }
    const auto number = read_number(digits);
    if (!number || std::abs(number->value) >= kNumberLimit) return false;
    word.mantissa = number->value;
    word.value = number->value;
    word.decimals = number->decimals;
    return true;
  }

  // E-002, also behind a blank.
  bool read_exponent(KlartextWord& word) {
    std::size_t ahead = 0;
    while (is_blank(peek(ahead))) ++ahead;
    if (upper(peek(ahead)) != 'E') return true;
    at_ += ahead + 1;
    const bool negative = peek() == '-';
    if (negative || peek() == '+') ++at_;
    const auto exponent = digits();
    if (!exponent || *exponent > 308) return false;
    word.exponent = negative ? -*exponent : *exponent;
    // Dividing by a power of ten that is exact rounds once.
    const double power = std::pow(10.0, *exponent);
    word.value = negative ? word.mantissa / power : word.mantissa * power;
    return true;
  }

  std::string_view text_;
  std::size_t at_ = 0;
};

// --- writing ------------------------------------------------------------------------------------

std::string with_sign(const std::string& digits) {
  return digits.starts_with('-') ? digits : "+" + digits;
}

// A block as printed: per axis K3, K2, K1.
struct PrintedBlock {
  PrintedPlace end;
  std::array<std::array<std::string, 3>, 3> k;  // [axis][K3, K2, K1]
  CubicBezier piece;                            // as read
};

class SplWriter {
 public:
  SplWriter(std::span<const CubicBezier> pieces, const CurveSetting& setting, int decimals)
      : pieces_(pieces), setting_(setting), printer_(setting), decimals_(decimals) {}

  // Empty where every block is as it should be.
  std::string print() {
    Point3 place = setting_.start;
    for (std::size_t i = 0; i < pieces_.size(); ++i) {
      const Point3& wanted = pieces_[i].control[3];
      PrintedBlock block;
      block.end = printer_.place(wanted, i + 1 == pieces_.size());
      if (block.end.mm.cwiseAbs().maxCoeff() > kGreatestEnd * printer_.unit()) {
        return "a position beyond 99999.9999";
      }
      if (!print_coefficients(between(pieces_[i], place, block.end.mm), place, block)) {
        return "a coefficient beyond the control's range";
      }
      if ((block.piece.control[0] - place).cwiseAbs().maxCoeff() >= kSplClosure) {
        return "a block that does not close to within 1 um";
      }
      place = block.end.mm;
      blocks_.push_back(std::move(block));
    }
    return {};
  }

  [[nodiscard]] bool adds_kinks() const {
    for (std::size_t i = 1; i < blocks_.size(); ++i) {
      if (kink_between(blocks_[i - 1].piece, blocks_[i].piece) >= kSplKink &&
          kink_between(pieces_[i - 1], pieces_[i]) < kSplKink) {
        return true;
      }
    }
    return false;
  }

  [[nodiscard]] CurveLines lines() const {
    CurveLines lines;
    for (std::size_t i = 0; i < blocks_.size(); ++i) {
      std::string line = "SPL";
      for (std::size_t axis = 0; axis < 3; ++axis) {
        if (!setting_.axes[axis]) continue;
        line += std::string(" ") + kAxisNames[axis] + with_sign(blocks_[i].end.digits[axis]);
      }
      for (std::size_t axis = 0; axis < 3; ++axis) {
        if (!setting_.axes[axis]) continue;
        lines.push_back(line + " ~");
        line = coefficient_line(axis, blocks_[i]);
      }
      if (i == 0 && setting_.feed) line += " " + feed_word(setting_);
      lines.push_back(std::move(line));
    }
    return lines;
  }

 private:
  bool print_coefficients(const CubicBezier& piece, const Point3& place, PrintedBlock& block) {
    const Point3* b = piece.control;
    const Vector3 third = b[0] - 3 * b[1] + 3 * b[2] - b[3];
    const Vector3 second = 3 * (b[1] - 2 * b[2] + b[3]);
    block.piece = {{b[3], b[3], b[3], b[3]}};
    for (int axis = 0; axis < 3; ++axis) {
      const auto i = static_cast<std::size_t>(axis);
      if (!setting_.axes[i]) continue;
      const double unit = printer_.unit();
      const auto k3 = print_spl_coefficient(third[axis] / unit, decimals_);
      const auto k2 = print_spl_coefficient(second[axis] / unit, decimals_);
      if (!k3 || !k2) return false;
      const double rest = (place[axis] - block.end.mm[axis]) / unit - k3->value - k2->value;
      const auto k1 = print_spl_coefficient(rest, decimals_);
      if (!k1) return false;
      block.k[i] = {k3->digits, k2->digits, k1->digits};
      const double end = block.end.mm[axis];
      block.piece.control[2][axis] = end + unit * k1->value / 3;
      block.piece.control[1][axis] = end + unit * (2 * k1->value + k2->value) / 3;
      block.piece.control[0][axis] = end + unit * (k1->value + k2->value + k3->value);
    }
    return true;
  }

  std::string coefficient_line(std::size_t axis, const PrintedBlock& block) const {
    std::string line = " ";
    for (std::size_t k = 0; k < 3; ++k) {
      line += std::string(" K") + static_cast<char>('3' - k) + kAxisNames[axis] + block.k[axis][k];
    }
    return line;
  }

  std::span<const CubicBezier> pieces_;
  const CurveSetting& setting_;
  PlacePrinter printer_;
  int decimals_;
  std::vector<PrintedBlock> blocks_;
};

CurveWriting write_spl(const geometry::BsplineCurve& curve, const CurveSetting& setting) {
  const std::vector<CubicBezier> pieces = curve.bezier_pieces();
  if (std::ranges::count(setting.axes, true) < 2) {
    return CurveRefusal{"SPL names two axes or more"};
  }
  if (!PlacePrinter(setting).starts_at(pieces.front().control[0])) {
    return CurveRefusal{"the curve does not start at the tool's position"};
  }
  for (int decimals = std::min(setting.other.decimals, kMantissaDecimals);; ++decimals) {
    SplWriter writer(pieces, setting, decimals);
    const std::string trouble = writer.print();
    if (trouble.empty() && !writer.adds_kinks()) return writer.lines();
    if (decimals < kMantissaDecimals) continue;
    return CurveRefusal{trouble.empty() ? "rounding bends a joint by 0.1 degrees or more"
                                        : trouble};
  }
}

// --- reading ------------------------------------------------------------------------------------

bool starts_spline(const Program& program, std::uint32_t block) {
  const SourceSpan content =
      klartext_parts(program.source.text(), program.blocks[block].span).content;
  return klartext_kind(program.source.text(content)) == KlartextKind::kSpline;
}

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

// They start where their K words say, so they chain to within 1 um, and to the rounding of doubles
// where Batten wrote them.
CurveResult read_spl(const Program& program, std::uint32_t first, const CurveStart& start) {
  const bool may_be = program.blocks[first].opacity == ParseStatus::kForeign;
  if (!may_be || !starts_spline(program, first)) return CurveRefusal{"no SPL"};
  const double unit = millimetres_per(start.units);
  CurveReading reading;
  Point3 place = start.position.mm;
  for (std::uint32_t at = first; at < program.blocks.size();) {
    const SplWords joined = joined_at(program, at);
    if (!joined.is("SPL")) break;
    if (!joined.understood || !spl_word_trouble(joined).empty() || !only_main_axes(joined)) {
      if (reading.motions.empty()) return CurveRefusal{"an SPL block that is not understood"};
      break;
    }
    const SplBlock block = spl_block_of(joined, place, unit);
    if (block.feed && !reading.motions.empty()) break;
    for (std::size_t axis = 0; axis < 3; ++axis) {
      if (block.axes[axis] && !start.position.known[axis]) {
        return CurveRefusal{"the tool's position is not known"};
      }
      reading.axes[axis] = reading.axes[axis] || block.axes[axis];
    }
    CubicBezier piece = block.piece;
    const double off = (piece.control[0] - place).cwiseAbs().maxCoeff();
    if (off >= kSplClosure) {
      return CurveRefusal{"a spline that starts 1 um or more from the tool's position"};
    }
    if (off <= kDecimalNoise) piece.control[0] = place;
    if (reading.motions.empty()) reading.feed = block.feed;
    reading.motions.push_back({at, piece});
    reading.blocks += joined.lines;
    at += joined.lines;
    place = piece.control[3];
  }
  if (reading.motions.empty()) return CurveRefusal{"no SPL"};
  return reading;
}

}  // namespace

std::optional<KlartextLine> read_klartext_line(std::string_view line) {
  return KlartextReader(line).read();
}

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

bool is_spl_coefficient(const KlartextWord& word) {
  return word.name.size() == 3 && word.name[0] == 'K';
}

bool is_spl_end(const KlartextWord& word) {
  return word.name.size() == 1 && kSplAxes.find(word.name[0]) != std::string_view::npos &&
         word.value.has_value();
}

SplWords joined_at(const Program& program, std::uint32_t first) {
  SplWords joined;
  bool continues = true;
  for (std::uint32_t at = first; at < program.blocks.size(); ++at) {
    const auto line = read_klartext_line(program.source.text(program.blocks[at].span));
    const bool more = at > first && line && !line->number && !line->words.empty() &&
                      is_spl_coefficient(line->words.front());
    if (!continues && !more) break;
    ++joined.lines;
    if (!line || (at > first && line->number)) {
      joined.understood = false;
      break;
    }
    for (const KlartextWord& word : line->words) joined.words.push_back(word);
    // Only splines are joined where nothing says so.
    continues = line->continues;
    if (!joined.is("SPL") && !continues) break;
  }
  return joined;
}

std::string_view spl_word_trouble(const SplWords& block) {
  std::string ends;
  std::string coefficients;
  std::string last_axis;
  for (std::size_t i = 1; i < block.words.size(); ++i) {
    const KlartextWord& word = block.words[i];
    if (is_spl_coefficient(word)) {
      coefficients += word.name;
    } else if (is_spl_end(word) && coefficients.empty()) {
      ends += word.name;
    } else if (word.name != "F" && word.name != "FMAX" && word.name != "M") {
      return "spl-words";
    }
  }
  for (std::size_t at = 0; at < coefficients.size(); at += 9) {
    const char axis = coefficients[at + 2];
    const std::string three = {'K', '3', axis, 'K', '2', axis, 'K', '1', axis};
    if (coefficients.substr(at, 9) != three) return "spl-order";
    if (ends.find(axis) == std::string::npos) return "spl-order";
    if (last_axis.find(axis) != std::string::npos) return "spl-order";
    last_axis.push_back(axis);
  }
  if (last_axis.size() != ends.size()) return "spl-order";
  if (ends.size() < 2 || ends.size() > 5) return "spl-axes";
  return {};
}

SplBlock spl_block_of(const SplWords& joined, const Point3& place, double unit) {
  SplBlock block;
  Point3 end = place;
  std::array<Vector3, 3> k = {Vector3::Zero(), Vector3::Zero(), Vector3::Zero()};  // K1, K2, K3; mm
  for (const KlartextWord& word : joined.words) {
    if (word.is("F")) block.feed = word.value;
    if (!is_spl_end(word) && !is_spl_coefficient(word)) continue;
    const char axis = word.name.back();
    if (axis < 'X' || axis > 'Z') continue;
    const int i = axis - 'X';
    if (is_spl_coefficient(word)) {
      k[static_cast<std::size_t>(word.name[1] - '1')][i] = *word.value * unit;
    } else {
      block.axes[static_cast<std::size_t>(i)] = true;
      end[i] = *word.value * unit;
    }
  }
  const Point3 begin = end + (k[0] + (k[1] + k[2]));
  block.piece = {{begin, end + (2 * k[0] + k[1]) / 3, end + k[0] / 3, end}};
  return block;
}

const CurveFormat& heidenhain_spl() {
  static const CurveFormat kFormat = [] {
    CurveFormat format;
    format.name = "SPL";  // a software option on the iTNC 530: no default
    // Of the size of the piece; more where a joint would have a kink.
    format.other_mm = format.other_inch = {.decimals = 6};
    format.write = write_spl;
    format.read = read_spl;
    return format;
  }();
  return kFormat;
}

}  // namespace batten::gcode
