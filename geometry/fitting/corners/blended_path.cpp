#include "geometry/fitting/corners/blended_path.h"

#include <cmath>
#include <numbers>
#include <utility>
#include <variant>

#include "geometry/basic/rounding.h"

namespace batten::geometry {
namespace {

// Lines and pieces one after the other, from where it was begun.
class Chain {
 public:
  Chain(const Point3& start, double station) : cursor_(start) { path_.stations = {station}; }

  // Blends that share a leg may overlap by the noise of the search that found them: what takes no
  // way along the polyline is no piece, and the next one starts where this one ended.
  void line_to(const Point3& end, double station) {
    if ((end - cursor_).norm() <= kSamePlace || station <= path_.stations.back()) return;
    path_.pieces.emplace_back(Line{cursor_, end});
    reach(end, station);
  }

  void curve(CubicBezier piece, double from, double to) {
    line_to(piece.control[0], from);
    piece.control[0] = cursor_;
    path_.pieces.emplace_back(piece);
    reach(piece.control[3], to);
  }

  // Ends exactly there, also where the last piece ends beside it by rounding.
  BlendedPath finish(const Point3& end, double station) && {
    line_to(end, station);
    if (path_.pieces.empty()) return {};
    if (auto* line = std::get_if<Line>(&path_.pieces.back())) line->end = end;
    if (auto* bezier = std::get_if<CubicBezier>(&path_.pieces.back())) bezier->control[3] = end;
    path_.stations.back() = station;
    return std::move(path_);
  }

 private:
  void reach(const Point3& end, double station) {
    cursor_ = end;
    path_.stations.push_back(station);
  }

  Point3 cursor_;
  BlendedPath path_;
};

// The middle of a blend's parameters; a knot that is there but for rounding.
double middle_of(const BsplineCurve& blend) {
  // Far above rounding, far below any span that a blend is made of.
  constexpr double kSameMiddle = 1e-9;
  const double middle = 0.5 * (blend.first() + blend.last());
  for (const double u : blend.breakpoints()) {
    if (std::abs(u - middle) <= kSameMiddle * (blend.last() - blend.first())) return u;
  }
  return middle;
}

// One side of a blend, cut at the middle of its parameters.
class HalfBlend {
 public:
  HalfBlend(const BsplineCurve& blend, bool first_half, const Point3& vertex) {
    const double middle = middle_of(blend);
    const BsplineCurve half =
        first_half ? blend.part(blend.first(), middle) : blend.part(middle, blend.last());
    pieces_ = half.bezier_pieces();
    const Point3& on_leg = first_half ? pieces_.front().control[0] : pieces_.back().control[3];
    const double reach = (on_leg - vertex).norm();
    for (const double u : half.breakpoints()) {
      const double part = (u - middle) / (half.last() - half.first());
      from_vertex_.push_back(reach * part);
    }
  }

  [[nodiscard]] const Point3& start() const { return pieces_.front().control[0]; }

  // `station`: of the vertex.
  void append_to(Chain& chain, double station) const {
    for (std::size_t i = 0; i < pieces_.size(); ++i) {
      chain.curve(pieces_[i], station + from_vertex_[i], station + from_vertex_[i + 1]);
    }
  }

 private:
  std::vector<CubicBezier> pieces_;
  std::vector<double> from_vertex_;  // mm along the polyline, negative before it
};

}  // namespace

DistinctVertices distinct_vertices(std::span<const Point3> points, bool ring) {
  DistinctVertices kept;
  for (std::size_t i = 0; i < points.size(); ++i) {
    if (!kept.points.empty() && (points[i] - kept.points.back()).norm() <= kSamePlace) continue;
    kept.points.push_back(points[i]);
    kept.indices.push_back(i);
  }
  while (ring && kept.size() > 1 &&
         (kept.points.back() - kept.points.front()).norm() <= kSamePlace) {
    kept.points.pop_back();
    kept.indices.pop_back();
  }
  return kept;
}

bool turns_more(const Corner& corner, double angle) {
  const Vector3 in = corner.vertex - corner.before;
  const Vector3 out = corner.after - corner.vertex;
  return std::atan2(in.cross(out).norm(), in.dot(out)) > angle;
}

ToleranceKind kind_at(const Corner& corner, ToleranceKind kind, double strict_sharper_than) {
  const bool sharp = turns_more(corner, std::numbers::pi - strict_sharper_than);
  return sharp ? ToleranceKind::kPath : kind;
}

std::vector<SharedCorner> shared_corners(std::span<const Point3> distinct, bool ring,
                                         double keep_corner_angle) {
  const auto& q = distinct;
  const std::size_t n = q.size();
  if (n < 2) return {};
  const std::size_t first = ring ? 0 : 1;
  const std::size_t end = ring ? n : n - 1;
  std::vector<SharedCorner> corners;
  std::vector<bool> blends(n, false);
  for (std::size_t i = first; i < end; ++i) {
    const Corner corner{q[(i + n - 1) % n], q[i], q[(i + 1) % n]};
    const bool stays = turns_more(corner, keep_corner_angle);
    blends[i] = !stays && std::holds_alternative<CornerFrame>(frame_of(corner));
    corners.push_back({i, corner, 0, 0, stays});
  }
  const auto share = [&](std::size_t vertex, std::size_t neighbour) {
    return (q[vertex] - q[neighbour]).norm() / (blends[neighbour] ? 2 : 1);
  };
  for (SharedCorner& corner : corners) {
    corner.share_before = share(corner.vertex, (corner.vertex + n - 1) % n);
    corner.share_after = share(corner.vertex, (corner.vertex + 1) % n);
  }
  return corners;
}

BlendedPath blended_path(std::span<const Point3> distinct,
                         std::span<const std::optional<BsplineCurve>> blends, bool ring) {
  const auto& q = distinct;
  const std::size_t n = q.size();
  if (n < 2) return {};
  const bool seam = ring && blends[0].has_value();
  std::optional<HalfBlend> before_seam;
  std::optional<HalfBlend> after_seam;
  if (seam) {
    before_seam.emplace(*blends[0], true, q[0]);
    after_seam.emplace(*blends[0], false, q[0]);
  }
  Chain chain(seam ? after_seam->start() : q[0], 0);
  if (seam) after_seam->append_to(chain, 0);
  double station = 0;
  for (std::size_t i = 1; i < n; ++i) {
    station += (q[i] - q[i - 1]).norm();
    if (!ring && i + 1 == n) break;
    if (blends[i]) {
      HalfBlend(*blends[i], true, q[i]).append_to(chain, station);
      HalfBlend(*blends[i], false, q[i]).append_to(chain, station);
    } else {
      chain.line_to(q[i], station);
    }
  }
  if (!ring) return std::move(chain).finish(q[n - 1], station);
  station += (q[0] - q[n - 1]).norm();
  if (!seam) return std::move(chain).finish(q[0], station);
  before_seam->append_to(chain, station);
  return std::move(chain).finish(after_seam->start(), station);
}

}  // namespace batten::geometry
