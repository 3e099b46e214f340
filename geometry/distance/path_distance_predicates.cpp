#include "geometry/distance/path_distance_predicates.h"

#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>
#include <CGAL/Exact_rational.h>
#include <CGAL/Simple_cartesian.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>

namespace batten::geometry {
namespace {

using Exact = CGAL::Simple_cartesian<CGAL::Exact_rational>;
using ExactNumber = Exact::FT;
using Filtered = CGAL::Exact_predicates_inexact_constructions_kernel;

// Steps of the decimals that coordinates are printed with, per mm: six decimals of an inch
// are 1e-6 * 25.4 = 2.54e-5 mm, a multiple of 1e-7 mm; mm carry up to nine decimals.
constexpr double kGridPerMm = 1e9;

// A double made from a printed decimal is off by half a rounding step; inches by three half
// steps (the decimal, 25.4, their product); one more for the product with kGridPerMm.
// Sixteen steps leave room for increments that were added up.
constexpr double kDecimalNoise = 16 * std::numeric_limits<double>::epsilon();

// The same where the sum of increments comes back to zero, in steps of the grid: 1e-13 mm.
constexpr double kDecimalFloor = 1e-4;

// Beyond it neighbouring doubles are too far apart to tell the decimal: 9e6 mm.
constexpr double kGreatestGrid = 9007199254740992.0;  // 2^53

// The whole number of grid steps that the double stands for.
std::optional<double> grid_steps(double mm) {
  const double scaled = mm * kGridPerMm;
  const double steps = std::round(scaled);
  if (std::abs(scaled) > kGreatestGrid) return {};
  const double noise = std::max(kDecimalFloor, kDecimalNoise * std::abs(scaled));
  if (std::abs(scaled - steps) > noise) return {};
  return steps;
}

ExactNumber exact_number(double mm) {
  const std::optional<double> steps = grid_steps(mm);
  return steps ? ExactNumber(*steps) / ExactNumber(kGridPerMm) : ExactNumber(mm);
}

Exact::Point_3 exact_point(const Point3& p) {
  return {exact_number(p.x()), exact_number(p.y()), exact_number(p.z())};
}

// The place in grid steps, as doubles that are whole numbers; nothing where it is none.
std::optional<Filtered::Point_3> grid_point(const Point3& p) {
  const auto x = grid_steps(p.x());
  const auto y = grid_steps(p.y());
  const auto z = grid_steps(p.z());
  if (!x || !y || !z) return {};
  return Filtered::Point_3(*x, *y, *z);
}

// How a place of a pair is read.
enum class Reading { kAsGiven, kFoot };

struct ReadPlace {
  PlaceOnChord place;
  Reading reading = Reading::kAsGiven;
  Point3 foot_of = Point3::Zero();  // of kFoot: the vertex of the other polyline
};

bool is_vertex(const PlaceOnChord& place) { return place.t == 0 || place.t == 1; }

Exact::Point_3 exact_place(const ChordPolyline& polyline, const PlaceOnChord& place) {
  Exact::Point_3 from = exact_point(polyline.points[place.edge]);
  if (place.t == 0) return from;
  Exact::Point_3 to = exact_point(polyline.points[place.edge + 1]);
  if (place.t == 1) return to;
  return from + ExactNumber(place.t) * (to - from);
}

// The parameter of the foot of the perpendicular on the line through the edge.
ExactNumber exact_foot(const ChordPolyline& polyline, std::size_t edge, const Point3& vertex) {
  const Exact::Point_3 from = exact_point(polyline.points[edge]);
  const Exact::Vector_3 along = exact_point(polyline.points[edge + 1]) - from;
  if (along.squared_length() == 0) return 0;
  return (exact_point(vertex) - from) * along / along.squared_length();
}

ExactNumber exact_parameter(const ChordPolyline& polyline, const ReadPlace& read) {
  if (read.reading == Reading::kAsGiven) return read.place.t;
  return exact_foot(polyline, read.place.edge, read.foot_of);
}

// Neighbouring places of one polyline, one of them read as a foot: still in order?
bool in_order(const ChordPolyline& polyline, const ReadPlace& before, const ReadPlace& after) {
  if (before.reading == Reading::kAsGiven && after.reading == Reading::kAsGiven) return true;
  const ExactNumber t = exact_parameter(polyline, after);
  if (before.place.edge == after.place.edge) return exact_parameter(polyline, before) <= t;
  return t >= 0;  // a foot is never read for a vertex, so `before` is the end of its edge
}

class Checker {
 public:
  Checker(const ChordPolyline& a, const ChordPolyline& b, double tolerance)
      : a_(a), b_(b), tolerance_(tolerance), noise_(distance_noise(a, b)) {}

  // Pairs must come in the order of the matching.
  bool accept(const MatchedPair& pair, double error) {
    ReadPlace on_a{pair.a};
    ReadPlace on_b{pair.b};
    const double apart = (point_at(a_, pair.a) - point_at(b_, pair.b)).norm();
    const double allowed = tolerance_ - error;
    if (apart > allowed + noise_) return false;
    if (apart > allowed - noise_ && !exactly_within(pair, error) &&
        !foot_within(pair, error, on_a, on_b)) {
      return false;
    }
    if (!first_ && (!in_order(a_, last_a_, on_a) || !in_order(b_, last_b_, on_b))) return false;
    first_ = false;
    last_a_ = on_a;
    last_b_ = on_b;
    return true;
  }

 private:
  [[nodiscard]] ExactNumber exactly_allowed(double error) const {
    return exact_number(tolerance_) - ExactNumber(error);
  }

  [[nodiscard]] bool exactly_within(const MatchedPair& pair, double error) const {
    if (error == 0 && is_vertex(pair.a) && is_vertex(pair.b)) {
      const std::optional<bool> answer = vertices_within(pair);
      if (answer) return *answer;
    }
    const ExactNumber allowed = exactly_allowed(error);
    if (allowed < 0) return false;
    return CGAL::compare_squared_distance(exact_place(a_, pair.a), exact_place(b_, pair.b),
                                          allowed * allowed) != CGAL::LARGER;
  }

  // Printed places against a printed tolerance, all whole numbers of grid steps: CGAL's
  // filtered predicate compares two distances without leaving doubles unless it must.
  [[nodiscard]] std::optional<bool> vertices_within(const MatchedPair& pair) const {
    const auto p = grid_point(point_at(a_, pair.a));
    const auto q = grid_point(point_at(b_, pair.b));
    const auto steps = grid_steps(tolerance_);
    if (!p || !q || !steps) return {};
    return Filtered().compare_distance_3_object()(*p, *q, Filtered::Point_3(0, 0, 0),
                                                  Filtered::Point_3(*steps, 0, 0)) != CGAL::LARGER;
  }

  [[nodiscard]] bool foot_within(const MatchedPair& pair, double error, ReadPlace& on_a,
                                 ReadPlace& on_b) const {
    if (is_vertex(pair.a) && !is_vertex(pair.b)) {
      return foot_on(b_, pair.b, point_at(a_, pair.a), error, on_b);
    }
    if (is_vertex(pair.b) && !is_vertex(pair.a)) {
      return foot_on(a_, pair.a, point_at(b_, pair.b), error, on_a);
    }
    return false;
  }

  [[nodiscard]] bool foot_on(const ChordPolyline& polyline, const PlaceOnChord& place,
                             const Point3& vertex, double error, ReadPlace& read) const {
    const ExactNumber t = exact_foot(polyline, place.edge, vertex);
    const ExactNumber allowed = exactly_allowed(error);
    if (t < 0 || t > 1 || allowed < 0) return false;
    const Exact::Point_3 from = exact_point(polyline.points[place.edge]);
    const Exact::Point_3 to = exact_point(polyline.points[place.edge + 1]);
    if (CGAL::compare_squared_distance(exact_point(vertex), Exact::Point_3(from + t * (to - from)),
                                       allowed * allowed) == CGAL::LARGER) {
      return false;
    }
    read.reading = Reading::kFoot;
    read.foot_of = vertex;
    return true;
  }

  const ChordPolyline& a_;
  const ChordPolyline& b_;
  double tolerance_;
  double noise_;
  bool first_ = true;
  ReadPlace last_a_;
  ReadPlace last_b_;
};

}  // namespace

double distance_noise(const ChordPolyline& a, const ChordPolyline& b) {
  // A coordinate off its decimal by kDecimalNoise of itself on both sides, a difference, a
  // place between two vertices and a norm: below 64 steps of the greatest coordinate. The
  // rest is the kDecimalFloor of both places.
  const double size = std::max(greatest_coordinate(a), greatest_coordinate(b));
  return 128 * std::numeric_limits<double>::epsilon() * size + 4 * kDecimalFloor / kGridPerMm;
}

bool within_tolerance(const Matching& matching, const ChordPolyline& a, const ChordPolyline& b,
                      double tolerance) {
  Checker checker(a, b, tolerance);
  for (std::size_t k = 0; k < matching.size(); ++k) {
    if (!checker.accept(matching[k], pair_error(matching, k, a, b))) return false;
  }
  return true;
}

}  // namespace batten::geometry
