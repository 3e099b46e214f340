#include "geometry/path/parallel_path.h"

#include <cmath>
#include <variant>

#include "geometry/basic/rounding.h"

namespace batten::geometry {

namespace {

bool turns_about_z(const Arc& arc) { return std::abs(arc.axis.z()) > 1 - kSameDirection; }

// How far the path is moved at the start and the end of a piece.
struct Shift {
  Vector3 start;
  Vector3 end;
};

PathPiece moved_line(const Line& line, const Shift& shift) {
  return Line{line.start + shift.start, line.end + shift.end};
}

// About the same centre. An arc that is left on its inside by more than its radius goes on behind
// the centre; on the centre itself it is a place.
PathPiece moved_arc(const Arc& arc, const Shift& shift) {
  Arc moved = arc;
  moved.start += shift.start;
  moved.end += shift.end;
  const Vector3 out = moved.start - moved.center;
  if (std::hypot(out.x(), out.y()) <= kSamePlace) return Line{moved.start, moved.end};
  return moved;
}

class Parallel {
 public:
  Parallel(std::span<const PathPiece> path, double distance) : path_(path), distance_(distance) {}

  std::optional<Path> make() {
    last_ = first_shift();
    for (const PathPiece& piece : path_) {
      const Vector3 start = shift_at(piece, 0);
      join(start_point(piece), start);
      last_ = start;
      const Vector3 end = shift_at(piece, 1);
      if (const auto* line = std::get_if<Line>(&piece)) {
        made_.push_back(moved_line(*line, {start, end}));
      } else if (const auto* arc = std::get_if<Arc>(&piece); arc && turns_about_z(*arc)) {
        made_.push_back(moved_arc(*arc, {start, end}));
      } else {
        return std::nullopt;
      }
      last_ = end;
    }
    return std::move(made_);
  }

 private:
  [[nodiscard]] Vector3 first_shift() const {
    for (const PathPiece& piece : path_) {
      const Vector3 left = left_of(direction_at(piece, 0));
      if (!left.isZero()) return distance_ * left;
    }
    return Vector3::Zero();
  }

  // That of the piece before where this one has no side.
  [[nodiscard]] Vector3 shift_at(const PathPiece& piece, double t) const {
    const Vector3 left = left_of(direction_at(piece, t));
    return left.isZero() ? last_ : Vector3(distance_ * left);
  }

  void join(const Point3& vertex, const Vector3& next) {
    const double turn = std::atan2(last_.x() * next.y() - last_.y() * next.x(), last_.dot(next));
    if (std::abs(turn) <= kSameDirection) return;
    made_.push_back(Arc{vertex + last_, vertex + next, vertex, Vector3::UnitZ(), turn});
  }

  std::span<const PathPiece> path_;
  double distance_;  // to the left, negative: to the right
  Vector3 last_ = Vector3::Zero();
  Path made_;
};

}  // namespace

Vector3 left_of(const Vector3& direction) {
  const Vector3 left(-direction.y(), direction.x(), 0);
  const double length = left.norm();
  return length <= kSameDirection ? Vector3(Vector3::Zero()) : Vector3(left / length);
}

std::optional<Path> parallel_path(std::span<const PathPiece> path, Side side, double distance) {
  if (side == Side::kBoth) return std::nullopt;
  return Parallel(path, side == Side::kLeft ? distance : -distance).make();
}

}  // namespace batten::geometry
