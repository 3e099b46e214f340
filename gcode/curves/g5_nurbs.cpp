#include "gcode/curves/g5_nurbs.h"

#include <algorithm>
#include <cmath>
#include <span>
#include <string_view>
#include <utility>
#include <vector>

#include "gcode/curves/spline_pieces.h"
#include "gcode/state/block_words.h"
#include "geometry/path/bspline_curve.h"

namespace batten::gcode {
namespace {

using geometry::BsplineBasis;
using geometry::Point3;

constexpr Code kOpens = 52;
constexpr Code kCloses = 53;
constexpr double kLeastL = 2;
constexpr double kUsualL = 3;
constexpr double kGreatestL = geometry::kMaxDegree + 1;

// A block of words with numbers, none of them beside N and `letters`; G and M as asked.
bool has_only(const Block& block, const BlockWords& words, std::size_t g_words,
              std::string_view letters) {
  if (block.opacity != ParseStatus::kNone || words.problem() != BlockWords::Problem::kNone ||
      !words.all_numbers() || words.g_codes().size() != g_words || !words.m_codes().empty()) {
    return false;
  }
  for (char letter = 'A'; letter <= 'Z'; ++letter) {
    const bool other = letter != 'N' && letters.find(letter) == std::string_view::npos;
    if (other && words.has(letter)) return false;
  }
  return true;
}

// Clamped, with steps of 1 between.
std::vector<double> even_knots(std::size_t points, std::size_t order) {
  std::vector<double> knots(order, 0.0);
  const std::size_t spans = points - order + 1;
  for (std::size_t i = 1; i < spans; ++i) knots.push_back(static_cast<double>(i));
  knots.insert(knots.end(), order, static_cast<double>(spans));
  return knots;
}

class EvenNurbsReader {
 public:
  EvenNurbsReader(const Program& program, const CurveStart& start)
      : program_(program), unit_(millimetres_per(start.units)), points_{start.position.mm} {
    reading_.axes = {true, true, false};
  }

  CurveResult read(std::uint32_t first) {
    if (!open(first)) return CurveRefusal{"G5.2 with other words or orders, or without P"};
    for (std::uint32_t at = first + 1; at < program_.blocks.size(); ++at) {
      const Block& block = program_.blocks[at];
      const BlockWords words(program_.words_of(block));
      if (words.has_g(kCloses) && has_only(block, words, 1, "")) {
        reading_.blocks = at + 1 - first;
        return curve();
      }
      const bool silent = block.opacity == ParseStatus::kNone && !words.has_words();
      if (silent) continue;
      if (!has_only(block, words, 0, "XYP") || !words.has('X') || !words.has('Y')) break;
      if (!add_point(at, words)) break;
    }
    return CurveRefusal{"no G5.3 behind points with weights"};
  }

 private:
  bool open(std::uint32_t first) {
    const Block& block = program_.blocks[first];
    const BlockWords words(program_.words_of(block));
    if (!words.has_g(kOpens) || !has_only(block, words, 1, "XYPLF")) return false;
    if (words.has('X') != words.has('Y')) return false;
    const double order = words.has('L') ? words.find('L')->value : kUsualL;
    if (order != std::floor(order) || order < kLeastL || order > kGreatestL) {
      return false;
    }
    order_ = static_cast<std::size_t>(order);
    if (const Word* feed = words.find('F')) {
      if (!(feed->value > 0)) return false;
      reading_.feed = feed->value;
    }
    if (words.has('X')) return add_point(first, words);
    return !words.has('P') || words.find('P')->value == 1;  // it belongs to no point
  }

  // False without a weight that is positive.
  bool add_point(std::uint32_t block, const BlockWords& words) {
    const Word* weight = words.find('P');
    if (weight == nullptr || !(weight->value > 0)) return false;
    Point3 point = points_.back();
    for (const int axis : {0, 1}) {
      const Word* word = words.find("XY"[axis]);
      point[axis] = word->value * unit_;
      reading_.decimals = std::max<int>(reading_.decimals, word->decimals);
    }
    points_.push_back(point);
    weights_.push_back(weight->value);
    blocks_.push_back(block);
    return true;
  }

  CurveResult curve() {
    if (points_.size() < order_) return CurveRefusal{"fewer points than the order"};
    const BsplineBasis basis(static_cast<int>(order_ - 1), even_knots(points_.size(), order_));
    // Piece i ends the influence of point i, and begins that of point i + order - 1: the first
    // point has no block.
    const auto blocks = std::span(blocks_).subspan(order_ - 2);
    if (!add_spline(basis, points_, weights_, blocks, reading_)) {
      return CurveRefusal{"weights that are too far apart"};
    }
    count_arcs();
    return std::move(reading_);
  }

  // The control makes two arcs of each of 4 N even parts of the parameter, N points.
  void count_arcs() {
    const double of_span = 8.0 * static_cast<double>(points_.size()) /
                           static_cast<double>(points_.size() - order_ + 1);
    std::vector<CurveMotion>& motions = reading_.motions;
    for (auto first = motions.begin(); first != motions.end();) {
      const auto last = std::find_if(first, motions.end(), [&](const CurveMotion& motion) {
        return motion.block != first->block;
      });
      const auto arcs = static_cast<float>(of_span / static_cast<double>(last - first));
      for (; first != last; ++first) first->arcs = arcs;
    }
  }

  const Program& program_;
  double unit_;
  std::size_t order_ = 0;
  std::vector<Point3> points_;         // mm; the first one is the place of the tool
  std::vector<double> weights_{1.0};   // of them
  std::vector<std::uint32_t> blocks_;  // of all points but the first
  CurveReading reading_;
};

}  // namespace

CurveResult read_g5_nurbs(const Program& program, std::uint32_t first, const CurveStart& start) {
  if (!start.position.known[0] || !start.position.known[1]) {
    return CurveRefusal{"the position is not known"};
  }
  return EvenNurbsReader(program, start).read(first);
}

}  // namespace batten::gcode
