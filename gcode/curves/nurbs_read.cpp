#include "gcode/curves/nurbs_read.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <string>
#include <utility>

#include "gcode/state/units.h"
#include "geometry/basic/rounding.h"

namespace batten::gcode {
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

}  // namespace batten::gcode
