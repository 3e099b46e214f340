#include "postproc/smooth/forms/line_arcs.h"

#include <algorithm>
#include <cmath>
#include <utility>
#include <variant>

#include "gcode/controls/arc_rules.h"
#include "geometry/arcs/circle_fit.h"
#include "geometry/basic/rounding.h"
#include "geometry/path/plane_curve.h"
#include "postproc/runs/run_path.h"
#include "postproc/smooth/forms/arc_moves.h"

namespace batten::postproc {

using geometry::LineArcSection;
using geometry::Point2;
using geometry::Point3;
using geometry::Vector3;

namespace {

// Vertices inside of the run.
std::vector<std::size_t> changes_of_feed(const Run& run) {
  std::vector<std::size_t> changes;
  double feed = run.feeds.front().feed;
  for (const FeedFrom& from : run.feeds) {
    const bool inside = from.vertex > 0 && from.vertex + 1 < run.points.size();
    if (inside && from.feed != feed) changes.push_back(from.vertex);
    feed = from.feed;
  }
  return changes;
}

std::optional<std::vector<LineArcSection>> sections_of(const std::vector<Point2>& points,
                                                       const std::vector<std::size_t>& changes,
                                                       double deviation, double rounded) {
  if (changes.empty()) {
    if (auto circle = geometry::fit_circle(points, {deviation, deviation})) {
      return std::vector<LineArcSection>{{0, points.size() - 1, std::move(circle)}};
    }
  }
  const double off = std::min(deviation, kLineArcs.roundings * rounded);
  return geometry::line_arc_sections(points, {off, deviation, points.size() / kLineArcs.of_section},
                                     changes);
}

// mm: of all vertices from what they are on.
double rms_off(const std::vector<Point2>& points, const std::vector<LineArcSection>& sections) {
  double squares = 0;
  for (const LineArcSection& section : sections) {
    const auto count = static_cast<double>(section.last - section.first + 1);
    if (section.circle) squares += count * section.circle->rms * section.circle->rms;
    for (std::size_t i = section.first + 1; i < section.last && !section.circle; ++i) {
      squares += std::pow(
          geometry::distance_to_segment(points[i], points[section.first], points[section.last]), 2);
    }
  }
  return std::sqrt(squares / static_cast<double>(points.size()));
}

// Of an angle of a point on the circle: between the vertices there it goes evenly.
double parameter_at(double angle, const LineArcSection& section,
                    const geometry::SmoothCurve& fair) {
  const std::vector<double>& angles = section.circle->angles;
  const auto is_behind = [&](double each) { return std::abs(each) > std::abs(angle); };
  const auto behind = std::ranges::find_if(angles.begin() + 1, angles.end() - 1, is_behind);
  const auto next = static_cast<std::size_t>(behind - angles.begin());
  const double part = (angle - angles[next - 1]) / (angles[next] - angles[next - 1]);
  const double before = fair.vertex_parameters[section.first + next - 1];
  return before + part * (fair.vertex_parameters[section.first + next] - before);
}

}  // namespace

std::optional<LineArcs> line_arcs_of(const Run& run, double deviation, double rounded) {
  if (!run.bends.empty()) return std::nullopt;
  for (const int normal : {2, 1, 0}) {
    if (!lies_across(run, normal)) continue;
    const auto frame = geometry::PlaneFrame::across(Vector3::Unit(normal));
    std::vector<Point2> points;
    points.reserve(run.points.size());
    for (const Point3& p : run.points) points.emplace_back(frame.local(p).head<2>());
    auto sections = sections_of(points, changes_of_feed(run), deviation, rounded);
    if (!sections) continue;
    const auto is_arc = [](const LineArcSection& each) { return each.circle.has_value(); };
    if (std::ranges::none_of(*sections, is_arc)) continue;
    const double off = rms_off(points, *sections);
    const bool is_certain = off <= rounded;
    if (!is_certain && sections->size() > 1) return std::nullopt;
    return LineArcs{normal, std::move(*sections), is_certain};
  }
  return std::nullopt;
}

std::vector<PlannedMove> moves_along(const LineArcs& shape, const Run& run,
                                     const geometry::SmoothCurve& fair) {
  const Vector3 axis = Vector3::Unit(shape.normal);
  const auto frame = geometry::PlaneFrame::across(axis);
  const double height = run.points.front()[shape.normal];
  std::vector<PlannedMove> moves;
  const std::vector<double> feeds = edge_feeds(run);
  for (const LineArcSection& section : shape.sections) {
    const Point3& from = run.points[section.first];
    const Point3& to = run.points[section.last];
    geometry::PathPiece piece = geometry::Line{from, to};
    if (section.circle) {
      const Point2& center = section.circle->center;
      piece = geometry::Arc{from, to, frame.global({center.x(), center.y(), height}), axis,
                            section.circle->angles.back()};
    }
    moves.push_back({piece, feeds[section.first], {}, fair.vertex_parameters[section.first]});
  }
  return moves;
}

std::optional<OutputPlan> plan_line_arcs(const LineArcs& shape, const Run& run,
                                         const geometry::SmoothCurve& fair,
                                         const PlanOptions& options) {
  const auto is_of_shape = [&](const auto& plane) { return plane.normal == shape.normal; };
  if (std::ranges::none_of(arc_planes(options), is_of_shape)) return std::nullopt;
  OutputPlan plan;
  plan.form = Form::kArcs;
  const std::vector<PlannedMove> moves = moves_along(shape, run, fair);
  for (std::size_t i = 0; i < moves.size(); ++i) {
    const auto* whole = std::get_if<geometry::Arc>(&moves[i].piece);
    if (whole == nullptr) {
      if (geometry::length_of(moves[i].piece) > geometry::kSamePlace) {
        plan.moves.push_back(moves[i]);
      }
      continue;
    }
    double angle = 0;
    for (const geometry::Arc& part : parts_of(*whole, *options.target, kLineArcs.arc)) {
      if (!gcode::arc_refusal(*options.target, part, options.units).empty()) return std::nullopt;
      const double start = parameter_at(angle, shape.sections[i], fair);
      plan.moves.push_back({part, moves[i].feed, {}, start});
      angle += part.sweep;
    }
  }
  if (plan.moves.size() > options.most_arcs) return std::nullopt;
  put_own_chords(run, fair, options, plan);
  place_comments(run, fair, plan);
  return plan;
}

}  // namespace batten::postproc
