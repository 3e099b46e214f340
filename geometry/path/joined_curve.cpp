#include "geometry/path/joined_curve.h"

#include <stdexcept>
#include <string>
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
class Joiner {
 public:
  void add(double from, std::span<const double> inner_knots, double to,
           std::span<const Point3> points) {
    if (knots_.empty()) {
      knots_.assign(kJoinedDegree + 1, from);
      points_.assign(points.begin(), points.begin() + 1);
    }
    knots_.insert(knots_.end(), inner_knots.begin(), inner_knots.end());
    knots_.insert(knots_.end(), kJoinedDegree, to);
    points_.insert(points_.end(), points.begin() + 1, points.end());
  }

  [[nodiscard]] BsplineCurve curve() && {
    knots_.push_back(knots_.back());
    return {BsplineBasis(kJoinedDegree, std::move(knots_)), std::move(points_)};
  }

 private:
  std::vector<double> knots_;
  std::vector<Point3> points_;
};

}  // namespace

BsplineCurve joined(std::span<const BsplineCurve> parts) {
  if (parts.empty()) throw std::invalid_argument("joined: no parts, expected one or more");
  Joiner joiner;
  double end = parts.front().first();
  for (const BsplineCurve& part : parts) {
    if (!is_clamped_cubic(part)) {
      throw std::invalid_argument("joined: a part of degree " + std::to_string(part.degree()) +
                                  ", expected clamped cubics");
    }
    if (part.first() != end) {
      throw std::invalid_argument("joined: a part starts at " + std::to_string(part.first()) +
                                  ", expected " + std::to_string(end));
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
    throw std::invalid_argument("curve_of_pieces: " + std::to_string(stations.size()) +
                                " stations for " + std::to_string(pieces.size()) +
                                " pieces, expected one more than pieces, and a piece at least");
  }
  Joiner joiner;
  for (std::size_t i = 0; i < pieces.size(); ++i) {
    if (!(stations[i] < stations[i + 1])) {
      throw std::invalid_argument("curve_of_pieces: station " + std::to_string(stations[i + 1]) +
                                  " after " + std::to_string(stations[i]) + ", expected more");
    }
    const CubicBezier bezier = as_bezier(pieces[i]);
    joiner.add(stations[i], {}, stations[i + 1], bezier.control);
  }
  return std::move(joiner).curve();
}

}  // namespace batten::geometry
