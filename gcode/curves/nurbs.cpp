#include "gcode/curves/nurbs.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <string>
#include <utility>

#include "gcode/curves/curve_print.h"
#include "gcode/curves/spline_pieces.h"
#include "geometry/basic/rounding.h"

namespace batten::gcode {
namespace {

using geometry::BsplineBasis;
using geometry::BsplineCurve;
using geometry::Point3;

struct NurbsRules {
  KnotDigits mm;  // of K; the decimals hold for R too
  KnotDigits inch;
  bool three_axes = false;  // X, Y and Z are all named, always
  // R1 in every block that has a place, rather than leaving the weight to be 1.
  bool weights = false;
  bool framed = false;  // G05 P10000 right before the curve, and G05 P0 right after it
};

// FANUC 15i/16i/18i/30i/31i, least increment 0.001 mm or 0.0001 inch. Nine digits in the least
// increment of the reference axis: +-999999.999 in millimetres at IS-B, +-99999.9999 in inches.
constexpr NurbsRules kFanuc = {.mm = {.digits = 9, .decimals = 3},
                               .inch = {.digits = 9, .decimals = 4}};

// As FANUC, in the frame that its sample has, with weights.
constexpr NurbsRules kSyntec = {
    .mm = kFanuc.mm, .inch = kFanuc.inch, .weights = true, .framed = true};

// M700V. The manual limits the decimals only. Eight digits in all are what its axis words have.
constexpr KnotDigits kMitsubishiDigits = {.digits = 8, .decimals = 4};
constexpr NurbsRules kMitsubishi = {
    .mm = kMitsubishiDigits, .inch = kMitsubishiDigits, .three_axes = true, .framed = true};

constexpr int kLeastOrder = 2;
constexpr int kGreatestOrder = 4;

// Six digits before the point: what nine digits in the least increment leave in millimetres.
constexpr double kGreatestNurbsPlace = 999999.999;

// --- reading ------------------------------------------------------------------------------------

// One block of a curve, or what is wrong with it.
struct NurbsBlock {
  bool begins = false;  // G06.2
  std::optional<double> order;
  std::optional<double> knot;
  std::optional<double> weight;
  std::optional<double> feed;
  std::array<std::optional<double>, 3> place;
  int decimals = 0;     // of the place: most digits after the point
  bool others = false;  // words that do not belong in a curve, or that were not understood

  [[nodiscard]] bool has_place() const { return place[0] || place[1] || place[2]; }
};

bool is_axis(char letter) { return letter >= 'X' && letter <= 'Z'; }

std::optional<double>* slot_of(char letter, NurbsBlock& block) {
  if (is_axis(letter)) return &block.place[static_cast<std::size_t>(letter - 'X')];
  return letter == 'P'   ? &block.order
         : letter == 'K' ? &block.knot
         : letter == 'R' ? &block.weight
         : letter == 'F' ? &block.feed
                         : nullptr;
}

NurbsBlock words_of_block(const Program& program, const Block& block) {
  NurbsBlock read;
  read.others =
      block.opacity != ParseStatus::kNone || block.block_delete || block.comment_count > 0;
  for (const Word& word : program.words_of(block)) {
    std::optional<double>* slot = slot_of(word.letter, read);
    if (word.letter == 'N') continue;
    if (word.letter == 'G' && word.is_number && word.value == 6.2 && !read.begins) {
      read.begins = true;
    } else if (slot != nullptr && !*slot && word.is_number) {
      *slot = word.value;
      if (is_axis(word.letter)) read.decimals = std::max<int>(read.decimals, word.decimals);
    } else {
      read.others = true;
    }
  }
  return read;
}

// G05 with this P, alone in its block.
bool is_frame(const Program& program, std::uint32_t block, double p) {
  if (block >= program.blocks.size()) return false;
  const Block& line = program.blocks[block];
  if (line.opacity != ParseStatus::kNone || line.block_delete) return false;
  int found = 0;
  for (const Word& word : program.words_of(line)) {
    if (word.letter == 'N') continue;
    const bool code = word.letter == 'G' && word.value == 5;
    const bool value = word.letter == 'P' && word.value == p;
    if (!word.is_number || (!code && !value)) return false;
    ++found;
  }
  return found == 2;
}

class NurbsReader {
 public:
  NurbsReader(const Program& program, const CurveStart& start, const NurbsRules& rules)
      : program_(program),
        rules_(rules),
        start_(start),
        unit_(millimetres_per(start.units)),
        place_(start.position.mm) {}

  CurveResult read(std::uint32_t first) {
    if (!read_blocks(first) || !knots_fit()) return CurveRefusal{trouble_};
    // The span to knot i + 1 belongs to the block of control point i.
    std::vector<std::uint32_t> blocks;
    for (auto i = static_cast<std::size_t>(order_ - 1); i < points_.size(); ++i) {
      if (knots_[i] < knots_[i + 1]) blocks.push_back(point_blocks_[i]);
    }
    if (!add_spline(BsplineBasis(order_ - 1, knots_), points_, weights_, blocks, reading_)) {
      return CurveRefusal{"weights that are too far apart"};
    }
    return std::move(reading_);
  }

 private:
  bool fail(std::string why) {
    trouble_ = std::move(why);
    return false;
  }

  bool read_blocks(std::uint32_t first) {
    std::uint32_t at = first;
    if (rules_.framed && !is_frame(program_, at++, 10000)) return fail("no G05 P10000 before it");
    if (!begin(at)) return false;
    for (++at; ending_knots_ < order_; ++at) {
      if (at >= program_.blocks.size()) return fail("the program ends inside the curve");
      if (!add(at)) return false;
    }
    if (rules_.framed && !is_frame(program_, at++, 0)) return fail("no G05 P0 after it");
    reading_.blocks = at - first;
    return true;
  }

  bool begin(std::uint32_t at) {
    if (at >= program_.blocks.size()) return fail("no block");
    const NurbsBlock block = words_of_block(program_, program_.blocks[at]);
    if (!block.begins) return fail("no G06.2");
    if (block.others) return fail("other words beside G06.2");
    const double order = block.order.value_or(kGreatestOrder);
    if (order != std::floor(order) || order < kLeastOrder || order > kGreatestOrder) {
      return fail("P" + to_text(order, {.decimals = 3}) + ", expected P2 to P4");
    }
    order_ = static_cast<int>(order);
    reading_.feed = block.feed;
    for (std::size_t axis = 0; axis < 3; ++axis)
      reading_.axes[axis] = block.place[axis].has_value();
    if (!block.has_place() || !block.knot) return fail("no point or no knot beside G06.2");
    if (rules_.three_axes && !(reading_.axes[0] && reading_.axes[1] && reading_.axes[2])) {
      return fail("X, Y and Z are not all named beside G06.2");
    }
    return add_point(at, block) && starts_in_place();
  }

  bool starts_in_place() {
    for (std::size_t axis = 0; axis < 3; ++axis) {
      if (!reading_.axes[axis]) continue;
      if (!start_.position.known[axis]) return fail("the tool's position is not known");
      const double off =
          points_[0][static_cast<int>(axis)] - start_.position.mm[static_cast<int>(axis)];
      if (std::abs(off) > geometry::kSamePlace) {
        return fail("the first point is not the tool's position");
      }
    }
    return true;
  }

  bool add(std::uint32_t at) {
    const NurbsBlock block = words_of_block(program_, program_.blocks[at]);
    if (block.begins || block.others || block.order || block.feed) {
      return fail("other words inside the curve");
    }
    if (!block.knot) return fail("a block without a knot");
    if (block.has_place()) {
      if (ending_knots_ > 0) return fail("a point after the ending knots");
      return add_point(at, block);
    }
    if (block.weight) return fail("a weight without a point");
    knots_.push_back(*block.knot);
    ++ending_knots_;
    return true;
  }

  bool add_point(std::uint32_t at, const NurbsBlock& block) {
    for (std::size_t axis = 0; axis < 3; ++axis) {
      if (!block.place[axis]) continue;
      if (!reading_.axes[axis]) return fail("an axis that the first block does not name");
      place_[static_cast<int>(axis)] = *block.place[axis] * unit_;
    }
    points_.push_back(place_);
    reading_.decimals = std::max(reading_.decimals, block.decimals);
    knots_.push_back(*block.knot);
    point_blocks_.push_back(at);
    weights_.push_back(block.weight.value_or(1));
    return weights_.back() > 0 || fail("a weight that is not positive");
  }

  bool knots_fit() {
    const auto order = static_cast<std::size_t>(order_);
    const std::vector<double>& t = knots_;
    if (points_.size() < order) return fail("fewer points than the order");
    if (!std::ranges::is_sorted(t)) return fail("a knot that decreases");
    if (t[0] != t[order - 1] || t[t.size() - order] != t.back()) {
      return fail("the first or the last knots are not all the same");
    }
    if (!(t[0] < t.back())) return fail("all knots are the same");
    // A curve that comes apart: nothing holds it together where a knot stands once more than the
    // degree says.
    for (std::size_t i = 1; i + order < t.size(); ++i) {
      if (t[i] > t[0] && t[i + order - 1] < t.back() && t[i] == t[i + order - 1]) {
        return fail("an inner knot is repeated as often as the order");
      }
    }
    // At an end, too, points would be left out.
    for (std::size_t i = 0; i + order < t.size(); ++i) {
      if (t[i] == t[i + order]) return fail("a knot is repeated more often than the order");
    }
    return true;
  }

  const Program& program_;
  NurbsRules rules_;
  const CurveStart& start_;
  double unit_;
  Point3 place_;
  CurveReading reading_;
  int order_ = kGreatestOrder;
  std::vector<double> knots_;
  std::vector<Point3> points_;   // mm; axes that are not named stay where they were
  std::vector<double> weights_;  // of them
  std::vector<std::uint32_t> point_blocks_;
  int ending_knots_ = 0;
  std::string trouble_;
};

// --- writing ------------------------------------------------------------------------------------

bool only_named_axes_move(const std::vector<Point3>& points, const CurveSetting& setting) {
  const double step = printed_step(setting.places, setting.units);
  for (const Point3& point : points) {
    for (int axis = 0; axis < 3; ++axis) {
      if (setting.axes[static_cast<std::size_t>(axis)]) continue;
      // Half a step is what printing would take away, too.
      if (std::abs(point[axis] - setting.start[axis]) > step / 2) return false;
    }
  }
  return true;
}

std::string_view trouble_with(const BsplineCurve& curve, const CurveSetting& setting,
                              const NurbsRules& rules) {
  if (!is_clamped_cubic(curve)) return "G06.2 is written for clamped cubic curves only";
  const auto named = std::ranges::count(setting.axes, true);
  if (named == 0) return "no axis is named";
  if (rules.three_axes && named < 3) return "this control's G06.2 names X, Y and Z";
  if (!only_named_axes_move(curve.control_points(), setting)) {
    return "an axis moves and has no word";
  }
  return {};
}

CurveLines lines_of(const std::vector<PrintedPlace>& places, const PrintedKnots& knots,
                    const CurveSetting& setting, const NurbsRules& rules) {
  NumberFormat format = setting.other;
  format.decimals = knots.decimals;
  CurveLines lines;
  if (rules.framed) lines.emplace_back("G05 P10000");
  for (std::size_t i = 0; i < places.size(); ++i) {
    std::string line = i == 0 ? "G06.2" : "";
    if (i == 0) add_word(line, "P4", setting);
    add_word(line, "K" + to_text(knots.knots[i], format), setting);
    add_place(line, places[i], setting);
    if (rules.weights) add_word(line, "R" + to_text(1, format), setting);
    if (i == 0) add_word(line, feed_word(setting), setting);
    lines.push_back(std::move(line));
  }
  lines.insert(lines.end(), kGreatestOrder, "K" + to_text(knots.knots.back(), format));
  if (rules.framed) lines.emplace_back("G05 P0");
  return lines;
}

CurveWriting write_nurbs(const BsplineCurve& curve, const CurveSetting& setting,
                         const NurbsRules& rules) {
  const std::string_view trouble = trouble_with(curve, setting, rules);
  if (!trouble.empty()) return CurveRefusal{std::string(trouble)};
  const PlacePrinter printer(setting);
  const auto start = printer.start();
  if (!start) return CurveRefusal{"the start has more decimals than the control reads"};
  std::vector<PrintedPlace> places = {*start};
  std::vector<Point3> points = {start->mm};
  for (std::size_t i = 1; i < curve.control_points().size(); ++i) {
    const bool is_last = i + 1 == curve.control_points().size();
    places.push_back(printer.place(curve.control_points()[i], is_last));
    points.push_back(places.back().mm);
    if (points.back().cwiseAbs().maxCoeff() > kGreatestNurbsPlace * printer.unit()) {
      return CurveRefusal{"a position beyond 999999.999"};
    }
  }
  KnotDigits digits = setting.units == Units::kInch ? rules.inch : rules.mm;
  if (setting.other.decimals < digits.decimals) {
    digits.digits -= digits.decimals - setting.other.decimals;
    digits.decimals = setting.other.decimals;
  }
  const auto knots = print_knots({curve.basis(), std::move(points)}, digits,
                                 printed_step(setting.places, setting.units));
  if (!knots) return CurveRefusal{"distinct knots meet when they are rounded"};
  return lines_of(places, *knots, setting, rules);
}

CurveFormat nurbs_format(const NurbsRules& rules) {
  return {.name = "G06.2",
          .is_block_per_piece = false,
          .names_all_axes = rules.three_axes,
          .other_mm = {.decimals = rules.mm.decimals, .always_point = true},
          .other_inch = {.decimals = rules.inch.decimals, .always_point = true},
          .write = [rules](const auto& curve,
                           const auto& setting) { return write_nurbs(curve, setting, rules); },
          .read =
              [rules](const Program& program, std::uint32_t first, const CurveStart& start) {
                return NurbsReader(program, start, rules).read(first);
              }};
}

}  // namespace

const CurveFormat& fanuc_curves() {
  static const CurveFormat kFormat = nurbs_format(kFanuc);
  return kFormat;
}

const CurveFormat& syntec_curves() {
  static const CurveFormat kFormat = nurbs_format(kSyntec);
  return kFormat;
}

const CurveFormat& mitsubishi_curves() {
  static const CurveFormat kFormat = nurbs_format(kMitsubishi);
  return kFormat;
}

}  // namespace batten::gcode
