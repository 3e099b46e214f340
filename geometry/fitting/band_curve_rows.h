// A band problem with its basis functions evaluated: what the solver works on.
#pragma once

#include <array>
#include <cstddef>
#include <vector>

#include "geometry/basic/point.h"
#include "geometry/fitting/band_curve.h"

namespace batten::geometry {

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
  Vector3 side = Vector3::Zero();
  bool rate = false;  // its radius may be widened by itself, as least_ratio_in_band does
};

// Adds (value - target)^T metric (value - target).
struct EnergyTerm {
  BandCombination value;
  Point3 target = Point3::Zero();
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

  // The greatest distance over radius of the rows that are (are not) rates. At a foot with a side
  // that is 1, and less inside.
  [[nodiscard]] double worst_ratio(const std::vector<Point3>& points, bool rates) const;
};

// `rates_from`: the derivative from which samples are rates. Throws as solve_band says.
[[nodiscard]] BandRows band_rows(const BandProblem& problem, int rates_from);

}  // namespace batten::geometry
