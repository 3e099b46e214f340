// The cubic B-spline of least energy that stays in a band: at given parameters its positions (or
// its derivatives) keep given distances from given ones. A convex problem, solved by Newton's
// method on a logarithmic barrier: every curve on the way is strictly inside.
// Method: docs/algorithms/band_curve.md.
#pragma once

#include <cstddef>
#include <functional>
#include <vector>

#include "geometry/basic/point.h"
#include "geometry/path/bspline_curve.h"

namespace batten::geometry {

struct BandTuning {
  // [..]: what fails at half and double (docs/ARCHITECTURE.md).
  int max_steps = 200;  // of Newton's method [<]
  // Ends when the energy is known to be above the least one by this part at most.
  double gap = 1e-5;
  // The barrier counts for less by this factor as soon as a curve is near its least: some four
  // Newton steps each.
  double sharpen = 20;
  double near = 0.5;    // squared Newton decrement below which a curve is near that least [>]
  double there = 1e-3;  // and one below which it is there [<]
  double wider = 1.05;  // a start outside: the band is widened by this much more than it needs
  // The band is no longer widened when the greatest ratio is below this: strictly inside, so that
  // the barrier is finite.
  double inside = 0.9999;  // [at 0.9]
  // The part that the energy at the start has in what is made least, beside the widening.
  double trace = 1e-3;  // [<]
  // The part that counts of an energy that counts next to nothing: it still holds the parameter.
  double next_to_nothing = 1e-3;  // [at 1: SolveBand.EnergyAlongADirectionMayBeLeftOut]
  // Of coordinates: they are rounded to 1e-16 of themselves, and what a Newton step solves for is
  // wrong by some tens of that.
  double rounding = 4e-15;  // [< SolveBand.NoiseInsideTheBandBecomesStraight]
  // Added to the diagonal in parts of itself: what the band and the energy leave free (a straight
  // run may slide along itself) must not make the system singular. Ten thousand times the rounding
  // of a pivot, and too little to slow any step down.
  double damping = 1e-12;  // [at 0: SolveBand.NoiseInsideTheBandBecomesStraight]
  // Tries, times a hundred each, where rounding still wins [at 0: SolveBand.BendsAsABeamDoes]
  int more_damping = 6;
  // To the edge of the band: no step goes further [at 1 - 1e-10:
  // SolveBand.EndsInsideWithTheLeastEnergy]
  double most_of_the_way = 0.99;
  double search_near_enough = 0.1;  // of the slope at the start of a step, where its search ends
  int search_tries = 20;            // [at 2: SolveBand.EndsInsideWithTheLeastEnergy]
};
inline constexpr BandTuning kBandTuning;

// What "no further than radius" is about.
enum class BandShape {
  kBall,      // the full distance
  kCylinder,  // the distance across `direction`: sliding along it is free
  kSlab,      // the distance along `direction`: sliding across it is free
};

struct BandSample {
  double parameter = 0;
  // 0: the position on the curve is bounded, mm; d > 0: its d-th derivative by the parameter.
  int derivative = 0;
  Point3 foot = Point3::Zero();
  BandShape shape = BandShape::kBall;
  Vector3 direction = Vector3::Zero();  // unit; kBall: not used
  double radius = 0;                    // > 0
};

// A control point that is not free to go anywhere.
struct HeldPoint {
  std::size_t index = 0;
  Point3 place = Point3::Zero();
  Eigen::Matrix3d free = Eigen::Matrix3d::Zero();  // projector on the directions it may go in

  [[nodiscard]] static HeldPoint at(std::size_t index, const Point3& place) {
    return {index, place, Eigen::Matrix3d::Zero()};
  }
  // `normal`: unit.
  [[nodiscard]] static HeldPoint on_plane(std::size_t index, const Point3& place,
                                          const Vector3& normal) {
    return {index, place, Eigen::Matrix3d::Identity() - normal * normal.transpose()};
  }
};

// How much the energy counts at a parameter.
struct EnergyWeight {
  double weight = 1;                // >= 0
  Vector3 along = Vector3::Zero();  // unit or zero: in this direction it counts next to nothing
};

struct BandProblem {
  BsplineBasis basis;  // of degree 3
  // The energy is the integral of weight * |C^(energy)|^2 over the parameter, 2 or 3.
  int energy = 3;
  // Empty: 1 everywhere. Else it is asked at four parameters per span.
  std::function<EnergyWeight(double)> weight;
  std::vector<BandSample> samples;
  std::vector<HeldPoint> held;
};

enum class BandEnd {
  kLeast,      // the least energy, to within the gap
  kStepLimit,  // inside the band, but the energy may not be the least
  kOutside,    // no curve on this basis was found that is inside
};

struct BandCurve {
  BsplineCurve curve;
  BandEnd end = BandEnd::kOutside;
  double energy = 0;
  double worst_ratio = 0;  // the greatest distance over radius at a sample
  int steps = 0;           // Newton steps, each linear in samples and control points
};

// `start`: control points to begin with; held points are put where they have to be. It may be
// outside: then the band is widened to hold it and shrunk again, as far as it goes.
//
// Throws std::invalid_argument when the degree is not 3, a radius is not positive, or the number
// of points does not fit the basis.
[[nodiscard]] BandCurve solve_band(const BandProblem& problem, std::vector<Point3> start,
                                   double gap = kBandTuning.gap);

// The curve for which the greatest ratio of distance over radius is least, over the samples with
// a derivative >= `from_derivative`; the others keep their radius (it is widened as well if the
// start is outside). Of the energy only a trace counts. worst_ratio is that greatest ratio, and
// `end` is kLeast when it is known to be the least to within the gap.
[[nodiscard]] BandCurve least_ratio_in_band(const BandProblem& problem, std::vector<Point3> start,
                                            int from_derivative);

}  // namespace batten::geometry
