#include "postproc/smooth/selection/meant_path.h"

#include <algorithm>
#include <array>
#include <cmath>
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

// Adds up squared distances of pieces from a curve.
class DistanceSum {
 public:
  explicit DistanceSum(const geometry::BsplineCurve& curve)
      : curve_(curve.basis().knots(), curve.control_points()),
        first_(curve.first()),
        last_(curve.last()) {}

  // `from` and `to`: about the parameters of its ends.
  void add(const PathPiece& piece, double from, double to) {
    const double length = geometry::length_of(piece);
    if (!(length > 0)) return;
    // The distance of an arc or a curve swings about the path more often than that of a chord.
    const int parts = std::holds_alternative<geometry::Line>(piece) ? 1 : 2;
    for (int part = 0; part < parts; ++part) {
      for (const Node& node : kNodes) {
        const double t = (part + node.at) / parts;
        squares_ += length * node.weight / parts * squared(piece, t, from + t * (to - from));
      }
    }
    length_ += length;
  }

  [[nodiscard]] double rms() const { return length_ > 0 ? std::sqrt(squares_ / length_) : 0; }

 private:
  // About a corner Newton's steps may lead away.
  double squared(const PathPiece& piece, double t, double u) {
    const Point3 place = geometry::point_at(piece, t);
    double least = (curve_.point_at(u) - place).squaredNorm();
    for (int i = 0; i < kMeantPath.steps; ++i) {
      u = std::clamp(curve_.nearer(u, place), first_, last_);
      least = std::min(least, (curve_.point_at(u) - place).squaredNorm());
    }
    return least;
  }

  geometry::SplineWalk curve_;
  double first_;
  double last_;
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

double MeantPath::distance_of(const Run& run) const {
  const std::vector<RunMotion> motions = motions_between(run, 0, run.points.size() - 1);
  DistanceSum sum(fair_.curve);
  for_some(motions.size(), [&](std::size_t i) {
    const std::size_t end = i + 1 < motions.size() ? motions[i + 1].first : run.points.size() - 1;
    sum.add(motions[i].piece, fair_.vertex_parameters[motions[i].first],
            fair_.vertex_parameters[end]);
  });
  return sum.rms();
}

double MeantPath::distance_of(std::span<const PlannedMove> moves,
                              const geometry::SmoothCurve& along) const {
  DistanceSum sum(fair_.curve);
  const ParameterMap of_fair(along.vertex_parameters, fair_.vertex_parameters);
  for_some(moves.size(), [&](std::size_t i) {
    const double end = i + 1 < moves.size() ? moves[i + 1].start : along.curve.last();
    sum.add(moves[i].piece, of_fair(moves[i].start), of_fair(end));
  });
  return sum.rms();
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
