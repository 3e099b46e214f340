#include "postproc/machine/program_time/program_time_blocks.h"

#include <algorithm>
#include <cmath>
#include <variant>

#include "gcode/state/modal_state.h"
#include "geometry/basic/rounding.h"

namespace batten::postproc {
namespace {

using gcode::DwellUnit;
using geometry::Point3;

constexpr double kMillisecond = 0.001;

std::optional<double> number(const gcode::BlockWords& words, char letter) {
  const gcode::Word* word = words.find(letter);
  if (word == nullptr || !word->is_number || !(word->value >= 0)) return std::nullopt;
  return word->value;
}

// How far above the bottom a peck comes back: LinuxCNC's 0.010 inch; others have a parameter
// of about that size.
constexpr double kPeckClearance = 0.254;

// More repeats or pecks than a drill can stand are a slip in the program.
constexpr int kMostRepeats = 10000;

double millimetres(const gcode::Word& word, const gcode::ModalState& state) {
  return state.units == gcode::Units::kInch ? word.value * gcode::kMillimetresPerInch : word.value;
}

void read_into(std::optional<double>& value, const gcode::Word* word,
               const gcode::ModalState& state) {
  if (word != nullptr && word->is_number) value = millimetres(*word, state);
}

// The moves of one hole, and where the tool is.
class HoleMoves {
 public:
  HoleMoves(std::vector<CycleMove>& moves, const Point3& from) : moves_(moves), at_(from) {}

  void to(StepKind kind, const Point3& place) {
    if ((place - at_).norm() > geometry::kSamePlace) moves_.push_back({kind, {at_, place}, 0});
    at_ = place;
  }
  void to_z(StepKind kind, double z) { to(kind, {at_.x(), at_.y(), z}); }
  void dwell(double seconds) {
    if (seconds > 0) moves_.push_back({StepKind::kDwell, {at_, at_}, seconds});
  }
  void start_spindle() { moves_.push_back({StepKind::kSpindle, {at_, at_}, 0}); }

  [[nodiscard]] const Point3& at() const { return at_; }

 private:
  std::vector<CycleMove>& moves_;
  Point3 at_;
};

// G83 comes up to R after each peck, G73 by the clearance only.
void peck(HoleMoves& hole, double r, double bottom, double depth, bool to_top) {
  for (double z = r - depth; z > bottom + geometry::kSamePlace; z -= depth) {
    hole.to_z(StepKind::kCut, z);
    if (to_top) hole.to_z(StepKind::kRapid, r);
    hole.to_z(StepKind::kRapid, std::min(r, z + kPeckClearance));
  }
  hole.to_z(StepKind::kCut, bottom);
}

}  // namespace

DwellTime dwell_of(const gcode::BlockWords& words, gcode::DwellUnit unit,
                   std::optional<double> spindle_speed) {
  if (const auto p = number(words, 'P')) {
    if (unit == DwellUnit::kSeconds) return {*p, false};
    const bool seconds = unit == DwellUnit::kByPoint && words.find('P')->has_point;
    const bool assumed = unit == DwellUnit::kByPoint && !seconds && *p > 0;
    return {seconds ? *p : *p * kMillisecond, assumed};
  }
  for (const char letter : {'X', 'U', 'F'}) {
    if (const auto seconds = number(words, letter)) return {seconds, false};
  }
  if (const auto turns = number(words, 'S'); turns && spindle_speed && *spindle_speed > 0) {
    return {*turns * 60 / *spindle_speed, false};
  }
  return {};
}

DwellUnit dwell_unit_of(const gcode::Control* target, const Machine& machine) {
  if (target != nullptr) return target->dwell_unit;
  if (machine.model == ControllerModel::kKlipper || machine.model == ControllerModel::kMarlin) {
    return DwellUnit::kMilliseconds;
  }
  return machine.model == ControllerModel::kLookAhead ? DwellUnit::kByPoint : DwellUnit::kSeconds;
}

void DrillingCycle::read(const gcode::BlockWords& words, const gcode::ModalState& state,
                         std::optional<double> dwell) {
  read_into(z_, words.find('Z'), state);
  read_into(r_, words.find('R'), state);
  read_into(peck_, words.find('Q'), state);
  if (dwell) dwell_ = *dwell;
}

std::optional<std::vector<CycleMove>> DrillingCycle::moves(const gcode::BlockWords& words,
                                                           const gcode::ModalState& state,
                                                           const Point3& from) const {
  const bool pecks = row_->is(gcode::trait::kPecks);
  if (!z_ || !r_ || (pecks && !(peck_ && *peck_ > 0))) return std::nullopt;
  const bool incremental = state.distance == gcode::DistanceMode::kIncremental;
  const double r = incremental ? initial_z_ + *r_ : *r_;
  const double bottom = incremental ? r + *z_ : *z_;
  if (bottom > r || (pecks && (r - bottom) / *peck_ > kMostRepeats)) return std::nullopt;

  const gcode::Word* repeats = words.has('L') ? words.find('L') : words.find('K');
  const int holes = repeats == nullptr
                        ? 1
                        : static_cast<int>(std::clamp(repeats->value, 0.0, double(kMostRepeats)));
  const auto step = [&](char axis, double at) {
    const gcode::Word* word = words.find(axis);
    if (word == nullptr) return at;
    return millimetres(*word, state) + (incremental ? at : 0);
  };
  std::vector<CycleMove> moves;
  HoleMoves hole(moves, from);
  for (int i = 0; i < holes; ++i) {
    if (hole.at().z() < r) hole.to_z(StepKind::kRapid, r);
    hole.to(StepKind::kRapid, {step('X', hole.at().x()), step('Y', hole.at().y()), hole.at().z()});
    hole.to_z(StepKind::kRapid, r);
    if (pecks) {
      peck(hole, r, bottom, *peck_, row_->is(gcode::trait::kClearsHole));
    } else {
      hole.to_z(StepKind::kCut, bottom);
    }
    if (row_->is(gcode::trait::kDwellsBelow)) hole.dwell(dwell_);
    if (row_->is(gcode::trait::kFeedsOut)) hole.to_z(StepKind::kCut, r);
    hole.to_z(StepKind::kRapid, returns_to_initial_ ? std::max(initial_z_, r) : r);
    if (row_->is(gcode::trait::kStopsSpindle)) hole.start_spindle();
  }
  return moves;
}

namespace {

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
    if (state.distance == gcode::DistanceMode::kIncremental) {
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
  const bool absolute = state.distance == gcode::DistanceMode::kAbsolute;
  const bool is_line = std::holds_alternative<geometry::Line>(motion.piece);
  for (std::size_t axis = 0; axis < 3; ++axis) {
    if (!words.has("XYZ"[axis])) continue;
    const Certainty certainty = absolute || !is_line ? Certainty::kKnown : place.certainty(axis);
    place.set_axis(axis, end[index_of(axis)], certainty);
  }
}

}  // namespace batten::postproc
