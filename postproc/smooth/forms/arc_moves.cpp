#include "postproc/smooth/forms/arc_moves.h"

#include <algorithm>
#include <limits>
#include <memory>
#include <optional>
#include <utility>

#include "geometry/basic/rounding.h"
#include "geometry/path/plane_curve.h"
#include "postproc/smooth/forms/output_plan.h"

namespace batten::postproc {

using gcode::PlaneAxes;
using geometry::Path;
using geometry::PathPiece;
using geometry::Point3;
using geometry::Vector3;

namespace {

// How far the chords that the target makes of an arc leave it. Printing may move each end by a
// step, which takes a chord more or less, or longer ones; it moves the centre by less.
geometry::ArcRunning::Error run_error(const gcode::ArcChords& chords, double grid, double radius,
                                      double sweep, double length) {
  constexpr double kOfCenter = 1e-3;
  const double part = std::min(0.5, 2 * grid / length);
  const auto error = [&](double times) {
    return gcode::chord_error(chords, radius, times * sweep, times * length);
  };
  // Of as many chords longer ones are farther off.
  const bool certain = error(1 - part - kOfCenter) <= error(1 + part + kOfCenter);
  return {std::max(error(1 - part), error(1 + part)), certain};
}

}  // namespace

std::vector<PlaneAxes> arc_planes(const PlanOptions& options) {
  std::vector<PlaneAxes> planes;
  for (const PlaneAxes& each : gcode::kPlaneAxes) {
    if (takes_arcs_in(*options.target, each.plane)) planes.push_back(each);
  }
  std::stable_partition(planes.begin(), planes.end(),
                        [&](const PlaneAxes& each) { return each.plane == options.active_plane; });
  return planes;
}

double arc_grid(const PlanOptions& options) {
  return gcode::printed_step(arc_end_format(*options.target, options.units), options.units);
}

double arc_deviation(const PlanOptions& options) {
  return options.max_deviation * (1 - kPlans.arc_chords);
}

std::vector<geometry::Arc> parts_of(const geometry::Arc& arc, const gcode::Control& target,
                                    double most) {
  geometry::ArcPartsOptions parts;
  parts.max_sweep = std::min(most, max_arc_sweep(target));
  const PlaneAxes* plane = gcode::plane_across(arc.axis);
  if (target.single_quadrants && plane != nullptr) {
    parts.quadrant_from = Vector3::Unit(plane->first);
  }
  return geometry::arc_parts(arc, parts);
}

void append_taken(const PathPiece& piece, double deviation, const PlanOptions& options,
                  Path& path) {
  const auto* arc = std::get_if<geometry::Arc>(&piece);
  if (arc == nullptr) {
    path.push_back(piece);
    return;
  }
  for (const geometry::Arc& part : parts_of(*arc, *options.target)) {
    if (gcode::arc_refusal(*options.target, part, options.units).empty()) {
      path.push_back(part);
      continue;
    }
    const Path chords = chords_for(part, deviation);
    path.insert(path.end(), chords.begin(), chords.end());
  }
}

RunChords::RunChords(const Run& run, const gcode::ArcChords& chords) : run_(run) {
  const double usual = gcode::usual_chord_error(chords);
  aimed_at_ = std::isfinite(usual) ? usual : 0;
  for (const RunBend& bend : run.bends) {
    const auto* arc = std::get_if<geometry::Arc>(&bend.piece);
    errors_.push_back(arc != nullptr ? gcode::chord_error(chords, *arc)
                                     : std::numeric_limits<double>::infinity());
  }
}

double RunChords::greatest(std::size_t first, std::size_t last) const {
  const auto begin = std::ranges::upper_bound(run_.bends, first, {}, &RunBend::last);
  double greatest = aimed_at_;
  auto i = static_cast<std::size_t>(begin - run_.bends.begin());
  const std::size_t from = i;
  for (; i < run_.bends.size() && run_.bends[i].first < last; ++i) {
    greatest = std::max(greatest, errors_[i]);
  }
  return i > from ? greatest : std::numeric_limits<double>::infinity();
}

geometry::ArcRunning::Room FollowedPath::room(double from, double to) const {
  const auto index = [this](auto found) {
    return static_cast<std::size_t>(found - places.begin());
  };
  const std::size_t behind = index(std::ranges::upper_bound(places, from));
  const std::size_t first = std::min(std::max<std::size_t>(behind, 1) - 1, places.size() - 2);
  const std::size_t last =
      std::clamp(index(std::ranges::lower_bound(places, to)), first + 1, places.size() - 1);
  BesideCurve most;
  for (std::size_t i = first; i < last && !beside.empty(); ++i) {
    most.left = std::max(most.left, beside[i].left);
    most.right = std::max(most.right, beside[i].right);
  }
  return {tolerance - most.left, tolerance - most.right,
          before.greatest(vertices[first], vertices[last])};
}
bool takes_chords_off(const PlanOptions& options) {
  return options.target->chords.any() && options.tolerance > 0;
}

geometry::ArcRunning running_of(const PlanOptions& options, FollowedPath path) {
  geometry::ArcRunning running;
  running.error = [&chords = options.target->chords, grid = arc_grid(options)](
                      double radius, double sweep, double length) {
    return run_error(chords, grid, radius, sweep, length);
  };
  running.room = [path = std::make_shared<const FollowedPath>(std::move(path))](
                     double from, double to) { return path->room(from, to); };
  return running;
}

namespace {

// Replaces arcs that the target would cut too coarsely by chords of ours.
class OwnChords {
 public:
  OwnChords(const Run& run, const geometry::SmoothCurve& fair, const PlanOptions& options)
      : run_(run),
        fair_(fair),
        options_(options),
        chords_(options.target->chords),
        before_(run, chords_) {}

  void put_into(OutputPlan& plan) {
    if (!chords_.any()) return;
    std::vector<PlannedMove> moves;
    moves.reserve(plan.moves.size());
    for (std::size_t i = 0; i < plan.moves.size(); ++i) {
      PlannedMove& move = plan.moves[i];
      const auto* arc = std::get_if<geometry::Arc>(&move.piece);
      const double end = i + 1 < plan.moves.size() ? plan.moves[i + 1].start : fair_.curve.last();
      const std::optional<double> height =
          arc == nullptr ? std::nullopt : height_for(*arc, move.start, end);
      if (!height) {
        moves.push_back(std::move(move));
        continue;
      }
      plan.arcs_as_chords = true;
      for (const PathPiece& chord : chords_for(*arc, *height)) {
        moves.push_back({chord, move.feed, {}, move.start});
      }
    }
    plan.moves = std::move(moves);
  }

 private:
  // How high chords in place of this arc may be; nothing where it stays.
  [[nodiscard]] std::optional<double> height_for(const geometry::Arc& arc, double start,
                                                 double end) {
    const auto& at = fair_.vertex_parameters;
    while (first_ + 2 < at.size() && at[first_ + 1] <= start) ++first_;
    std::size_t last = first_ + 1;  // of the run: the arc is between these vertices
    while (last + 1 < at.size() && at[last] < end) ++last;
    const geometry::ArcRunning::Error error = error_of(arc);
    if (distance(arc, error, last) <= options_.tolerance &&
        error.off <= before_.greatest(first_, last)) {
      return std::nullopt;
    }
    const double left = options_.tolerance - distance(arc, {}, last);
    return std::max(left, kPlans.spline_chords * options_.max_deviation);
  }

  [[nodiscard]] geometry::ArcRunning::Error error_of(const geometry::Arc& arc) const {
    return run_error(chords_, arc_grid(options_), geometry::radius_of(arc), arc.sweep,
                     geometry::length_of(arc));
  }

  // mm, about: between the run, from the vertex before the arc to the one behind it, and the arc
  // and what is so far inside of it.
  [[nodiscard]] double distance(const geometry::Arc& arc, const geometry::ArcRunning::Error& error,
                                std::size_t last) const {
    const double inside = error.off;
    const double outside = error.certain ? 0 : error.off;
    double greatest = 0;
    const double radius = geometry::radius_of(arc);
    for (std::size_t i = first_ + 1; i < last; ++i) {
      const Vector3 out = run_.points[i] - arc.center;
      const double off = (out - out.dot(arc.axis) * arc.axis).norm() - radius;
      greatest = std::max({greatest, off + inside, outside - off});
    }
    constexpr int kParts = 4;
    for (int k = 0; k <= kParts; ++k) {
      const Point3 point = geometry::point_at(arc, static_cast<double>(k) / kParts);
      greatest = std::max(greatest, distance_to_run(point, last) + outside);
      // Both ends of the arc are ends of chords.
      if (inside == 0 || k == 0 || k == kParts) continue;
      const Vector3 out = point - arc.center;
      const Vector3 across = (out - out.dot(arc.axis) * arc.axis).normalized();
      greatest = std::max(greatest, distance_to_run(point - inside * across, last));
    }
    return greatest;
  }

  [[nodiscard]] double distance_to_run(const Point3& point, std::size_t last) const {
    double nearest = std::numeric_limits<double>::infinity();
    for (std::size_t i = first_; i < last; ++i) {
      nearest = std::min(nearest,
                         geometry::distance_to_segment(point, run_.points[i], run_.points[i + 1]));
    }
    return nearest;
  }

  const Run& run_;
  const geometry::SmoothCurve& fair_;
  const PlanOptions& options_;
  const gcode::ArcChords& chords_;
  RunChords before_;
  std::size_t first_ = 0;  // vertex at or before the arc
};

}  // namespace

void put_own_chords(const Run& run, const geometry::SmoothCurve& fair, const PlanOptions& options,
                    OutputPlan& plan) {
  OwnChords(run, fair, options).put_into(plan);
}

}  // namespace batten::postproc
