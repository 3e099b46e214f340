#include <cmath>
#include <optional>
#include <utility>
#include <vector>

#include "geometry/arcs/arc_spline.h"
#include "geometry/path/plane_curve.h"
#include "postproc/smooth/forms/arc_moves.h"
#include "postproc/smooth/forms/output_plan.h"

namespace batten::postproc {

using gcode::PlaneAxes;
using geometry::Path;
using geometry::PathPiece;
using geometry::Point2;
using geometry::Point3;
using geometry::Vector3;

namespace {

// A part of the run that is one chain of arcs: between changes of feed and kept corners.
struct ArcSection {
  std::size_t first;  // vertices of the run
  std::size_t last;
  double feed;
  bool tangent_start;  // the path goes smoothly through this end
  bool tangent_end;
};

class ArcSplinePlanner {
 public:
  ArcSplinePlanner(const Run& run, const geometry::SmoothCurve& fair, const PlanOptions& options,
                   const PlaneAxes& plane)
      : run_(run),
        fair_(fair),
        options_(options),
        frame_(geometry::PlaneFrame::across(Vector3::Unit(plane.normal))),
        axis_(Vector3::Unit(plane.normal)),
        height_(run.points.front()[plane.normal]) {}

  std::optional<OutputPlan> plan() {
    plan_.form = Form::kArcs;
    for (const ArcSection& section : sections()) {
      if (!add(section)) return std::nullopt;
    }
    put_own_chords(run_, fair_, options_, plan_);
    place_comments(run_, fair_, plan_);
    return std::move(plan_);
  }

 private:
  [[nodiscard]] bool kept_corner(std::size_t i) const {
    const Vector3 in = run_.points[i] - run_.points[i - 1];
    const Vector3 out = run_.points[i + 1] - run_.points[i];
    const double turn = std::atan2(in.cross(out).norm(), in.dot(out));
    return turn > std::min(options_.keep_corner_angle, kPlans.reversal);
  }

  [[nodiscard]] double angle_of(double parameter) const {
    const Vector3 d = frame_.local(fair_.curve.derivative_at(parameter, 1));
    return std::atan2(d.y(), d.x());
  }

  // A closed run without a corner where it starts.
  [[nodiscard]] bool goes_round() const {
    if (!run_.closed) return false;
    const double off = angle_of(fair_.curve.last()) - angle_of(fair_.curve.first());
    return std::abs(std::remainder(off, 2 * geometry::kPi)) < kPlans.no_corner;
  }

  [[nodiscard]] std::vector<ArcSection> sections() const {
    const std::size_t end = run_.points.size() - 1;
    const bool round = goes_round();
    std::vector<ArcSection> all = {{0, end, run_.feeds.front().feed, round, round}};
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

  bool add(const ArcSection& section) {
    std::vector<Point2> points;
    std::vector<std::size_t> vertices;
    for (std::size_t i = section.first; i <= section.last; ++i) {
      const Point2 p = frame_.local(run_.points[i]).head<2>();
      if (!points.empty() && (p - points.back()).norm() <= geometry::kSamePlace) continue;
      points.push_back(p);
      vertices.push_back(i);
    }
    if (points.size() < 2) return section.first == section.last || section.last == 0;
    const auto spline = geometry::fit_arc_spline(points, fit_options(section, points, vertices));
    if (!spline) return false;
    append(*spline, section, points, vertices);
    return true;
  }

  [[nodiscard]] geometry::ArcRunning running_beside(
      const std::vector<Point2>& points, const std::vector<std::size_t>& vertices) const {
    if (!takes_chords_off(options_)) return {};
    FollowedPath path{
        {0}, vertices, {}, RunChords(run_, options_.target->chords), options_.tolerance};
    for (std::size_t i = 1; i < points.size(); ++i) {
      path.places.push_back(path.places.back() + (points[i] - points[i - 1]).norm());
    }
    return running_of(options_, std::move(path));
  }

  [[nodiscard]] geometry::ArcSplineOptions fit_options(
      const ArcSection& section, const std::vector<Point2>& points,
      const std::vector<std::size_t>& vertices) const {
    geometry::ArcSplineOptions fit;
    fit.tolerance = (1 - kPlans.spline_chords) * options_.max_deviation;
    fit.outside = (1 - kPlans.spline_chords) * options_.outside;
    fit.min_radius = options_.target->min_radius;
    fit.max_radius = options_.target->max_radius;
    fit.grid = arc_grid(options_);
    fit.effort = options_.arc_effort;
    fit.running = running_beside(points, vertices);
    const geometry::Vector2 first = points[1] - points[0];
    fit.direction = std::atan2(first.y(), first.x());
    if (section.tangent_start) fit.start_angle = angle_of(fair_.vertex_parameters[section.first]);
    if (section.tangent_end) fit.end_angle = angle_of(fair_.vertex_parameters[section.last]);
    return fit;
  }

  [[nodiscard]] Point3 placed(const Point2& p) const {
    return frame_.global({p.x(), p.y(), height_});
  }

  void append(const geometry::ArcSpline& spline, const ArcSection& section,
              const std::vector<Point2>& points, const std::vector<std::size_t>& vertices) {
    const auto edge = [&](std::size_t i) { return (points[i + 1] - points[i]).norm(); };
    std::size_t at = 0;  // the vertex before the start of the piece
    double passed = 0;   // station of that vertex
    double station = 0;
    for (const geometry::ArcSplinePiece& piece : spline.pieces) {
      while (at + 2 < points.size() && passed + edge(at) <= station) passed += edge(at++);
      const double part = (station - passed) / edge(at);
      const double u0 = fair_.vertex_parameters[vertices[at]];
      const double u1 = fair_.vertex_parameters[vertices[at + 1]];
      add_piece(piece.arc, u0 + part * (u1 - u0), section.feed);
      station = piece.station;
    }
  }

  void add_piece(const geometry::PlaneArc& arc, double start, double feed) {
    const Point3 from = placed(arc.start);
    const Point3 to = placed(arc.end);
    PathPiece piece = geometry::Line{from, to};
    if (!arc.is_line()) piece = geometry::Arc{from, to, placed(arc.center), axis_, arc.sweep};
    Path taken;
    append_taken(piece, kPlans.spline_chords * options_.max_deviation, options_, taken);
    for (const PathPiece& each : taken) {
      plan_.moves.push_back({each, feed, {}, start});
    }
  }

  const Run& run_;
  const geometry::SmoothCurve& fair_;
  const PlanOptions& options_;
  geometry::PlaneFrame frame_;
  Vector3 axis_;
  double height_;  // of the run along the axis
  OutputPlan plan_;
};

}  // namespace

std::optional<OutputPlan> plan_arc_spline(const Run& run, const geometry::SmoothCurve& fair,
                                          const PlanOptions& options) {
  for (const PlaneAxes& plane : arc_planes(options)) {
    if (!lies_across(run, plane.normal)) continue;
    auto plan = ArcSplinePlanner(run, fair, options, plane).plan();
    if (plan && plan->moves.size() <= options.most_arcs) return plan;
  }
  return std::nullopt;
}

}  // namespace batten::postproc
