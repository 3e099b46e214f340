#include <algorithm>
#include <cmath>
#include <utility>

#include "gcode/curves/curve_format.h"
#include "geometry/basic/rounding.h"
#include "geometry/chords/linearize.h"
#include "geometry/fitting/fewer_knots.h"
#include "geometry/path/curve_pieces.h"
#include "postproc/smooth/forms/output_plan.h"

namespace batten::postproc {
namespace {

using geometry::BsplineCurve;
using geometry::CubicBezier;
using geometry::CurvePieces;
using geometry::Point3;
using geometry::Vector3;

// What is one thing in the program.
struct CurvePart {
  double from = 0;
  double to = 0;
  bool straight = false;
  bool starts_free = false;  // at a corner, or at an end of the run: any direction will do
  bool ends_free = false;
};

// Exactly at the height of the run where all its points have one. Rounding noise of the curve
// would name an axis that never moves.
BsplineCurve laid_level(const Run& run, const BsplineCurve& curve) {
  std::vector<Point3> points = curve.control_points();
  for (int axis = 0; axis < 3; ++axis) {
    if (!lies_across(run, axis)) continue;
    for (Point3& point : points) point[axis] = run.points.front()[axis];
  }
  return {curve.basis(), std::move(points)};
}

class CurvePlanner {
 public:
  CurvePlanner(const Run& run, const geometry::SmoothCurve& fair, const PlanOptions& options,
               const gcode::CurveFormat& format)
      : run_(run), fair_(fair), options_(options), format_(format), curve_(curve_for(run, fair)) {}

  std::optional<OutputPlan> plan() {
    plan_.form = Form::kCurves;
    place_ = run_.points.front();
    for (const FeedSection& section : feed_sections(run_, fair_)) {
      feed_ = section.feed;
      for (const CurvePart& part : parts_of(section)) add(part);
    }
    if (plan_.curves.empty()) return std::nullopt;
    place_comments(run_, fair_, plan_);
    return std::move(plan_);
  }

 private:
  [[nodiscard]] BsplineCurve curve_for(const Run& run, const geometry::SmoothCurve& fair) const {
    geometry::FewerKnotsOptions fewer;
    const double for_control = format_.is_run_as_chords ? kPlans.for_control : 0;
    fewer.max_deviation = (1 - kPlans.curve_chords - for_control) * options_.max_deviation;
    fewer.long_line = kPlans.long_line;
    for (const FeedFrom& change : run.feeds) {
      fewer.places.push_back(fair.vertex_parameters.at(change.vertex));
    }
    const auto reduced = geometry::on_fewer_knots(fair.curve, fewer);
    return laid_level(run, reduced ? *reduced : fair.curve);
  }

  [[nodiscard]] bool is_line(const geometry::StraightRun& straight) const {
    if (format_.is_block_per_piece) return true;
    const Point3 way = curve_.point_at(straight.to) - curve_.point_at(straight.from);
    return way.norm() >= kPlans.long_line;
  }

  [[nodiscard]] double knot_noise() const {
    return geometry::kSameKnot * (curve_.last() - curve_.first());
  }

  // Cut at corners and at lines.
  [[nodiscard]] std::vector<CurvePart> parts_of(const FeedSection& section) const {
    const CurvePieces pieces(curve_, section.from, section.to);
    std::vector<CurvePart> parts;
    double done = section.from;
    const double noise = knot_noise();
    const auto bend_to = [&](double end) {
      if (end > done + noise) parts.push_back({.from = done, .to = end});
      done = std::max(done, end);
    };
    const std::vector<double> corners = pieces.corners();
    auto corner = corners.begin();
    for (const geometry::StraightRun& straight : pieces.straight_runs()) {
      if (!is_line(straight)) continue;
      for (; corner != corners.end() && *corner <= straight.from; ++corner) bend_to(*corner);
      bend_to(straight.from);
      parts.push_back({.from = straight.from, .to = straight.to, .straight = true});
      done = straight.to;
    }
    for (; corner != corners.end(); ++corner) bend_to(*corner);
    bend_to(section.to);
    for (CurvePart& part : parts) {
      part.starts_free = is_free(part.from, corners);
      part.ends_free = is_free(part.to, corners);
    }
    return parts;
  }

  [[nodiscard]] bool is_free(double place, const std::vector<double>& corners) const {
    const double noise = knot_noise();
    const auto here = [&](double other) { return std::abs(place - other) <= noise; };
    return here(curve_.first()) || here(curve_.last()) || std::ranges::any_of(corners, here);
  }

  void add(const CurvePart& part) {
    if (part.straight || is_as_good_as_straight(part)) return add_line(part.from, part.to);
    const BsplineCurve curve = curve_.part(part.from, part.to);
    const std::vector<CubicBezier> pieces = curve.bezier_pieces();
    const bool all_taken =
        std::ranges::all_of(pieces, [&](const CubicBezier& piece) { return is_taken(piece); });
    if (!all_taken) return add_piece_by_piece(curve);
    add_curve(curve, curve.first(), curve.last());
  }

  // A line along the part keeps what chords have to keep, and where the part goes on smoothly it
  // makes no kink: the noise of straight lines is no curve.
  [[nodiscard]] bool is_as_good_as_straight(const CurvePart& part) const {
    const Point3 start = curve_.point_at(part.from);
    const Vector3 way = curve_.point_at(part.to) - start;
    const double length = way.norm();
    if (!(length > 0)) return false;
    const Vector3 along = way / length;
    const BsplineCurve fair = fair_.curve.part(part.from, part.to);
    const std::vector<Point3>& points = fair.control_points();
    double done = 0;
    for (std::size_t i = 1; i + 1 < points.size(); ++i) {
      const Vector3 offset = points[i] - start;
      const double forward = offset.dot(along);
      const bool in_order = forward >= done && forward <= length;
      if (!in_order || (offset - forward * along).norm() > options_.max_deviation) return false;
      done = forward;
    }
    const auto bends = [&](const Point3& from, const Point3& to) {
      return (to - from).cross(along).norm() > kPlans.no_kink * (to - from).norm();
    };
    return (part.starts_free || !bends(points[0], points[1])) &&
           (part.ends_free || !bends(points[points.size() - 2], points.back()));
  }

  // The control takes it, and runs it near enough.
  [[nodiscard]] bool is_taken(const CubicBezier& piece) const {
    return format_.takes(piece) &&
           format_.chords_error(piece) <= kPlans.for_control * options_.max_deviation;
  }

  void add_piece_by_piece(const BsplineCurve& curve) {
    const std::vector<double> breaks = curve.breakpoints();
    for (std::size_t i = 0; i + 1 < breaks.size(); ++i) {
      add_taken(curve, breaks[i], breaks[i + 1], kPlans.halvings);
    }
  }

  // Within one span.
  void add_taken(const BsplineCurve& curve, double from, double to, int halvings) {
    if (to - from <= knot_noise()) return;  // two knots that rounding has parted
    const std::vector<CubicBezier> piece = curve.part(from, to).bezier_pieces();
    if (piece.size() == 1 && is_taken(piece.front())) return add_curve(curve, from, to);
    if (halvings == 0) return add_chords(curve, from, to);
    const double middle = 0.5 * (from + to);
    add_taken(curve, from, middle, halvings - 1);
    add_taken(curve, middle, to, halvings - 1);
  }

  void add_curve(const BsplineCurve& curve, double from, double to) {
    if (!(from < to)) return;
    BsplineCurve part = curve.part(from, to);
    const std::vector<CubicBezier> pieces = part.bezier_pieces();
    const std::vector<double> breaks = part.breakpoints();
    const std::size_t first = plan_.moves.size();
    for (std::size_t i = 0; i < pieces.size(); ++i) {
      plan_.moves.push_back({pieces[i], feed_, {}, breaks[i]});
    }
    place_ = pieces.back().control[3];
    plan_.curves.push_back({first, pieces.size(), std::move(part)});
  }

  void add_chords(const BsplineCurve& curve, double from, double to) {
    const double deviation = kPlans.curve_chords * options_.max_deviation;
    const std::vector<double> vertices =
        geometry::chord_vertices(curve, from, to, {.max_deviation = deviation});
    for (std::size_t i = 0; i + 1 < vertices.size(); ++i) add_line(vertices[i], vertices[i + 1]);
  }

  void add_line(double from, double to) {
    const bool last = to >= curve_.last();
    const Point3 end = last ? run_.points.back() : curve_.point_at(to);
    plan_.moves.push_back({geometry::Line{place_, end}, feed_, {}, from});
    place_ = end;
  }

  const Run& run_;
  const geometry::SmoothCurve& fair_;
  const PlanOptions& options_;
  const gcode::CurveFormat& format_;
  BsplineCurve curve_;
  double feed_ = 0;
  Point3 place_ = Point3::Zero();
  OutputPlan plan_;
};

}  // namespace

double curves_expected(const geometry::MarkedPieces& pieces, const PlanOptions& options) {
  return geometry::spans_expected(pieces.pieces, options.max_deviation);
}

std::optional<OutputPlan> plan_curves(const Run& run, const geometry::SmoothCurve& fair,
                                      const PlanOptions& options) {
  const gcode::CurveFormat* format = options.target->curves;
  if (format == nullptr) return std::nullopt;
  return CurvePlanner(run, fair, options, *format).plan();
}

}  // namespace batten::postproc
