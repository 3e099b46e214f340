#include "geometry/arcs/arc_fit.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <vector>

#include "geometry/arcs/arc_chain.h"
#include "geometry/basic/require.h"
#include "geometry/basic/rounding.h"
#include "geometry/distance/chord_polyline.h"
#include "geometry/path/plane_curve.h"

namespace batten::geometry {
namespace {

constexpr ArcFitTuning kFit = kArcFitTuning;

double near_angle(double angle, double to) {
  return to + std::remainder(angle - to, 2 * std::numbers::pi);
}

// A straight run of the curve, or what is smooth between runs and corners.
struct ArcSection {
  double from;
  double to;
  bool straight;
};

// Where two sections meet.
struct ArcStop {
  Point3 place;     // local
  double arriving;  // angles of the tangent
  double leaving;
};

Path between(const CurvePieces& pieces, double from, double to) {
  Path path;
  for (std::size_t i = pieces.index_of(from); i < pieces.size() && pieces.breaks()[i] < to; ++i) {
    path.emplace_back(pieces.part(i, from, to));
  }
  return path;
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

double length_of(const std::vector<Point2>& points) {
  double length = 0;
  for (std::size_t i = 1; i < points.size(); ++i) length += (points[i] - points[i - 1]).norm();
  return length;
}

// What is left across of `whole` where so much is used up along the axis.
double beside(double along, double whole) {
  return whole > along ? std::sqrt(whole * whole - along * along) : 0;
}

// One curve, chained in one plane.
class ArcFit {
 public:
  ArcFit(const MarkedPieces& marked, double chords, const ArcFitOptions& options, bool flat)
      : marked_(marked),
        chords_(chords),
        options_(options),
        flat_(flat),
        frame_(PlaneFrame::across(options.axis)),
        curve_(marked.pieces, frame_) {
    limits_.ArcRange::operator=(options);
    limits_.deviation = options.max_deviation * (flat_ ? 1.0 : kFit.plane_share);
    limits_.height_deviation = options.max_deviation * kFit.height_share;
    limits_.flat = flat_;
    if (!flat_ && limits_.running.error) {
      limits_.running.room = [room = options.running.room, along = limits_.height_deviation](
                                 double u0, double u1) {
        ArcRunning::Room there = room(u0, u1);
        there.left = beside(along, there.left);
        there.right = beside(along, there.right);
        return there;
      };
    }
  }

  // Nothing where it takes too many arcs.
  [[nodiscard]] std::optional<Path> path() const {
    const std::vector<ArcSection> sections = cut();
    const std::vector<ArcStop> stops = stops_of(sections);
    // Off the plane most curves are no helices: arcs that are more than chords would be do not
    // pay. In the plane arcs are worth more than chords, since their tangents agree.
    const std::size_t most =
        flat_ ? options_.at_most
              : std::min(sections.size() + static_cast<std::size_t>(chords_), options_.at_most);
    std::size_t left = most;
    const double from = marked_.pieces.first();
    const double length = marked_.pieces.last() - from;
    std::vector<Chain> chains;
    for (std::size_t i = 0; i < sections.size(); ++i) {
      if (left == 0) return std::nullopt;
      auto chain = chain_of(sections[i], stops[i], stops[i + 1], left);
      if (!chain) return std::nullopt;
      left -= chain->pieces.size();
      if (!flat_ && falls_behind((sections[i].to - from) / length, most - left, most)) {
        return std::nullopt;
      }
      chains.push_back(std::move(*chain));
    }
    Path path;
    for (Chain& chain : chains) {
      if (chain.greedy && options_.effort != ArcEffort::kBrief) {
        chain.pieces = balanced(curve_, limits_, chain.start, chain.end, std::move(chain.pieces));
      }
      for (const ChainPiece& piece : chain.pieces) append(piece.arc, piece.end_height, path);
    }
    return path;
  }

 private:
  struct Chain {  // of a section
    ChainNode start;
    ChainNode end;
    std::vector<ChainPiece> pieces;
    bool greedy = false;  // by arc_chain
  };

  [[nodiscard]] std::optional<Chain> chain_of(const ArcSection& section, const ArcStop& from,
                                              const ArcStop& to, std::size_t at_most) const {
    Chain chain{{section.from, from.place, from.leaving}, {section.to, to.place, to.arriving}, {}};
    if (section.straight) {
      chain.pieces = {{{Point2::Zero(), to.place.head<2>()}, to.place.z()}};
      return chain;
    }
    auto pieces = flat_ ? spline_between(chain.start, chain.end, at_most) : std::nullopt;
    if (!pieces) {
      pieces = arc_chain(curve_, limits_, chain.start, chain.end, at_most);
      chain.greedy = true;
    }
    if (!pieces) return std::nullopt;
    chain.pieces = std::move(*pieces);
    return chain;
  }

  [[nodiscard]] std::vector<ArcSection> cut() const {
    std::vector<double> corners = marked_.corners;
    corners.push_back(marked_.pieces.last());
    std::vector<ArcSection> sections;
    auto run = marked_.straight_runs.begin();
    double at = marked_.pieces.first();
    for (double corner : corners) {
      const double first = at;
      for (; run != marked_.straight_runs.end() && run->to <= corner; ++run) {
        if (!stays(*run, first, corner)) continue;
        if (run->from > at) sections.push_back({at, run->from, false});
        sections.push_back({run->from, run->to, true});
        at = run->to;
      }
      if (corner > at) sections.push_back({at, corner, false});
      at = corner;
    }
    return sections;
  }

  // A run stays a line unless a pair of arcs from one of its ends reaches well beyond the
  // other one. `first` and `last`: the corners about the run.
  [[nodiscard]] bool stays(const StraightRun& run, double first, double last) const {
    const double width = run.to - run.from;
    const double length = (curve_.point_at(run.to) - curve_.point_at(run.from)).norm();
    if (length < kFit.least_run_in_grids * options_.grid) return false;
    const double extra = (kFit.beyond_run - 1) * width;
    const auto reaches = [this](double from, double to) {
      return pair_of_arcs_holds(curve_, limits_, from, to);
    };
    if (run.to + extra <= last &&
        reaches(run.from, std::min(run.to + kFit.beyond_run * width, last))) {
      return false;
    }
    return !(run.from - extra >= first &&
             reaches(std::max(run.from - kFit.beyond_run * width, first), run.to));
  }

  // Where the sections meet, rounded; next to a straight run the tangent is the run's,
  // as rounding has turned it.
  [[nodiscard]] std::vector<ArcStop> stops_of(const std::vector<ArcSection>& sections) const {
    std::vector<ArcStop> stops;
    const auto add = [&](double u, bool exact) {
      Point3 place = curve_.point_at(u);
      if (!exact) {
        place = rounded_to(options_.grid, place);
        if (flat_) place.z() = stops.front().place.z();
      }
      stops.push_back({place, curve_.angle_before(u), curve_.angle_at(u)});
    };
    add(sections.front().from, true);
    for (const ArcSection& section : sections) add(section.to, &section == &sections.back());
    for (std::size_t i = 0; i < sections.size(); ++i) {
      if (!sections[i].straight) continue;
      ArcStop& start = stops[i];
      ArcStop& end = stops[i + 1];
      const Vector2 along = (end.place - start.place).head<2>();
      if (along.norm() < kFit.one_height) continue;  // along the axis: no direction in the plane
      const double angle = std::atan2(along.y(), along.x());
      const bool smooth_start = std::abs(start.leaving - start.arriving) <= kCornerAngle;
      const bool smooth_end = std::abs(end.leaving - end.arriving) <= kCornerAngle;
      start.leaving = near_angle(angle, start.leaving);
      end.arriving = near_angle(angle, end.arriving);
      if (smooth_start) start.arriving = start.leaving;
      if (smooth_end) end.leaving = end.arriving;
    }
    return stops;
  }

  // The fewest arcs found for one smooth section of a flat curve; nothing when the search finds
  // no tangent chain of so few.
  [[nodiscard]] std::optional<std::vector<ChainPiece>> spline_between(const ChainNode& start,
                                                                      const ChainNode& end,
                                                                      std::size_t at_most) const {
    const Path section = between(marked_.pieces, start.u, end.u);
    std::vector<Point2> points;
    const double off = kFit.chord_part * limits_.deviation;
    for (const Point3& point : cut_into_chords(section, off).points) {
      const Point2 p = frame_.local(point).head<2>();
      if (points.empty() || (p - points.back()).norm() > kSamePlace) points.push_back(p);
    }
    if (points.size() < 2) return std::nullopt;
    points.front() = start.place.head<2>();
    points.back() = end.place.head<2>();
    ArcSplineOptions options;
    options.ArcRange::operator=(options_);
    options.tolerance = (1 - kFit.chord_part) * limits_.deviation;
    options.outside *= 1 - kFit.chord_part;
    if (options_.running.error) {
      const double per_mm = (end.u - start.u) / length_of(points);
      options.running.room = [this, per_mm, u = start.u](double from, double to) {
        ArcRunning::Room there = options_.running.room(u + per_mm * from, u + per_mm * to);
        there.left -= kFit.chord_part * limits_.deviation;
        there.right -= kFit.chord_part * limits_.deviation;
        return there;
      };
    }
    options.start_angle = start.angle;
    options.end_angle = end.angle;
    options.kinks = false;
    options.effort = options_.effort;
    options.at_most = at_most;
    const auto spline = fit_arc_spline(points, options);
    if (!spline) return std::nullopt;
    std::vector<ChainPiece> pieces;
    for (const ArcSplinePiece& piece : spline->pieces) {
      pieces.push_back({piece.arc, start.place.z()});
    }
    return pieces;
  }

  // From where the path ends to the arc's end at that height.
  void append(const PlaneArc& arc, double height, Path& path) const {
    const auto global = [&](const Point2& p) { return frame_.global({p.x(), p.y(), height}); };
    const Point3 start = path.empty() ? marked_.pieces.piece(0).control[0] : end_point(path.back());
    if (arc.is_line()) {
      path.push_back(Line{start, global(arc.end)});
    } else {
      path.push_back(Arc{start, global(arc.end), global(arc.center), options_.axis, arc.sweep});
    }
  }

  const MarkedPieces& marked_;
  double chords_;
  const ArcFitOptions& options_;
  bool flat_;
  PlaneFrame frame_;
  PlaneCurve curve_;
  ArcChainLimits limits_;
};

void check(const ArcFitOptions& options) {
  require(options.max_deviation > 0, "fit_arcs: max_deviation", options.max_deviation, "> 0");
  require(options.max_sweep > 0 && options.max_sweep < std::numbers::pi, "fit_arcs: max_sweep",
          options.max_sweep, "above 0 and below pi");
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
  const bool flat = range_along(pieces.pieces, options.axis) <= kFit.one_height;
  if (!flat && !options.helical) return std::nullopt;
  return ArcFit(pieces, chords, options, flat).path();
}

double chords_along(const CurvePieces& pieces, double deviation) {
  constexpr int kParts = kFit.chords_read;
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
