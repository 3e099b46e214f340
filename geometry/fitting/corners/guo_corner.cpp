#include "geometry/fitting/corners/guo_corner.h"

#include <algorithm>
#include <utility>
#include <vector>

#include "geometry/basic/require.h"
#include "geometry/basic/rounding.h"

namespace batten::geometry {
namespace {

// mm, e = (L / 2) cos theta.
double apex_distance(const CornerFrame& frame, double spacing) {
  return spacing / 2 * frame.cos_half;
}

}  // namespace

GuoBlend guo_blend(const CornerFrame& frame, double spacing) {
  const Point3& q = frame.vertex;
  std::vector<Point3> points = {q + 2 * spacing * frame.a, q + spacing * frame.a, q,
                                q + spacing * frame.b, q + 2 * spacing * frame.b};
  BsplineCurve curve(BsplineBasis::clamped(3, {0, 0.5, 1}), std::move(points));
  // The vertex is nearest to the middle, which is also the point farthest from the legs; up
  // to there the Bezier points lie on the one leg but for the last, so in order, too, nothing
  // is further apart than vertex and middle.
  const double e = apex_distance(frame, spacing);
  const BlendDeviation deviation{e * frame.sin_half, e, e};
  return {{std::move(curve), deviation},
          spacing,
          4 * frame.cos_half / (3 * spacing * frame.sin_half * frame.sin_half)};
}

std::variant<GuoBlend, NoBlend> guo_corner(const Corner& corner, const GuoRule& rule,
                                           double share_before, double share_after) {
  require_positive_tolerance(rule.tolerance, "guo_corner");
  const auto framed = frame_of(corner);
  if (const auto* reason = std::get_if<NoBlend>(&framed)) return *reason;
  const auto& frame = std::get<CornerFrame>(framed);
  double spacing = std::min({share_before, share_after, frame.length_a, frame.length_b}) / 2;
  // The e that is allowed. Exact: the blend's deviation of that kind is the tolerance then.
  const double allowed =
      rule.kind == ToleranceKind::kBand ? rule.tolerance / frame.sin_half : rule.tolerance;
  if (apex_distance(frame, spacing) > allowed) {
    const double apex = rule.apex == GuoApex::kAllowed ? allowed : rule.tolerance / 2;
    spacing = 2 * apex / frame.cos_half;
  }
  if (!(spacing > kSamePlace)) return NoBlend::kNoRoom;
  return guo_blend(frame, spacing);
}

namespace {

// Routines 1 to 3 as the paper has them: start = Q0; for each inner vertex Q_i: the blend that fits
// between start and Q_{i+1}, halved where it would reach Q_{i+1} and that is a corner, too; then
// start = P4 + lambda (Q_{i+1} - P4).
std::vector<GuoPath::Corner> literal_corners(const DistinctVertices& vertices,
                                             const GuoOptions& options) {
  const std::vector<Point3>& q = vertices.points;
  std::vector<GuoPath::Corner> corners;
  Point3 start = q[0];
  for (const SharedCorner& each : shared_corners(q, options)) {
    const std::size_t i = each.vertex;
    const double a = (q[i] - start).norm();
    const double b = (q[i + 1] - q[i]).norm();
    start = q[i];
    corners.push_back({vertices.indices[i], NoBlend::kKept});
    if (const auto* reason = std::get_if<NoBlend>(&each.frame)) {
      corners.back().outcome = *reason;
      continue;
    }
    const GuoRule rule{options.tolerance, each.kind, options.apex};
    auto outcome = guo_corner(each.corner, rule, a, b);
    // Only a blend that the segments limit can fill the next one, so the tolerance has its say
    // before this rule.
    const auto* blend = std::get_if<GuoBlend>(&outcome);
    if (blend != nullptr && i + 2 < q.size() && 2 * blend->spacing >= b) {
      outcome = guo_corner(each.corner, rule, b / 2, b / 2);
      blend = std::get_if<GuoBlend>(&outcome);
    }
    if (blend != nullptr) {
      const Point3& p4 = blend->blend.curve.control_points().back();
      start = p4 + options.lambda * (q[i + 1] - p4);
    }
    corners.back().outcome = std::move(outcome);
  }
  return corners;
}

}  // namespace

GuoOptions GuoOptions::literal(double tolerance, double lambda) {
  GuoOptions options;
  options.tolerance = tolerance;
  options.kind = ToleranceKind::kBand;
  options.apex = GuoApex::kHalfTolerance;
  options.sharing = GuoSharing::kLiteral;
  options.lambda = lambda;
  return options;
}

GuoPath guo_path(std::span<const Point3> points, const GuoOptions& options) {
  require_positive_tolerance(options.tolerance, "guo_path");
  require(options.lambda >= 0 && options.lambda < 1, "guo_path: lambda", options.lambda,
          "0 or more and less than 1");
  if (options.sharing == GuoSharing::kFair) {
    return path_with_blends<GuoBlend>(
        points, options, [&](const SharedCorner& each, const CornerFrame& /*frame*/) {
          return guo_corner(each.corner, {options.tolerance, each.kind, options.apex},
                            each.share_before, each.share_after);
        });
  }
  GuoPath path;
  const DistinctVertices vertices = distinct_vertices(points);
  if (vertices.size() < 2) return path;
  path.corners = literal_corners(vertices, options);
  path.round(vertices);
  return path;
}

}  // namespace batten::geometry
