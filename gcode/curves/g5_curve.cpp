#include "gcode/curves/g5_curve.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <string_view>
#include <tuple>

#include "gcode/curves/curve_print.h"
#include "gcode/curves/g5_nurbs.h"
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
constexpr Code kG51 = 51;
constexpr Code kG52 = 52;

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

// Why the block is none of this G word alone with its own letters, N and F; empty where it is.
std::string_view trouble_with(const Block& block, const BlockWords& words, Code code,
                              std::string_view others) {
  if (block.opacity != ParseStatus::kNone) return "not words alone";
  if (!words.has_g(code)) return "another word";
  if (words.problem() != BlockWords::Problem::kNone || !words.all_numbers()) {
    return "words that cannot be taken together";
  }
  const bool alone = words.g_codes().size() == 1 && words.m_codes().empty();
  if (!alone || words.has_any("ABCDEHKLORSTUVWZ") || words.has_any(others)) {
    return "other words in the block";
  }
  const Word* feed = words.find('F');
  return feed != nullptr && !(feed->value > 0) ? "a feed of zero" : std::string_view();
}

bool has_all(const BlockWords& words, std::string_view letters) {
  return std::ranges::all_of(letters, [&](char letter) { return words.has(letter); });
}

// Reads the blocks of one curve, one after the other.
class G5Reader {
 public:
  G5Reader(const CurveStart& start)
      : unit_(millimetres_per(start.units)), place_(start.position.mm) {
    reading_.axes = {true, true, false};
  }

  // The way that two words say (mm).
  [[nodiscard]] Vector3 way(const BlockWords& words, char x, char y) const {
    return {words.find(x)->value * unit_, words.find(y)->value * unit_, 0};
  }

  // Where the block ends; an axis that it does not name stays.
  [[nodiscard]] Point3 end_of(const BlockWords& words) const {
    Point3 end = place_;
    for (const int axis : {0, 1}) {
      if (const Word* word = words.find("XY"[axis])) end[axis] = word->value * unit_;
    }
    return end;
  }

  // The block has a piece with these inner control points.
  // `arcs`: CurveMotion::arcs; 0 of a G5.
  void add(std::uint32_t block, const BlockWords& words, const Point3& second, const Point3& third,
           float arcs = 0) {
    for (const char letter : std::string_view("XY")) {
      const Word* word = words.find(letter);
      if (word != nullptr) reading_.decimals = std::max<int>(reading_.decimals, word->decimals);
    }
    if (reading_.motions.empty() && words.has('F')) reading_.feed = words.find('F')->value;
    const Point3 end = end_of(words);
    reading_.motions.push_back({block, CubicBezier{{place_, second, third, end}}, arcs});
    place_ = end;
  }

  [[nodiscard]] const Point3& place() const { return place_; }

  // With so many blocks.
  [[nodiscard]] CurveReading finish(std::uint32_t blocks) {
    reading_.blocks = blocks;
    return std::move(reading_);
  }

 private:
  double unit_;
  Point3 place_;  // where the next piece begins, mm
  CurveReading reading_;
};

bool is_place_known(const CurveStart& start) {
  return start.position.known[0] && start.position.known[1];
}

// G5 with all its words.
CurveResult read_g5(const Program& program, std::uint32_t first, const CurveStart& start) {
  const Block& block = program.blocks[first];
  const BlockWords words(program.words_of(block));
  const std::string_view trouble = trouble_with(block, words, kG5, "");
  if (!trouble.empty()) return CurveRefusal{std::string(trouble)};
  if (!has_all(words, "XYIJPQ")) return CurveRefusal{"one of X Y I J P Q is missing"};
  if (!is_place_known(start)) return CurveRefusal{"the position is not known"};
  G5Reader reader(start);
  reader.add(first, words, reader.place() + reader.way(words, 'I', 'J'),
             reader.end_of(words) + reader.way(words, 'P', 'Q'));
  return reader.finish(1);
}

// G5 as LinuxCNC takes it, and what goes on from it: blocks of G5 without I and J leave in the
// direction in which the one before arrived. A feed of their own ends the curve.
CurveResult read_g5_chain(const Program& program, std::uint32_t first, const CurveStart& start) {
  if (!is_place_known(start)) return CurveRefusal{"the position is not known"};
  G5Reader reader(start);
  Vector3 onwards = Vector3::Zero();
  std::uint32_t end = first;
  for (std::uint32_t at = first; at < program.blocks.size(); ++at) {
    const Block& block = program.blocks[at];
    const BlockWords words(program.words_of(block));
    if (at > first && block.opacity == ParseStatus::kNone && !words.has_words()) continue;
    const std::string_view trouble = trouble_with(block, words, kG5, "");
    const bool whole = trouble.empty() && words.has_any("XY") && has_all(words, "PQ");
    const bool leaves = has_all(words, "IJ");
    if (at == first && !(whole && leaves)) {
      return CurveRefusal{trouble.empty() ? "one of X Y I J P Q is missing" : std::string(trouble)};
    }
    if (at > first && (!whole || words.has_any("IJF"))) break;
    if (leaves) onwards = reader.way(words, 'I', 'J');
    const Vector3 back = reader.way(words, 'P', 'Q');
    reader.add(at, words, reader.place() + onwards, reader.end_of(words) + back);
    onwards = -back;
    end = at + 1;
  }
  return reader.finish(end - first);
}

// LinuxCNC makes 8 arcs for each of its three points; 32 of a G5, for its four.
constexpr float kArcsOfG51 = 24;

// A quadratic piece, whose one inner control point I and J give from the start.
CurveResult read_g5_1(const Program& program, std::uint32_t first, const CurveStart& start) {
  const Block& block = program.blocks[first];
  const BlockWords words(program.words_of(block));
  const std::string_view trouble = trouble_with(block, words, kG51, "PQ");
  if (!trouble.empty()) return CurveRefusal{std::string(trouble)};
  if (!words.has_any("XY") || !has_all(words, "IJ")) {
    return CurveRefusal{"I, J or both of X and Y are missing"};
  }
  if (!is_place_known(start)) return CurveRefusal{"the position is not known"};
  G5Reader reader(start);
  const Point3 inner = reader.place() + reader.way(words, 'I', 'J');
  const Point3 end = reader.end_of(words);
  reader.add(first, words, (reader.place() + 2 * inner) / 3, (end + 2 * inner) / 3, kArcsOfG51);
  return reader.finish(1);
}

CurveResult read_linuxcnc(const Program& program, std::uint32_t first, const CurveStart& start) {
  const BlockWords words(program.words_of(program.blocks[first]));
  if (words.has_g(kG51)) return read_g5_1(program, first, start);
  if (words.has_g(kG52)) return read_g5_nurbs(program, first, start);
  return read_g5_chain(program, first, start);
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
      .read = read_linuxcnc,
      .takes = bends_one_way};
  return kFormat;
}

const CurveFormat& chopped_g5() {
  static const CurveFormat kFormat = [] {
    CurveFormat format = linuxcnc_g5();
    format.read = read_g5;
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
