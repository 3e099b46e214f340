#include "postproc/machine/models/linuxcnc_naive_cam.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <numbers>
#include <utility>

#include "geometry/basic/rounding.h"

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

// Places that are asked for together, without a branch between them.
constexpr std::size_t kAskedTogether = 4;

// The ends of the lines that are one so far, as ways from where that one starts.
class JoinedEnds {
 public:
  void clear() { size_ = 0; }
  [[nodiscard]] std::size_t size() const { return size_; }

  void add(const Vector3& end) {
    // The rest of those that are asked for with it is the same place until it gets its own.
    const std::size_t last = size_ % kAskedTogether == 0 ? size_ + kAskedTogether : size_ + 1;
    for (std::size_t i = size_; i < last; ++i) {
      x_[i] = end.x();
      y_[i] = end.y();
      z_[i] = end.z();
    }
    ++size_;
  }

  // Whether all of them are within `tolerance` of the line to `way`, which has a length.
  [[nodiscard]] bool are_near(const Vector3& way, double tolerance) const {
    for (std::size_t i = 0; i < size_; i += kAskedTogether) {
      if (std::sqrt(farthest_square(i, way)) > tolerance) return false;
    }
    return true;
  }

 private:
  // Squared distance of the farthest of kAskedTogether places.
  [[nodiscard]] double farthest_square(std::size_t first, const Vector3& way) const {
    const double square = way.squaredNorm();
    std::array<double, kAskedTogether> squares;
    for (std::size_t k = 0; k < kAskedTogether; ++k) {
      const double x = x_[first + k];
      const double y = y_[first + k];
      const double z = z_[first + k];
      const double along = (way.x() * x + (way.y() * y + way.z() * z)) / square;
      const double t = along < 0 ? 0 : (along > 1 ? 1 : along);
      const double off_x = x - t * way.x();
      const double off_y = y - t * way.y();
      const double off_z = z - t * way.z();
      squares[k] = off_x * off_x + (off_y * off_y + off_z * off_z);
    }
    return std::max(std::max(squares[0], squares[1]), std::max(squares[2], squares[3]));
  }

  std::size_t size_ = 0;
  std::array<double, kMostPoints + kAskedTogether> x_;
  std::array<double, kMostPoints + kAskedTogether> y_;
  std::array<double, kMostPoints + kAskedTogether> z_;
};

class Joiner {
 public:
  explicit Joiner(double tolerance) : tolerance_(tolerance) {}

  void add_line(const Point3& from, const Point3& to, const TimedPiece& piece,
                std::uint32_t index) {
    if (ends_.size() > 0 && (piece.feed != open_.feed || !can_reach(to))) flush();
    if (ends_.size() == 0) {
      start_ = from;
      open_ = {piece, index, index};
    }
    ends_.add(to - start_);
    end_ = to;
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
    if (ends_.size() > kMostPoints) return false;
    const Vector3 way = to - start_;
    return way.norm() > geometry::kSamePlace && ends_.are_near(way, tolerance_);
  }

  void flush() {
    if (ends_.size() == 0) return;
    open_.piece = Line{start_, end_};
    joined_.push_back(open_);
    ends_.clear();
  }

  double tolerance_;
  Point3 start_ = Point3::Zero();
  Point3 end_ = Point3::Zero();
  JoinedPiece open_;  // what is joined so far, but for its line
  JoinedEnds ends_;
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
