#include "postproc/report/page_curvature.h"

#include <algorithm>
#include <cmath>
#include <variant>

#include "geometry/basic/rounding.h"

namespace batten::postproc {
namespace {

using geometry::Line;
using geometry::PathPiece;
using geometry::Point3;

// 1/mm, of the circle through three places; 0 where two of them are one.
double circle_through(const Point3& a, const Point3& b, const Point3& c) {
  const double sides = (b - a).norm() * (c - b).norm() * (c - a).norm();
  if (sides <= geometry::kSamePlace * geometry::kSamePlace * geometry::kSamePlace) return 0;
  return 2 * (b - a).cross(c - b).norm() / sides;
}

bool is_line(const PathPiece& piece) { return std::holds_alternative<Line>(piece); }

double at_joint(const PathPiece& before, const PathPiece& after) {
  if (is_line(before) && is_line(after)) {
    return circle_through(geometry::start_point(before), geometry::end_point(before),
                          geometry::end_point(after));
  }
  return std::max(geometry::curvature_at(before, 1), geometry::curvature_at(after, 0));
}

}  // namespace

ChainCurvature::ChainCurvature(std::span<const PathPiece> chain)
    : chain_(chain), at_joint_(chain.size() + 1, 0.0) {
  for (std::size_t i = 0; i + 1 < chain.size(); ++i) {
    at_joint_[i + 1] = at_joint(chain[i], chain[i + 1]);
  }
}

double ChainCurvature::at(std::size_t piece, const Point3& place) const {
  const double share = share_of_piece(chain_[piece], place);
  if (!is_line(chain_[piece])) return geometry::curvature_at(chain_[piece], share);
  return (1 - share) * at_joint_[piece] + share * at_joint_[piece + 1];
}

double share_of_piece(const PathPiece& piece, const Point3& place) {
  const double from_start = (place - geometry::start_point(piece)).norm();
  const double to_end = (geometry::end_point(piece) - place).norm();
  if (const auto* arc = std::get_if<geometry::Arc>(&piece)) {
    // By the angle: a full circle starts and ends in one place.
    const geometry::Vector3 from = arc->start - arc->center;
    const geometry::Vector3 to = place - arc->center;
    double angle = std::atan2(arc->axis.dot(from.cross(to)),
                              from.dot(to) - arc->axis.dot(from) * arc->axis.dot(to));
    if (arc->sweep < 0) angle = -angle;
    constexpr double kTurn = 2 * 3.14159265358979323846;
    const double sweep = std::abs(arc->sweep);
    // Places a little before the start or behind the end by rounding belong to that end.
    if (angle < 0 && angle + kTurn > sweep) angle = -angle < angle + kTurn - sweep ? 0 : sweep;
    if (angle < 0) angle += kTurn;
    return std::clamp(angle / sweep, 0.0, 1.0);
  }
  const double whole = from_start + to_end;
  return whole > 0 ? from_start / whole : 0;
}

}  // namespace batten::postproc
