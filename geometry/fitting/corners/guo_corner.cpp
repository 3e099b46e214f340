#include "geometry/fitting/corners/guo_corner.h"

#include <algorithm>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include "geometry/basic/rounding.h"
#include "geometry/fitting/corners/corner_blend.h"

namespace batten::geometry {

double guo_apex_distance(const CornerFrame& frame, double spacing) {
  return spacing / 2 * frame.cos_half;
}

double guo_allowed_apex(const CornerFrame& frame, double tolerance, ToleranceKind kind) {
  return kind == ToleranceKind::kBand ? tolerance / frame.sin_half : tolerance;
}

double guo_spacing_for_apex(const CornerFrame& frame, double apex_distance) {
  return 2 * apex_distance / frame.cos_half;
}

double guo_greatest_curvature(const CornerFrame& frame, double spacing) {
  return 4 * frame.cos_half / (3 * spacing * frame.sin_half * frame.sin_half);
}

GuoBlend guo_blend(const CornerFrame& frame, double spacing) {
  const Point3& q = frame.vertex;
  std::vector<Point3> points = {q + 2 * spacing * frame.a, q + spacing * frame.a, q,
                                q + spacing * frame.b, q + 2 * spacing * frame.b};
  BsplineCurve curve(BsplineBasis::clamped(3, {0, 0.5, 1}), std::move(points));
  // The vertex is nearest to the middle, which is also the place farthest from the legs; up
  // to there the Bezier points lie on the one leg but for the last, so in order, too, nothing
  // is further apart than vertex and middle.
  const double e = guo_apex_distance(frame, spacing);
  const BlendDeviation deviation{e * frame.sin_half, e, e};
  return {{std::move(curve), deviation}, spacing, guo_greatest_curvature(frame, spacing)};
}

std::variant<GuoBlend, NoBlend> guo_corner(const Corner& corner, const GuoRule& rule,
                                           double share_before, double share_after) {
  require_positive_tolerance(rule.tolerance, "guo_corner");
  const auto framed = frame_of(corner);
  if (const auto* reason = std::get_if<NoBlend>(&framed)) return *reason;
  const auto& frame = std::get<CornerFrame>(framed);
  double spacing = std::min({share_before, share_after, frame.length_a, frame.length_b}) / 2;
  const double allowed = guo_allowed_apex(frame, rule.tolerance, rule.kind);
  if (guo_apex_distance(frame, spacing) > allowed) {
    spacing =
        guo_spacing_for_apex(frame, rule.apex == GuoApex::kAllowed ? allowed : rule.tolerance / 2);
  }
  if (!(spacing > kSamePlace)) return NoBlend::kNoRoom;
  return guo_blend(frame, spacing);
}

namespace {

GuoRule rule_at(const Corner& corner, const GuoOptions& options) {
  GuoRule rule = options.rule;
  rule.kind = kind_at(corner, rule.kind, options.strict_sharper_than);
  return rule;
}

// --- routines 1 to 3 as the paper has them -------------------------------------------------

// start = Q0; for each inner vertex Q_i: the blend that fits between start and Q_{i+1}, halved
// where it would reach Q_{i+1} and that is a corner, too; then start = P4 + lambda (Q_{i+1} - P4).
std::vector<GuoPath::Corner> literal_corners(const DistinctVertices& vertices,
                                             const GuoOptions& options) {
  const std::vector<Point3>& q = vertices.points;
  const std::size_t n = q.size() - 1;
  std::vector<GuoPath::Corner> corners;
  Point3 start = q[0];
  for (std::size_t i = 1; i < n; ++i) {
    const double a = (q[i] - start).norm();
    const double b = (q[i + 1] - q[i]).norm();
    const Corner corner{q[i - 1], q[i], q[i + 1]};
    if (turns_more(corner, options.keep_corner_angle)) {
      corners.push_back({vertices.indices[i], NoBlend::kKept});
      start = q[i];
      continue;
    }
    const GuoRule rule = rule_at(corner, options);
    auto outcome = guo_corner(corner, rule, a, b);
    // Only a blend that the segments limit can fill the next one, so the tolerance has its say
    // before this rule.
    const auto* blend = std::get_if<GuoBlend>(&outcome);
    if (blend != nullptr && i + 1 < n && 2 * blend->spacing >= b) {
      outcome = guo_corner(corner, rule, b / 2, b / 2);
      blend = std::get_if<GuoBlend>(&outcome);
    }
    start = q[i];
    if (blend != nullptr) {
      const Point3& p4 = blend->blend.curve.control_points().back();
      start = p4 + options.lambda * (q[i + 1] - p4);
    }
    corners.push_back({vertices.indices[i], std::move(outcome)});
  }
  return corners;
}

}  // namespace

GuoOptions GuoOptions::literal(double tolerance, double lambda) {
  GuoOptions options;
  options.rule = {tolerance, ToleranceKind::kBand, GuoApex::kHalfTolerance};
  options.sharing = GuoSharing::kLiteral;
  options.lambda = lambda;
  return options;
}

GuoPath guo_path(std::span<const Point3> points, const GuoOptions& options) {
  require_positive_tolerance(options.rule.tolerance, "guo_path");
  if (!(options.lambda >= 0 && options.lambda < 1)) {
    throw std::invalid_argument("guo_path: lambda " + std::to_string(options.lambda) +
                                ", expected 0 or more and less than 1");
  }
  if (options.sharing == GuoSharing::kFair) {
    return path_with_blends<GuoBlend>(
        points, options.keep_corner_angle, [&](const SharedCorner& each) {
          return guo_corner(each.corner, rule_at(each.corner, options), each.share_before,
                            each.share_after);
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
