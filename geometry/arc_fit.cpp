#include "geometry/arc_fit.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>
#include <numbers>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include "geometry/arc_chain.h"
#include "geometry/arc_spline.h"
#include "geometry/chord_polyline.h"
#include "geometry/curve_pieces.h"
#include "geometry/numeric.h"
#include "geometry/plane_curve.h"

namespace batten::geometry {
namespace {

// Heights that differ by no more than this (mm) are one height: the last decimal that any
// program carries.
constexpr double kOneHeight = 1e-6;

// The two parts of the deviation of a helix are at right angles: 0.8^2 + 0.6^2 = 1.
constexpr double kPlaneShare = 0.8;
constexpr double kHeightShare = 0.6;

// Arcs that hold a straight run and half as much again besides are not stopped by it.
constexpr double kBeyondRun = 1.5;

// A straight run shorter than this (in grid units) would have its direction from rounding.
constexpr double kLeastRunInGrids = 50;

double near_angle(double angle, double to) {
  return to + std::remainder(angle - to, 2 * std::numbers::pi);
}

struct Stretch {
  double from;
  double to;
  bool straight;
};

// The curve cut into straight runs and smooth stretches between corners.
class ArcCutter {
 public:
  ArcCutter(const PlaneCurve& curve, const ArcChain& chain, double grid)
      : curve_(curve), chain_(chain), grid_(grid) {}

  std::vector<Stretch> cut(const CurvePieces& pieces) const {
    std::vector<double> corners = pieces.corners();
    corners.push_back(pieces.last());
    const std::vector<StraightRun> runs = pieces.straight_runs();
    std::vector<Stretch> stretches;
    auto run = runs.begin();
    double at = pieces.first();
    for (double corner : corners) {
      const double section = at;
      for (; run != runs.end() && run->to <= corner; ++run) {
        if (!stays(*run, section, corner)) continue;
        if (run->from > at) stretches.push_back({at, run->from, false});
        stretches.push_back({run->from, run->to, true});
        at = run->to;
      }
      if (corner > at) stretches.push_back({at, corner, false});
      at = corner;
    }
    return stretches;
  }

 private:
  // A run stays a line unless a pair of arcs from one of its ends reaches well beyond the
  // other one. `first` and `last`: the corners about the run.
  bool stays(const StraightRun& run, double first, double last) const {
    const double width = run.to - run.from;
    const double length = (curve_.place_at(run.to) - curve_.place_at(run.from)).norm();
    if (length < kLeastRunInGrids * grid_) return false;
    const double extra = (kBeyondRun - 1) * width;
    const bool room_after = run.to + extra <= last;
    const bool room_before = run.from - extra >= first;
    if (room_after && reaches(run.from, std::min(run.to + kBeyondRun * width, last))) return false;
    if (room_before && reaches(std::max(run.from - kBeyondRun * width, first), run.to)) {
      return false;
    }
    return true;
  }

  bool reaches(double from, double to) const {
    const ChainNode start{from, chain_.rounded(curve_.place_at(from)), curve_.angle_at(from)};
    return chain_.pair_to(start, to).has_value();
  }

  const PlaneCurve& curve_;
  const ArcChain& chain_;
  double grid_;
};

struct Stop {
  Point3 place;     // local
  double arriving;  // angles of the tangent
  double leaving;
};

// The places between stretches, rounded; next to a straight run the tangent is the run's,
// as rounding has turned it.
std::vector<Stop> stops_of(const PlaneCurve& curve, const ArcChain& chain,
                           const std::vector<Stretch>& stretches, bool flat) {
  std::vector<Stop> stops;
  const auto add = [&](double u, bool exact) {
    Point3 place = curve.place_at(u);
    if (!exact) {
      const double height = stops.front().place.z();
      place = chain.rounded(place);
      if (flat) place.z() = height;
    }
    stops.push_back({place, curve.angle_before(u), curve.angle_at(u)});
  };
  add(stretches.front().from, true);
  for (const Stretch& stretch : stretches) add(stretch.to, &stretch == &stretches.back());
  for (std::size_t i = 0; i < stretches.size(); ++i) {
    if (!stretches[i].straight) continue;
    Stop& start = stops[i];
    Stop& end = stops[i + 1];
    const Vector2 along = (end.place - start.place).head<2>();
    if (along.norm() < kOneHeight) continue;  // along the axis: no direction in the plane
    const double angle = std::atan2(along.y(), along.x());
    const bool smooth_start = std::abs(start.leaving - start.arriving) <= kCornerAngle;
    const bool smooth_end = std::abs(end.leaving - end.arriving) <= kCornerAngle;
    const double leaving = near_angle(angle, start.leaving);
    const double arriving = near_angle(angle, end.arriving);
    if (smooth_start) start.arriving = leaving;
    if (smooth_end) end.leaving = arriving;
    start.leaving = leaving;
    end.arriving = arriving;
  }
  return stops;
}

// Appends pieces, each from where the last one ended.
class PathBuilder {
 public:
  PathBuilder(const PlaneFrame& frame, const Vector3& axis, const Point3& start)
      : frame_(frame), axis_(axis), at_(start) {}

  void add_line(const Point3& local_end) {
    const Point3 end = frame_.global(local_end);
    path_.push_back(Line{at_, end});
    at_ = end;
  }

  void add(const ChainPiece& piece) {
    const Point3 end(piece.arc.end.x(), piece.arc.end.y(), piece.end_height);
    if (piece.arc.is_line()) {
      add_line(end);
      return;
    }
    const Point3 center =
        frame_.global({piece.arc.center.x(), piece.arc.center.y(), piece.end_height});
    const Point3 global_end = frame_.global(end);
    path_.push_back(Arc{at_, global_end, center, axis_, piece.arc.sweep});
    at_ = global_end;
  }

  Path take() { return std::move(path_); }

 private:
  PlaneFrame frame_;
  Vector3 axis_;
  Point3 at_;
  Path path_;
};

// In the plane the curve is held against chords that leave it by no more than this part of
// the deviation: below what the band takes for one edge without places between (plane_band.cpp).
constexpr double kChordPart = 0.018;

Path between(const CurvePieces& pieces, double from, double to) {
  Path path;
  for (std::size_t i = pieces.index_of(from); i < pieces.size() && pieces.breaks()[i] < to; ++i) {
    path.emplace_back(pieces.part(i, from, to));
  }
  return path;
}

// The fewest arcs found for one smooth stretch of a flat curve; nothing when the search finds
// no tangent chain.
std::optional<std::vector<ChainPiece>> spline_between(const CurvePieces& curve,
                                                      const PlaneFrame& frame,
                                                      const ChainNode& start, const ChainNode& end,
                                                      const ArcChainLimits& limits,
                                                      ArcEffort effort) {
  const Path stretch = between(curve, start.u, end.u);
  std::vector<Point2> points;
  for (const Point3& place : cut_into_chords(stretch, kChordPart * limits.deviation).points) {
    const Point2 p = frame.local(place).head<2>();
    if (points.empty() || (p - points.back()).norm() > kSamePlace) points.push_back(p);
  }
  if (points.size() < 2) return std::nullopt;
  points.front() = start.place.head<2>();
  points.back() = end.place.head<2>();
  ArcSplineOptions options;
  options.tolerance = (1 - kChordPart) * limits.deviation;
  options.min_radius = limits.min_radius;
  options.max_radius = limits.max_radius;
  options.max_sweep = limits.max_sweep;
  options.grid = limits.grid;
  options.start_angle = start.angle;
  options.end_angle = end.angle;
  options.kinks = false;
  options.effort = effort;
  const auto spline = fit_arc_spline(points, options);
  if (!spline) return std::nullopt;
  std::vector<ChainPiece> pieces;
  for (const ArcSplinePiece& piece : spline->pieces) {
    pieces.push_back({piece.arc, start.place.z(), 0});
  }
  return pieces;
}

// About how many chords the curve takes: the integral of sqrt(curvature / 8 deviation) along it.
double about_chords(const CurvePieces& pieces, double deviation) {
  constexpr int kParts = 3;
  double chords = 0;
  for (std::size_t i = 0; i < pieces.size(); ++i) {
    const CubicBezier& piece = pieces.piece(i);
    for (int k = 0; k < kParts; ++k) {
      const double from = static_cast<double>(k) / kParts;
      const double to = static_cast<double>(k + 1) / kParts;
      const double length = (point_at(piece, to) - point_at(piece, from)).norm();
      chords += length * std::sqrt(curvature_at(piece, (from + to) / 2) / (8 * deviation));
    }
  }
  return chords;
}

// Off the plane most curves are no helices: arcs that are more than chords would be do not
// pay. In the plane arcs are worth more than chords, since their tangents agree.
std::size_t most_pieces(const CurvePieces& pieces, std::size_t stretches,
                        const ArcFitOptions& options, bool flat) {
  if (flat) return std::numeric_limits<std::size_t>::max();
  const auto chords = static_cast<std::size_t>(about_chords(pieces, options.max_deviation));
  return std::min(stretches + chords, options.at_most);
}

void check(const ArcFitOptions& options) {
  if (!(options.max_deviation > 0)) {
    throw std::invalid_argument("fit_arcs: max_deviation " + std::to_string(options.max_deviation) +
                                ", expected > 0");
  }
  if (!(options.max_sweep > 0 && options.max_sweep < std::numbers::pi)) {
    throw std::invalid_argument("fit_arcs: max_sweep " + std::to_string(options.max_sweep) +
                                ", expected above 0 and below pi");
  }
}

}  // namespace

std::optional<Path> fit_arcs(const BsplineCurve& curve, double from, double to,
                             const ArcFitOptions& options) {
  check(options);
  const PlaneFrame frame = PlaneFrame::across(options.axis);
  const PlaneCurve plane_curve(curve, from, to, frame);
  const bool flat = plane_curve.height_range() <= kOneHeight;
  if (!flat && !options.helical) return std::nullopt;

  ArcChainLimits limits;
  limits.deviation = options.max_deviation * (flat ? 1.0 : kPlaneShare);
  limits.height_deviation = options.max_deviation * kHeightShare;
  limits.min_radius = options.min_radius;
  limits.max_radius = options.max_radius;
  limits.max_sweep = options.max_sweep;
  limits.grid = options.grid;
  limits.flat = flat;
  const ArcChain chain(plane_curve, limits);

  const CurvePieces all(curve, from, to);
  const std::vector<Stretch> stretches = ArcCutter(plane_curve, chain, options.grid).cut(all);
  const std::vector<Stop> stops = stops_of(plane_curve, chain, stretches, flat);

  PathBuilder builder(frame, options.axis, curve.point_at(from));
  const std::size_t most = most_pieces(all, stretches.size(), options, flat);
  std::size_t left = most;
  for (std::size_t i = 0; i < stretches.size(); ++i) {
    const Stretch& stretch = stretches[i];
    if (stretch.straight) {
      builder.add_line(stops[i + 1].place);
      continue;
    }
    const ChainNode start{stretch.from, stops[i].place, stops[i].leaving};
    const ChainNode end{stretch.to, stops[i + 1].place, stops[i + 1].arriving};
    auto pieces =
        flat ? spline_between(all, frame, start, end, limits, options.effort) : std::nullopt;
    if (!pieces) pieces = chain.between(start, end, left);
    if (!pieces) return std::nullopt;
    left -= pieces->size();
    if (falls_behind((stretch.to - from) / (to - from), most - left, most)) return std::nullopt;
    for (const ChainPiece& piece : *pieces) builder.add(piece);
  }
  return builder.take();
}

}  // namespace batten::geometry
