// The five-point corner: a cubic B-spline over two equal sections of the legs, with closed
// forms for everything. Method: docs/algorithms/guo.md.
//
// Source: Y. Guo, J. Yan, X. Wang, Journal of Engineering Research and Reports 25(12), 2023,
// 60-75.
//
// Letters of the paper: L the spacing of the control points along the legs, e the distance
// of the vertex from the blend, theta half the angle between the legs, delta the tolerance.
#pragma once

#include <limits>
#include <span>
#include <variant>

#include "geometry/fitting/corners/corner_blend.h"

namespace batten::geometry {

struct GuoBlend {
  CornerBlend blend;  // control points on the legs, 2L and L from the vertex, and the vertex
  double spacing;     // mm, L: the blend replaces 2L of either leg
  double greatest_curvature;  // 1/mm, in the middle: (4/3) cos theta / (L sin^2 theta)
};

// The blend of that spacing. Requires 0 < 2 * spacing <= both legs.
[[nodiscard]] GuoBlend guo_blend(const CornerFrame& frame, double spacing);

// What becomes of a corner that has more room than the tolerance allows.
enum class GuoApex {
  kAllowed,        // as great a blend as the tolerance allows
  kHalfTolerance,  // the paper's: e = delta / 2
};

struct GuoRule {
  double tolerance = 0.01;  // mm
  ToleranceKind kind = ToleranceKind::kPath;
  GuoApex apex = GuoApex::kAllowed;
};

// The blend that takes no more than so much of each leg (mm; more than the leg counts as the
// whole leg) and holds the tolerance: all of the lesser share where that holds it, else what
// `apex` says. Throws std::invalid_argument when the tolerance is not a positive number.
[[nodiscard]] std::variant<GuoBlend, NoBlend> guo_corner(
    const Corner& corner, const GuoRule& rule,
    double share_before = std::numeric_limits<double>::infinity(),
    double share_after = std::numeric_limits<double>::infinity());

// How a segment between two corners is shared.
enum class GuoSharing {
  kFair,     // half and half; the whole where the other end needs none
  kLiteral,  // the paper's: the earlier corner takes what it wants, the later what is left
};

struct GuoOptions : CornerPathOptions {
  GuoApex apex = GuoApex::kAllowed;
  GuoSharing sharing = GuoSharing::kFair;
  // kLiteral only: the next blend may begin after this part of what a blend leaves of the
  // segment after it. In [0, 1[.
  double lambda = 0;

  // The paper's routines, word for word but for the guards of degenerate corners.
  [[nodiscard]] static GuoOptions literal(double tolerance, double lambda);
};

using GuoPath = CornerPath<GuoBlend>;

// A polyline with such a blend in the place of each corner. Starts and ends at the given ends. With
// kFair the path reversed gives the reversed blends. With kLiteral only the order of the joints
// along each segment is promised.
//
// Cost: linear. Throws std::invalid_argument when the tolerance is not a positive number or
// lambda is not in [0, 1[.
[[nodiscard]] GuoPath guo_path(std::span<const Point3> points, const GuoOptions& options);

}  // namespace batten::geometry
