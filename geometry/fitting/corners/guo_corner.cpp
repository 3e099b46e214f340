#include "geometry/fitting/corners/guo_corner.h"

#include <algorithm>
#include <limits>
#include <vector>

#include "geometry/basic/rounding.h"

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

std::variant<GuoBlend, NoBlend> guo_corner(const Corner& corner, const GuoRule& rule) {
  constexpr double kWhole = std::numeric_limits<double>::infinity();
  return guo_corner(corner, rule, kWhole, kWhole);
}

}  // namespace batten::geometry
