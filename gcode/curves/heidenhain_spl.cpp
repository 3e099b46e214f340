#include "gcode/curves/heidenhain_spl.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <string>
#include <utility>

#include "gcode/curves/bezier_chain.h"
#include "gcode/curves/curve_print.h"
#include "gcode/curves/spl_limits.h"
#include "gcode/state/units.h"

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

}  // namespace batten::gcode
