#include "gcode/curves/g5_curve.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <string_view>
#include <tuple>

#include "gcode/curves/curve_print.h"
#include "gcode/state/block_words.h"
#include "geometry/basic/point.h"
#include "geometry/basic/rounding.h"
#include "geometry/path/cubic_polynomial.h"

namespace batten::gcode {
namespace {

using geometry::CubicBezier;
using geometry::Point3;
using geometry::Vector3;

constexpr Code kG5 = 50;

// The arcs of a sixteenth that turns by `a` radians are right to some 1e-15 / a^2 of its length:
// to 1e-7 of it here, which is far less than is printed.
constexpr double kLeastTurn = 1e-4;
constexpr int kParts = 16;

bool is_flat(const CubicBezier& piece, double height) {
  return std::ranges::all_of(piece.control, [height](const Point3& point) {
    return std::abs(point.z() - height) <= geometry::kSamePlace;
  });
}

CurveWriting write_g5(const geometry::BsplineCurve& curve, const CurveSetting& setting) {
  const double unit = millimetres_per(setting.units);
  std::string line;
  // Returns what the control reads, mm.
  const auto add_length = [&](char letter, double mm, const NumberFormat& format) {
    const std::string digits = to_text(mm / unit, format);
    add_word(line, letter + digits, setting);
    return read_number(digits)->value * unit;
  };
  const std::vector<CubicBezier> pieces = curve.bezier_pieces();
  CurveLines lines;
  for (std::size_t i = 0; i < pieces.size(); ++i) {
    const CubicBezier& piece = pieces[i];
    if (!is_flat(piece, setting.start.z())) return CurveRefusal{"the piece leaves XY"};
    NumberFormat places = setting.places;
    if (i + 1 == pieces.size()) places.decimals = std::max(places.decimals, setting.last_decimals);
    line = "G5";
    (void)add_length('X', piece.control[3].x(), places);
    (void)add_length('Y', piece.control[3].y(), places);
    // The ways of the given piece, not those from the printed ends: rounding those makes no kinks.
    const Vector3 from_start = piece.control[1] - piece.control[0];
    const Vector3 from_end = piece.control[2] - piece.control[3];
    const double out_x = add_length('I', from_start.x(), setting.other);
    const double out_y = add_length('J', from_start.y(), setting.other);
    const double back_x = add_length('P', from_end.x(), setting.other);
    const double back_y = add_length('Q', from_end.y(), setting.other);
    if ((out_x == 0 && out_y == 0) || (back_x == 0 && back_y == 0)) {
      return CurveRefusal{"an offset of a Bezier point is zero once it is printed"};
    }
    if (i == 0) add_word(line, feed_word(setting), setting);
    lines.push_back(line);
  }
  return lines;
}

CurveResult read_g5(const Program& program, std::uint32_t first, const CurveStart& start) {
  const Block& block = program.blocks[first];
  if (block.opacity != ParseStatus::kNone) return CurveRefusal{"not words alone"};
  const BlockWords words(program.words_of(block));
  if (!words.has_g(kG5)) return CurveRefusal{"no G5"};
  if (words.problem() != BlockWords::Problem::kNone || !words.all_numbers()) {
    return CurveRefusal{"words that cannot be taken together"};
  }
  if (words.g_codes().size() != 1 || !words.m_codes().empty() ||
      words.has_any("ABCDEHKLORSTUVWZ")) {
    return CurveRefusal{"other words in the block"};
  }
  for (const char letter : std::string_view("XYIJPQ")) {
    if (!words.has(letter)) return CurveRefusal{"one of X Y I J P Q is missing"};
  }
  if (!start.position.known[0] || !start.position.known[1]) {
    return CurveRefusal{"the position is not known"};
  }
  const double unit = millimetres_per(start.units);
  const auto value = [&](char letter) { return words.find(letter)->value * unit; };
  const Point3 from = start.position.mm;
  const Point3 to(value('X'), value('Y'), from.z());
  CurveReading reading;
  reading.blocks = 1;
  reading.axes = {true, true, false};
  if (const Word* feed = words.find('F')) {
    if (!(feed->value > 0)) return CurveRefusal{"a feed of zero"};
    reading.feed = feed->value;
  }
  reading.motions.push_back({first, CubicBezier{{from, from + Vector3(value('I'), value('J'), 0),
                                                 to + Vector3(value('P'), value('Q'), 0), to}}});
  return reading;
}

// Whether the piece lies in a plane of XY and LinuxCNC's arcs follow it: they are two for each
// sixteenth of it, found by tangents, and a sixteenth whose tangents are parallel gives no arcs or
// wild ones. So each must turn, all to one side, by kLeastTurn at least, and together by less than
// half a turn.
bool bends_one_way(const CubicBezier& piece) {
  if (!is_flat(piece, piece.control[0].z())) return false;
  const geometry::PathPiece path = piece;
  Vector3 before = geometry::direction_at(path, 0);
  double sum = 0;
  for (int i = 1; i <= kParts; ++i) {
    const Vector3 after = geometry::direction_at(path, static_cast<double>(i) / kParts);
    const double turn = std::atan2(before.x() * after.y() - before.y() * after.x(),
                                   before.x() * after.x() + before.y() * after.y());
    if (std::abs(turn) < kLeastTurn || turn * sum < 0) return false;
    sum += turn;
    before = after;
  }
  return std::abs(sum) < std::numbers::pi;
}

// The settings of their sources, which no setting of the machine changes.
constexpr double kNear = 0.1;  // mm, |x| + |y| between the curve and the middle of its chord
constexpr double kLeastStep = 0.002;
constexpr double kGreatestStep = 0.1;

double sum_of_axes(const Point3& a, const Point3& b) {
  return std::abs(a.x() - b.x()) + std::abs(a.y() - b.y());
}

// Where the chord from t on ends: at `end`, halved while the chord is off; doubled only where it
// was not.
double chord_end(const CubicBezier& piece, double t, double end) {
  const auto is_near = [&](double middle, double to) {
    const Point3 of_chord = 0.5 * (geometry::point_at(piece, t) + geometry::point_at(piece, to));
    return sum_of_axes(geometry::point_at(piece, middle), of_chord) <= kNear;
  };
  bool halved = false;
  while (end - t >= kLeastStep) {
    const double middle = 0.5 * (t + end);
    if (is_near(middle, end)) break;
    end = middle;
    halved = true;
  }
  while (!halved && end - t <= kGreatestStep) {
    const double twice = t + 2 * (end - t);
    if (twice >= 1 || !is_near(end, twice)) break;
    end = twice;
  }
  return end;
}

// The distance from a chord is convex, 0 at its ends, and the inner control points have weights
// whose sum is 3 t (1 - t): the curve is off by 3/4 of the greater of theirs at the most.
double flatness(const CubicBezier& part) {
  const auto& p = part.control;
  const Vector3 chord = p[3] - p[0];
  const double square = chord.squaredNorm();
  const auto off = [&](const Point3& point) {
    const Vector3 to = point - p[0];
    const double along = square > 0 ? std::clamp(to.dot(chord) / square, 0.0, 1.0) : 0;
    return (to - along * chord).norm();
  };
  return 0.75 * std::max(off(p[1]), off(p[2]));
}

}  // namespace

std::vector<double> chopped_at(const CubicBezier& piece) {
  std::vector<double> ends;
  double step = kGreatestStep;
  for (double t = 0; t < 1; t = ends.back()) {
    ends.push_back(chord_end(piece, t, std::min(t + step, 1.0)));
    step = ends.back() - t;
  }
  return ends;
}

namespace {

// mm: no point of the piece is further from its chord. An upper bound, by the hull of the control
// points of each part; right to some percent where all chords bend one way.
double chopping_error(const CubicBezier& piece) {
  double most = 0;
  double from = 0;
  CubicBezier rest = piece;
  for (const double end : chopped_at(piece)) {
    CubicBezier part = rest;
    if (end < 1) std::tie(part, rest) = geometry::parts_at(rest, (end - from) / (1 - from));
    most = std::max(most, flatness(part));
    from = end;
  }
  return most;
}

}  // namespace

// Arcs say the same with a deviation that we choose, and the controls run G5 as arcs or chords: so
// it is no default. Only LinuxCNC asks for pieces that bend one way; the others have no use for
// pieces that are nearly straight.
const CurveFormat& linuxcnc_g5() {
  static const CurveFormat kFormat = {
      .name = "G5",
      .only_in_xy = true,
      // As many as arc ends have: a direction that is off by half a step of the fifth decimal over
      // the third of a millimetre turns the joint by 2e-5 radians.
      .other_mm = {.decimals = 5},
      .other_inch = {.decimals = 6},
      .write = write_g5,
      .read = read_g5,
      .takes = bends_one_way};
  return kFormat;
}

const CurveFormat& chopped_g5() {
  static const CurveFormat kFormat = [] {
    CurveFormat format = linuxcnc_g5();
    format.is_run_as_chords = true;
    format.chords_error = chopping_error;
    // Chords are found in 32-bit numbers: the fifth decimal would be noise.
    format.other_mm = {.decimals = 4};
    format.other_inch = {.decimals = 5};
    return format;
  }();
  return kFormat;
}

}  // namespace batten::gcode
