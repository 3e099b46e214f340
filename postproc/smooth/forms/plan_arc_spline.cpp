#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

#include "geometry/arcs/arc_spline.h"
#include "geometry/basic/rounding.h"
#include "geometry/path/plane_curve.h"
#include "postproc/smooth/forms/arc_moves.h"
#include "postproc/smooth/forms/output_plan.h"
#include "postproc/smooth/forms/plan_stretches.h"

namespace batten::postproc {
namespace {

using geometry::Point2;
using geometry::Point3;
using geometry::Vector3;

// The part of the deviation that is kept for chords in place of arcs that the target refuses
// after rounding. There are few of them.
constexpr double kPartForArcSplineChords = 0.03;

// Turns beyond this stay as they are: see geometry::find_features.
constexpr double kReversal = 170 * std::numbers::pi / 180;

// Tangents at the two ends of a closed run that differ less make no corner there.
constexpr double kNoCorner = 1e-3;

// A part of the run that is one chain of arcs: between changes of feed and kept corners.
struct ArcStretch {
  std::size_t first;  // vertices of the run
  std::size_t last;
  double feed;
  bool tangent_start;  // the path goes smoothly through this end
  bool tangent_end;
};

double turn_at(const Run& run, std::size_t i) {
  const Vector3 a = run.points[i] - run.points[i - 1];
  const Vector3 b = run.points[i + 1] - run.points[i];
  return std::atan2(a.cross(b).norm(), a.dot(b));
}

class ArcSplinePlanner {
 public:
  ArcSplinePlanner(const Run& run, const geometry::SmoothCurve& fair, const PlanOptions& options,
                   const gcode::PlaneAxes& plane)
      : run_(run),
        fair_(fair),
        options_(options),
        frame_(geometry::PlaneFrame::across(Vector3::Unit(plane.normal))),
        axis_(Vector3::Unit(plane.normal)),
        height_(run.points.front()[plane.normal]) {}

  std::optional<OutputPlan> plan() {
    plan_.form = OutputForm::kArcs;
    for (const ArcStretch& stretch : stretches()) {
      if (!add(stretch)) return std::nullopt;
    }
    place_comments(run_, fair_, starts_, plan_);
    return std::move(plan_);
  }

 private:
  [[nodiscard]] bool kept_corner(std::size_t i) const {
    return turn_at(run_, i) > std::min(options_.keep_corner_angle, kReversal);
  }

  [[nodiscard]] double angle_of(double parameter) const {
    const Vector3 d = frame_.local(fair_.curve.derivative_at(parameter, 1));
    return std::atan2(d.y(), d.x());
  }

  // A closed run without a corner where it starts.
  [[nodiscard]] bool goes_round() const {
    if (!run_.closed) return false;
    const double off = angle_of(fair_.curve.last()) - angle_of(fair_.curve.first());
    return std::abs(std::remainder(off, 2 * std::numbers::pi)) < kNoCorner;
  }

  [[nodiscard]] std::vector<ArcStretch> stretches() const {
    const std::size_t end = run_.points.size() - 1;
    const bool round = goes_round();
    std::vector<ArcStretch> all = {{0, end, run_.feeds.front().feed, round, round}};
    std::size_t next = 0;
    for (std::size_t i = 0; i < end; ++i) {
      double feed = all.back().feed;
      while (next < run_.feeds.size() && run_.feeds[next].vertex <= i) {
        feed = run_.feeds[next++].feed;
      }
      const bool corner = i > 0 && kept_corner(i);
      if (i == 0) all.back().feed = feed;
      if (i == 0 || (!corner && feed == all.back().feed)) continue;
      const bool tangent_end = std::exchange(all.back().tangent_end, !corner);
      all.back().last = i;
      all.push_back({i, end, feed, !corner, tangent_end});
    }
    return all;
  }

  bool add(const ArcStretch& stretch) {
    std::vector<Point2> points;
    std::vector<std::size_t> vertices;
    for (std::size_t i = stretch.first; i <= stretch.last; ++i) {
      const Point2 p = frame_.local(run_.points[i]).head<2>();
      if (!points.empty() && (p - points.back()).norm() <= geometry::kSamePlace) continue;
      points.push_back(p);
      vertices.push_back(i);
    }
    if (points.size() < 2) return stretch.first == stretch.last || stretch.last == 0;
    const auto spline = geometry::fit_arc_spline(points, fit_options(stretch, points));
    if (!spline) return false;
    append(*spline, stretch, points, vertices);
    return true;
  }

  [[nodiscard]] geometry::ArcSplineOptions fit_options(const ArcStretch& stretch,
                                                       const std::vector<Point2>& points) const {
    geometry::ArcSplineOptions fit;
    fit.tolerance = (1 - kPartForArcSplineChords) * options_.max_deviation;
    fit.min_radius = options_.target->min_arc_radius();
    fit.max_radius = options_.target->max_arc_radius();
    fit.grid = arc_grid(options_);
    fit.effort = geometry::ArcEffort::kThorough;
    const geometry::Vector2 first = points[1] - points[0];
    fit.direction = std::atan2(first.y(), first.x());
    if (stretch.tangent_start) fit.start_angle = angle_of(fair_.vertex_parameters[stretch.first]);
    if (stretch.tangent_end) fit.end_angle = angle_of(fair_.vertex_parameters[stretch.last]);
    return fit;
  }

  [[nodiscard]] Point3 placed(const Point2& p) const {
    return frame_.global({p.x(), p.y(), height_});
  }

  void append(const geometry::ArcSpline& spline, const ArcStretch& stretch,
              const std::vector<Point2>& points, const std::vector<std::size_t>& vertices) {
    std::size_t at = 0;  // the vertex before the start of the piece
    double passed = 0;   // station of that vertex
    double station = 0;
    for (const geometry::ArcSplinePiece& piece : spline.pieces) {
      while (at + 2 < points.size() && passed + (points[at + 1] - points[at]).norm() <= station) {
        passed += (points[at + 1] - points[at]).norm();
        ++at;
      }
      const double part = (station - passed) / (points[at + 1] - points[at]).norm();
      const double u0 = fair_.vertex_parameters[vertices[at]];
      const double u1 = fair_.vertex_parameters[vertices[at + 1]];
      add_piece(piece.arc, u0 + part * (u1 - u0), stretch.feed);
      station = piece.station;
    }
  }

  void add_piece(const geometry::PlaneArc& arc, double start, double feed) {
    const Point3 from = placed(arc.start);
    const Point3 to = placed(arc.end);
    geometry::PathPiece piece = geometry::Line{from, to};
    if (!arc.is_line()) piece = geometry::Arc{from, to, placed(arc.center), axis_, arc.sweep};
    geometry::Path taken;
    append_taken(piece, kPartForArcSplineChords * options_.max_deviation, options_, taken);
    for (const geometry::PathPiece& each : taken) {
      plan_.moves.push_back({each, feed, {}});
      starts_.push_back(start);
    }
  }

  const Run& run_;
  const geometry::SmoothCurve& fair_;
  const PlanOptions& options_;
  geometry::PlaneFrame frame_;
  Vector3 axis_;
  double height_;  // of the run along the axis
  OutputPlan plan_;
  std::vector<double> starts_;  // parameter of the fair curve at the start of each move
};

bool lies_flat(const Run& run, int normal) {
  const double height = run.points.front()[normal];
  return std::ranges::all_of(run.points, [&](const Point3& p) {
    return std::abs(p[normal] - height) <= geometry::kSamePlace;
  });
}

}  // namespace

std::optional<OutputPlan> plan_arc_spline(const Run& run, const geometry::SmoothCurve& fair,
                                          const PlanOptions& options) {
  for (const gcode::PlaneAxes& plane : arc_planes(options)) {
    if (!lies_flat(run, plane.normal)) continue;
    if (auto plan = ArcSplinePlanner(run, fair, options, plane).plan()) return plan;
  }
  return std::nullopt;
}

}  // namespace batten::postproc
