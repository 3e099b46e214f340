#include "geometry/fitting/band_problem.h"

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <string>

namespace batten::geometry {

namespace {

constexpr int kRowDegree = 3;
constexpr std::size_t kFunctions = kRowDegree + 1;  // that are not zero on a span

// The derivative-th derivative of the curve at u.
BandCombination combination_at(const BsplineBasis& basis, double u, int derivative) {
  const double inside = std::clamp(u, basis.first(), basis.last());
  const std::size_t span = basis.find_span(inside);
  std::array<double, kFunctions * kFunctions> values{};
  basis.evaluate_derivatives(span, inside, derivative, values.data());
  BandCombination made;
  made.first = span - kRowDegree;
  for (std::size_t j = 0; j < 4; ++j) {
    made.weights[j] = values[static_cast<std::size_t>(derivative) * kFunctions + j];
  }
  return made;
}

Eigen::Matrix3d across_of(const BandSample& sample) {
  Eigen::Matrix3d along = sample.direction * sample.direction.transpose();
  switch (sample.shape) {
    case BandShape::kCylinder:
      return Eigen::Matrix3d::Identity() - along;
    case BandShape::kSlab:
      return along;
    case BandShape::kBall:
      break;
  }
  return Eigen::Matrix3d::Identity();
}

void require(bool holds, const std::string& what) {
  if (!holds) throw std::invalid_argument("solve_band: " + what);
}

struct GaussPlace {
  double at;      // in [-1, 1]
  double weight;  // of all, 1
};

// Places that make the integral over a span exact: |C''|^2 is quadratic there, |C'''|^2 constant.
// Weights of any kind are seen at four.
std::vector<GaussPlace> gauss_places(const BandProblem& problem) {
  if (problem.weight) {
    const double inner = std::sqrt((3 - 2 * std::sqrt(1.2)) / 7);
    const double outer = std::sqrt((3 + 2 * std::sqrt(1.2)) / 7);
    const double more = (18 + std::sqrt(30.0)) / 72;
    const double less = (18 - std::sqrt(30.0)) / 72;
    return {{-outer, less}, {-inner, more}, {inner, more}, {outer, less}};
  }
  if (problem.energy == 3) return {{0, 1}};
  const double root = 1 / std::sqrt(3.0);
  return {{-root, 0.5}, {root, 0.5}};
}

Eigen::Matrix3d metric_of(const EnergyWeight& weight) {
  // What counts next to nothing still holds the parameter.
  constexpr double kNextToNothing = 1e-3;
  const Vector3& d = weight.along;
  return weight.weight * (Eigen::Matrix3d::Identity() - (1 - kNextToNothing) * d * d.transpose());
}

std::vector<EnergyTerm> energy_terms(const BandProblem& problem) {
  const auto& t = problem.basis.knots();
  const auto places = gauss_places(problem);
  std::vector<EnergyTerm> terms;
  for (std::size_t k = kRowDegree; k < problem.basis.size(); ++k) {
    if (!(t[k] < t[k + 1])) continue;
    const double width = t[k + 1] - t[k];
    for (const GaussPlace& place : places) {
      const double u = t[k] + 0.5 * width * (1 + place.at);
      const EnergyWeight weight = problem.weight ? problem.weight(u) : EnergyWeight{};
      terms.push_back({combination_at(problem.basis, u, problem.energy),
                       width * place.weight * metric_of(weight)});
    }
  }
  return terms;
}

}  // namespace

HeldPoint HeldPoint::at(std::size_t index, const Point3& place) {
  return {index, place, Eigen::Matrix3d::Zero()};
}

HeldPoint HeldPoint::on_plane(std::size_t index, const Point3& place, const Vector3& normal) {
  return {index, place, Eigen::Matrix3d::Identity() - normal * normal.transpose()};
}

double BandRows::energy(const std::vector<Point3>& points) const {
  double sum = 0;
  for (const EnergyTerm& term : terms) {
    const Vector3 value = term.value.of(points);
    sum += value.dot(term.metric * value);
  }
  return sum;
}

double BandRows::energy_of_moves() const {
  double radius = 0;
  for (const BandRow& row : rows) {
    if (!row.rate) radius = std::max(radius, row.radius);
  }
  double sum = 0;
  for (const EnergyTerm& term : terms) {
    double size = 0;
    for (const double weight : term.value.weights) size += std::abs(weight) * radius;
    sum += term.metric.trace() * size * size;
  }
  return sum;
}

double BandRows::energy_noise(const std::vector<Point3>& points) const {
  // Coordinates are rounded to 1e-16 of themselves, and what a Newton step solves for is wrong by
  // some tens of that.
  constexpr double kRounding = 4e-15;
  double sum = 0;
  for (const EnergyTerm& term : terms) {
    double size = 0;
    for (std::size_t j = 0; j < 4; ++j) {
      size += std::abs(term.value.weights[j]) * points[term.value.first + j].norm();
    }
    sum += term.metric.trace() * std::pow(kRounding * size, 2);
  }
  return sum;
}

double BandRows::worst_ratio(const std::vector<Point3>& points, bool rates) const {
  double worst = 0;
  for (const BandRow& row : rows) {
    if (row.rate != rates) continue;
    const Vector3 off = row.value.of(points) - row.foot;
    worst = std::max(worst, (row.across * off).norm() / row.radius);
  }
  return worst;
}

BandRows band_rows(const BandProblem& problem, int rates_from) {
  require(problem.basis.degree() == kRowDegree,
          "degree " + std::to_string(problem.basis.degree()) + ", expected 3");
  require(problem.energy == 2 || problem.energy == 3,
          "energy of derivative " + std::to_string(problem.energy) + ", expected 2 or 3");
  BandRows made;
  made.terms = energy_terms(problem);
  for (const BandSample& sample : problem.samples) {
    require(sample.radius > 0, "radius " + std::to_string(sample.radius) + ", expected above 0");
    require(sample.derivative >= 0 && sample.derivative <= kRowDegree,
            "derivative " + std::to_string(sample.derivative) + ", expected 0 to 3");
    BandRow row;
    row.value = combination_at(problem.basis, sample.parameter, sample.derivative);
    row.foot = sample.foot;
    row.across = across_of(sample);
    row.radius = sample.radius;
    row.rate = sample.derivative >= rates_from;
    made.rows.push_back(row);
  }
  for (const HeldPoint& held : problem.held) {
    require(held.index < problem.basis.size(), "held point " + std::to_string(held.index) + " of " +
                                                   std::to_string(problem.basis.size()));
  }
  return made;
}

}  // namespace batten::geometry
