#include "gcode/curves/g5_curve.h"

#include <cmath>
#include <numbers>
#include <string_view>

#include "gcode/state/block_words.h"
#include "gcode/state/control_state.h"
#include "geometry/basic/rounding.h"

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

double unit_of(Units units) { return units == Units::kInch ? kMillimetresPerInch : 1; }

// The words of one block.
class G5Words {
 public:
  explicit G5Words(const CurveSetting& setting) : setting_(setting) {}

  void add(char letter, std::string_view digits) {
    if (!line_.empty() && setting_.blanks) line_ += ' ';
    line_ += letter;
    line_ += digits;
  }

  // Returns what the control reads, mm.
  double add_length(char letter, double mm, const NumberFormat& format) {
    const double unit = unit_of(setting_.units);
    const std::string digits = to_text(mm / unit, format);
    add(letter, digits);
    return read_number(digits)->value * unit;
  }

  [[nodiscard]] const std::string& line() const { return line_; }

 private:
  const CurveSetting& setting_;
  std::string line_;
};

bool is_flat(const CubicBezier& piece, double height, double noise) {
  for (const Point3& point : piece.control) {
    if (!(std::abs(point.z() - height) <= noise)) return false;
  }
  return true;
}

CurveRefusal refusal(std::string_view why) { return {std::string(why)}; }

}  // namespace

CurveWriting write_g5(const std::vector<CubicBezier>& pieces, const CurveSetting& setting) {
  CurveLines lines;
  lines.reserve(pieces.size());
  Point3 start = setting.start;
  for (std::size_t i = 0; i < pieces.size(); ++i) {
    const CubicBezier& piece = pieces[i];
    if (!is_flat(piece, start.z(), geometry::kSamePlace)) return refusal("the piece leaves XY");
    NumberFormat places = setting.places;
    if (i + 1 == pieces.size()) places.decimals = std::max(places.decimals, setting.last_decimals);
    G5Words words(setting);
    words.add('G', "5");
    Point3 end = start;
    end.x() = words.add_length('X', piece.control[3].x(), places);
    end.y() = words.add_length('Y', piece.control[3].y(), places);
    // The ways of the given piece, not those from the printed ends: rounding those makes no kinks.
    const Vector3 from_start = piece.control[1] - piece.control[0];
    const Vector3 from_end = piece.control[2] - piece.control[3];
    const double out_x = words.add_length('I', from_start.x(), setting.other);
    const double out_y = words.add_length('J', from_start.y(), setting.other);
    const double back_x = words.add_length('P', from_end.x(), setting.other);
    const double back_y = words.add_length('Q', from_end.y(), setting.other);
    if ((out_x == 0 && out_y == 0) || (back_x == 0 && back_y == 0)) {
      return refusal("an offset of a Bezier point is zero once it is printed");
    }
    if (i == 0 && setting.feed) words.add_length('F', *setting.feed, setting.feeds);
    lines.push_back(words.line());
    start = end;
  }
  return lines;
}

CurveResult read_g5(const Program& program, std::uint32_t first, const CurveStart& start) {
  const Block& block = program.blocks[first];
  if (block.opacity != ParseStatus::kNone) return refusal("not words alone");
  const BlockWords words(program.words_of(block));
  if (!words.has_g(kG5)) return refusal("no G5");
  if (words.problem() != BlockWords::Problem::kNone || !words.all_numbers()) {
    return refusal("words that cannot be taken together");
  }
  if (words.g_codes().size() != 1 || !words.m_codes().empty() ||
      words.has_any("ABCDEHKLORSTUVWZ")) {
    return refusal("other words in the block");
  }
  for (const char letter : std::string_view("XYIJPQ")) {
    if (!words.has(letter)) return refusal("one of X Y I J P Q is missing");
  }
  if (!start.position.known[0] || !start.position.known[1])
    return refusal("the place is not known");

  const double unit = unit_of(start.units);
  const auto value = [&](char letter) { return words.find(letter)->value * unit; };
  const Point3 from = start.position.mm;
  const Point3 to(value('X'), value('Y'), from.z());
  CurveReading reading;
  reading.blocks = 1;
  reading.axes = {true, true, false};
  if (const Word* feed = words.find('F')) {
    if (!(feed->value > 0)) return refusal("a feed of zero");
    reading.feed = feed->value;
  }
  reading.motions.push_back({first, CubicBezier{{from, from + Vector3(value('I'), value('J'), 0),
                                                 to + Vector3(value('P'), value('Q'), 0), to}}});
  return reading;
}

bool bends_one_way(const CubicBezier& piece) {
  if (!is_flat(piece, piece.control[0].z(), geometry::kSamePlace)) return false;
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

}  // namespace batten::gcode
