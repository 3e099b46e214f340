#include "gcode/curves/nurbs.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <string>
#include <utility>

#include "gcode/curves/curve_format.h"
#include "gcode/curves/curve_print.h"
#include "gcode/state/modal_state.h"
#include "geometry/basic/rounding.h"

namespace batten::gcode {

NurbsRules fanuc_nurbs(Units units) {
  NurbsRules rules;
  rules.control = "FANUC";
  // Nine digits in the least increment of the reference axis: +-999999.999 in millimetres at IS-B,
  // +-99999.9999 in inches.
  rules.knots = {.digits = 9, .decimals = units == Units::kInch ? 4 : 3};
  return rules;
}

NurbsRules syntec_nurbs(Units units) {
  NurbsRules rules = fanuc_nurbs(units);
  rules.control = "Syntec";
  rules.weights = true;
  rules.framed = true;
  return rules;
}

NurbsRules mitsubishi_nurbs() {
  NurbsRules rules;
  rules.control = "Mitsubishi";
  // The manual limits the decimals only. Eight digits in all are what its axis words have.
  rules.knots = {.digits = 8, .decimals = 4};
  rules.three_axes = true;
  rules.framed = true;
  rules.missing_knot = "P33";
  rules.wrong_mode = "P29";
  rules.wrong_start = "start-differs";
  rules.decreasing = "P551";
  rules.axis_too_late = "P32";
  rules.too_many_decimals = "P33";
  return rules;
}

std::string_view nurbs_complaint(const ModalState& state) {
  if (state.feed_mode != FeedMode::kPerMinute) return "G06.2 needs feed per minute (G94)";
  if (state.distance != DistanceMode::kAbsolute) return "G06.2 is written in G90 only";
  const std::array<std::pair<TriState, std::string_view>, 11> items = {{
      {state.cutter_compensation, "G06.2 is an alarm under G41 and G42"},
      {state.polar, "G06.2 is an alarm under G12.1, and polar coordinates are no places"},
      {state.cylindrical, "G06.2 in cylindrical interpolation"},
      {state.tool_center_point, "G06.2 under tool centre point control"},
      {state.tilted_plane, "G06.2 in a tilted plane"},
      {state.scaling, "G06.2 under scaling"},
      {state.rotation, "G06.2 under rotation"},
      {state.mirror, "G06.2 under mirror image"},
      {state.modal_macro, "G06.2 under a modal macro call"},
      {state.constant_surface_speed, "G06.2 under constant surface speed"},
      {state.lathe_diameter, "G06.2 with diameters"},
  }};
  for (const auto& [item, complaint] : items) {
    if (item != TriState::kOff) return complaint;
  }
  return {};
}

namespace {

using geometry::BsplineBasis;
using geometry::BsplineCurve;
using geometry::Point3;

constexpr int kLeastOrder = 2;
constexpr int kGreatestOrder = 4;

// One block of a curve, or what is wrong with it.
struct NurbsBlock {
  bool begins = false;  // G06.2
  std::optional<double> order;
  std::optional<double> knot;
  std::optional<double> weight;
  std::optional<double> feed;
  std::array<std::optional<double>, 3> place;
  bool others = false;  // words that do not belong in a curve, or that were not understood

  [[nodiscard]] bool has_place() const { return place[0] || place[1] || place[2]; }
};

std::optional<double>* slot_of(char letter, NurbsBlock& block) {
  switch (letter) {
    case 'P':
      return &block.order;
    case 'K':
      return &block.knot;
    case 'R':
      return &block.weight;
    case 'F':
      return &block.feed;
    case 'X':
    case 'Y':
    case 'Z':
      return &block.place[static_cast<std::size_t>(letter - 'X')];
    default:
      return nullptr;
  }
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

  std::variant<NurbsText, CurveRefusal> read(std::uint32_t first) {
    std::uint32_t at = first;
    if (rules_.framed && !is_frame(program_, at++, 10000)) return refuse("no G05 P10000 before it");
    if (!begin(at)) return CurveRefusal{trouble_};
    for (++at; !complete(); ++at) {
      if (at >= program_.blocks.size()) return refuse("the program ends inside the curve");
      if (!add(at)) return CurveRefusal{trouble_};
    }
    if (rules_.framed && !is_frame(program_, at++, 0)) return refuse("no G05 P0 behind it");
    text_.blocks = at - first;
    if (!knots_fit()) return CurveRefusal{trouble_};
    return std::move(text_);
  }

 private:
  CurveRefusal refuse(std::string why) const { return {std::move(why)}; }
  bool fail(std::string why) {
    trouble_ = std::move(why);
    return false;
  }

  bool complete() const { return ending_knots_ == text_.order; }

  bool begin(std::uint32_t at) {
    if (at >= program_.blocks.size()) return fail("no block");
    const NurbsBlock block = words_of_block(program_, program_.blocks[at]);
    if (!block.begins) return fail("no G06.2");
    if (block.others) return fail("other words beside G06.2");
    const double order = block.order.value_or(kGreatestOrder);
    if (order != std::floor(order) || order < kLeastOrder || order > kGreatestOrder) {
      return fail("P" + to_text(order, {.decimals = 3}) + ", expected P2 to P4");
    }
    text_.order = static_cast<int>(order);
    text_.feed = block.feed;
    for (std::size_t axis = 0; axis < 3; ++axis) text_.axes[axis] = block.place[axis].has_value();
    if (!block.has_place() || !block.knot) return fail("no point or no knot beside G06.2");
    if (rules_.three_axes && !(text_.axes[0] && text_.axes[1] && text_.axes[2])) {
      return fail("X, Y and Z are not all named beside G06.2");
    }
    return add_point(at, block) && starts_in_place();
  }

  bool starts_in_place() {
    for (std::size_t axis = 0; axis < 3; ++axis) {
      if (!text_.axes[axis]) continue;
      if (!start_.position.known[axis]) return fail("where the tool stands is not known");
      const double off =
          text_.points[0][static_cast<int>(axis)] - start_.position.mm[static_cast<int>(axis)];
      if (std::abs(off) > geometry::kSamePlace) {
        return fail("the first point is not where the tool stands");
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
      if (ending_knots_ > 0) return fail("a point behind the ending knots");
      return add_point(at, block);
    }
    if (block.weight) return fail("a weight without a point");
    text_.knots.push_back(*block.knot);
    ++ending_knots_;
    return true;
  }

  bool add_point(std::uint32_t at, const NurbsBlock& block) {
    for (std::size_t axis = 0; axis < 3; ++axis) {
      if (!block.place[axis]) continue;
      if (!text_.axes[axis]) return fail("an axis that the first block does not name");
      place_[static_cast<int>(axis)] = *block.place[axis] * unit_;
    }
    text_.points.push_back(place_);
    text_.weights.push_back(block.weight.value_or(1));
    text_.knots.push_back(*block.knot);
    text_.point_blocks.push_back(at);
    if (!(text_.weights.back() > 0)) return fail("a weight that is not positive");
    return true;
  }

  bool knots_fit() {
    const auto order = static_cast<std::size_t>(text_.order);
    const std::vector<double>& t = text_.knots;
    if (text_.points.size() < order) return fail("fewer points than the order");
    if (!std::ranges::is_sorted(t)) return fail("a knot that decreases");
    if (t[0] != t[order - 1] || t[t.size() - order] != t.back()) {
      return fail("the first or the last knots are not all the same");
    }
    if (!(t[0] < t.back())) return fail("all knots are the same");
    // A curve that comes apart: nothing holds it together where a knot stands once more than the
    // degree says.
    for (std::size_t i = 1; i + order < t.size(); ++i) {
      if (t[i] > t[0] && t[i + order - 1] < t.back() && t[i] == t[i + order - 1]) {
        return fail("an inner knot stands as often as the order");
      }
    }
    // At an end, too, points would be left out.
    for (std::size_t i = 0; i + order < t.size(); ++i) {
      if (t[i] == t[i + order]) return fail("a knot stands more often than the order");
    }
    return true;
  }

  const Program& program_;
  const NurbsRules& rules_;
  const CurveStart& start_;
  double unit_;
  Point3 place_;
  NurbsText text_;
  int ending_knots_ = 0;
  std::string trouble_;
};

}  // namespace

Point3 NurbsText::point_at(double u) const {
  const BsplineBasis basis(order - 1, knots);
  const std::size_t span = basis.find_span(u);
  std::array<double, kGreatestOrder> values{};
  basis.evaluate(span, std::clamp(u, basis.first(), basis.last()), values.data());
  Point3 sum = Point3::Zero();
  double weight = 0;
  for (std::size_t j = 0; j < static_cast<std::size_t>(order); ++j) {
    const std::size_t i = span + 1 + j - static_cast<std::size_t>(order);
    sum += values[j] * weights[i] * points[i];
    weight += values[j] * weights[i];
  }
  return sum / weight;
}

bool NurbsText::is_polynomial() const {
  return std::ranges::all_of(weights, [this](double w) { return w == weights.front(); });
}

BsplineCurve NurbsText::curve() const { return {BsplineBasis(order - 1, knots), points}; }

std::variant<NurbsText, CurveRefusal> read_nurbs_text(const Program& program, std::uint32_t first,
                                                      const CurveStart& start,
                                                      const NurbsRules& rules) {
  return NurbsReader(program, start, rules).read(first);
}

CurveResult read_nurbs(const Program& program, std::uint32_t first, const CurveStart& start,
                       const NurbsRules& rules) {
  auto read = read_nurbs_text(program, first, start, rules);
  if (auto* refusal = std::get_if<CurveRefusal>(&read)) return std::move(*refusal);
  const NurbsText& text = std::get<NurbsText>(read);
  if (!text.is_polynomial()) return CurveRefusal{"weights that differ"};
  CurveReading reading;
  reading.blocks = text.blocks;
  reading.axes = text.axes;
  reading.feed = text.feed;
  const BsplineCurve curve = text.curve();
  const auto order = static_cast<std::size_t>(text.order);
  std::size_t span = order - 1;
  for (const geometry::CubicBezier& piece : curve.bezier_pieces()) {
    while (!(text.knots[span] < text.knots[span + 1])) ++span;
    reading.motions.push_back({text.point_blocks[span], piece});
    ++span;
  }
  return reading;
}

namespace {

using geometry::BsplineCurve;
using geometry::Point3;

constexpr std::size_t kOrder = 4;

// Six digits before the point: what nine digits in the least increment leave in millimetres.
constexpr double kGreatestNurbsPlace = 999999.999;

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

// The words of the control points, without knots; empty when one cannot be printed.
struct Points {
  std::vector<PrintedPlace> printed;
  std::string trouble;
};

Points print_points(const std::vector<Point3>& points, const CurveSetting& setting) {
  const PlacePrinter printer(setting);
  Points result;
  const auto start = printer.start();
  if (!start) {
    result.trouble = "the start has more decimals than the control reads";
    return result;
  }
  result.printed.push_back(*start);
  for (std::size_t i = 1; i < points.size(); ++i) {
    result.printed.push_back(i + 1 < points.size() ? printer.place(points[i])
                                                   : printer.last_place(points[i]));
    if (result.printed.back().mm.cwiseAbs().maxCoeff() > kGreatestNurbsPlace * printer.unit()) {
      result.trouble = "a place beyond 999999.999";
      return result;
    }
  }
  return result;
}

BsplineCurve with_points(const BsplineCurve& curve, const Points& points) {
  std::vector<Point3> places;
  places.reserve(points.printed.size());
  for (const PrintedPlace& place : points.printed) places.push_back(place.mm);
  return {curve.basis(), std::move(places)};
}

class NurbsLines {
 public:
  NurbsLines(const CurveSetting& setting, const NurbsRules& rules, int knot_decimals)
      : setting_(setting), rules_(rules), knots_(setting.other) {
    knots_.decimals = knot_decimals;
  }

  void point(const std::string& opening, double knot, const PrintedPlace& place,
             const std::string& closing) {
    std::string line = opening;
    add_word(line, "K" + to_text(knot, knots_), setting_);
    for (std::size_t axis = 0; axis < 3; ++axis) {
      if (place.digits[axis].empty()) continue;
      add_word(line, kAxisNames[axis] + place.digits[axis], setting_);
    }
    if (rules_.weights) add_word(line, "R" + to_text(1, knots_), setting_);
    add_word(line, closing, setting_);
    lines_.push_back(std::move(line));
  }

  void knot_alone(double knot) { lines_.push_back("K" + to_text(knot, knots_)); }
  void frame(std::string_view text) { lines_.emplace_back(text); }

  [[nodiscard]] CurveLines take() { return std::move(lines_); }

 private:
  const CurveSetting& setting_;
  const NurbsRules& rules_;
  NumberFormat knots_;
  CurveLines lines_;
};

std::string_view trouble_with(const BsplineCurve& curve, const CurveSetting& setting,
                              const NurbsRules& rules) {
  if (!is_clamped_cubic(curve)) return "G06.2 is written for clamped cubic curves only";
  const auto named = std::ranges::count(setting.axes, true);
  if (named == 0) return "no axis is named";
  if (rules.three_axes && named < 3) return "this control's G06.2 names X, Y and Z";
  if (!only_named_axes_move(curve.control_points(), setting))
    return "an axis moves and has no word";
  return {};
}

}  // namespace

CurveWriting write_nurbs(const BsplineCurve& curve, const CurveSetting& setting,
                         const NurbsRules& rules) {
  const std::string_view trouble = trouble_with(curve, setting, rules);
  if (!trouble.empty()) return CurveRefusal{std::string(trouble)};
  const Points points = print_points(curve.control_points(), setting);
  if (!points.trouble.empty()) return CurveRefusal{points.trouble};

  KnotDigits digits = rules.knots;
  if (setting.other.decimals < digits.decimals) {
    digits.digits -= digits.decimals - setting.other.decimals;
    digits.decimals = setting.other.decimals;
  }
  const auto knots =
      print_knots(with_points(curve, points), digits, printed_step(setting.places, setting.units));
  if (!knots) return CurveRefusal{"distinct knots meet when they are rounded"};

  NurbsLines lines(setting, rules, knots->decimals);
  std::string opening = "G06.2";
  add_word(opening, "P4", setting);
  if (rules.framed) lines.frame(kFrameBegin);
  for (std::size_t i = 0; i < points.printed.size(); ++i) {
    const bool first = i == 0;
    lines.point(first ? opening : std::string(), knots->knots[i], points.printed[i],
                first ? feed_word(setting) : std::string());
  }
  for (std::size_t i = 0; i < kOrder; ++i) lines.knot_alone(knots->knots.back());
  if (rules.framed) lines.frame(kFrameEnd);
  return lines.take();
}

namespace {

class NurbsFormat final : public CurveFormat {
 public:
  using Rules = NurbsRules (*)(Units);
  explicit NurbsFormat(Rules rules) : rules_(rules) {}

  std::string_view name() const override { return "G06.2"; }
  bool is_default() const override { return false; }
  std::string_view complaint(const ModalState& state) const override {
    return nurbs_complaint(state);
  }
  bool is_block_per_piece() const override { return false; }
  bool names_all_axes() const override { return rules_(Units::kMillimetre).three_axes; }
  NumberFormat other_numbers(Units units) const override {
    return {.decimals = rules_(units).knots.decimals, .always_point = true};
  }

  CurveWriting write(const geometry::BsplineCurve& curve,
                     const CurveSetting& setting) const override {
    return write_nurbs(curve, setting, rules_(setting.units));
  }

  CurveResult read(const Program& program, std::uint32_t first,
                   const CurveStart& start) const override {
    return read_nurbs(program, first, start, rules_(start.units));
  }

 private:
  Rules rules_;
};

NurbsRules mitsubishi_in(Units) { return mitsubishi_nurbs(); }

}  // namespace

const CurveFormat& fanuc_curves() {
  static const NurbsFormat kFormat(&fanuc_nurbs);
  return kFormat;
}

const CurveFormat& syntec_curves() {
  static const NurbsFormat kFormat(&syntec_nurbs);
  return kFormat;
}

const CurveFormat& mitsubishi_curves() {
  static const NurbsFormat kFormat(&mitsubishi_in);
  return kFormat;
}

}  // namespace batten::gcode
