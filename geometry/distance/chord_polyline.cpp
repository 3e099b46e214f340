#include "geometry/distance/chord_polyline.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace batten::geometry {
namespace {

// Rounding of a position computed on an arc or Bezier piece, relative to the sizes that enter it:
// some dozen operations of half a rounding step each, and the arc's angle, a few steps times the
// radius. 64 steps are several times that sum.
constexpr double kEvaluationNoise = 64 * std::numeric_limits<double>::epsilon();

// 2^20 chords (28 MB) for one path at the most on top of one per piece. A full circle of
// radius 1e4 mm cut to 1e-5 mm takes 70,000.
constexpr double kMostChords = 1 << 20;

// The control points (centre) whose coordinates enter the evaluation, and sweep as a factor.
double size_of_evaluation(const PathPiece& piece) {
  if (const auto* arc = std::get_if<Arc>(&piece)) {
    const double radius =
        std::max((arc->start - arc->center).norm(), (arc->end - arc->center).norm());
    return arc->center.cwiseAbs().maxCoeff() + radius * (1 + std::abs(arc->sweep));
  }
  const auto& control = std::get<CubicBezier>(piece).control;
  double size = 0;
  for (const Point3& point : control) size = std::max(size, point.cwiseAbs().maxCoeff());
  return size;
}

double chords_for(double bend, double max_error) {
  return std::max(1.0, std::ceil(std::sqrt(bend / (8 * max_error))));
}

}  // namespace

double chords_wanted(const PathPiece& piece, double max_error) {
  if (std::holds_alternative<Line>(piece)) return 0;
  return chords_for(second_derivative_bound(piece), max_error);
}

double affordable_error(double wanted, double max_error) {
  // Halving the number of chords makes their error four times as large.
  const double coarser = std::max(1.0, wanted / kMostChords);
  return max_error * coarser * coarser;
}

ChordPolyline cut_into_chords(std::span<const PathPiece> path, double max_error) {
  double wanted = 0;
  for (const PathPiece& piece : path) wanted += chords_wanted(piece, max_error);
  max_error = affordable_error(wanted, max_error);

  ChordPolyline result;
  const std::size_t most = path.size() + static_cast<std::size_t>(std::min(wanted, kMostChords));
  result.points.reserve(most + 1);
  result.errors.reserve(most);
  result.pieces.reserve(most);
  const auto add = [&result](const Point3& end, double error, std::size_t piece) {
    result.points.push_back(end);
    result.errors.push_back(error);
    result.pieces.push_back(piece);
  };
  const auto add_line = [&](const Point3& end, std::size_t piece) {
    if (end != result.points.back()) add(end, 0, piece);
  };
  result.points.push_back(start_point(path.front()));
  for (std::size_t i = 0; i < path.size(); ++i) {
    const PathPiece& piece = path[i];
    add_line(start_point(piece), i);
    if (std::holds_alternative<Line>(piece)) {
      add_line(end_point(piece), i);
      continue;
    }
    const double bend = second_derivative_bound(piece);
    const auto count = static_cast<std::size_t>(chords_for(bend, max_error));
    const double step = 1.0 / static_cast<double>(count);
    // The steps of t are equal to within a rounding step of t; that is far inside the noise.
    const double error = bend * step * step / 8 + kEvaluationNoise * size_of_evaluation(piece);
    for (std::size_t k = 1; k < count; ++k) {
      add(geometry::point_at(piece, static_cast<double>(k) * step), error, i);
    }
    add(end_point(piece), error, i);
  }
  if (result.errors.empty()) add(Point3(result.points.front()), 0, 0);
  return result;
}

double greatest_coordinate(const ChordPolyline& polyline) {
  double greatest = 0;
  for (const Point3& point : polyline.points) {
    greatest = std::max(greatest, point.cwiseAbs().maxCoeff());
  }
  return greatest;
}

Point3 point_at(const ChordPolyline& polyline, const PlaceOnChord& place) {
  const Point3& from = polyline.points[place.edge];
  const Point3& to = polyline.points[place.edge + 1];
  if (place.t >= 1) return to;
  return from + place.t * (to - from);
}

namespace {

struct Edges {  // those of one piece
  std::size_t first = 0;
  std::size_t end = 0;  // after the last
  [[nodiscard]] double count() const { return static_cast<double>(end - first); }
};

Edges edges_of(const ChordPolyline& polyline, std::size_t piece) {
  // Not std::ranges::equal_range: Clang 14 cannot read what it returns.
  const auto [first, end] = std::equal_range(polyline.pieces.begin(), polyline.pieces.end(), piece);
  const auto index = [&](auto at) {
    return static_cast<std::size_t>(at - polyline.pieces.begin());
  };
  return {index(first), index(end)};
}

}  // namespace

double piece_parameter(const ChordPolyline& polyline, const PlaceOnChord& place) {
  const Edges edges = edges_of(polyline, polyline.pieces[place.edge]);
  return (static_cast<double>(place.edge - edges.first) + place.t) / edges.count();
}

PlaceOnChord place_on_piece(const ChordPolyline& polyline, std::size_t piece, double parameter) {
  const Edges edges = edges_of(polyline, piece);
  if (edges.first == edges.end) {
    if (edges.first < polyline.edge_count()) return {edges.first, 0};
    return {polyline.edge_count() - 1, 1};
  }
  const double at = std::clamp(parameter, 0.0, 1.0) * edges.count();
  const double whole = std::min(std::floor(at), edges.count() - 1);
  return {edges.first + static_cast<std::size_t>(whole), at - whole};
}

double nearest_parameter(const ChordPolyline& polyline, std::size_t edge, const Point3& point,
                         double from, double to) {
  const Vector3 along = polyline.points[edge + 1] - polyline.points[edge];
  const double length2 = along.squaredNorm();
  // On an edge of no length every position is the nearest; going on to its end loses nothing.
  if (length2 == 0) return to;
  return std::clamp((point - polyline.points[edge]).dot(along) / length2, from, to);
}

}  // namespace batten::geometry
