#include "gcode/curves/siemens_bspline.h"

#include <algorithm>
#include <cmath>
#include <string>
#include <utility>

#include "gcode/curves/curve_format.h"
#include "gcode/curves/curve_print.h"
#include "gcode/curves/siemens_poly.h"
#include "gcode/curves/siemens_words.h"
#include "gcode/state/modal_state.h"
#include "geometry/basic/rounding.h"

namespace batten::gcode {
namespace {

using geometry::BsplineBasis;
using geometry::BsplineCurve;
using geometry::Point3;

constexpr std::size_t kDegree = 3;

// PL is a length like X; nine digits in all, as for other lengths of the control.
constexpr int kDigits = 9;

// One block: places and PL.
struct BsplineBlock {
  bool begins = false;
  bool understood = true;
  std::array<std::optional<double>, 3> place;
  std::optional<double> length;
  std::optional<double> feed;
};

BsplineBlock sorted(const std::vector<SiemensWord>& words) {
  BsplineBlock block;
  for (const SiemensWord& word : words) {
    const bool axis = word.name.size() == 1 && word.name[0] >= 'X' && word.name[0] <= 'Z';
    if (word.is("N") || (word.is("SD") && word.values == std::vector<double>{3})) continue;
    if (word.is("BSPLINE")) {
      block.begins = true;
    } else if (axis) {
      block.place[static_cast<std::size_t>(word.name[0] - 'X')] = word.value();
    } else if (word.is("PL") && word.values.size() == 1) {
      block.length = word.value();
    } else if (word.is("F") && word.values.size() == 1) {
      block.feed = word.value();
    } else {
      block.understood = false;
    }
  }
  return block;
}

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

}  // namespace

CurveWriting write_bspline(const BsplineCurve& curve, const CurveSetting& setting, BsplineUse use) {
  if (use != BsplineUse::kAcceptedUnverified) return CurveRefusal{std::string(kBsplineUnverified)};
  if (!is_clamped_cubic(curve)) return CurveRefusal{"BSPLINE is written for clamped cubics only"};
  const PlacePrinter printer(setting);
  const double step = printed_step(setting.places, setting.units);
  if ((curve.control_points().front() - setting.start).cwiseAbs().maxCoeff() > step) {
    return CurveRefusal{"the curve does not start where the tool stands"};
  }
  const auto knots = print_knots(
      curve, {.digits = kDigits, .decimals = std::min(setting.other.decimals, 4)}, step);
  if (!knots) return CurveRefusal{"distinct knots meet when they are rounded"};
  NumberFormat lengths = setting.other;
  lengths.decimals = knots->decimals;
  CurveLines lines;
  const auto& points = curve.control_points();
  for (std::size_t i = 1; i < points.size(); ++i) {
    std::string line = i == 1 ? "BSPLINE SD=3" : "";
    const PrintedPlace place =
        i + 1 < points.size() ? printer.place(points[i]) : printer.last_place(points[i]);
    for (std::size_t axis = 0; axis < 3; ++axis) {
      if (!place.digits[axis].empty())
        add_word(line, kAxisNames[axis] + place.digits[axis], setting);
    }
    const double length = knots->knots[i + kDegree] - knots->knots[i + kDegree - 1];
    line += " PL=" + to_text(length, lengths);
    if (i == 1 && setting.feed) line += " " + feed_word(setting);
    lines.push_back(std::move(line));
  }
  return lines;
}

CurveResult read_bspline(const Program& program, std::uint32_t first, const CurveStart& start,
                         BsplineUse use) {
  if (use != BsplineUse::kAcceptedUnverified) return CurveRefusal{std::string(kBsplineUnverified)};
  const double unit = millimetres_per(start.units);
  CurveReading reading;
  std::vector<Point3> points = {start.position.mm};
  std::vector<double> lengths;
  for (std::uint32_t at = first; at < program.blocks.size(); ++at) {
    const auto words = read_siemens_words(program.source.text(program.blocks[at].span));
    if (!words) break;
    const BsplineBlock block = sorted(*words);
    if (!block.understood || !block.length || block.begins != (at == first)) break;
    if (at == first) reading.feed = block.feed;
    if (at != first && block.feed) break;
    Point3 place = points.back();
    for (std::size_t axis = 0; axis < 3; ++axis) {
      if (!block.place[axis]) continue;
      if (!start.position.known[axis]) return CurveRefusal{"where the tool stands is not known"};
      reading.axes[axis] = true;
      place[static_cast<int>(axis)] = *block.place[axis] * unit;
    }
    points.push_back(place);
    lengths.push_back(*block.length);
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

namespace {

class BsplineFormat final : public CurveFormat {
 public:
  std::string_view name() const override { return "BSPLINE"; }
  bool is_default() const override { return false; }
  std::string_view caution() const override { return kBsplineUnverified; }

  // Both are members of one group, and what forbids the one forbids the other.
  std::string_view complaint(const ModalState& state) const override {
    return poly_complaint(state);
  }
  bool is_block_per_piece() const override { return false; }

  // PL, in the units of the curve's parameter: scaled as the knots of G06.2 are.
  NumberFormat other_numbers(Units) const override { return {.decimals = 4}; }

  CurveWriting write(const geometry::BsplineCurve& curve,
                     const CurveSetting& setting) const override {
    return write_bspline(curve, setting, BsplineUse::kAcceptedUnverified);
  }

  CurveResult read(const Program& program, std::uint32_t first,
                   const CurveStart& start) const override {
    return read_bspline(program, first, start, BsplineUse::kAcceptedUnverified);
  }
};

}  // namespace

const CurveFormat& siemens_bspline() {
  static const BsplineFormat kFormat;
  return kFormat;
}

}  // namespace batten::gcode
