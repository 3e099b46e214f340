#include "geometry/chords/chord_deviation.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>
#include <optional>

#include "geometry/path/bezier_halves.h"

namespace batten::geometry {
namespace {

// A bound is sharp when it is too great by less than this part. Each halving of a Bezier piece
// quarters what its bound has too much, so twenty are enough.
constexpr double kSharp = 1e-12;
constexpr int kHalvings = 20;

// The doubles of a piece's parameter are used up after so many halvings.
constexpr int kAllHalvings = 50;

// Rounding of a distance, as a part of the coordinates.
constexpr double kRounding = 4 * std::numeric_limits<double>::epsilon();

// Squared distance to a segment; to a line where it has no end.
class StraightLine {
 public:
  StraightLine(const Point3& start, const Point3& end)
      : start_(start), length_((end - start).norm()) {
    if (length_ > 0) along_ = (end - start) / length_;
  }
  static StraightLine through(const Point3& start, const Vector3& along) {
    StraightLine line(start, start + along);
    line.endless_ = true;
    return line;
  }

  [[nodiscard]] double squared_distance(const Point3& p) const {
    const double at = along_.dot(p - start_);
    const double nearest = endless_ ? at : std::clamp(at, 0.0, length_);
    return (p - start_ - nearest * along_).squaredNorm();
  }

 private:
  Point3 start_;
  double length_;
  Vector3 along_ = Vector3::Zero();
  bool endless_ = false;
};

// The distance from a convex set is a convex function: on the piece it is at most what it is at
// the farthest control point.
double bound(const CubicBezier& piece, const StraightLine& line) {
  double farthest = 0;
  for (const Point3& p : piece.control) farthest = std::max(farthest, line.squared_distance(p));
  return farthest;
}

void raise_to(const CubicBezier& piece, const StraightLine& line, int halvings, double& greatest) {
  greatest = std::max(
      {greatest, line.squared_distance(piece.control[0]), line.squared_distance(piece.control[3])});
  const double noise = kRounding * piece.control[0].cwiseAbs().maxCoeff();
  const double open = 2 * greatest * kSharp + 2 * std::sqrt(greatest) * noise + noise * noise;
  if (halvings == 0 || bound(piece, line) <= greatest + open) return;
  const auto [left, right] = halves(piece);
  raise_to(left, line, halvings - 1, greatest);
  raise_to(right, line, halvings - 1, greatest);
}

// The first t of the piece where the squared distance is reached.
std::optional<double> first_at(const CubicBezier& piece, const StraightLine& line, double squared,
                               int halvings) {
  if (bound(piece, line) < squared) return std::nullopt;
  if (halvings == 0) return 0.5;
  const auto [left, right] = halves(piece);
  if (const auto t = first_at(left, line, squared, halvings - 1)) return *t / 2;
  if (const auto t = first_at(right, line, squared, halvings - 1)) return (1 + *t) / 2;
  return std::nullopt;
}

}  // namespace

double chord_deviation(const CurvePieces& pieces, double from, double to) {
  const StraightLine chord(pieces.point_at(from), pieces.point_at(to));
  double greatest = 0;
  for (std::size_t i = pieces.index_of(from); i < pieces.size() && pieces.breaks()[i] < to; ++i) {
    raise_to(pieces.part(i, from, to), chord, kHalvings, greatest);
  }
  return std::sqrt(greatest);
}

double leaves_tangent_at(const CurvePieces& pieces, double from, double to, double distance) {
  const auto tangent = StraightLine::through(pieces.point_at(from), pieces.leaving(from));
  for (std::size_t i = pieces.index_of(from); i < pieces.size() && pieces.breaks()[i] < to; ++i) {
    const double start = std::max(from, pieces.breaks()[i]);
    const double end = std::min(to, pieces.breaks()[i + 1]);
    const auto t = first_at(pieces.part(i, from, to), tangent, distance * distance, kAllHalvings);
    if (t) return std::min(start + *t * (end - start), to);
  }
  return to;
}

}  // namespace batten::geometry
