#include "postproc/smooth/selection/meant_path.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>
#include <variant>

#include "geometry/fitting/fair/fair_measure.h"
#include "geometry/path/path.h"
#include "postproc/runs/run_path.h"

namespace batten::postproc {

namespace {

using geometry::PathPiece;
using geometry::Point3;
using geometry::Vector3;

struct Node {
  double at;
  double weight;
};

// Gauss-Legendre on [0, 1]: exact for the square of a parabola.
constexpr std::array<Node, 3> kNodes = {
    {{0.112701665379258, 5.0 / 18}, {0.5, 8.0 / 18}, {0.887298334620742, 5.0 / 18}}};

// mm^2
double squared_distance(const Point3& place, const PathPiece& piece) {
  const Point3 start = geometry::start_point(piece);
  const Point3 end = geometry::end_point(piece);
  const auto* arc = std::get_if<geometry::Arc>(&piece);
  if (arc == nullptr) return std::pow(geometry::distance_to_segment(place, start, end), 2);
  const double least = std::min((place - start).squaredNorm(), (place - end).squaredNorm());
  const Vector3 out = place - arc->center;
  const double height = out.dot(arc->axis);
  const Vector3 flat = out - height * arc->axis;
  const Vector3 from = start - arc->center;
  const double turn = std::atan2(from.cross(flat).dot(arc->axis), from.dot(flat));
  const double along = arc->sweep > 0 ? turn : -turn;
  if ((along < 0 ? along + 2 * geometry::kPi : along) > std::abs(arc->sweep)) return least;
  return std::min(least, std::pow(flat.norm() - geometry::radius_of(*arc), 2) + height * height);
}

// The squared distance of a place (mm^2) from a curve, near to a parameter.
class FromCurve {
 public:
  explicit FromCurve(const geometry::BsplineCurve& curve)
      : curve_(curve.basis().knots(), curve.control_points()),
        first_(curve.first()),
        last_(curve.last()) {}

  // About a corner Newton's steps may lead away.
  double operator()(const Point3& place, double u) {
    double least = (curve_.point_at(u) - place).squaredNorm();
    for (int i = 0; i < kMeantPath.steps; ++i) {
      u = std::clamp(curve_.nearer(u, place), first_, last_);
      least = std::min(least, (curve_.point_at(u) - place).squaredNorm());
    }
    return least;
  }

 private:
  geometry::SplineWalk curve_;
  double first_;
  double last_;
};

// The same from moves along it.
class FromMoves {
 public:
  explicit FromMoves(const std::vector<PlannedMove>& moves) : moves_(moves) {}

  double operator()(const Point3& place, double u) {
    const auto behind = std::ranges::upper_bound(moves_, u, {}, &PlannedMove::start);
    const std::ptrdiff_t at = std::max<std::ptrdiff_t>(behind - moves_.begin() - 1, 0);
    double least = std::numeric_limits<double>::infinity();
    for (std::ptrdiff_t i = at - 1; i <= at + 1; ++i) {
      if (i < 0 || i >= std::ssize(moves_)) continue;
      const PathPiece& piece = moves_[static_cast<std::size_t>(i)].piece;
      least = std::min(least, squared_distance(place, piece));
    }
    return least;
  }

 private:
  const std::vector<PlannedMove>& moves_;
};

// Adds up squared distances of pieces.
template <typename From>
class DistanceSum {
 public:
  explicit DistanceSum(From from) : squared_(std::move(from)) {}

  // `from` and `to`: about the parameters of its ends.
  void add(const PathPiece& piece, double from, double to) {
    const double length = geometry::length_of(piece);
    if (!(length > 0)) return;
    // The distance of an arc or a curve swings about the path more often than that of a chord.
    const int parts = std::holds_alternative<geometry::Line>(piece) ? 1 : 2;
    for (int part = 0; part < parts; ++part) {
      for (const Node& node : kNodes) {
        const double t = (part + node.at) / parts;
        const double squared = squared_(geometry::point_at(piece, t), from + t * (to - from));
        squares_ += length * node.weight / parts * squared;
      }
    }
    length_ += length;
  }

  [[nodiscard]] double rms() const { return length_ > 0 ? std::sqrt(squares_ / length_) : 0; }

 private:
  From squared_;
  double squares_ = 0;
  double length_ = 0;
};

// Calls with some of the indices below `count`, in order: all, or spread without a period that
// moves could have, too.
template <typename Visit>
void for_some(std::size_t count, Visit visit) {
  if (count <= kMeantPath.moves) {
    for (std::size_t i = 0; i < count; ++i) visit(i);
    return;
  }
  const double step = static_cast<double>(count) / static_cast<double>(kMeantPath.moves);
  for (std::size_t k = 0; k < kMeantPath.moves; ++k) {
    double whole = 0;
    const double offset = std::modf(static_cast<double>(k) * std::numbers::phi, &whole);
    visit(std::min(count - 1, static_cast<std::size_t>((static_cast<double>(k) + offset) * step)));
  }
}

// From the parameters of one curve of a run to those of another one, by the vertices.
class ParameterMap {
 public:
  ParameterMap(const std::vector<double>& from, const std::vector<double>& to)
      : from_(from), to_(to) {}

  [[nodiscard]] double operator()(double u) const {
    if (&from_ == &to_) return u;
    const auto after = std::upper_bound(from_.begin(), from_.end(), u);
    if (after == from_.begin()) return to_.front();
    if (after == from_.end()) return to_.back();
    const auto i = static_cast<std::size_t>(after - from_.begin());
    const double part = (u - from_[i - 1]) / (from_[i] - from_[i - 1]);
    return to_[i - 1] + part * (to_[i] - to_[i - 1]);
  }

 private:
  const std::vector<double>& from_;
  const std::vector<double>& to_;
};

}  // namespace

// `visit` is called with what adds a piece from one parameter to another.
template <typename Visit>
double MeantPath::rms_of(Visit visit) const {
  if (shape_.empty()) {
    DistanceSum sum{FromCurve(fair_.curve)};
    visit(sum);
    return sum.rms();
  }
  DistanceSum sum{FromMoves(shape_)};
  visit(sum);
  return sum.rms();
}

double MeantPath::distance_of(const Run& run) const {
  const std::vector<RunMotion> motions = motions_between(run, 0, run.points.size() - 1);
  const auto& at = fair_.vertex_parameters;
  return rms_of([&](auto& sum) {
    for_some(motions.size(), [&](std::size_t i) {
      const std::size_t end = i + 1 < motions.size() ? motions[i + 1].first : run.points.size() - 1;
      sum.add(motions[i].piece, at[motions[i].first], at[end]);
    });
  });
}

double MeantPath::distance_of(std::span<const PlannedMove> moves,
                              const geometry::SmoothCurve& along) const {
  const ParameterMap of_fair(along.vertex_parameters, fair_.vertex_parameters);
  return rms_of([&](auto& sum) {
    for_some(moves.size(), [&](std::size_t i) {
      const double end = i + 1 < moves.size() ? moves[i + 1].start : along.curve.last();
      sum.add(moves[i].piece, of_fair(moves[i].start), of_fair(end));
    });
  });
}

double roughness_of(std::span<const TimedPiece> moves) {
  double squares = 0;
  double length = 0;
  Vector3 before = Vector3::Zero();
  for (const TimedPiece& move : moves) {
    const double own = geometry::length_of(move.piece);
    if (!(own > 0)) continue;
    length += own;
    // Between unit vectors: twice the sine of half the turn.
    const Vector3 here = geometry::direction_at(move.piece, 0);
    if (!before.isZero()) squares += (here - before).squaredNorm();
    before = geometry::direction_at(move.piece, 1);
  }
  return length > 0 ? std::sqrt(squares / length) : 0;
}

}  // namespace batten::postproc
