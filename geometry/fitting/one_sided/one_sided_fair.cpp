#include "geometry/fitting/one_sided/one_sided_fair.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <deque>
#include <utility>
#include <vector>

#include "geometry/basic/rounding.h"
#include "geometry/fitting/corners/corner_blend.h"
#include "geometry/fitting/fair/fair_measure.h"
#include "geometry/path/path.h"

namespace batten::geometry {

namespace {

class OneSided {
 public:
  OneSided(std::span<const Point3> points, const OneSidedOptions& options)
      : p_(points),
        options_(options),
        sign_(options.side == Side::kRight ? -1 : 1),
        move_(points.size(), 0) {
    find_normals();
  }

  std::optional<SmoothCurve> make() {
    if (normals_.empty()) return std::nullopt;
    for (int round = 0; round < kOneSidedTuning.rounds; ++round) {
      auto path = faired(moved(), {});
      if (!path) return std::nullopt;
      std::vector<double> lacking = lacking_beside(*path);
      if (is_let_through(lacking)) {
        if (path->deviation > options_.fair.tolerance) break;
        return path;
      }
      move_on(std::move(lacking));
    }
    return beside();
  }

 private:
  [[nodiscard]] std::optional<SmoothCurve> faired(const std::vector<Point3>& points,
                                                  std::span<const double> rooms) const {
    FairOptions fair = options_.fair;
    fair.tolerance *= kOneSidedTuning.curve_part;
    fair.scatter = std::min(fair.scatter, kOneSidedTuning.curve_part * fair.tolerance);
    fair.rooms = rooms;
    auto path = fair_path(points, fair);
    if (path) {
      path->deviation =
          greatest_deviation(path->curve, {p_, path->vertex_parameters}, options_.fair.tolerance);
    }
    return path;
  }

  [[nodiscard]] bool is_let_through(const std::vector<double>& lacking) const {
    return *std::ranges::max_element(lacking) <=
           kOneSidedTuning.let_through * options_.fair.tolerance;
  }

  // Where noise or corners leave no curve that is moved by less: all in the middle of the allowed
  // half of the band.
  [[nodiscard]] std::optional<SmoothCurve> beside() const {
    std::vector<Point3> points(p_.begin(), p_.end());
    std::vector<double> free(p_.size(), 0);  // mm around the moved vertices
    for (std::size_t i = 1; i + 1 < points.size(); ++i) free[i] = move_beside(i, points[i]);
    const double half = kOneSidedTuning.curve_part * options_.fair.tolerance;
    const double least_room = kOneSidedTuning.least_room / kOneSidedTuning.curve_part;
    std::vector<double> rooms(p_.size() - 1);
    for (std::size_t edge = 0; edge < rooms.size(); ++edge) {
      rooms[edge] = std::clamp(std::min(free[edge], free[edge + 1]) / half, least_room, 1.0);
    }
    auto path = faired(points, rooms);
    const bool holds =
        path && path->deviation <= options_.fair.tolerance && is_let_through(lacking_beside(*path));
    return holds ? std::move(path) : std::nullopt;
  }

  // Moves a vertex to the middle of what is allowed and gives how far from there (mm) a curve may
  // be: inside the discs about the path beside this one, and on its side of both edges by the
  // margin.
  [[nodiscard]] double move_beside(std::size_t i, Point3& place) const {
    const Vector3& before = normals_[i - 1];
    const Vector3& after = normals_[i];
    const double gentle = gentle_at(stations_[i]);
    const double move = gentle * (1 - kOneSidedTuning.curve_part) * options_.fair.tolerance;
    const double half_cosine = std::sqrt(std::max(0.0, 0.5 * (1 + before.dot(after))));
    const double half_sine = std::sqrt(std::max(0.0, 0.5 * (1 - before.dot(after))));
    const Vector3 middle = 0.5 * (before + after);
    double room = 0;
    if (sign_ * (before.x() * after.y() - before.y() * after.x()) > 0) {
      // The path beside this one comes back round the vertex between two places: midway of them.
      place += move * middle;
      room = move * std::min(1 - half_sine, half_cosine * half_cosine);
    } else {
      const double far = std::min(1 / std::max(half_cosine, 1e-6), kOneSidedTuning.furthest_corner);
      if (middle.norm() > kSameDirection) place += far * move * middle.normalized();
      room = move * std::min(2 - far, far * half_cosine);
    }
    return room - gentle * options_.margin;
  }

  // Per edge, to the allowed side. None where no edge has a side.
  void find_normals() {
    Vector3 last = Vector3::Zero();
    normals_.reserve(p_.size());
    stations_.push_back(0);
    for (std::size_t i = 0; i + 1 < p_.size(); ++i) {
      const Vector3 edge = p_[i + 1] - p_[i];
      const double length = edge.norm();
      stations_.push_back(stations_.back() + length);
      if (length > kSamePlace) {
        const Vector3 left = left_of(edge / length);
        if (!left.isZero()) last = sign_ * left;
      }
      normals_.push_back(last);
    }
    const auto first = std::ranges::find_if(normals_, [](const Vector3& n) { return !n.isZero(); });
    if (first == normals_.end()) {
      normals_.clear();
      return;
    }
    std::fill(normals_.begin(), first, *first);
  }

  [[nodiscard]] std::vector<Point3> moved() const {
    std::vector<Point3> points(p_.begin(), p_.end());
    for (std::size_t i = 1; i + 1 < points.size(); ++i) {
      const Vector3& before = normals_[i - 1];
      const Vector3& after = normals_[i];
      // At a turn of more than a right angle the corner of the moved path would be far off.
      points[i] += move_[i] / std::max(1.0, 1 + before.dot(after)) * (before + after);
    }
    return points;
  }

  // Per edge, mm: how much further to the allowed side the curve beside it would have to be.
  [[nodiscard]] std::vector<double> lacking_beside(const SmoothCurve& path) const {
    SplineWalk curve(path.curve.basis().knots(), path.curve.control_points());
    std::vector<double> lacking(p_.size() - 1, 0);
    for (std::size_t edge = 0; edge + 1 < p_.size(); ++edge) {
      const double from = path.vertex_parameters[edge];
      const double step = (path.vertex_parameters[edge + 1] - from) / kOneSidedTuning.samples;
      for (int k = 0; k <= kOneSidedTuning.samples; ++k) {
        const double u = from + k * step;
        const double over = over_at(curve.point_at(u), edge);
        const bool bends = curve.curvature_at(u) > kSameDirection;
        const double station = std::lerp(stations_[edge], stations_[edge + 1],
                                         static_cast<double>(k) / kOneSidedTuning.samples);
        const double margin = bends ? options_.margin * gentle_at(station) : 0;
        lacking[edge] = std::max(lacking[edge], over + margin);
      }
    }
    return lacking;
  }

  // mm on the wrong side of the edge; of a neighbour where that is less and beside it, too.
  [[nodiscard]] double over_at(const Point3& place, std::size_t edge) const {
    double over = -normals_[edge].dot(place - p_[edge]);
    if (edge > 0) over = std::min(over, over_beside(place, edge - 1, over));
    if (edge + 2 < p_.size()) over = std::min(over, over_beside(place, edge + 1, over));
    return over;
  }

  [[nodiscard]] double over_beside(const Point3& place, std::size_t edge, double otherwise) const {
    const Vector3 along = p_[edge + 1] - p_[edge];
    const Vector3 there = place - p_[edge];
    const double foot = there.dot(along);
    if (foot < 0 || foot > along.squaredNorm()) return otherwise;
    return -normals_[edge].dot(there);
  }

  // Moves the vertices on by what the edges around them lack, and gently what is around.
  void move_on(std::vector<double> lacking) {
    const double ramp = kOneSidedTuning.ramp * options_.fair.tolerance;
    for (double& each : lacking) each = each > 0 ? kOneSidedTuning.further * each : 0;
    std::vector<double> more = greatest_within(lacking, 2 * ramp);
    more = mean_within(more, ramp);
    const double most = (1 - kOneSidedTuning.curve_part) * options_.fair.tolerance;
    for (std::size_t i = 0; i < move_.size(); ++i) {
      const double gentle = gentle_at(stations_[i]);
      move_[i] = std::min(move_[i] + gentle * more[i], gentle * most);
    }
  }

  // 0 at the ends of the run, which stay, 1 from a ramp behind them on.
  [[nodiscard]] double gentle_at(double station) const {
    const double to_end = std::min(station, stations_.back() - station);
    const double part = std::min(1.0, to_end / (kOneSidedTuning.ramp * options_.fair.tolerance));
    return part * part * (3 - 2 * part);
  }

  // Per vertex, the greatest value of the edges that are within `way` of it along the path.
  [[nodiscard]] std::vector<double> greatest_within(const std::vector<double>& of_edges,
                                                    double way) const {
    std::vector<double> greatest(p_.size());
    std::deque<std::size_t> falling;  // edges, later ones are less than earlier ones
    std::size_t next = 0;
    for (std::size_t i = 0; i < p_.size(); ++i) {
      while (next < of_edges.size() && (next <= i || stations_[next] <= stations_[i] + way)) {
        while (!falling.empty() && of_edges[falling.back()] <= of_edges[next]) falling.pop_back();
        falling.push_back(next++);
      }
      while (falling.size() > 1 && falling.front() + 1 < i &&
             stations_[falling.front() + 1] < stations_[i] - way) {
        falling.pop_front();
      }
      greatest[i] = of_edges[falling.front()];
    }
    return greatest;
  }

  [[nodiscard]] std::vector<double> mean_within(const std::vector<double>& values,
                                                double way) const {
    std::vector<double> sums = {0};
    for (const double value : values) sums.push_back(sums.back() + value);
    std::vector<double> means(values.size());
    std::size_t first = 0;
    std::size_t end = 0;
    for (std::size_t i = 0; i < values.size(); ++i) {
      while (stations_[first] < stations_[i] - way) ++first;
      while (end < values.size() && stations_[end] <= stations_[i] + way) ++end;
      means[i] = (sums[end] - sums[first]) / static_cast<double>(end - first);
    }
    return means;
  }

  std::span<const Point3> p_;
  const OneSidedOptions& options_;
  double sign_;
  std::vector<double> move_;      // mm, per vertex
  std::vector<Vector3> normals_;  // per edge
  std::vector<double> stations_;  // mm along the run, per vertex
};

}  // namespace

std::optional<SmoothCurve> one_sided_fair_path(std::span<const Point3> points,
                                               const OneSidedOptions& options) {
  const DistinctVertices vertices = distinct_vertices(points);
  if (vertices.size() < 2 || options.side == Side::kBoth) return fair_path(points, options.fair);
  auto path = OneSided(vertices.points, options).make();
  if (!path) return std::nullopt;
  std::vector<double> of_all;
  of_all.reserve(points.size());
  std::size_t vertex = 0;
  for (std::size_t i = 0; i < points.size(); ++i) {
    if (vertex + 1 < vertices.size() && vertices.indices[vertex + 1] == i) ++vertex;
    of_all.push_back(path->vertex_parameters[vertex]);
  }
  path->vertex_parameters = std::move(of_all);
  return path;
}

}  // namespace batten::geometry
