// LinuxCNC 2.9: naive CAM, blend arcs, tangent joints, trapezoids per move.

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <iterator>
#include <numbers>
#include <span>
#include <utility>
#include <vector>

#include "geometry/basic/rounding.h"
#include "postproc/machine/models/cycle_time.h"
#include "postproc/machine/models/linuxcnc_segment.h"
#include "postproc/machine/models/velocity_profile.h"

namespace batten::postproc {
namespace linuxcnc {
namespace {

using gcode::PathMode;
using geometry::Arc;
using geometry::CubicBezier;
using geometry::Line;
using geometry::PathPiece;
using geometry::Point3;
using geometry::Vector3;

// --- the canon layer in front of the planner: under G64 P Q it joins lines that are nearly one ---

// A move as the planner gets it: the pieces of the program from the first to the last.
struct JoinedPiece : TimedPiece {
  std::uint32_t first_piece = 0;
  std::uint32_t last_piece = 0;
};

// A joined move is closed when it holds more points than this.
constexpr std::size_t kMostPoints = 100;

// Axes this near to Z belong to arcs of G17; printed programs give them exactly.
constexpr double kAlongZ = 1e-6;

// Distance of the middle of a bend from the middle of its chord.
double rise_of(const PathPiece& bend) {
  const Point3 chord = (geometry::start_point(bend) + geometry::end_point(bend)) / 2;
  return (geometry::point_at(bend, 0.5) - chord).norm();
}

// A part of a curve is flat: the control has curves in XY alone.
bool becomes_lines(const PathPiece& bend, double tolerance) {
  if (const auto* arc = std::get_if<Arc>(&bend)) {
    const bool flat = std::abs(std::abs(arc->axis.z()) - 1) < kAlongZ;
    if (!flat || std::abs(arc->sweep) >= std::numbers::pi) return false;
  }
  return rise_of(bend) < tolerance;
}

// A cubic piece for itself runs as this many arcs.
constexpr double kArcsPerBezier = 32;

// From the start of one to the end of the other, in their directions there.
CubicBezier joined(const CubicBezier& first, const CubicBezier& last) {
  const Vector3 out = geometry::direction_at(first, 0);
  const Vector3 in = geometry::direction_at(last, 1);
  const double third = (last.control[3] - first.control[0]).norm() / 3;
  return {{first.control[0], first.control[0] + third * out, last.control[3] - third * in,
           last.control[3]}};
}

// Lines that are joined become one line. Flat arcs in a plane of constant Z whose middle is less
// than `tolerance` (mm) off the chord become two lines, which then may be joined too. Rapids stay
// as they are. A tolerance of 0 changes nothing. Cost: linear, since a joined move has some 100
// parts.
template <typename Take>
class Joiner {
 public:
  // `take` gets the moves, in order.
  Joiner(double tolerance, Take& take) : tolerance_(tolerance), take_(take) {}

  // A piece of the program, or an arc of several.
  void add(const TimedPiece& piece, std::uint32_t first, std::uint32_t last) {
    const auto* line = std::get_if<Line>(&piece.piece);
    if (!(tolerance_ > 0) || piece.rapid) {
      add_other({piece, first, last});
    } else if (line != nullptr) {
      add_line(line->start, line->end, piece, first, last);
    } else if (becomes_lines(piece.piece, tolerance_)) {
      const Point3 middle = geometry::point_at(piece.piece, 0.5);
      add_line(geometry::start_point(piece.piece), middle, piece, first, last);
      add_line(middle, geometry::end_point(piece.piece), piece, first, last);
    } else {
      add_other({piece, first, last});
    }
  }

  void finish() { flush(); }

 private:
  void add_line(const Point3& from, const Point3& to, const TimedPiece& piece, std::uint32_t first,
                std::uint32_t last) {
    if (!ends_.empty() && (piece.feed != open_.feed || !can_reach(to))) flush();
    if (ends_.empty()) {
      start_ = from;
      open_ = {piece, first, last};
    }
    ends_.push_back(to - start_);
    end_ = to;
    open_.last_piece = last;
  }

  void add_other(const JoinedPiece& move) {
    flush();
    take_(move);
  }

  [[nodiscard]] bool can_reach(const Point3& to) const {
    if (ends_.size() > kMostPoints) return false;
    const Vector3 way = to - start_;
    if (!(way.norm() > geometry::kSamePlace)) return false;
    const double square = way.squaredNorm();
    return std::ranges::all_of(ends_, [&](const Vector3& end) {
      const double t = std::clamp(way.dot(end) / square, 0.0, 1.0);
      return (end - t * way).norm() <= tolerance_;
    });
  }

  void flush() {
    if (ends_.empty()) return;
    open_.piece = Line{start_, end_};
    take_(open_);
    ends_.clear();
  }

  double tolerance_;
  Take& take_;
  Point3 start_ = Point3::Zero();
  Point3 end_ = Point3::Zero();
  JoinedPiece open_;           // what is joined so far, but for its line
  std::vector<Vector3> ends_;  // of its lines, as ways from where it starts
};

// Curves as the arcs that the interpreter makes of them: parts of a piece, or several pieces. The
// rest stays. Both go to the joiner.
template <typename Take>
void add_with_curves_as_arcs(std::span<const TimedPiece> pieces, Joiner<Take>& joiner) {
  JoinedPiece arc;  // of several pieces
  double open = 0;  // what the pieces so far are of it; 0: there is none
  const auto close = [&] {
    if (open > 0) joiner.add(arc, arc.first_piece, arc.last_piece);
    open = 0;
  };
  for (std::size_t i = 0; i < pieces.size(); ++i) {
    const TimedPiece& timed = pieces[i];
    const auto index = static_cast<std::uint32_t>(i);
    const auto* cubic = std::get_if<CubicBezier>(&timed.piece);
    if (cubic == nullptr) {
      close();
      joiner.add(timed, index, index);
      continue;
    }
    const double wanted = timed.arcs > 0 ? timed.arcs : kArcsPerBezier;
    if (wanted < 1 && timed.goes_on && open > 0 && open + wanted / 2 < 1) {
      arc.piece = joined(std::get<CubicBezier>(arc.piece), *cubic);
      arc.last_piece = index;
      open += wanted;
      continue;
    }
    close();
    const double count = std::max(1.0, std::round(wanted));
    for (double k = 0; k < count; ++k) {
      JoinedPiece part{timed, index, index};
      part.piece = geometry::sub_piece(*cubic, k / count, (k + 1) / count);
      if (!(geometry::length_of(part.piece) > 0)) continue;
      if (wanted < 1) {
        arc = part;
        open = wanted;
      } else {
        joiner.add(part, index, index);
      }
    }
  }
  close();
  joiner.finish();
}

// --- the planner ------------------------------------------------------------------------------

// A line that a corner leaves shorter than this many periods joins the blend arc.
constexpr double kGapPeriods = 4;

// Moves shorter than this (s) run at one acceleration ([TRAJ]ARC_BLEND_RAMP_FREQ, 100 Hz).
constexpr double kRampTime = 0.01;

// A move that stops ends with a whole period: half a period is lost on average.
constexpr double kStopPeriods = 0.5;

// Cycles of the interpreter that a wait for the end of the motion takes; measured: 2.9 to 3.7.
constexpr double kWaitPeriods = 3;

// Moves that turn back by more than 178 degrees stop.
constexpr double kSharpTurn = 2.0 / 180 * std::numbers::pi;

Joint joint_of(PathMode path) {
  if (path == PathMode::kExactStop) return Joint::kStop;
  return path == PathMode::kExactPath ? Joint::kExactPath : Joint::kParabolic;
}

class Queue {
 public:
  Queue(const Machine& machine, const gcode::PathControl& path, WithPositions places)
      : machine_(machine),
        blend_tolerance_(path.blend_tolerance.value_or(machine.blend_tolerance)),
        limits_(space_limits(machine)),
        joint_(joint_of(path.mode)),
        wants_places_(places == WithPositions::kYes) {
    chain_.rules.look_ahead = machine_.look_ahead;
    chain_.rules.ramp_time = kRampTime;
    chain_.rules.stop_time = kStopPeriods * machine_.servo_period;
    moves_.reserve(kHeld + kHandedOn + 1);
  }

  void add(const JoinedPiece& timed) {
    Segment next = segment_of(timed, limits_, joint_);
    next.first_piece = timed.first_piece;
    next.last_piece = timed.last_piece;
    if (!moves_.empty()) {
      connect(next, timed.piece);
      finish_segment(moves_.back(), machine_.servo_period);
    }
    moves_.push_back(next);
    if (wants_places_) paths_.push_back(timed.piece);
    if (moves_.size() >= kHeld + kHandedOn) hand_on(kHandedOn);
  }

  [[nodiscard]] StretchChain finish(ChainEnd end) {
    if (moves_.empty()) return std::move(chain_);
    if (end == ChainEnd::kEndOfMotion) enter_last_move_slowly();
    if (end == ChainEnd::kStop || joint_ != Joint::kParabolic) moves_.back().end = Joint::kStop;
    hand_on(moves_.size());
    return std::move(chain_);
  }

 private:
  // Moves are big, and only the last few of them still change: those before them are stretches
  // already, some at a time.
  static constexpr std::size_t kHeld = 4;
  static constexpr std::size_t kHandedOn = 28;

  void hand_on(std::size_t count) {
    for (std::size_t i = 0; i < count; ++i) {
      const bool overlaps = i + 1 < moves_.size() && moves_[i].end == Joint::kParabolic;
      const double at_end = overlaps ? overlap(moves_[i], moves_[i + 1]) : 0;
      VelocityStretch own = stretch_of(moves_[i]);
      own.length = std::max(own.length - at_start_ - at_end, geometry::kSamePlace);
      chain_.stretches.push_back(own);
      if (wants_places_) chain_.places.push_back(place_of(i, at_start_, at_end));
      if (overlaps) {
        VelocityStretch both = own;
        both.length = 2 * at_end;
        both.max_velocity = own.exit_velocity;
        chain_.stretches.push_back(both);
        if (wants_places_) chain_.places.push_back(overlap_place(i, at_end));
      }
      at_start_ = at_end;
    }
    moves_.erase(moves_.begin(), moves_.begin() + static_cast<std::ptrdiff_t>(count));
    if (!wants_places_) return;
    paths_.erase(paths_.begin(), paths_.begin() + static_cast<std::ptrdiff_t>(count));
  }

  // The last move of the queue could still lose half of its length to a corner: the planner
  // enters it only as fast as it can stop on the other half.
  void enter_last_move_slowly() {
    if (moves_.size() < 2) return;
    const Segment& last = moves_.back();
    Segment& before = moves_[moves_.size() - 2];
    before.kink_velocity =
        std::min(before.kink_velocity, std::sqrt(tangential_acceleration(last) * last.length));
  }

  // While one move slows down to rest and the next speeds up from rest, the path goes on at
  // an even speed: neither move can go faster over this length (mm) next to the joint.
  static double overlap(const Segment& before, const Segment& after) {
    const double velocity = before.kink_velocity;
    const double slower = std::min(tangential_acceleration(before), tangential_acceleration(after));
    return std::min({velocity * velocity / slower / 2, before.length / 2, after.length / 2});
  }

  // The position `cut` mm before the end of what corners leave of the move, or after its start.
  static Point3 place_before_end(const Segment& s, const PathPiece& path, double cut) {
    return point_at(path, std::clamp(1 - (s.cut_at_end + cut) / s.nominal_length, 0.0, 1.0));
  }
  static Point3 place_after_start(const Segment& s, const PathPiece& path, double cut) {
    return point_at(path, std::clamp((s.cut_at_start + cut) / s.nominal_length, 0.0, 1.0));
  }

  [[nodiscard]] StretchPlace place_of(std::size_t i, double at_start, double at_end) const {
    const Segment& s = moves_[i];
    StretchPlace place{s.first_piece, s.last_piece, s.shape == Shape::kBlendArc, paths_[i]};
    // Rounding may leave nothing between the two cuts: a millionth of the move stands for it.
    constexpr double kLeastPart = 1e-6;
    const double t0 = std::min((s.cut_at_start + at_start) / s.nominal_length, 1 - kLeastPart);
    const double t1 = std::max(1 - (s.cut_at_end + at_end) / s.nominal_length, t0 + kLeastPart);
    if (t0 > 0 || t1 < 1) place.path = geometry::sub_piece(paths_[i], t0, std::min(t1, 1.0));
    return place;
  }

  // The parabola of a point that move i brings to rest while the next one speeds it up.
  [[nodiscard]] StretchPlace overlap_place(std::size_t i, double way) const {
    return {moves_[i].last_piece, moves_[i + 1].first_piece, true,
            bend_through(place_before_end(moves_[i], paths_[i], way), end_point(paths_[i]),
                         place_after_start(moves_[i + 1], paths_[i + 1], way))};
  }

  // From one place to another, tangent at both to the lines through the corner.
  static geometry::CubicBezier bend_through(const Point3& from, const Point3& corner,
                                            const Point3& to) {
    return {{from, from + 2.0 / 3 * (corner - from), to + 2.0 / 3 * (corner - to), to}};
  }

  // A bend of this length between two places and directions, along which the way goes nearly
  // evenly with the parameter; a circle to within a few per cent of its rise.
  static geometry::CubicBezier bend_of(const Point3& from, const geometry::Vector3& leaving,
                                       const Point3& to, const geometry::Vector3& arriving,
                                       double length) {
    return {{from, from + length / 3 * leaving, to - length / 3 * arriving, to}};
  }

  static VelocityStretch stretch_of(const Segment& s) {
    VelocityStretch stretch;
    stretch.length = s.length;
    stretch.max_velocity = target_velocity(s);
    stretch.acceleration = tangential_acceleration(s);
    const bool stops = s.end == Joint::kStop || s.end == Joint::kExactPath;
    stretch.exit_velocity = stops ? 0 : s.kink_velocity;
    stretch.runs_on = s.end == Joint::kTangent;
    return stretch;
  }

  // `path`: of the next move.
  void connect(Segment& next, const PathPiece& path) {
    Segment& last = moves_.back();
    if (last.end == Joint::kStop) return;
    if ((last.end_direction + next.start_direction).norm() < kSharpTurn) {
      last.end = Joint::kStop;
      return;
    }
    const double kink = kink_at_full_speed(last, next, limits_.acceleration, machine_.servo_period);
    const double velocity = std::min(target_velocity(last), target_velocity(next));
    if (kink < kKinkShare) {
      set_kink(last, next, velocity, kink);
      last.end = Joint::kTangent;
      return;
    }
    set_kink(last, next, velocity * kKinkShare / kink, kKinkShare);
    if (last.end == Joint::kParabolic) blend(next, path);
  }

  static void set_kink(Segment& last, Segment& next, double velocity, double share) {
    last.kink_velocity = velocity;
    last.kink_share_at_end = share;
    next.kink_share_at_start = share;
  }

  static void clear_kink(Segment& last, Segment& next) { set_kink(last, next, kNoLimit, 0); }

  // Of a blend arc, running over the kink slowly, and a parabolic blend, the control takes
  // the one that passes fastest; a parabolic blend counts half, since it halves the
  // acceleration on both sides.
  void blend(Segment& next, const PathPiece& path) {
    Segment& last = moves_.back();
    const double tolerance = blend_tolerance_;
    const double parabolic = parabolic_velocity(last, next, tolerance);
    const double half_turn_cos =
        std::sqrt(std::max(0.0, (1 + last.end_direction.dot(next.start_direction)) / 2));
    const double parabolic_worth = half_turn_cos * parabolic / 2;
    const auto arc = blend_arc(last, next, machine_, tolerance);
    double arc_worth = 0;
    if (arc) {
      const double left = takes_rest_of_last(*arc) ? last.length - arc->trim_before : 0;
      arc_worth = std::min(arc->velocity, (arc->radius * arc->turn + left) / machine_.servo_period);
    }
    if (arc_worth > std::max(parabolic_worth, last.kink_velocity)) {
      insert(*arc, next, path);
    } else if (last.kink_velocity > parabolic_worth) {
      last.end = Joint::kTangent;
    } else {
      clear_kink(last, next);
      last.kink_velocity = parabolic;
      next.after_parabolic = true;
    }
  }

  // Whether what the arc leaves of the last line is so short that the arc takes that too.
  [[nodiscard]] bool takes_rest_of_last(const BlendArc& arc) const {
    const Segment& last = moves_.back();
    if (last.shape != Shape::kLine || last.after_parabolic) return false;
    return last.length - arc.trim_before < kGapPeriods * machine_.servo_period * arc.velocity;
  }

  void insert(const BlendArc& arc, Segment& next, const PathPiece& path) {
    Segment& last = moves_.back();
    clear_kink(last, next);
    const bool takes_rest = takes_rest_of_last(arc);
    Segment bend;
    bend.shape = Shape::kBlendArc;
    bend.length =
        arc.radius * arc.turn + (takes_rest ? std::max(0.0, last.length - arc.trim_before) : 0);
    bend.nominal_length = bend.length;
    bend.feed = std::max(last.feed, next.feed);
    bend.max_velocity = arc.velocity;
    bend.acceleration = arc.acceleration;
    bend.end = Joint::kTangent;
    bend.first_piece = takes_rest ? last.first_piece : last.last_piece;
    bend.last_piece = next.first_piece;
    if (wants_places_) insert_bend(arc, next, path, bend.length);
    cut(next, arc.trim_after);
    next.cut_at_start += arc.trim_after;
    if (takes_rest) {
      moves_.pop_back();
    } else {
      cut(last, arc.trim_before);
      last.cut_at_end += arc.trim_before;
      last.end = Joint::kTangent;
      finish_segment(last, machine_.servo_period);
    }
    finish_segment(bend, machine_.servo_period);
    moves_.push_back(bend);
  }

  // Where the arc runs, in its place among the paths. `length`: of the bend, mm.
  void insert_bend(const BlendArc& arc, const Segment& next, const PathPiece& path, double length) {
    const Segment& last = moves_.back();
    const bool takes_rest = takes_rest_of_last(arc);
    const Point3 from = takes_rest ? place_after_start(last, paths_.back(), 0)
                                   : place_before_end(last, paths_.back(), arc.trim_before);
    if (takes_rest) paths_.pop_back();
    paths_.push_back(bend_of(from, last.end_direction,
                             place_after_start(next, path, arc.trim_after), next.start_direction,
                             length));
  }

  static void cut(Segment& s, double by) {
    // The corners take half of a line and two thirds and one third of an arc at most;
    // rounding must not leave less than nothing.
    const double left = std::max(s.length - by, geometry::kSamePlace);
    s.sweep *= left / s.length;
    s.length = left;
  }

  const Machine& machine_;
  double blend_tolerance_;  // mm
  SpaceLimits limits_;
  Joint joint_;
  bool wants_places_;
  StretchChain chain_;
  std::vector<Segment> moves_;    // those that may still change
  std::vector<PathPiece> paths_;  // of the moves, where places are wanted
  double at_start_ = 0;  // mm of the first of them that the overlap with the one before takes
};

}  // namespace
}  // namespace linuxcnc

namespace {

StretchChain stretches_in_one(std::span<const TimedPiece> pieces, const Machine& machine,
                              const gcode::PathControl& path, ChainEnd end, WithPositions places) {
  linuxcnc::Queue queue(machine, path, places);
  const bool joins =
      path.mode != gcode::PathMode::kExactStop && path.mode != gcode::PathMode::kExactPath;
  const double tolerance =
      joins ? path.naive_cam_tolerance.value_or(machine.naive_cam_tolerance) : 0;
  const auto take = [&queue](const linuxcnc::JoinedPiece& move) { queue.add(move); };
  linuxcnc::Joiner joiner(tolerance, take);
  linuxcnc::add_with_curves_as_arcs(pieces, joiner);
  return queue.finish(end);
}

}  // namespace

// A speed of the spindle, the one that holds as well, waits for the motion before it to end.
StretchChain linuxcnc_stretches(std::span<const TimedPiece> pieces, const Machine& machine,
                                const gcode::PathControl& path, ChainEnd end,
                                WithPositions places) {
  StretchChain chain;
  std::size_t first = 0;
  do {
    const std::span<const TimedPiece> rest = pieces.subspan(first);
    const auto more = rest.subspan(std::min<std::size_t>(rest.size(), 1));
    const auto wait = std::ranges::find_if(more, &TimedPiece::says_speed);
    const auto count = rest.size() - static_cast<std::size_t>(more.end() - wait);
    const bool is_last = count == rest.size();
    StretchChain part = stretches_in_one(rest.first(count), machine, path,
                                         is_last ? end : ChainEnd::kEndOfMotion, places);
    if (is_last && first == 0) return part;
    // The interpreter goes on when it has seen the rest, in its next cycles.
    part.rules.stop_time += linuxcnc::kWaitPeriods * machine.block_period;
    if (!part.stretches.empty()) part.stretches.back().exit_velocity = 0;
    for (StretchPlace& place : part.places) {
      place.first_piece += static_cast<std::uint32_t>(first);
      place.last_piece += static_cast<std::uint32_t>(first);
    }
    chain.rules = part.rules;
    std::ranges::move(part.stretches, std::back_inserter(chain.stretches));
    std::ranges::move(part.places, std::back_inserter(chain.places));
    first += count;
  } while (first < pieces.size());
  return chain;
}

}  // namespace batten::postproc
