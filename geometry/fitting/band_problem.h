// What a curve in a band (band_curve.h) has to keep: places, derivatives, held control points and
// the energy; and the same with its basis functions evaluated, which the solver works on.
#pragma once

#include <array>
#include <cstddef>
#include <functional>
#include <vector>

#include "geometry/basic/point.h"
#include "geometry/path/bspline_curve.h"

namespace batten::geometry {

// What "no further than radius" is about.
enum class BandShape {
  kBall,      // the full distance
  kCylinder,  // the distance across `direction`: sliding along it is free
  kSlab,      // the distance along `direction`: sliding across it is free
};

struct BandSample {
  double parameter = 0;
  // 0: the place of the curve is bounded, mm; d > 0: its d-th derivative by the parameter.
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

  [[nodiscard]] static HeldPoint at(std::size_t index, const Point3& place);
  // `normal`: unit.
  [[nodiscard]] static HeldPoint on_plane(std::size_t index, const Point3& place,
                                          const Vector3& normal);
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
  // Empty: 1 everywhere. Else it is asked at four places per span.
  std::function<EnergyWeight(double)> weight;
  std::vector<BandSample> samples;
  std::vector<HeldPoint> held;
};

// Four neighbouring control points, and the weights that make one value of them.
struct BandCombination {
  std::size_t first = 0;
  std::array<double, 4> weights{};

  [[nodiscard]] Vector3 of(const std::vector<Point3>& points) const {
    return weights[0] * points[first] + weights[1] * points[first + 1] +
           weights[2] * points[first + 2] + weights[3] * points[first + 3];
  }
};

// The value of the combination keeps |across (value - foot)| <= radius.
struct BandRow {
  BandCombination value;
  Point3 foot = Point3::Zero();
  Eigen::Matrix3d across = Eigen::Matrix3d::Identity();  // projector
  double radius = 1;
  bool rate = false;  // its radius may be widened by itself, as least_ratio_in_band does
};

// Adds value^T metric value.
struct EnergyTerm {
  BandCombination value;
  Eigen::Matrix3d metric = Eigen::Matrix3d::Identity();
};

struct BandRows {
  std::vector<BandRow> rows;
  std::vector<EnergyTerm> terms;

  [[nodiscard]] double energy(const std::vector<Point3>& points) const;

  // What the energy rises to, at most, when control points are moved by the greatest radius of a
  // row that is no rate.
  [[nodiscard]] double energy_of_moves() const;

  // What rounding of the points alone makes of the energy of a straight line.
  [[nodiscard]] double energy_noise(const std::vector<Point3>& points) const;

  // The greatest distance over radius of the rows that are (are not) rates.
  [[nodiscard]] double worst_ratio(const std::vector<Point3>& points, bool rates) const;
};

// `rates_from`: the derivative from which samples are rates. Throws as solve_band says.
[[nodiscard]] BandRows band_rows(const BandProblem& problem, int rates_from);

}  // namespace batten::geometry
