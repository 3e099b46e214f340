#include "gcode/curves/spline_pieces.h"

#include <algorithm>
#include <cstddef>
#include <vector>

namespace batten::gcode {

bool add_cubics(std::uint32_t block, const geometry::RationalBezier& piece,
                const geometry::Point3& start, const geometry::Point3& end, CurveReading& reading) {
  auto cubics = geometry::cubic_pieces(piece, kReadWithin);
  if (!cubics) return false;
  cubics->front().control[0] = start;
  cubics->back().control[3] = end;
  for (const geometry::CubicBezier& cubic : *cubics) reading.motions.push_back({block, cubic});
  reading.is_near = true;
  return true;
}

bool add_spline(const geometry::BsplineBasis& basis, std::span<const geometry::Point3> points,
                std::span<const double> weights, std::span<const std::uint32_t> blocks,
                CurveReading& reading) {
  const bool all_same = std::ranges::all_of(weights, [&](double w) { return w == weights[0]; });
  if (all_same && basis.degree() <= 3) {
    const geometry::BsplineCurve curve(basis, {points.begin(), points.end()});
    auto block = blocks.begin();
    for (const geometry::CubicBezier& piece : curve.bezier_pieces()) {
      reading.motions.push_back({*block++, piece});
    }
    return true;
  }
  std::vector<geometry::WeightedPoint> heavy;
  heavy.reserve(points.size());
  for (std::size_t i = 0; i < points.size(); ++i) {
    heavy.push_back(geometry::weighted(points[i], weights[i]));
  }
  const auto pieces = geometry::rational_pieces(basis, heavy);
  geometry::Point3 start = points.front();
  for (std::size_t i = 0; i < pieces.size(); ++i) {
    const geometry::Point3 end =
        i + 1 < pieces.size() ? geometry::place_of(pieces[i].control.back()) : points.back();
    if (!add_cubics(blocks[i], pieces[i], start, end, reading)) return false;
    start = end;
  }
  return true;
}

}  // namespace batten::gcode
