#include "geometry/fitting/naseath/naseath_sensitivity.h"

namespace batten::geometry {

namespace {

// Below this (part of the move) the curve does not follow at all, and the quotient is rounding.
constexpr double kNoInfluence = 1e-12;

}  // namespace

std::vector<double> parameters_of_influence(const BsplineBasis& basis, std::size_t points) {
  const auto& t = basis.knots();
  const double period = basis.last() - basis.first();
  std::vector<double> parameters;
  for (std::size_t i = 0; i < points; ++i) {
    double u = t[i + 2];
    if (points == basis.size()) {
      if (i == 1) u = 0.5 * (t[3] + t[4]);
      if (i + 2 == points) u = 0.5 * (t[points - 1] + t[points]);
    } else if (u < basis.first()) {
      u += period;
    }
    parameters.push_back(u);
  }
  return parameters;
}

std::vector<double> naseath_sensitivities(const BsplineCurve& moves,
                                          const std::vector<double>& parameters,
                                          const std::vector<double>& nominal,
                                          const std::vector<double>& before) {
  std::vector<double> sensitivities = before;
  for (std::size_t i = 0; i < parameters.size(); ++i) {
    if (nominal[i] <= 0) continue;
    const double quotient = moves.point_at(parameters[i]).norm() / nominal[i];
    sensitivities[i] = quotient < kNoInfluence ? 1 : quotient;
  }
  return sensitivities;
}

}  // namespace batten::geometry
