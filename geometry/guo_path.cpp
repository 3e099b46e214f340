#include "geometry/guo_path.h"

#include <algorithm>
#include <stdexcept>
#include <string>
#include <utility>

#include "geometry/numeric.h"

namespace batten::geometry {
namespace {

// The vertices that are apart from the one before them.
struct Vertices {
  std::vector<Point3> points;
  std::vector<std::size_t> indices;
};

Vertices distinct_vertices(std::span<const Point3> points, bool closed) {
  Vertices kept;
  for (std::size_t i = 0; i < points.size(); ++i) {
    if (!kept.points.empty() && (points[i] - kept.points.back()).norm() <= kSamePlace) continue;
    kept.points.push_back(points[i]);
    kept.indices.push_back(i);
  }
  // The last point of a closed path is the first one.
  while (closed && kept.points.size() > 1 &&
         (kept.points.back() - kept.points.front()).norm() <= kSamePlace) {
    kept.points.pop_back();
    kept.indices.pop_back();
  }
  return kept;
}

// --- routine 2 with fair shares ------------------------------------------------------------

std::vector<GuoPathCorner> fair_corners(const Vertices& vertices, const GuoOptions& options) {
  const std::vector<Point3>& q = vertices.points;
  const std::size_t n = q.size();
  const std::size_t first = options.closed ? 0 : 1;
  const std::size_t last = options.closed ? n : n - 1;  // one past
  const auto corner_at = [&](std::size_t i) {
    return Corner{q[(i + n - 1) % n], q[i], q[(i + 1) % n]};
  };
  std::vector<bool> turns(n, false);
  for (std::size_t i = first; i < last; ++i) {
    turns[i] = std::holds_alternative<CornerFrame>(frame_of(corner_at(i)));
  }
  const auto share = [&](std::size_t vertex, std::size_t neighbour) {
    return (q[vertex] - q[neighbour]).norm() / (turns[neighbour] ? 2 : 1);
  };
  std::vector<GuoPathCorner> corners;
  for (std::size_t i = first; i < last; ++i) {
    corners.push_back(
        {vertices.indices[i],
         guo_corner(corner_at(i), options.rule, share(i, (i + n - 1) % n), share(i, (i + 1) % n))});
  }
  return corners;
}

// --- routines 1 to 3 as the paper has them -------------------------------------------------

// start = Q0; for each inner vertex Q_i: the blend that fits between start and Q_{i+1}, halved
// where it would reach Q_{i+1} and that is a corner, too; then start = P4 + lambda (Q_{i+1} - P4).
std::vector<GuoPathCorner> literal_corners(const Vertices& vertices, const GuoOptions& options) {
  const std::vector<Point3>& q = vertices.points;
  const std::size_t n = q.size() - 1;
  std::vector<GuoPathCorner> corners;
  Point3 start = q[0];
  for (std::size_t i = 1; i < n; ++i) {
    const double a = (q[i] - start).norm();
    const double b = (q[i + 1] - q[i]).norm();
    const Corner corner{q[i - 1], q[i], q[i + 1]};
    auto outcome = guo_corner(corner, options.rule, a, b);
    // Only a blend that the segments limit can fill the next one, so the tolerance has its say
    // before this rule.
    const auto* blend = std::get_if<GuoBlend>(&outcome);
    if (blend != nullptr && i + 1 < n && 2 * blend->spacing >= b) {
      outcome = guo_corner(corner, options.rule, b / 2, b / 2);
      blend = std::get_if<GuoBlend>(&outcome);
    }
    start = q[i];
    if (blend != nullptr) {
      const Point3& p4 = blend->blend.curve.control_points().back();
      start = p4 + options.lambda * (q[i + 1] - p4);
    }
    corners.push_back({vertices.indices[i], std::move(outcome)});
  }
  return corners;
}

// --- the path -----------------------------------------------------------------------------

// Lines and pieces one after the other, from where it was begun.
class Chain {
 public:
  explicit Chain(const Point3& start) : cursor_(start) {}

  void line_to(const Point3& end) {
    if ((end - cursor_).norm() <= kSamePlace) return;
    pieces_.push_back(Line{cursor_, end});
    cursor_ = end;
  }

  void curve(CubicBezier piece) {
    line_to(piece.control[0]);
    piece.control[0] = cursor_;
    pieces_.push_back(piece);
    cursor_ = piece.control[3];
  }

  // Ends exactly there, also where the last piece ends beside it by rounding.
  Path finish(const Point3& end) && {
    line_to(end);
    if (pieces_.empty()) return std::move(pieces_);
    if (auto* line = std::get_if<Line>(&pieces_.back())) line->end = end;
    if (auto* bezier = std::get_if<CubicBezier>(&pieces_.back())) bezier->control[3] = end;
    return std::move(pieces_);
  }

 private:
  Point3 cursor_;
  Path pieces_;
};

// `corners` are those of the inner vertices, or of all vertices of a ring.
Path rounded_path(const std::vector<Point3>& q, const std::vector<GuoPathCorner>& corners,
                  bool ring) {
  const auto halves_at = [&](std::size_t i) {
    const auto* blend = std::get_if<GuoBlend>(&corners[ring ? i : i - 1].outcome);
    return blend ? blend->blend.curve.bezier_pieces() : std::vector<CubicBezier>();
  };
  const std::vector<CubicBezier> seam = ring ? halves_at(0) : std::vector<CubicBezier>();
  Chain chain(seam.empty() ? q.front() : seam.back().control[0]);
  if (!seam.empty()) chain.curve(seam.back());
  const std::size_t inner_end = ring ? q.size() : q.size() - 1;
  for (std::size_t i = 1; i < inner_end; ++i) {
    const std::vector<CubicBezier> halves = halves_at(i);
    if (halves.empty()) chain.line_to(q[i]);
    for (const CubicBezier& half : halves) chain.curve(half);
  }
  if (!seam.empty()) {
    chain.curve(seam.front());
    return std::move(chain).finish(seam.back().control[0]);
  }
  return std::move(chain).finish(ring ? q.front() : q.back());
}

}  // namespace

GuoOptions GuoOptions::literal(double tolerance, double lambda) {
  return {{tolerance, ToleranceKind::kBand, GuoApex::kHalfTolerance},
          GuoSharing::kLiteral,
          lambda,
          false};
}

GuoPath guo_path(std::span<const Point3> points, const GuoOptions& options) {
  require_positive_tolerance(options.rule.tolerance, "guo_path");
  if (!(options.lambda >= 0 && options.lambda < 1)) {
    throw std::invalid_argument("guo_path: lambda " + std::to_string(options.lambda) +
                                ", expected 0 or more and less than 1");
  }
  const bool fair = options.sharing == GuoSharing::kFair;
  const bool ring = options.closed && fair;
  const Vertices vertices = distinct_vertices(points, ring);
  if (vertices.points.size() < 2) return {};
  GuoPath path;
  path.corners = fair ? fair_corners(vertices, options) : literal_corners(vertices, options);
  path.pieces = rounded_path(vertices.points, path.corners, ring);
  return path;
}

}  // namespace batten::geometry
