#include "geometry/path/joined_curve.h"

#include <fmt/format.h>

#include <stdexcept>
#include <utility>
#include <variant>
#include <vector>

namespace batten::geometry {
namespace {

constexpr int kJoinedDegree = 3;

bool is_clamped_cubic(const BsplineCurve& part) {
  const auto& t = part.basis().knots();
  return part.degree() == kJoinedDegree && t.front() == part.first() && t.back() == part.last();
}

CubicBezier as_bezier(const PathPiece& piece) {
  if (const auto* bezier = std::get_if<CubicBezier>(&piece)) return *bezier;
  const auto* line = std::get_if<Line>(&piece);
  if (line == nullptr) throw std::invalid_argument("curve_of_pieces: an arc is no polynomial");
  const Vector3 third = (line->end - line->start) / 3;
  return {{line->start, line->start + third, line->end - third, line->end}};
}

// Knots and control points of the whole, part after part.
struct Joiner {
  void add(double from, std::span<const double> inner_knots, double to,
           std::span<const Point3> added) {
    if (knots.empty()) {
      knots.assign(kJoinedDegree + 1, from);
      points.push_back(added.front());
    }
    knots.insert(knots.end(), inner_knots.begin(), inner_knots.end());
    knots.insert(knots.end(), kJoinedDegree, to);
    points.insert(points.end(), added.begin() + 1, added.end());
  }

  [[nodiscard]] BsplineCurve curve() && {
    knots.push_back(knots.back());
    return {BsplineBasis(kJoinedDegree, std::move(knots)), std::move(points)};
  }

  std::vector<double> knots;
  std::vector<Point3> points;
};

}  // namespace

BsplineCurve joined(std::span<const BsplineCurve> parts) {
  if (parts.empty()) throw std::invalid_argument("joined: no parts, expected one or more");
  Joiner joiner;
  double end = parts.front().first();
  for (const BsplineCurve& part : parts) {
    if (!is_clamped_cubic(part) || part.first() != end) {
      throw std::invalid_argument(
          fmt::format("joined: a part of degree {} that starts at {:f}, expected a clamped cubic "
                      "that starts at {:f}",
                      part.degree(), part.first(), end));
    }
    end = part.last();
    const std::span<const double> knots = part.basis().knots();
    constexpr std::size_t kAtEnd = kJoinedDegree + 1;  // knots of a clamped end
    joiner.add(part.first(), knots.subspan(kAtEnd, knots.size() - 2 * kAtEnd), end,
               part.control_points());
  }
  return std::move(joiner).curve();
}

BsplineCurve curve_of_pieces(std::span<const PathPiece> pieces, std::span<const double> stations) {
  if (pieces.empty() || stations.size() != pieces.size() + 1) {
    throw std::invalid_argument(
        fmt::format("curve_of_pieces: {} stations for {} pieces, expected one more than pieces, "
                    "and a piece at least",
                    stations.size(), pieces.size()));
  }
  Joiner joiner;
  for (std::size_t i = 0; i < pieces.size(); ++i) {
    if (!(stations[i] < stations[i + 1])) {
      throw std::invalid_argument(
          fmt::format("curve_of_pieces: station {:f} after {:f}", stations[i + 1], stations[i]));
    }
    const CubicBezier bezier = as_bezier(pieces[i]);
    joiner.add(stations[i], {}, stations[i + 1], bezier.control);
  }
  return std::move(joiner).curve();
}

Path beziers_of(const BsplineCurve& curve) {
  const std::vector<CubicBezier> pieces = curve.bezier_pieces();
  return {pieces.begin(), pieces.end()};
}

double length_of(const BsplineCurve& curve) {
  double length = 0;
  for (const CubicBezier& piece : curve.bezier_pieces()) length += length_of(PathPiece(piece));
  return length;
}

Path path_through(std::span<const Point3> points) {
  Path path;
  if (points.empty()) return path;
  path.reserve(points.size() - 1);
  Point3 last = points.front();
  for (const Point3& point : points.subspan(1)) {
    if ((point - last).norm() <= kSamePlace) continue;
    path.push_back(Line{last, point});
    last = point;
  }
  return path;
}

}  // namespace batten::geometry
