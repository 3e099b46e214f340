#include "gcode/interpreter/motion_words.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <numbers>
#include <optional>
#include <utility>

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

// The part of v that lies in the plane.
Vector3 part_in_plane(Vector3 v, const PlaneAxes& plane) {
  v[plane.normal] = 0;
  return v;
}

double angle_in_plane(const Vector3& v, const PlaneAxes& plane) {
  return std::atan2(v[plane.second], v[plane.first]);
}

ArcReading problem(std::string_view id, std::string message) {
  return {std::nullopt, id, std::move(message)};
}

// Signed, never 0. A full turn when the ends are one position.
double sweep_about(const Point3& center, const ArcWords& words) {
  if (part_in_plane(words.end - words.start, words.plane).norm() < geometry::kSamePlace) {
    return words.clockwise ? -kFullTurn : kFullTurn;
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
  return {geometry::Arc{words.start, words.end, center, Vector3::Unit(words.plane.normal), sweep},
          {},
          {}};
}

ArcReading arc_with_radius(const ArcWords& words, double radius) {
  const Vector3 chord = part_in_plane(words.end - words.start, words.plane);
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
  const Vector3 to_left = Vector3::Unit(words.plane.normal).cross(chord) / (2 * half);
  const Point3 center = words.start + chord / 2 + (left ? height : -height) * to_left;
  return arc_about(center, words);
}

const std::optional<double>& center_word(const ArcWords& words, int axis) {
  return words.center[static_cast<std::size_t>(axis)];
}

ArcReading arc_with_center(const ArcWords& words) {
  const auto& [plane, axis0, axis1, normal] = words.plane;
  const auto& first = center_word(words, axis0);
  const auto& second = center_word(words, axis1);
  if (words.center_absolute && !(first && second)) {
    return problem("arc-centre-missing", "absolute arc centres (G90.1) need both centre words");
  }
  Point3 center = words.center_absolute ? Point3::Zero() : words.start;
  center[axis0] += first.value_or(0);
  center[axis1] += second.value_or(0);
  center[normal] = words.start[normal];

  const double at_start = part_in_plane(words.start - center, words.plane).norm();
  const double at_end = part_in_plane(words.end - center, words.plane).norm();
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

std::string_view why_arc_not_followed(const BlockWords& words, const StateEffect& effect,
                                      const ControlState& state) {
  const ModalState& modal = state.modal;
  if (modal.plane == Plane::kUnknown || modal.arc_distance == DistanceMode::kUnknown) {
    return reason::kStateUnknown;
  }
  const auto known = [&state](int axis) {
    return state.position.known[static_cast<std::size_t>(axis)];
  };
  const PlaneAxes& plane = axes_of(modal.plane);
  if (!known(plane.first) || !known(plane.second)) return reason::kPositionUnknown;
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

// But for the kind of motion, which the block may say.
bool is_plain_state(const ModalState& modal) {
  return modal.distance == DistanceMode::kAbsolute && modal.polar == TriState::kOff &&
         modal.polar_interpolation == TriState::kOff && modal.modal_macro == TriState::kOff;
}

bool is_plain_block(const Block& block, const BlockFlow& flow) {
  return block.opacity == ParseStatus::kNone && !block.block_delete && !block.has_checksum &&
         block.comment_count == 0 && block.word_count > 0 && !flow.label_referenced &&
         !flow.jump_target && !flow.in_body;
}

// What the words of a block say, each at most once.
struct PlainWords {
  std::array<const Word*, 3> places{};  // X, Y, Z
  const Word* number = nullptr;         // N
  const Word* motion = nullptr;         // G0 or G1
  const Word* feed = nullptr;           // F

  [[nodiscard]] bool moves() const {
    return places[0] != nullptr || places[1] != nullptr || places[2] != nullptr;
  }
};

// Nothing where the interpreter has more to do or to report: other words, one of them twice.
std::optional<PlainWords> plain_words_of(std::span<const Word> words) {
  PlainWords found;
  for (const Word& word : words) {
    const char c = word.letter;
    const Word** const slot = c >= 'X' && c <= 'Z'
                                  ? &found.places[static_cast<std::size_t>(c - 'X')]
                              : c == 'N'                                         ? &found.number
                              : c == 'F'                                         ? &found.feed
                              : c == 'G' && (word.value == 0 || word.value == 1) ? &found.motion
                                                                                 : nullptr;
    if (slot == nullptr || !word.is_number || std::exchange(*slot, &word) != nullptr) {
      return std::nullopt;
    }
  }
  return found.moves() ? std::optional(found) : std::nullopt;
}

// The feed that the block says, in the state's way of saying feeds; nothing where it says one in
// another way.
bool take_feed(const Word* word, ModalState& modal) {
  if (word == nullptr) return true;
  if (modal.feed_mode != FeedMode::kPerMinute || !(word->value > 0) ||
      word->without_point != modal.feed_without_point) {
    return false;
  }
  modal.feed = modal.units == Units::kInch ? word->value * kMillimetresPerInch : word->value;
  return true;
}

}  // namespace

ArcReading arc_from_words(const ArcWords& words) {
  // K0 in the XY plane says nothing; FreeCAD writes it for grbl.
  if (center_word(words, words.plane.normal).value_or(0) != 0) {
    return problem("arc-words-conflict", fmt::format("{} is no centre word of the active plane",
                                                     "IJK"[words.plane.normal]));
  }
  const bool has_center =
      center_word(words, words.plane.first) || center_word(words, words.plane.second);
  if (has_center && words.radius) {
    return problem("arc-words-conflict", "R beside centre words; expected one of them");
  }
  if (!has_center && !words.radius) {
    return problem("arc-centre-missing", "an arc without R and without centre words");
  }
  return has_center ? arc_with_center(words) : arc_with_radius(words, *words.radius);
}

std::string_view why_not_followed(const BlockWords& words, const StateEffect& effect,
                                  const ControlState& state) {
  const ModalState& modal = state.modal;
  if (!words.all_numbers()) return reason::kExpression;
  if (modal.motion == MotionMode::kUnknown || modal.distance == DistanceMode::kUnknown) {
    return reason::kStateUnknown;
  }
  const auto is_any = [&](TriState value) {
    return modal.polar == value || modal.polar_interpolation == value;
  };
  if (is_any(TriState::kOn) || is_any(TriState::kUnknown) || modal.modal_macro != TriState::kOff) {
    return is_any(TriState::kOn)                ? reason::kPolar
           : modal.modal_macro == TriState::kOn ? reason::kModalMacro
                                                : reason::kStateUnknown;
  }
  if (is_arc(modal.motion)) return why_arc_not_followed(words, effect, state);
  if (effect.takes_parameters) return {};
  if (words.has('R')) return reason::kCornerWord;  // G1 X10 R2: a rounded corner
  return words.has_any("IJKPQL") ? reason::kNotUnderstood : std::string_view();
}

Position end_of_motion(const BlockWords& words, const ControlState& state) {
  Position end = state.position;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const Word* word = words.find("XYZ"[axis]);
    if (word == nullptr) continue;
    double& mm = end.mm[static_cast<Eigen::Index>(axis)];
    if (state.modal.distance == DistanceMode::kAbsolute) {
      mm = to_mm(word->value, state);
      end.known[axis] = true;
    } else {
      mm += end.known[axis] ? to_mm(word->value, state) : 0;
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
    if (const Word* word = words.find("IJK"[axis])) arc.center[axis] = to_mm(word->value, state);
  }
  if (const Word* word = words.find('R')) arc.radius = to_mm(word->value, state);
  return arc;
}

bool read_plain_line(const Program& program, std::uint32_t index, const BlockFlow& flow,
                     ControlState& now, Interpretation& read) {
  const Block& block = program.blocks[index];
  if (!is_plain_state(now.modal) || !is_plain_block(block, flow)) return false;
  const auto words = plain_words_of(program.words_of(block));
  const ModalState& modal = now.modal;
  const bool straight = modal.motion == MotionMode::kLine || modal.motion == MotionMode::kRapid;
  if (!words || (words->motion == nullptr && !straight) || !take_feed(words->feed, now.modal)) {
    return false;
  }
  if (words->motion != nullptr) {
    now.modal.motion = words->motion->value == 0 ? MotionMode::kRapid : MotionMode::kLine;
    now.other_motion = {};
  }
  if (words->motion != nullptr || words->feed != nullptr) {
    if (read.states.back() != modal) read.states.push_back(modal);
  }

  const bool rapid = modal.motion == MotionMode::kRapid;
  BlockMeaning& meaning = read.blocks.emplace_back();
  meaning.kind = BlockKind::kMotion;
  meaning.motion = static_cast<std::int32_t>(read.motions.size());
  meaning.state_after = static_cast<std::uint32_t>(read.states.size() - 1);
  if (rapid) meaning.barrier = reason::kRapid;

  const geometry::Point3 start = now.position.mm;
  const double unit = modal.units == Units::kInch ? kMillimetresPerInch : 1;
  Motion& motion = read.motions.emplace_back();
  motion.block = index;
  motion.kind = rapid ? MotionKind::kRapid : MotionKind::kLine;
  motion.end_known = true;
  motion.start_known = true;
  for (std::size_t axis = 0; axis < words->places.size(); ++axis) {
    const Word* const place = words->places[axis];
    if (place == nullptr) continue;
    motion.axes_named[axis] = true;
    motion.start_known &= now.position.known[axis];
    now.position.mm[static_cast<Eigen::Index>(axis)] = place->value * unit;
    now.position.known[axis] = true;
  }
  motion.piece = geometry::Line{start, now.position.mm};
  return true;
}

}  // namespace batten::gcode
