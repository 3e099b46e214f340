#include "gcode/interpreter/motion_words.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "gcode/state/reason.h"
#include "geometry/basic/rounding.h"

namespace batten::gcode {
namespace {

using geometry::Point3;
using geometry::Vector3;

constexpr double kFullTurn = 2 * std::numbers::pi;

// How far the radii at the ends of an arc may differ before controls refuse it: this much, or this
// part of the radius (LinuxCNC, measured), but never more than the last one (grbl; LinuxCNC takes
// 2.83 mm).
constexpr double kRadiusSlack = 0.0283;  // mm
constexpr double kRelativeRadiusSlack = 0.001;
constexpr double kGreatestRadiusSlack = 0.5;  // mm

// A half turn written with R: the printed ends may be a little further apart than 2 R. LinuxCNC
// takes half chords that are longer by this (0.00005 in), and refuses more.
constexpr double kHalfChordSlack = 0.00127;  // mm

// grbl reads an angle below this as a full turn, others as no turn: such an arc has no certain
// meaning.
constexpr double kDoubtfulAngle = 5e-7;  // radians

Vector3 unit(std::size_t axis) { return Vector3::Unit(static_cast<Eigen::Index>(axis)); }

double component(const Vector3& v, std::size_t axis) { return v[static_cast<Eigen::Index>(axis)]; }

// The part of v that lies in the plane.
Vector3 in_plane(const Vector3& v, const ArcAxes& plane) {
  return v - component(v, plane.normal) * unit(plane.normal);
}

double angle_in_plane(const Vector3& v, const ArcAxes& plane) {
  return std::atan2(component(v, plane.axis1), component(v, plane.axis0));
}

ArcReading problem(std::string_view id, std::string message) {
  return {std::nullopt, id, std::move(message)};
}

bool is_one_place_in_plane(const ArcWords& words) {
  return in_plane(words.end - words.start, words.plane).norm() < geometry::kSamePlace;
}

// Signed, never 0. A full turn when the ends are one place.
double sweep_about(const Point3& center, const ArcWords& words) {
  const double full = words.clockwise ? -kFullTurn : kFullTurn;
  if (is_one_place_in_plane(words)) {
    return full;
  }
  const double turn = angle_in_plane(words.end - center, words.plane) -
                      angle_in_plane(words.start - center, words.plane);
  const double forward =
      std::fmod(words.clockwise ? kFullTurn - turn : kFullTurn + turn, kFullTurn);
  return words.clockwise ? -forward : forward;
}

ArcReading arc_about(const Point3& center, const ArcWords& words) {
  const double sweep = sweep_about(center, words);
  if (std::abs(sweep) < kDoubtfulAngle) {
    return problem("arc-radius-too-small",
                   fmt::format("the arc turns by {:.1e} rad: a full turn to some controls, none to "
                               "others",
                               std::abs(sweep)));
  }
  return {geometry::Arc{words.start, words.end, center, unit(words.plane.normal), sweep}, {}, {}};
}

ArcReading arc_with_radius(const ArcWords& words, double radius) {
  const Vector3 chord = in_plane(words.end - words.start, words.plane);
  const double half = chord.norm() / 2;
  if (half < geometry::kSamePlace / 2) {
    return problem("arc-radius-too-small",
                   "the arc with R ends where it starts; a full turn needs I, J, K");
  }
  if (half > std::abs(radius) + kHalfChordSlack) {
    return problem("arc-radius-too-small",
                   fmt::format("radius {:.4f} mm, needed at least {:.4f} mm to reach the end",
                               std::abs(radius), half));
  }
  const double height = std::sqrt(std::max(0.0, radius * radius - half * half));
  // The centre of a short counter-clockwise arc lies to the left of its chord.
  const bool left = words.clockwise != (radius > 0);
  const Vector3 to_left = unit(words.plane.normal).cross(chord) / (2 * half);
  const Point3 center = words.start + chord / 2 + (left ? height : -height) * to_left;
  return arc_about(center, words);
}

ArcReading arc_with_center(const ArcWords& words) {
  const auto& first = words.center[words.plane.axis0];
  const auto& second = words.center[words.plane.axis1];
  if (words.center_absolute && !(first && second)) {
    return problem("arc-centre-missing", "absolute arc centres (G90.1) need both centre words");
  }
  Point3 center = words.center_absolute ? Point3::Zero() : words.start;
  center[static_cast<Eigen::Index>(words.plane.axis0)] += first.value_or(0);
  center[static_cast<Eigen::Index>(words.plane.axis1)] += second.value_or(0);
  const auto normal = static_cast<Eigen::Index>(words.plane.normal);
  center[normal] = words.start[normal];

  const double at_start = in_plane(words.start - center, words.plane).norm();
  const double at_end = in_plane(words.end - center, words.plane).norm();
  const double slack =
      std::clamp(kRelativeRadiusSlack * at_start, kRadiusSlack, kGreatestRadiusSlack);
  if (std::abs(at_start - at_end) > slack) {
    return problem("arc-radius-mismatch",
                   fmt::format("start radius {:.4f} mm, end radius {:.4f} mm, expected to differ "
                               "by at most {:.4f} mm",
                               at_start, at_end, slack));
  }
  if (std::min(at_start, at_end) < geometry::kSamePlace) {
    return problem("arc-radius-too-small", "the centre of the arc is one of its ends");
  }
  return arc_about(center, words);
}

}  // namespace

ArcAxes axes_of(Plane plane) {
  switch (plane) {
    case Plane::kZX:
      return {2, 0, 1};
    case Plane::kYZ:
      return {1, 2, 0};
    default:
      return {0, 1, 2};
  }
}

ArcReading arc_from_words(const ArcWords& words) {
  // K0 in the XY plane says nothing; FreeCAD writes it for grbl.
  if (words.center[words.plane.normal].value_or(0) != 0) {
    return problem("arc-words-conflict", fmt::format("{} is no centre word of the active plane",
                                                     "IJK"[words.plane.normal]));
  }
  const bool has_center = words.center[words.plane.axis0] || words.center[words.plane.axis1];
  if (has_center && words.radius) {
    return problem("arc-words-conflict", "R beside centre words; expected one of them");
  }
  if (words.radius) {
    return arc_with_radius(words, *words.radius);
  }
  if (!has_center) {
    return problem("arc-centre-missing", "an arc without R and without centre words");
  }
  return arc_with_center(words);
}

namespace {

std::string_view why_arc_not_followed(const BlockWords& words, const StateEffect& effect,
                                      const ControlState& state) {
  const ModalState& modal = state.modal;
  if (modal.plane == Plane::kUnknown || modal.arc_distance == DistanceMode::kUnknown) {
    return reason::kStateUnknown;
  }
  const ArcAxes plane = axes_of(modal.plane);
  if (!state.position.known[plane.axis0] || !state.position.known[plane.axis1]) {
    return reason::kPositionUnknown;
  }
  const Word* turns = words.find('P');
  const bool several_turns = turns != nullptr && turns->value != 1;
  if (!effect.takes_parameters && (several_turns || words.has_any("QL"))) {
    return reason::kNotUnderstood;
  }
  return {};
}

double to_mm(double value, const ControlState& state) {
  return state.modal.units == Units::kInch ? value * kMillimetresPerInch : value;
}

}  // namespace

std::string_view why_not_followed(const BlockWords& words, const StateEffect& effect,
                                  const ControlState& state) {
  const ModalState& modal = state.modal;
  if (!words.all_numbers()) {
    return reason::kExpression;
  }
  if (modal.motion == MotionMode::kUnknown || modal.distance == DistanceMode::kUnknown) {
    return reason::kStateUnknown;
  }
  if (modal.polar != TriState::kOff || modal.modal_macro != TriState::kOff) {
    return modal.polar == TriState::kOn         ? reason::kPolar
           : modal.modal_macro == TriState::kOn ? reason::kModalMacro
                                                : reason::kStateUnknown;
  }
  if (is_arc(modal.motion)) {
    return why_arc_not_followed(words, effect, state);
  }
  if (!effect.takes_parameters && words.has('R')) {
    return reason::kCornerWord;  // G1 X10 R2: a rounded corner
  }
  if (!effect.takes_parameters && words.has_any("IJKPQL")) {
    return reason::kNotUnderstood;
  }
  return {};
}

Position end_of_motion(const BlockWords& words, const ControlState& state) {
  Position end = state.position;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const Word* word = words.find("XYZ"[axis]);
    if (word == nullptr) {
      continue;
    }
    double& place = end.mm[static_cast<Eigen::Index>(axis)];
    if (state.modal.distance == DistanceMode::kAbsolute) {
      place = to_mm(word->value, state);
      end.known[axis] = true;
    } else {
      place += end.known[axis] ? to_mm(word->value, state) : 0;
    }
  }
  return end;
}

ArcWords arc_words(const BlockWords& words, const ControlState& state, const Position& end) {
  ArcWords arc;
  arc.start = state.position.mm;
  arc.end = end.mm;
  arc.plane = axes_of(state.modal.plane);
  arc.clockwise = state.modal.motion == MotionMode::kClockwise;
  arc.center_absolute = state.modal.arc_distance == DistanceMode::kAbsolute;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    if (const Word* word = words.find("IJK"[axis])) {
      arc.center[axis] = to_mm(word->value, state);
    }
  }
  if (const Word* word = words.find('R')) {
    arc.radius = to_mm(word->value, state);
  }
  return arc;
}

}  // namespace batten::gcode
