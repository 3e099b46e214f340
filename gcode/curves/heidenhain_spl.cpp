#include "gcode/curves/heidenhain_spl.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <string>
#include <utility>

#include "gcode/curves/bezier_chain.h"
#include "gcode/curves/curve_print.h"
#include "gcode/klartext/statement.h"
#include "gcode/state/modal_state.h"

namespace batten::gcode {
namespace {

using geometry::CubicBezier;
using geometry::Point3;
using geometry::Vector3;

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
      block.end = i + 1 < pieces_.size() ? printer_.place(wanted) : printer_.last_place(wanted);
      if (block.end.mm.cwiseAbs().maxCoeff() > kGreatestEnd * printer_.unit()) {
        return "a place beyond 99999.9999";
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

  [[nodiscard]] CurveLines lines(const SplOptions& options) const {
    CurveLines lines;
    for (std::size_t i = 0; i < blocks_.size(); ++i) {
      std::string line = "SPL";
      if (options.first_number) {
        line = std::to_string(*options.first_number + static_cast<int>(i)) + " SPL";
      }
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

}  // namespace

std::string_view spl_complaint(const ModalState& state) {
  if (state.feed_mode != FeedMode::kPerMinute) return "SPL needs feed per minute";
  if (state.distance != DistanceMode::kAbsolute) return "SPL is written with absolute places only";
  const std::array<std::pair<TriState, std::string_view>, 8> items = {{
      {state.cutter_compensation, "SPL under RL or RR"},
      {state.polar, "SPL in polar coordinates"},
      {state.cylindrical, "SPL on a cylinder surface"},
      {state.tool_center_point, "SPL under M128"},
      {state.tilted_plane, "SPL in a tilted plane"},
      {state.scaling, "SPL under a scaling cycle"},
      {state.rotation, "SPL under a rotation cycle"},
      {state.mirror, "SPL under a mirror cycle"},
  }};
  for (const auto& [item, complaint] : items) {
    if (item != TriState::kOff) return complaint;
  }
  return {};
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

CurveWriting write_spl(std::span<const CubicBezier> pieces, const CurveSetting& setting,
                       const SplOptions& options) {
  if (pieces.empty()) return CurveRefusal{"no curve"};
  if (std::ranges::count(setting.axes, true) < 2) {
    return CurveRefusal{"SPL names two axes or more"};
  }
  const double step = printed_step(setting.places, setting.units);
  if ((pieces.front().control[0] - setting.start).cwiseAbs().maxCoeff() > step) {
    return CurveRefusal{"the curve does not start where the tool stands"};
  }
  const int most = std::min(options.max_decimals, kMantissaDecimals);
  for (int decimals = std::min(setting.other.decimals, most); decimals <= most; ++decimals) {
    SplWriter writer(pieces, setting, decimals);
    const std::string trouble = writer.print();
    const bool last = decimals == most;
    if (!trouble.empty() && last) return CurveRefusal{trouble};
    if (trouble.empty() && !writer.adds_kinks()) return writer.lines(options);
  }
  return CurveRefusal{"rounding makes a kink of 0.1 degrees or more"};
}

using geometry::Point3;

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

SplBlock spl_block_of(const SplWords& joined, std::uint32_t at, const Point3& place, double unit) {
  SplBlock block;
  block.block = at;
  block.end = place;
  for (const KlartextWord& word : joined.words) {
    if (word.is("F")) block.feed = word.value;
    if (!is_spl_end(word) && !is_spl_coefficient(word)) continue;
    const char axis = word.name.back();
    if (axis < 'X' || axis > 'Z') continue;
    const int i = axis - 'X';
    if (is_spl_coefficient(word)) {
      block.k[static_cast<std::size_t>(word.name[1] - '1')][i] = *word.value * unit;
    } else {
      block.axes[static_cast<std::size_t>(i)] = true;
      block.end[i] = *word.value * unit;
    }
  }
  return block;
}

namespace {

bool starts_spline(const Program& program, std::uint32_t block) {
  const SourceSpan content =
      klartext_parts(program.source.text(), program.blocks[block].span).content;
  return klartext_kind(program.source.text(content)) == KlartextKind::kSpline;
}

class SplFormat final : public CurveFormat {
 public:
  std::string_view name() const override { return "SPL"; }

  // A software option on the iTNC 530.
  bool is_default() const override { return false; }
  std::string_view complaint(const ModalState& state) const override {
    return spl_complaint(state);
  }
  bool is_block_per_piece() const override { return true; }

  // Of the size of the piece; write_spl takes more where a joint would have a kink.
  NumberFormat other_numbers(Units) const override { return {.decimals = 6}; }

  CurveWriting write(const geometry::BsplineCurve& curve,
                     const CurveSetting& setting) const override {
    return write_spl(curve.bezier_pieces(), setting, {});
  }

  CurveResult read(const Program& program, std::uint32_t first,
                   const CurveStart& start) const override {
    const bool may_be = program.blocks[first].opacity == ParseStatus::kForeign;
    if (!may_be || !starts_spline(program, first)) return CurveRefusal{"no SPL"};
    return read_spl(program, first, start);
  }
};

}  // namespace

const CurveFormat& heidenhain_spl() {
  static const SplFormat kFormat;
  return kFormat;
}

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
