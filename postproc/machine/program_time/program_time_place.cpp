#include "postproc/machine/program_time/program_time_place.h"

#include <algorithm>
#include <cmath>
#include <variant>

#include "gcode/state/control_state.h"
#include "geometry/basic/rounding.h"

namespace batten::postproc {
namespace {

using gcode::DistanceMode;
using geometry::Point3;

double millimetres(const gcode::Word& word, const gcode::ModalState& state) {
  return state.units == gcode::Units::kInch ? word.value * gcode::kMillimetresPerInch : word.value;
}

Eigen::Index index_of(std::size_t axis) { return static_cast<Eigen::Index>(axis); }

// An arc can be moved along its axis alone: its centre stays.
bool can_be_moved(const geometry::PathPiece& piece, Eigen::Index axis) {
  const auto* arc = std::get_if<geometry::Arc>(&piece);
  constexpr double kAlong = 0.5;  // the axis of an arc of G17, G18 or G19 has one component: 1
  return arc == nullptr || std::abs(arc->axis[axis]) > kAlong;
}

// Both ends of the piece along one axis.
void shift_axis(geometry::PathPiece& piece, Eigen::Index axis, double start, double end) {
  if (auto* line = std::get_if<geometry::Line>(&piece)) {
    line->start[axis] = start;
    line->end[axis] = end;
  } else if (auto* arc = std::get_if<geometry::Arc>(&piece)) {
    arc->start[axis] = start;
    arc->end[axis] = end;
  }
}

}  // namespace

void ToolPlace::set(const Point3& mm) {
  mm_ = mm;
  certainty_.fill(Certainty::kKnown);
}

void ToolPlace::set_axis(std::size_t axis, double mm, Certainty certainty) {
  mm_[index_of(axis)] = mm;
  certainty_[axis] = certainty;
}

void ToolPlace::forget() { certainty_.fill(Certainty::kUnknown); }

void ToolPlace::doubt() {
  for (Certainty& c : certainty_) c = std::min(c, Certainty::kAssumed);
}

PlacedMotion line_of_words(const gcode::BlockWords& words, const gcode::ModalState& state,
                           const ToolPlace& place) {
  geometry::Line line{place.mm(), place.mm()};
  PlacedMotion placed;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const gcode::Word* word = words.find("XYZ"[axis]);
    if (word == nullptr) continue;
    const auto i = index_of(axis);
    if (state.distance == DistanceMode::kIncremental) {
      line.end[i] += millimetres(*word, state);
      continue;  // the way is known, wherever it begins
    }
    line.end[i] = millimetres(*word, state);
    if (place.certainty(axis) == Certainty::kUnknown) line.start[i] = line.end[i];
    placed.start = std::min(placed.start, place.certainty(axis));
  }
  placed.piece = line;
  return placed;
}

PlacedMotion place_motion(const gcode::Motion& motion, const gcode::BlockWords& words,
                          const gcode::ModalState& state, const ToolPlace& place) {
  const bool is_line = motion.piece.is_line();
  if (!motion.start_known && is_line) return line_of_words(words, state, place);

  // The ends in the plane of an arc are known, or the interpreter would have no arc; an axis
  // across it that is not known stands still in `piece`, at 0.
  PlacedMotion placed{motion.piece, Certainty::kKnown};
  const Point3& start = motion.piece.start();
  const Point3& end = motion.piece.end();
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const auto i = index_of(axis);
    if (place.certainty(axis) == Certainty::kUnknown) {
      if (!motion.start_known && motion.axes_named[axis] && start[i] != end[i]) {
        shift_axis(placed.piece, i, end[i], end[i]);
        placed.start = Certainty::kUnknown;
      }
      continue;
    }
    if (!motion.axes_named[axis]) {
      if (can_be_moved(motion.piece, i)) shift_axis(placed.piece, i, place.mm()[i], place.mm()[i]);
    } else if (!motion.start_known && start[i] != place.mm()[i]) {
      shift_axis(placed.piece, i, place.mm()[i], end[i]);
      placed.start = std::min(placed.start, place.certainty(axis));
    }
  }
  return placed;
}

void move_to_end(ToolPlace& place, const PlacedMotion& motion, const gcode::BlockWords& words,
                 const gcode::ModalState& state) {
  const Point3 end = geometry::end_point(motion.piece);
  const bool absolute = state.distance == DistanceMode::kAbsolute;
  const bool is_line = std::holds_alternative<geometry::Line>(motion.piece);
  for (std::size_t axis = 0; axis < 3; ++axis) {
    if (!words.has("XYZ"[axis])) continue;
    const Certainty certainty = absolute || !is_line ? Certainty::kKnown : place.certainty(axis);
    place.set_axis(axis, end[index_of(axis)], certainty);
  }
}

}  // namespace batten::postproc
