#include "postproc/runs/intended_arcs.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "geometry/basic/rounding.h"
#include "postproc/runs/run_path.h"

namespace batten::postproc {
namespace {

using geometry::Arc;
using geometry::CubicBezier;
using geometry::PathPiece;
using geometry::Vector3;

// Pieces of one curve do not meet at a greater angle, however short they are.
constexpr double kCorner = 30 * std::numbers::pi / 180;

// What a segment of length l is off its curve when it alone makes a kink a: a line a l / 8, an arc
// through the ends and the middle of its section a l / 20 (docs/algorithms/arcs_in_runs.md). A
// cubic piece, which bends as it likes, may be nearer still.
constexpr double kLineOff = 1.0 / 8;
constexpr double kArcOff = 1.0 / 20;

// A curve in segments that is less true than this many tolerances was made for another job: its
// kinks cannot be hidden, and count as corners.
constexpr double kCoarse = 2;

// Where this part of the joints of consecutive arcs are kinks, the others are tangent by chance:
// arcs of even length along an evenly bending curve meet so.
constexpr double kKinksOfCurve = 1.0 / 3;

// A sweep this close to a full turn (radians) is one.
constexpr double kFullTurn = 2 * std::numbers::pi - 1e-6;

const Arc* arc_of(const PrintedMotion& motion) { return std::get_if<Arc>(&motion.piece); }

const CubicBezier* cubic_of(const PrintedMotion& motion) {
  return std::get_if<CubicBezier>(&motion.piece);
}

bool is_line(const PrintedMotion& motion) {
  return std::holds_alternative<geometry::Line>(motion.piece);
}

double rise_of(const PathPiece& piece, const Vector3& axis) {
  return (geometry::end_point(piece) - geometry::start_point(piece)).dot(axis);
}

bool is_level(const PrintedMotion& motion, const Vector3& axis) {
  if (const Arc* arc = arc_of(motion)) {
    // In another plane it leaves the level somewhere.
    if (std::abs(std::abs(arc->axis.dot(axis)) - 1) > geometry::kSameDirection) return false;
  }
  if (const CubicBezier* cubic = cubic_of(motion)) {
    return std::ranges::all_of(cubic->control, [&](const geometry::Point3& point) {
      return std::abs((point - cubic->control[0]).dot(axis)) <= geometry::kSamePlace;
    });
  }
  return std::abs(rise_of(motion.piece, axis)) <= geometry::kSamePlace;
}

// The tool ramps down on one segment and cuts a floor with the next: intended at any turn.
bool changes_level(const PrintedMotion& before, const PrintedMotion& after) {
  for (const PrintedMotion* motion : {&before, &after}) {
    const Arc* arc = arc_of(*motion);
    if (arc != nullptr && is_level(before, arc->axis) != is_level(after, arc->axis)) return true;
  }
  return false;
}

// The same of a curve that leaves its level with a kink, or comes to it so. Where it does so
// without one, it is a curve in space.
bool leaves_level(const PrintedMotion& before, const PrintedMotion& after) {
  const Vector3 up = Vector3::UnitZ();
  const bool curve = cubic_of(before) != nullptr || cubic_of(after) != nullptr;
  return curve && is_level(before, up) != is_level(after, up);
}

// mm, to the control point that gives a cubic its direction at one end: the next one that is not
// there itself.
double leg_of(const CubicBezier& cubic, bool at_end) {
  const geometry::Point3* p = cubic.control;
  for (const int i : {1, 2, 3}) {
    const double leg = at_end ? (p[3] - p[3 - i]).norm() : (p[i] - p[0]).norm();
    if (leg > geometry::kSamePlace) return leg;
  }
  return geometry::kSamePlace;
}

double radius_at(const Arc& arc, bool at_end) {
  const Vector3 out = (at_end ? arc.end : arc.start) - arc.center;
  return std::max((out - out.dot(arc.axis) * arc.axis).norm(), geometry::kSamePlace);
}

// By how much the direction that a motion has at one end may be wrong (radians), with errors e of
// its ends and f of its centre in two axes, sqrt(2) of the printed errors.
double direction_error(const PrintedMotion& motion, bool at_end, const PrintedErrors& errors) {
  const double e = std::numbers::sqrt2 * errors.place;
  // Its control points are printed as places, as offsets of no fewer decimals or by coefficients.
  if (const CubicBezier* cubic = cubic_of(motion)) return 4 * e / leg_of(*cubic, at_end);
  const double f = std::numbers::sqrt2 * errors.center;
  const Vector3 across = geometry::end_point(motion.piece) - geometry::start_point(motion.piece);
  const double chord = std::max(across.norm(), geometry::kSamePlace);
  const Arc* arc = arc_of(motion);
  // Its ends turn the chord, and the whole of the segment with it.
  const double turned = 2 * e / chord;
  if (arc == nullptr) return turned;
  const double radius = radius_at(*arc, at_end);
  if (motion.by_radius) {
    // The angle between chord and tangent is h with sin h = chord / 2 R.
    const double half = std::min(0.5 * std::abs(arc->sweep), std::numbers::pi);
    return turned + std::abs(std::tan(half)) * (errors.center / radius + turned);
  }
  // The centre is seen beside its position: from the start by its own error, from the end by those
  // of both ends as well. And the radii at the two ends differ, by at most 2 e + 2 f: a spiral.
  const double shifted = (at_end ? 2 * e + f : f) / radius;
  return shifted + (2 * e + 2 * f) / chord;
}

// The least that two segments must be off one curve to meet at this angle.
double off_by(const PrintedMotion& motion, double turn) {
  return turn * geometry::length_of(motion.piece) * (is_line(motion) ? kLineOff : kArcOff);
}

class Judge {
 public:
  Judge(std::span<const PrintedMotion> chain, const PrintedErrors& errors, double tolerance)
      : chain_(chain), joints_(chain.size() + 1, ArcJoint::kCorner) {
    for (std::size_t i = 1; i < chain.size(); ++i) {
      joints_[i] = joint_between(chain[i - 1], chain[i], errors, tolerance);
    }
  }

  ChainJudgement judge() {
    ChainJudgement judged;
    for (std::size_t i = 0; i < chain_.size(); ++i) {
      judged.starts_part.push_back(joints_[i] == ArcJoint::kCorner);
      judged.kept.push_back(arc_of(chain_[i]) != nullptr && !is_kinked(i));
    }
    for (std::size_t i = 0; i < chain_.size();) {
      const std::size_t end = end_of_group(i);
      if (is_curve(i, end)) {
        for (std::size_t k = i; k < end; ++k) judged.kept[k] = judged.kept[k] && is_fillet(k);
      }
      i = std::max(end, i + 1);
    }
    return judged;
  }

 private:
  [[nodiscard]] bool may_be_piece(std::size_t i) const {
    const Arc* arc = arc_of(chain_[i]);
    return arc != nullptr && std::abs(arc->sweep) < kFullTurn;
  }

  [[nodiscard]] bool is_kinked(std::size_t i) const {
    return may_be_piece(i) && (joints_[i] == ArcJoint::kKink || joints_[i + 1] == ArcJoint::kKink);
  }

  // After the last of the arcs from `begin` on that follow each other without a corner.
  [[nodiscard]] std::size_t end_of_group(std::size_t begin) const {
    std::size_t end = begin;
    while (end < chain_.size() && may_be_piece(end) &&
           (end == begin || joints_[end] != ArcJoint::kCorner)) {
      ++end;
    }
    return end;
  }

  [[nodiscard]] bool is_curve(std::size_t begin, std::size_t end) const {
    if (end < begin + 2) return false;
    const auto first = joints_.begin() + static_cast<std::ptrdiff_t>(begin);
    const auto last = joints_.begin() + static_cast<std::ptrdiff_t>(end);
    const auto kinks = std::count(first + 1, last, ArcJoint::kKink);
    return static_cast<double>(kinks) >= kKinksOfCurve * static_cast<double>(end - begin - 1);
  }

  // Between a straight line and other arcs, tangent to both.
  [[nodiscard]] bool is_fillet(std::size_t i) const {
    const bool behind_line = i > 0 && is_line(chain_[i - 1]);
    const bool before_line = i + 1 < chain_.size() && is_line(chain_[i + 1]);
    return (behind_line && joints_[i] == ArcJoint::kTangent) ||
           (before_line && joints_[i + 1] == ArcJoint::kTangent);
  }

  std::span<const PrintedMotion> chain_;
  std::vector<ArcJoint> joints_;  // before each motion; the ends of the chain are corners
};

}  // namespace

ArcJoint joint_between(const PrintedMotion& before, const PrintedMotion& after,
                       const PrintedErrors& errors, double tolerance) {
  if (is_line(before) && is_line(after)) return ArcJoint::kNone;
  if (changes_level(before, after)) return ArcJoint::kCorner;
  const double turn = turn_between(before.piece, after.piece);
  if (turn <= direction_error(before, true, errors) + direction_error(after, false, errors)) {
    return ArcJoint::kTangent;
  }
  if (leaves_level(before, after)) return ArcJoint::kCorner;
  const bool coarse = std::min(off_by(before, turn), off_by(after, turn)) > kCoarse * tolerance;
  return turn > kCorner || coarse ? ArcJoint::kCorner : ArcJoint::kKink;
}

ChainJudgement judge_arcs(std::span<const PrintedMotion> chain, const PrintedErrors& errors,
                          double tolerance) {
  return Judge(chain, errors, tolerance).judge();
}

}  // namespace batten::postproc
