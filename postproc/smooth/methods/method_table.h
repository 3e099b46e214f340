// What each method makes of a path, in the figures that its paper prints: for `batten methods
// --table`. Paths are planned by the planner of postproc/machine/planner, not by the model of a
// control.
#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include "geometry/basic/point.h"
#include "geometry/basic/tolerance_kind.h"
#include "geometry/chords/chord_proof.h"
#include "geometry/path/bspline_curve.h"
#include "postproc/machine/planner/feed_plan_path.h"
#include "postproc/machine/planner/s_curve.h"

namespace batten::postproc {

struct TableSettings {
  // Of polylines: the machine of Ozcan 2018.
  KinematicPathLimits limits = ozcan_limits();
  SCurveLimits s_curve;   // of curves: Naseath 2007
  double guo_lambda = 0;  // of guo-literal, see geometry::GuoOptions

  // 25 mm/s, 2500 and 3000 mm/s^2, 5000 mm/s^3 per axis, 1e4 mm/s^2 and 1e5 mm/s^3 along the path.
  [[nodiscard]] static KinematicPathLimits ozcan_limits();
};

// A polyline, mm. A ring, whose last point is its first one, is run from the middle of its longest
// side, so that this point is a corner as the others are.
struct PolylineCase {
  std::vector<geometry::Point3> points;
  bool ring = false;
};

struct PolylineRow {
  std::string method;
  geometry::ToleranceKind kind = geometry::ToleranceKind::kPath;
  // Nothing else is known where the method makes no curve.
  struct Figures {
    double time = 0;                  // s, from rest to rest
    std::optional<double> curvature;  // 1/mm, the greatest; nothing of the polyline
    std::optional<double> deviation;  // mm, proved; nothing where it is above the tolerance
    std::size_t pieces = 0;           // lines and cubics
  };
  std::optional<Figures> figures;
};

// The polyline as it is, each method in the strict reading of the tolerance (mm), and those that
// differ there in the reading `band`. Seconds for some hundred points.
//
// Throws std::invalid_argument for fewer than two points, a tolerance that is not above 0, and
// limits or a lambda that are not sound.
[[nodiscard]] std::vector<PolylineRow> method_rows(const PolylineCase& given, double tolerance,
                                                   const TableSettings& settings);

// Radians: a section of a curve that turns one way by less is not counted as a bend of it. A ripple
// of a hundredth of a millimetre on ten millimetres turns by a few times as much.
inline constexpr double kSeenBend = 1e-3;

struct CurveCase {
  geometry::BsplineCurve curve;
  bool ring = false;
};

struct CurveRow {
  std::string method;
  double curvature = 0;  // 1/mm, mean over kNaseathSteps equal parameter steps in each span
  double greatest_curvature = 0;  // 1/mm, of these
  double length = 0;              // mm
  double time = 0;                // s, by the S-curve generator
  double sampled_feed = 0;        // mm/s, mean of the same samples (s_curve_sampled_feed)
  std::size_t bends = 0;          // sections that turn one way, by kSeenBend or more (bends_of)
  double displacement = 0;        // mm: |new(u) - old(u)| does not exceed it at any u
};

// The curve as it is, and in a tube of that radius (mm): Naseath's smoother as the thesis has it,
// repaired, and the curve of the least time. The curves of a ring, which ends where it begins, stay
// there with their tangent and curvature, so that they have no seam. Throws as best_in_tube does.
[[nodiscard]] std::vector<CurveRow> tube_rows(const CurveCase& given, double radius,
                                              const TableSettings& settings);

struct LinesRow {
  std::string method;     // as of --linearize
  std::size_t lines = 0;  // 0: none were found within a bounded effort
  double length = 0;      // mm, of the lines and the jumps between them
  double deviation = 0;   // mm, the greatest distance of the curve from them, a proved bound
  std::size_t jumps = 0;  // across the path, from one line to the next
  double jumped = 0;      // mm, the length of the jumps
  geometry::BesideCurve beside = {};  // of the lines
};

// The curve as lines by each way of laying them within a tolerance (mm), and as the tool path of
// Hamdan 2005 along its tangents: `blca-tangents` before the correction of over- and undercut,
// `blca-jumps` after it (geometry::tangent_lines). `first_step`: of the
// parameter, with which ilca begins; 0: one step. Throws std::invalid_argument for a tolerance that
// is not above 0.
[[nodiscard]] std::vector<LinesRow> line_rows(const geometry::BsplineCurve& curve, double tolerance,
                                              double first_step);

}  // namespace batten::postproc
