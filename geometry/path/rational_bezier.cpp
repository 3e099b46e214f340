#include "geometry/path/rational_bezier.h"

#include <algorithm>
#include <array>
#include <cstddef>
#include <utility>

namespace batten::geometry {

namespace {

constexpr int kMostCubicHalvings = 16;
constexpr std::size_t kMostCubics = 256;

std::pair<RationalBezier, RationalBezier> halves(const RationalBezier& piece) {
  std::vector<WeightedPoint> d = piece.control;
  const std::size_t count = d.size();
  RationalBezier left;
  RationalBezier right;
  right.control.resize(count);
  for (std::size_t level = 0; level < count; ++level) {
    left.control.push_back(d.front());
    right.control[count - 1 - level] = d.back();
    for (std::size_t j = 0; j + 1 < d.size(); ++j) d[j] = 0.5 * (d[j] + d[j + 1]);
    d.pop_back();
  }
  return {std::move(left), std::move(right)};
}

CubicBezier with_ends_of(const RationalBezier& piece) {
  const std::vector<WeightedPoint>& h = piece.control;
  const auto degree = static_cast<double>(h.size() - 1);
  const Point3 start = place_of(h.front());
  const Point3 end = place_of(h.back());
  const WeightedPoint& after = h[1];
  const WeightedPoint& before = h[h.size() - 2];
  const Vector3 out = degree * (after.head<3>() - after.w() * start) / h.front().w();
  const Vector3 in = degree * (before.w() * end - before.head<3>()) / h.back().w();
  return {{start, start + out / 3, end - in / 3, end}};
}

// mm, at the same parameter at most. The weights are positive.
double distance_bound(const RationalBezier& piece, const CubicBezier& cubic) {
  const std::size_t degree = piece.control.size() - 1;
  // Coefficient k of a product is the sum over i + j = k of binomials (degree, i) (3, j) over
  // (degree + 3, k).
  std::vector<Vector3> sums(degree + 4, Vector3::Zero());
  std::vector<double> counts(degree + 4, 0.0);
  constexpr std::array<double, 4> kOfThree = {1, 3, 3, 1};
  double of_degree = 1;
  double least_weight = piece.control.front().w();
  for (std::size_t i = 0; i <= degree; ++i) {
    const WeightedPoint& h = piece.control[i];
    least_weight = std::min(least_weight, h.w());
    for (std::size_t j = 0; j < kOfThree.size(); ++j) {
      const double factor = of_degree * kOfThree[j];
      sums[i + j] += factor * (h.head<3>() - h.w() * cubic.control[j]);
      counts[i + j] += factor;
    }
    of_degree *= static_cast<double>(degree - i) / static_cast<double>(i + 1);
  }
  double bound = 0;
  for (std::size_t k = 0; k < sums.size(); ++k) {
    bound = std::max(bound, sums[k].norm() / counts[k]);
  }
  return bound / least_weight;
}

// False where so many halvings, or kMostCubics, are not enough.
bool append_cubics(const RationalBezier& piece, double within, int halvings,
                   std::vector<CubicBezier>& pieces) {
  const bool positive =
      std::ranges::all_of(piece.control, [](const WeightedPoint& h) { return h.w() > 0; });
  if (positive) {
    const CubicBezier cubic = with_ends_of(piece);
    if (distance_bound(piece, cubic) <= within) {
      pieces.push_back(cubic);
      return true;
    }
  }
  if (halvings == 0 || pieces.size() >= kMostCubics) return false;
  const auto [left, right] = halves(piece);
  return append_cubics(left, within, halvings - 1, pieces) &&
         append_cubics(right, within, halvings - 1, pieces);
}

}  // namespace

WeightedPoint weighted(const Point3& point, double weight) {
  return {weight * point.x(), weight * point.y(), weight * point.z(), weight};
}

Point3 place_of(const WeightedPoint& point) { return point.head<3>() / point.w(); }

Point3 point_at(const RationalBezier& piece, double t) {
  std::vector<WeightedPoint> d = piece.control;
  for (; d.size() > 1; d.pop_back()) {
    for (std::size_t j = 0; j + 1 < d.size(); ++j) d[j] = (1 - t) * d[j] + t * d[j + 1];
  }
  return place_of(d.front());
}

std::vector<RationalBezier> rational_pieces(const BsplineBasis& basis,
                                            std::span<const WeightedPoint> points) {
  const auto degree = static_cast<std::size_t>(basis.degree());
  const std::vector<double>& t = basis.knots();
  std::vector<RationalBezier> pieces;
  for (std::size_t span = degree; span < basis.size(); ++span) {
    if (!(t[span] < t[span + 1])) continue;
    RationalBezier& piece = pieces.emplace_back();
    std::vector<double> arguments(degree, t[span]);
    piece.control.push_back(blossom(basis, points, span, arguments));
    for (double& argument : arguments) {
      argument = t[span + 1];
      piece.control.push_back(blossom(basis, points, span, arguments));
    }
  }
  return pieces;
}

std::optional<std::vector<CubicBezier>> cubic_pieces(const RationalBezier& piece, double within) {
  std::vector<CubicBezier> pieces;
  if (!append_cubics(piece, within, kMostCubicHalvings, pieces)) return std::nullopt;
  return pieces;
}

}  // namespace batten::geometry
