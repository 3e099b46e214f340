#include "geometry/arcs/arc_fit.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>
#include <numbers>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include "geometry/arcs/arc_chain.h"
#include "geometry/arcs/arc_spline.h"
#include "geometry/basic/rounding.h"
#include "geometry/distance/chord_polyline.h"
#include "geometry/path/curve_pieces.h"
#include "geometry/path/plane_curve.h"

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

  // From the curve's start to `last`.
  std::vector<Stretch> cut(const MarkedPieces& marked, double last) const {
    std::vector<double> corners = marked.corners;
    corners.erase(std::lower_bound(corners.begin(), corners.end(), last), corners.end());
    corners.push_back(last);
    const std::vector<StraightRun>& runs = marked.straight_runs;
    std::vector<Stretch> stretches;
    auto run = runs.begin();
    double at = marked.pieces.first();
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
    const double length = (curve_.point_at(run.to) - curve_.point_at(run.from)).norm();
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
    const ChainNode start{from, chain_.rounded(curve_.point_at(from)), curve_.angle_at(from)};
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
    Point3 place = curve.point_at(u);
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

// Off the plane most curves are no helices: arcs that are more than chords would be do not
// pay. In the plane arcs are worth more than chords, since their tangents agree.
std::size_t most_pieces(double chords, std::size_t stretches, const ArcFitOptions& options,
                        bool flat) {
  if (flat) return std::numeric_limits<std::size_t>::max();
  return std::min(stretches + static_cast<std::size_t>(chords), options.at_most);
}

// How far the pieces reach along an axis, mm.
double range_along(const CurvePieces& pieces, const Vector3& axis) {
  double least = axis.dot(pieces.piece(0).control[0]);
  double greatest = least;
  for (std::size_t i = 0; i < pieces.size(); ++i) {
    for (const Point3& control : pieces.piece(i).control) {
      least = std::min(least, axis.dot(control));
      greatest = std::max(greatest, axis.dot(control));
    }
  }
  return greatest - least;
}

// Whether a chain off the plane falls so far behind on so many pieces that it would be given up,
// however well it went afterwards: most are, and so only they are looked at closely.
constexpr std::size_t kFirstPieces = 1500;

// A try need not know better than this how many arcs there will be.
constexpr double kPrecisionOfTries = 0.03;

// One curve, chained in one plane.
class ArcFit {
 public:
  ArcFit(const MarkedPieces& marked, double chords, const ArcFitOptions& options)
      : marked_(marked),
        chords_(chords),
        options_(options),
        frame_(PlaneFrame::across(options.axis)),
        flat_(range_along(marked.pieces, options.axis) <= kOneHeight) {
    limits_.deviation = options.max_deviation * (flat_ ? 1.0 : kPlaneShare);
    limits_.height_deviation = options.max_deviation * kHeightShare;
    limits_.min_radius = options.min_radius;
    limits_.max_radius = options.max_radius;
    limits_.max_sweep = options.max_sweep;
    limits_.grid = options.grid;
    limits_.flat = flat_;
  }

  [[nodiscard]] bool is_flat() const { return flat_; }

  // Whether the first pieces already take so many arcs that the whole would be given up behind
  // them.
  [[nodiscard]] bool falls_behind_early() const {
    const double end = marked_.pieces.breaks()[kFirstPieces];
    const PlaneCurve first(marked_.pieces, kFirstPieces, frame_);
    ArcChainLimits limits = limits_;
    limits.precision = kPrecisionOfTries;
    const ArcChain chain(first, limits);
    std::vector<Stretch> stretches = ArcCutter(first, chain, options_.grid).cut(marked_, end);
    const std::vector<Stop> stops = stops_of(first, chain, stretches, flat_);
    // The last one goes on behind these pieces. Of the others there are no more than at corners and
    // about straight runs.
    const Stretch last = stretches.back();
    stretches.pop_back();
    const auto runs = std::ranges::count_if(
        marked_.straight_runs, [this](const StraightRun& run) { return has_direction(run); });
    const std::size_t most_stretches =
        marked_.corners.size() + 2 * static_cast<std::size_t>(runs) + 2;
    const std::size_t most = most_pieces(chords_, most_stretches, options_, flat_);
    std::size_t left = most;
    if (!path_along(chain, stretches, stops, most, left)) return true;
    if (last.straight) return false;
    const ChainNode from{last.from, stops[stretches.size()].place, stops[stretches.size()].leaving};
    const ChainNode to{last.to, stops.back().place, stops.back().arriving};
    return chain.fails_before(from, to, end_of_stretch(end), left);
  }

  [[nodiscard]] std::optional<Path> chain() const {
    const PlaneCurve whole(marked_.pieces, marked_.pieces.size(), frame_);
    const ArcChain chain(whole, limits_);
    const std::vector<Stretch> stretches =
        ArcCutter(whole, chain, options_.grid).cut(marked_, marked_.pieces.last());
    const std::vector<Stop> stops = stops_of(whole, chain, stretches, flat_);
    const std::size_t most = most_pieces(chords_, stretches.size(), options_, flat_);
    std::size_t left = most;
    return path_along(chain, stretches, stops, most, left);
  }

 private:
  // Where the smooth stretch that holds u ends, or before: at the next corner or straight run.
  [[nodiscard]] double end_of_stretch(double u) const {
    double end = marked_.pieces.last();
    const auto corner = std::ranges::upper_bound(marked_.corners, u);
    if (corner != marked_.corners.end()) end = std::min(end, *corner);
    auto run = std::ranges::upper_bound(marked_.straight_runs, u, {}, &StraightRun::from);
    while (run != marked_.straight_runs.end() && !has_direction(*run)) ++run;
    if (run != marked_.straight_runs.end()) end = std::min(end, run->from);
    return end;
  }

  // Whether the run may stay a line (ArcCutter asks more of it).
  [[nodiscard]] bool has_direction(const StraightRun& run) const {
    const Vector3 way = marked_.pieces.point_at(run.to) - marked_.pieces.point_at(run.from);
    return way.norm() >= kLeastRunInGrids * options_.grid;
  }

  // `left`: of `most` pieces, those that may still be used.
  [[nodiscard]] std::optional<Path> path_along(const ArcChain& chain,
                                               const std::vector<Stretch>& stretches,
                                               const std::vector<Stop>& stops, std::size_t most,
                                               std::size_t& left) const {
    const double from = marked_.pieces.first();
    const double length = marked_.pieces.last() - from;
    PathBuilder builder(frame_, options_.axis, marked_.pieces.piece(0).control[0]);
    for (std::size_t i = 0; i < stretches.size(); ++i) {
      const Stretch& stretch = stretches[i];
      if (stretch.straight) {
        builder.add_line(stops[i + 1].place);
        continue;
      }
      const ChainNode start{stretch.from, stops[i].place, stops[i].leaving};
      const ChainNode end{stretch.to, stops[i + 1].place, stops[i + 1].arriving};
      auto pieces =
          flat_ ? spline_between(marked_.pieces, frame_, start, end, limits_, options_.effort)
                : std::nullopt;
      if (!pieces) pieces = chain.between(start, end, left);
      if (!pieces) return std::nullopt;
      left -= pieces->size();
      if (falls_behind((stretch.to - from) / length, most - left, most)) return std::nullopt;
      for (const ChainPiece& piece : *pieces) builder.add(piece);
    }
    return builder.take();
  }

  const MarkedPieces& marked_;
  double chords_;
  const ArcFitOptions& options_;
  PlaneFrame frame_;
  bool flat_;
  ArcChainLimits limits_;
};

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
  const bool whole = from == curve.first() && to == curve.last();
  const BsplineCurve part = whole ? curve : curve.part(from, to);
  const MarkedPieces pieces(part, from, to);
  return fit_arcs(pieces, chords_along(pieces.pieces, options.max_deviation), options);
}

std::optional<Path> fit_arcs(const MarkedPieces& pieces, double chords,
                             const ArcFitOptions& options) {
  check(options);
  const ArcFit fit(pieces, chords, options);
  if (!fit.is_flat() && !options.helical) return std::nullopt;
  if (!fit.is_flat() && pieces.pieces.size() > 2 * kFirstPieces && fit.falls_behind_early()) {
    return std::nullopt;
  }
  return fit.chain();
}

double chords_along(const CurvePieces& pieces, double deviation) {
  constexpr int kParts = 3;
  double chords = 0;
  for (std::size_t i = 0; i < pieces.size(); ++i) {
    const CubicBezier& piece = pieces.piece(i);
    for (int k = 0; k < kParts; ++k) {
      const double from = static_cast<double>(k) / kParts;
      const double to = static_cast<double>(k + 1) / kParts;
      const double length = (point_at(piece, to) - point_at(piece, from)).norm();
      // The integral of sqrt(curvature / 8 deviation) along the curve.
      chords += length * std::sqrt(curvature_at(piece, (from + to) / 2) / (8 * deviation));
    }
  }
  return chords;
}

}  // namespace batten::geometry
