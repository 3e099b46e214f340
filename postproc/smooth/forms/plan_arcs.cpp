#include <algorithm>
#include <cmath>
#include <limits>
#include <memory>
#include <numeric>
#include <utility>
#include <vector>

#include "gcode/controls/arc_rules.h"
#include "gcode/state/modal_state.h"
#include "geometry/arcs/arc_fit.h"
#include "geometry/arcs/arc_spline.h"
#include "geometry/arcs/biarc.h"
#include "geometry/arcs/circle_fit.h"
#include "geometry/basic/rounding.h"
#include "geometry/fitting/fair/fair_measure.h"
#include "geometry/path/plane_curve.h"
#include "postproc/runs/run_path.h"
#include "postproc/smooth/forms/output_plan.h"

namespace batten::postproc {
namespace {

using gcode::PlaneAxes;
using geometry::BsplineCurve;
using geometry::Path;
using geometry::PathPiece;
using geometry::Point2;
using geometry::Point3;
using geometry::Vector3;

geometry::ArcPartsOptions parts_for(const geometry::Arc& arc, const gcode::Control& target) {
  geometry::ArcPartsOptions parts;
  parts.max_sweep = max_arc_sweep(target);
  const PlaneAxes* plane = gcode::plane_across(arc.axis);
  if (target.single_quadrants && plane != nullptr) {
    parts.quadrant_from = Vector3::Unit(plane->first);
  }
  return parts;
}

// Planes that the target takes arcs in, the active one first.
std::vector<PlaneAxes> arc_planes(const PlanOptions& options) {
  std::vector<PlaneAxes> planes;
  for (const PlaneAxes& each : gcode::kPlaneAxes) {
    if (takes_arcs_in(*options.target, each.plane)) planes.push_back(each);
  }
  std::stable_partition(planes.begin(), planes.end(),
                        [&](const PlaneAxes& each) { return each.plane == options.active_plane; });
  return planes;
}

// mm: the printed step of the ends of arcs.
double arc_grid(const PlanOptions& options) {
  return gcode::printed_step(arc_end_format(*options.target, options.units), options.units);
}

// Appends the piece; an arc in as many parts as the target needs, and chords within `deviation` of
// those parts that it refuses.
void append_taken(const PathPiece& piece, double deviation, const PlanOptions& options,
                  Path& path) {
  const auto* arc = std::get_if<geometry::Arc>(&piece);
  if (arc == nullptr) {
    path.push_back(piece);
    return;
  }
  for (const geometry::Arc& part : geometry::arc_parts(*arc, parts_for(*arc, *options.target))) {
    if (gcode::arc_refusal(*options.target, part, options.units).empty()) {
      path.push_back(part);
      continue;
    }
    const Path chords = chords_for(part, deviation);
    path.insert(path.end(), chords.begin(), chords.end());
  }
}

// The curve laid flat into the plane, when it lies in it to within half a printed step and its
// ends do so exactly.
std::optional<BsplineCurve> laid_flat(const Run& run, const BsplineCurve& curve, int normal,
                                      double step) {
  const double height = run.points.front()[normal];
  if (std::abs(run.points.back()[normal] - height) > geometry::kSamePlace) return std::nullopt;
  std::vector<Point3> points = curve.control_points();
  for (Point3& point : points) {
    if (std::abs(point[normal] - height) > step / 2) return std::nullopt;
    point[normal] = height;
  }
  return BsplineCurve(curve.basis(), std::move(points));
}

double fit_deviation(const PlanOptions& options) {
  return options.max_deviation * (1 - kPlans.arc_chords);
}

geometry::ArcFitOptions fit_options(const PlanOptions& options, const PlaneAxes& plane,
                                    bool helical) {
  geometry::ArcFitOptions fit;
  fit.max_deviation = fit_deviation(options);
  fit.outside = (1 - kPlans.arc_chords) * options.outside;
  fit.axis = Vector3::Unit(plane.normal);
  fit.helical = helical;
  fit.min_radius = options.target->min_radius;
  fit.max_radius = options.target->max_radius;
  fit.grid = arc_grid(options);
  fit.effort = options.arc_effort;
  return fit;
}

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

// What the target's chords of the run's own arcs leave of these, by place.
class RunChords {
 public:
  RunChords(const Run& run, const gcode::ArcChords& chords) : run_(run) {
    const double usual = gcode::usual_chord_error(chords);
    aimed_at_ = std::isfinite(usual) ? usual : 0;
    for (const RunBend& bend : run.bends) {
      const auto* arc = std::get_if<geometry::Arc>(&bend.piece);
      errors_.push_back(arc != nullptr ? gcode::chord_error(chords, *arc)
                                       : std::numeric_limits<double>::infinity());
    }
  }

  // mm: the greatest between two vertices, or what the target itself aims at; without an arc there,
  // new ones may have any.
  [[nodiscard]] double greatest(std::size_t first, std::size_t last) const {
    const auto begin = std::ranges::upper_bound(run_.bends, first, {}, &RunBend::last);
    double greatest = aimed_at_;
    auto i = static_cast<std::size_t>(begin - run_.bends.begin());
    const std::size_t from = i;
    for (; i < run_.bends.size() && run_.bends[i].first < last; ++i) {
      greatest = std::max(greatest, errors_[i]);
    }
    return i > from ? greatest : std::numeric_limits<double>::infinity();
  }

 private:
  const Run& run_;
  std::vector<double> errors_;  // of its arcs
  double aimed_at_ = 0;
};

// How far the run is to the left and to the right of the curve along one of its edges, mm.
struct BesideCurve {
  double left = 0;
  double right = 0;
};

// The path that arcs follow: a place for each vertex, increasing, which vertex of the run it is,
// and how far the run is beside it at each edge (none: it is the run itself).
struct FollowedPath {
  std::vector<double> places;
  std::vector<std::size_t> vertices;
  std::vector<BesideCurve> beside;
  RunChords before;
  double tolerance;

  [[nodiscard]] geometry::ArcRunning::Room room(double from, double to) const {
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
};

// Seen along the axis of the arcs, at some places of each edge.
std::vector<BesideCurve> beside_curve(const Run& run, const geometry::SmoothCurve& fair,
                                      const Vector3& axis) {
  constexpr int kParts = 4;
  const auto& at = fair.vertex_parameters;
  std::vector<BesideCurve> all(run.points.size() - 1);
  for (std::size_t i = 0; i < all.size(); ++i) {
    for (int k = 0; k <= kParts; ++k) {
      const double part = static_cast<double>(k) / kParts;
      const double u = at[i] + part * (at[i + 1] - at[i]);
      const Point3 place = run.points[i] + part * (run.points[i + 1] - run.points[i]);
      const Vector3 left = axis.cross(fair.curve.derivative_at(u, 1));
      const double size = left.norm();
      if (!(size > 0)) continue;  // along the axis
      const double off = (place - fair.curve.point_at(u)).dot(left) / size;
      all[i].left = std::max(all[i].left, off);
      all[i].right = std::max(all[i].right, -off);
    }
  }
  return all;
}

bool takes_chords_off(const PlanOptions& options) {
  return options.target->chords.any() && options.tolerance > 0;
}

// What the search for arcs has to know of the target's own chords.
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

// Of arcs along the curve.
geometry::ArcRunning running_along(const Run& run, const geometry::SmoothCurve& fair,
                                   const Vector3& axis, const PlanOptions& options) {
  if (!takes_chords_off(options)) return {};
  FollowedPath path{fair.vertex_parameters, std::vector<std::size_t>(run.points.size()),
                    beside_curve(run, fair, axis), RunChords(run, options.target->chords),
                    options.tolerance};
  std::iota(path.vertices.begin(), path.vertices.end(), 0);
  return running_of(options, std::move(path));
}

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

// `whole`: all of the curve in its pieces, where these are known, and about how many chords it
// takes.
std::optional<OutputPlan> plan_in(const Run& run, const geometry::SmoothCurve& fair,
                                  const BsplineCurve& curve, const geometry::MarkedPieces* whole,
                                  double chords, const geometry::ArcFitOptions& fit,
                                  const PlanOptions& options) {
  OutputPlan plan;
  plan.form = Form::kArcs;
  for (const FeedSection& section : feed_sections(run, fair)) {
    const bool all = section.from == curve.first() && section.to == curve.last();
    const std::optional<Path> arcs = all && whole != nullptr
                                         ? geometry::fit_arcs(*whole, chords, fit)
                                         : geometry::fit_arcs(curve, section.from, section.to, fit);
    if (!arcs) return std::nullopt;
    Path taken;
    for (const PathPiece& piece : *arcs) {
      append_taken(piece, kPlans.arc_chords * options.max_deviation, options, taken);
    }
    // The parameter goes about with the length: each end is found from the one before it.
    geometry::SplineWalk walk(curve.basis().knots(), curve.control_points());
    double start = section.from;
    for (const PathPiece& piece : taken) {
      plan.moves.push_back({piece, section.feed, {}, start});
      const Point3 end = geometry::end_point(piece);
      double next = start + geometry::length_of(piece);
      for (int i = 0; i < kPlans.newton_steps; ++i) next = walk.nearer(next, end);
      start = std::clamp(next, start, section.to);
    }
  }
  OwnChords(run, fair, options).put_into(plan);
  place_comments(run, fair, plan);
  return plan;
}

// By how far the run reaches across the plane.
std::vector<PlaneAxes> flattest_first(const Run& run, std::vector<PlaneAxes> planes) {
  const auto reach = [&](const PlaneAxes& plane) {
    const auto [low, high] = std::ranges::minmax(
        run.points, {}, [&](const Point3& point) { return point[plane.normal]; });
    return high[plane.normal] - low[plane.normal];
  };
  std::ranges::stable_sort(planes, {}, reach);
  return planes;
}

constexpr std::size_t kAnyNumber = std::numeric_limits<std::size_t>::max() / 2;

std::size_t most_pieces(const PlanOptions& options) {
  return std::min(options.most_arcs, kAnyNumber);
}

bool has_helix(const OutputPlan& plan) {
  return std::ranges::any_of(plan.moves, [](const auto& move) {
    const auto* arc = std::get_if<geometry::Arc>(&move.piece);
    return arc != nullptr && std::abs((arc->end - arc->start).dot(arc->axis)) > 0;
  });
}

}  // namespace

std::optional<OutputPlan> plan_arcs(const Run& run, const geometry::SmoothCurve& fair,
                                    const geometry::MarkedPieces& pieces,
                                    const CurvatureProfile& bends, const PlanOptions& options) {
  const std::vector<PlaneAxes> planes = arc_planes(options);
  bool flat_somewhere = false;
  for (const PlaneAxes& plane : planes) {
    const auto flat = laid_flat(run, fair.curve, plane.normal, arc_grid(options));
    if (!flat) continue;
    flat_somewhere = true;
    geometry::ArcFitOptions fit = fit_options(options, plane, false);
    fit.running = running_along(run, fair, fit.axis, options);
    fit.at_most = most_pieces(options);
    if (auto plan = plan_in(run, fair, *flat, nullptr, 0, fit, options)) return plan;
  }
  if (flat_somewhere) return std::nullopt;
  // In space the planes differ much: the rows of a raster along X are arcs in G18, and in G17 they
  // are lines and steep little helices. The fewest moves win; the plane in which the run is
  // flattest comes first, so that the others are soon given up. More moves than the run has motions
  // are chords in all but name, and plan_lines does those better.
  const double chords = bends.chords(fit_deviation(options), 0);
  std::optional<OutputPlan> best;
  std::size_t most = std::min(motion_count(run), std::min(options.most_arcs, kAnyNumber) + 1);
  for (const PlaneAxes& plane : flattest_first(run, planes)) {
    geometry::ArcFitOptions fit = fit_options(options, plane, true);
    fit.running = running_along(run, fair, fit.axis, options);
    fit.at_most = most;
    auto plan = plan_in(run, fair, fair.curve, &pieces, chords, fit, options);
    if (!plan || plan->moves.size() >= most) continue;
    if (!options.target->helices && has_helix(*plan)) continue;  // a plunge may be all that rises
    most = plan->moves.size();
    best = std::move(plan);
  }
  return best;
}

double arcs_expected(const Run& run, const geometry::ArcCount& count, const PlanOptions& options) {
  const std::vector<PlaneAxes> planes = arc_planes(options);
  const bool flat = std::ranges::any_of(
      planes, [&](const PlaneAxes& plane) { return lies_across(run, plane.normal); });
  double fewest = std::numeric_limits<double>::infinity();
  for (const PlaneAxes& plane : planes) {
    if (flat && !lies_across(run, plane.normal)) continue;
    fewest =
        std::min(fewest, count.within(fit_deviation(options), arc_grid(options), plane.normal));
  }
  return fewest;
}

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
    OwnChords(run_, fair_, options_).put_into(plan_);
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

namespace {

// An angle of a point on the circle, on the curve: between the vertices there it goes evenly.
double parameter_at(double angle, const geometry::CircleFit& circle,
                    const geometry::SmoothCurve& fair) {
  const auto is_behind = [&](double each) { return std::abs(each) > std::abs(angle); };
  const auto behind =
      std::ranges::find_if(circle.angles.begin() + 1, circle.angles.end() - 1, is_behind);
  const auto next = static_cast<std::size_t>(behind - circle.angles.begin());
  const double before = circle.angles[next - 1];
  const double part = (angle - before) / (circle.angles[next] - before);
  const auto& at = fair.vertex_parameters;
  return at[next - 1] + part * (at[next] - at[next - 1]);
}

std::optional<OutputPlan> plan_circle_in(const Run& run, const geometry::SmoothCurve& fair,
                                         const PlaneAxes& plane, const PlanOptions& options) {
  const Vector3 axis = Vector3::Unit(plane.normal);
  const auto frame = geometry::PlaneFrame::across(axis);
  std::vector<Point2> points;
  points.reserve(run.points.size());
  for (const Point3& p : run.points) points.emplace_back(frame.local(p).head<2>());
  const auto circle = geometry::fit_circle(points, fit_deviation(options));
  if (!circle) return std::nullopt;
  const double height = run.points.front()[plane.normal];
  const Point3 center = frame.global({circle->center.x(), circle->center.y(), height});
  const Vector3 out = run.points.front() - center;
  const double sweep = circle->angles.back();
  const int count = static_cast<int>(std::ceil(std::abs(sweep) / kPlans.circle_arc - 1e-9));
  OutputPlan plan;
  plan.form = Form::kArcs;
  double angle = 0;
  Point3 start = run.points.front();
  for (int i = 1; i <= count; ++i) {
    const Point3 end =
        i < count ? center + Eigen::AngleAxisd(sweep * i / count, axis) * out : run.points.back();
    const geometry::Arc arc{start, end, center, axis, sweep / count};
    for (const geometry::Arc& part : geometry::arc_parts(arc, parts_for(arc, *options.target))) {
      if (!gcode::arc_refusal(*options.target, part, options.units).empty()) return std::nullopt;
      plan.moves.push_back({part, run.feeds.front().feed, {}, parameter_at(angle, *circle, fair)});
      angle += part.sweep;
    }
    start = end;
  }
  OwnChords(run, fair, options).put_into(plan);
  if (!plan.arcs_as_chords) plan.off_circle = circle->rms;
  place_comments(run, fair, plan);
  return plan;
}

}  // namespace

std::optional<OutputPlan> plan_circle(const Run& run, const geometry::SmoothCurve& fair,
                                      const PlanOptions& options) {
  if (!run.bends.empty() || feed_sections(run, fair).size() > 1) return std::nullopt;
  for (const PlaneAxes& plane : arc_planes(options)) {
    if (!lies_across(run, plane.normal)) continue;
    auto plan = plan_circle_in(run, fair, plane, options);
    if (plan && plan->moves.size() <= options.most_arcs) return plan;
  }
  return std::nullopt;
}

}  // namespace batten::postproc
