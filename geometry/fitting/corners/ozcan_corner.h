// The eight-point corner: a cubic B-spline whose first and last three control points lie on the
// legs, while the two in the middle are moved until the machine can keep the highest feed.
// Method: docs/algorithms/ozcan.md.
//
// Source: A. Ozcan, E. Riviere-Lorphevre, F. Ducobu, AIP Conference Proceedings 1960, 070020,
// 2018.
#pragma once

#include <array>
#include <span>
#include <variant>

#include "geometry/fitting/corners/corner_blend.h"
#include "geometry/path/kinematic_feed.h"

namespace batten::geometry {

// Where P1, P2, P3 lie on the leg that arrives and P8, P7, P6 on the leg that leaves: mm from the
// vertex, decreasing.
using OzcanLeg = std::array<double, 3>;

// A place beside a leg: mm from the vertex along it, and mm from it, away from the other leg.
struct BesideLeg {
  double along;
  double outward;
};

struct OzcanBlend {
  CornerBlend blend;
  BesideLeg fourth;      // P4 beside the leg that arrives; P5 is its mirror image
  double feed_estimate;  // mm/s, see feed_estimate()
};

// Points at 1, 3/4 and 1/2 of a reach, as in the paper. The reach is all of the share of the legs
// (mm), or less where a leg is shorter or even the sharpest curve (P4 and P5 in the vertex) would
// use more than 0.35 of the tolerance, about where the feed estimate of the optimum is greatest.
[[nodiscard]] OzcanLeg ozcan_leg(const CornerFrame& frame, double tolerance, ToleranceKind kind,
                                 double share);

// Knots 0 0 0 0 1 2 3 4 5 5 5 5. The first three points of either side are on the legs, so the
// curve leaves them with their direction and curvature 0, wherever P4 and P5 are.
[[nodiscard]] BsplineCurve ozcan_curve(const CornerFrame& frame, const OzcanLeg& leg,
                                       const BesideLeg& fourth);

struct OzcanProblem {
  CornerFrame frame;
  OzcanLeg leg;
  double tolerance;  // mm
  ToleranceKind kind;
  KinematicLimits limits;
};

// P4 and P5 on the legs, as far from the vertex (in parts of P3 and P6) as the tolerance allows:
// the paper's "usual" corner. kNoRoom where no such place is near enough.
//
// Throws std::invalid_argument when the tolerance is not a positive number.
[[nodiscard]] std::variant<OzcanBlend, NoBlend> ozcan_usual(const OzcanProblem& problem);

// P4 and P5 where the feed estimate is greatest within the tolerance, searched from the usual
// corner and never worse than that. Does not throw for other reasons than ozcan_usual.
[[nodiscard]] std::variant<OzcanBlend, NoBlend> ozcan_optimum(const OzcanProblem& problem);

struct OzcanTuning {
  // [..]: what fails at half and double (docs/ARCHITECTURE.md).
  // Of the tolerance, that the sharpest curve uses: with more the corner is cramped; with less the
  // curve has less length to turn on. docs/algorithms/ozcan.md has the table.
  double sharpest = 0.35;
  int halvings = 48;  // of the usual corner's places: the deviation is right to 1e-14 of the blend
  int evaluations = 600;  // of one search [<]
  double finest = 1e-4;   // of the first step, about a tolerance: changes no feed by a thousandth
};
inline constexpr OzcanTuning kOzcanTuning;

struct OzcanOptions : CornerPathOptions {
  KinematicLimits limits;
  // Radians: vertices that turn less get the "usual" corner, in closed form. The feed that the
  // search would win there is little, and a smooth curve has thousands of them.
  double least_searched_turn = 0.1;
};

using OzcanPath = CornerPath<OzcanBlend>;

// A polyline with such a blend in the place of each corner (docs/algorithms/ozcan.md, section
// Paths). Segments are shared as by guo_path with kFair, and both legs of a blend are as long as
// the lesser share. Corners that are alike (half angle, legs and directions of the legs to a
// millionth) are searched once.
//
// Cost: linear, but some 12 ms for each corner that has to be searched. Throws
// std::invalid_argument when the tolerance is not a positive number.
[[nodiscard]] OzcanPath ozcan_path(std::span<const Point3> points, const OzcanOptions& options);

}  // namespace batten::geometry
