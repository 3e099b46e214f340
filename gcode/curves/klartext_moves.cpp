#include "gcode/curves/klartext_moves.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <optional>
#include <string>
#include <utility>

#include "gcode/curves/curve_print.h"
#include "gcode/curves/klartext_words.h"
#include "gcode/state/units.h"
#include "gcode/text/arc_center.h"
#include "geometry/basic/rounding.h"

namespace batten::gcode {
namespace {

using geometry::Arc;
using geometry::Line;
using geometry::Point3;
using geometry::Vector3;

constexpr double kGreatestPlace = 99999.9999;

std::string with_klartext_sign(const std::string& digits) {
  return digits.starts_with('-') ? digits : "+" + digits;
}

PlanePoint in_plane(const Point3& place) { return {place.x(), place.y()}; }

// From `start` to `end` about `center`, in the sense of `wanted`: above 0 and at most a full turn.
double sweep_about(const Point3& start, const Point3& end, const Point3& center, double wanted) {
  const PlanePoint a = in_plane(start - center);
  const PlanePoint b = in_plane(end - center);
  const double angle = std::atan2(a.x() * b.y() - a.y() * b.x(), a.dot(b));
  if (wanted > 0) return angle > 0 ? angle : angle + 2 * std::numbers::pi;
  return angle < 0 ? angle : angle - 2 * std::numbers::pi;
}

class MoveWriter {
 public:
  MoveWriter(const CurveSetting& setting, std::optional<int> first_number)
      : setting_(setting), printer_(setting), number_(first_number), place_(setting.start) {}

  // Empty where the piece is written.
  std::string_view add(const geometry::PathPiece& piece, bool last) {
    const Point3 wanted = geometry::end_point(piece);
    const PrintedPlace end = last ? printer_.last_place(wanted) : printer_.place(wanted);
    if (std::holds_alternative<Line>(piece)) return add_line(end);
    if (const auto* arc = std::get_if<Arc>(&piece)) return add_arc(*arc, end);
    return "a piece that is neither line nor arc";
  }

  CurveLines take() { return std::move(lines_); }

 private:
  std::string_view add_line(const PrintedPlace& end) {
    std::string line = "L";
    for (std::size_t axis = 0; axis < 3; ++axis) {
      const auto i = static_cast<int>(axis);
      if (std::abs(end.mm[i] - place_[i]) > geometry::kSamePlace) add_axis(axis, end, line);
    }
    if (line == "L") return {};  // nothing moves
    add_block(line);
    place_ = end.mm;
    return {};
  }

  std::string_view add_arc(const Arc& arc, const PrintedPlace& end) {
    if (!setting_.axes[0] || !setting_.axes[1]) return "an arc in an axis without a word";
    if (std::abs(std::abs(arc.axis.z()) - 1) > geometry::kSameDirection) {
      return "an arc out of the plane of X and Y";
    }
    if (std::abs(end.mm.z() - place_.z()) > geometry::kSamePlace) return "a helix";
    const double sweep = arc.axis.z() > 0 ? arc.sweep : -arc.sweep;
    const double unit = printer_.unit();
    const double step = std::pow(10.0, -setting_.other.decimals);
    const PlanePoint steps =
        printed_center(in_plane(place_) / unit, in_plane(end.mm) / unit,
                       in_plane(arc.center) / unit, sweep, {PlanePoint::Zero(), step});
    const std::string x = to_text(steps.x() * step, setting_.other);
    const std::string y = to_text(steps.y() * step, setting_.other);
    const Point3 center(read_number(x)->value * unit, read_number(y)->value * unit, place_.z());
    const double printed = sweep_about(place_, end.mm, center, sweep);
    if (std::abs(printed - sweep) > std::numbers::pi) return "an arc that is a full turn or none";
    add_numbered("CC X" + with_klartext_sign(x) + " Y" + with_klartext_sign(y));
    std::string line = "C";
    add_axis(0, end, line);
    add_axis(1, end, line);
    add_block(line + (sweep > 0 ? " DR+" : " DR-"));
    place_ = end.mm;
    return {};
  }

  static void add_axis(std::size_t axis, const PrintedPlace& place, std::string& line) {
    line += std::string(" ") + kAxisNames[axis] + with_klartext_sign(place.digits[axis]);
  }

  // The first block that moves says the feed.
  void add_block(std::string line) {
    const std::string feed = std::exchange(feed_said_, true) ? std::string() : feed_word(setting_);
    if (!feed.empty()) line += " " + feed;
    add_numbered(line);
  }

  void add_numbered(const std::string& line) {
    lines_.push_back(number_ ? std::to_string((*number_)++) + " " + line : line);
  }

  const CurveSetting& setting_;
  PlacePrinter printer_;
  std::optional<int> number_;
  Point3 place_;
  bool feed_said_ = false;
  CurveLines lines_;
};

// --- reading ------------------------------------------------------------------------------------

// One block of a chain.
struct MoveBlock {
  enum class Kind { kOther, kLine, kCenter, kArc } kind = Kind::kOther;
  std::array<std::optional<double>, 3> place;
  std::optional<double> feed;
  int sense = 0;  // 1 or -1
};

MoveBlock::Kind kind_of(const KlartextWord& keyword) {
  if (keyword.value) return MoveBlock::Kind::kOther;
  if (keyword.is("L")) return MoveBlock::Kind::kLine;
  if (keyword.is("CC")) return MoveBlock::Kind::kCenter;
  if (keyword.is("C")) return MoveBlock::Kind::kArc;
  return MoveBlock::Kind::kOther;
}

MoveBlock sorted(const std::optional<KlartextLine>& line) {
  MoveBlock block;
  if (!line || line->continues || line->words.empty()) return block;
  for (std::size_t i = 1; i < line->words.size(); ++i) {
    const KlartextWord& word = line->words[i];
    const bool axis = word.name.size() == 1 && word.name[0] >= 'X' && word.name[0] <= 'Z';
    if (axis && word.value) {
      block.place[static_cast<std::size_t>(word.name[0] - 'X')] = word.value;
    } else if (word.is("F") && word.value) {
      block.feed = word.value;
    } else if (word.is("DR+") || word.is("DR-")) {
      block.sense = word.is("DR+") ? 1 : -1;
    } else if (!(word.is("R") && word.value == 0.0) && !(word.is("M") && !word.value)) {
      return block;  // kOther
    }
  }
  block.kind = kind_of(line->words.front());
  return block;
}

class MoveReader {
 public:
  MoveReader(const Program& program, const CurveStart& start)
      : program_(program), unit_(millimetres_per(start.units)), place_(start.position) {}

  CurveResult read(std::uint32_t first) {
    for (std::uint32_t at = first; at < program_.blocks.size(); ++at) {
      const MoveBlock block =
          sorted(read_klartext_line(program_.source.text(program_.blocks[at].span)));
      if (block.kind == MoveBlock::Kind::kOther) break;
      if (block.feed && !reading_.motions.empty()) break;
      if (block.feed) reading_.feed = block.feed;
      if (const std::string_view why = add(at, block); !why.empty()) {
        return CurveRefusal{std::string(why)};
      }
      ++reading_.blocks;
    }
    if (reading_.blocks == 0) return CurveRefusal{"no L, CC or C"};
    return std::move(reading_);
  }

 private:
  std::string_view add(std::uint32_t at, const MoveBlock& block) {
    if (block.kind == MoveBlock::Kind::kCenter) {
      if (!block.place[0] || !block.place[1]) return "a CC without X and Y";
      center_ = {*block.place[0] * unit_, *block.place[1] * unit_};
      return {};
    }
    Point3 end = place_.mm;
    for (std::size_t axis = 0; axis < 3; ++axis) {
      if (!block.place[axis]) continue;
      if (!place_.known[axis]) return "where the tool stands is not known";
      end[static_cast<int>(axis)] = *block.place[axis] * unit_;
      reading_.axes[axis] = true;
    }
    if (block.kind == MoveBlock::Kind::kLine) {
      if (end != place_.mm) reading_.motions.push_back({at, Line{place_.mm, end}});
    } else {
      if (!center_) return "a C without a CC before it";
      if (block.sense == 0) return "a C without DR";
      if (block.place[2]) return "a C with Z";
      const Point3 center(center_->x(), center_->y(), place_.mm.z());
      const double radius = (place_.mm - center).norm();
      const double mismatch = std::abs((end - center).norm() - radius);
      if (!(radius > 0) || mismatch > kKlartextRadiusMismatch) {
        return "the radii at the ends of an arc differ";
      }
      const double sweep = sweep_about(place_.mm, end, center, block.sense);
      reading_.motions.push_back({at, Arc{place_.mm, end, center, Vector3::UnitZ(), sweep}});
    }
    place_.mm = end;
    return {};
  }

  const Program& program_;
  double unit_;
  Position place_;
  std::optional<PlanePoint> center_;
  CurveReading reading_;
};

}  // namespace

CurveWriting write_klartext_moves(std::span<const geometry::PathPiece> pieces,
                                  const CurveSetting& setting, std::optional<int> first_number) {
  if (pieces.empty()) return CurveRefusal{"no moves"};
  MoveWriter writer(setting, first_number);
  for (std::size_t i = 0; i < pieces.size(); ++i) {
    const Point3 end = geometry::end_point(pieces[i]);
    for (int axis = 0; axis < 3; ++axis) {
      const bool moves = std::abs(end[axis] - setting.start[axis]) > geometry::kSamePlace;
      if (moves && !setting.axes[static_cast<std::size_t>(axis)]) {
        return CurveRefusal{"an axis moves and has no word"};
      }
    }
    const std::string_view why = writer.add(pieces[i], i + 1 == pieces.size());
    if (!why.empty()) return CurveRefusal{std::string(why)};
  }
  return writer.take();
}

CurveResult read_klartext_moves(const Program& program, std::uint32_t first,
                                const CurveStart& start) {
  return MoveReader(program, start).read(first);
}

CurveAlarms klartext_arc_alarms(const Program& program, Units units) {
  const double unit = millimetres_per(units);
  CurveAlarms alarms;
  std::optional<std::array<double, 2>> center;  // in the plane, as printed
  std::array<std::optional<double>, 3> place;
  for (const Block& line : program.blocks) {
    const auto say = [&](std::string_view id, std::string message) {
      alarms.push_back({Severity::kError, line.line, id, std::move(message)});
    };
    const MoveBlock block = sorted(read_klartext_line(program.source.text(line.span)));
    for (const auto& value : block.place) {
      if (value && std::abs(*value) > kGreatestPlace) say("place-range", "beyond 99999.9999");
    }
    if (block.kind == MoveBlock::Kind::kCenter) {
      center.reset();
      if (block.place[0] && block.place[1]) center = {{*block.place[0], *block.place[1]}};
      continue;
    }
    const std::array<std::optional<double>, 3> before = place;
    for (std::size_t axis = 0; axis < 3; ++axis) {
      if (block.kind == MoveBlock::Kind::kOther) place[axis].reset();
      if (block.place[axis]) place[axis] = block.place[axis];
    }
    if (block.kind != MoveBlock::Kind::kArc) continue;
    if (!center) say("arc-no-centre", "a C without a CC before it");
    if (block.sense == 0) say("arc-no-sense", "a C without DR+ or DR-");
    if (!center || !before[0] || !before[1] || !place[0] || !place[1]) continue;
    const double start_radius = std::hypot(*before[0] - (*center)[0], *before[1] - (*center)[1]);
    const double end_radius = std::hypot(*place[0] - (*center)[0], *place[1] - (*center)[1]);
    const double mismatch = std::abs(end_radius - start_radius) * unit;
    if (mismatch <= kKlartextRadiusMismatch) continue;
    say("arc-radius", "radii differ by " +
                          to_text(std::min(mismatch, kGreatestPlace), {.decimals = 4}) +
                          " mm, expected at most 0.016 mm");
  }
  return alarms;
}

}  // namespace batten::gcode
