#include "postproc/machine/linuxcnc_naive_cam.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

#include "geometry/numeric.h"

namespace batten::postproc::linuxcnc {
namespace {

using geometry::Arc;
using geometry::Line;
using geometry::Point3;
using geometry::Vector3;

// A joined move is closed when it holds more points than this.
constexpr std::size_t kMostPoints = 100;

// Axes this near to Z belong to arcs of G17; printed programs give them exactly.
constexpr double kAlongZ = 1e-6;

double distance_to_segment(const Point3& p, const Point3& a, const Vector3& way) {
  const double square = way.squaredNorm();
  const double t = square > 0 ? std::clamp(way.dot(p - a) / square, 0.0, 1.0) : 0.0;
  return (p - a - t * way).norm();
}

class Joiner {
 public:
  explicit Joiner(double tolerance) : tolerance_(tolerance) {}

  void add_line(const Point3& from, const Point3& to, const TimedPiece& piece,
                std::uint32_t index) {
    if (!points_.empty() && (piece.feed != open_.feed || !can_reach(to))) flush();
    if (points_.empty()) {
      start_ = from;
      open_ = {piece, index, index};
    }
    points_.push_back(to);
    open_.last_piece = index;
  }

  void add_other(const TimedPiece& piece, std::uint32_t index) {
    flush();
    joined_.push_back({piece, index, index});
  }

  std::vector<JoinedPiece> finish() {
    flush();
    return std::move(joined_);
  }

 private:
  [[nodiscard]] bool can_reach(const Point3& to) const {
    if (points_.size() > kMostPoints) return false;
    const Vector3 way = to - start_;
    if (way.norm() <= geometry::kSamePlace) return false;
    return std::all_of(points_.begin(), points_.end(), [&](const Point3& p) {
      return distance_to_segment(p, start_, way) <= tolerance_;
    });
  }

  void flush() {
    if (points_.empty()) return;
    open_.piece = Line{start_, points_.back()};
    joined_.push_back(open_);
    points_.clear();
  }

  double tolerance_;
  Point3 start_ = Point3::Zero();
  JoinedPiece open_;  // its line ends at the last of the points
  std::vector<Point3> points_;
  std::vector<JoinedPiece> joined_;
};

// Distance of the middle of the arc from the middle of its chord.
double rise_of(const Arc& arc) {
  const Point3 middle = geometry::point_at(arc, 0.5);
  return (middle - (arc.start + arc.end) / 2).norm();
}

bool becomes_lines(const Arc& arc, double tolerance) {
  const bool flat = std::abs(std::abs(arc.axis.z()) - 1) < kAlongZ;
  return flat && std::abs(arc.sweep) < std::numbers::pi && rise_of(arc) < tolerance;
}

}  // namespace

std::vector<JoinedPiece> join_within(std::span<const TimedPiece> pieces, double tolerance) {
  Joiner joiner(tolerance);
  for (std::size_t i = 0; i < pieces.size(); ++i) {
    const TimedPiece& timed = pieces[i];
    const auto index = static_cast<std::uint32_t>(i);
    const bool joins = tolerance > 0 && !timed.rapid;
    const auto* arc = std::get_if<Arc>(&timed.piece);
    const auto* line = std::get_if<Line>(&timed.piece);
    if (joins && line != nullptr) {
      joiner.add_line(line->start, line->end, timed, index);
    } else if (joins && arc != nullptr && becomes_lines(*arc, tolerance)) {
      const Point3 middle = geometry::point_at(*arc, 0.5);
      joiner.add_line(arc->start, middle, timed, index);
      joiner.add_line(middle, arc->end, timed, index);
    } else {
      joiner.add_other(timed, index);
    }
  }
  return joiner.finish();
}

}  // namespace batten::postproc::linuxcnc
