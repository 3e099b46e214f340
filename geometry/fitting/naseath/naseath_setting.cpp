#include "geometry/fitting/naseath/naseath_setting.h"

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <string>
#include <utility>

#include "geometry/path/bspline_curve.h"

namespace batten::geometry {

namespace {

// A bound on the displacement may exceed it by this part of what `accuracy` resolves: while
// passes are made, and in the end.
constexpr double kSlack = 0.1;
constexpr double kLastSlack = 1e-7;

// Of the room that is left, moves take this part. A pass that takes all of it is at the tube to
// within rounding; this much less and the last bound, too, is inside it.
constexpr double kInside = 1 - 1e-6;

void check(const NaseathOptions& options) {
  const auto refuse = [](const std::string& name, double found) {
    throw std::invalid_argument("smooth_naseath: " + name + " " + std::to_string(found) +
                                ", expected above 0");
  };
  if (!(options.radius > 0)) refuse("radius", options.radius);
  if (!(options.accuracy > 0)) refuse("accuracy", options.accuracy);
  if (options.precision < 1) refuse("precision", options.precision);
  if (options.max_passes < 1) refuse("max_passes", options.max_passes);
}

bool is_clamped(const BsplineBasis& basis) {
  const auto& t = basis.knots();
  return t.front() == basis.first() && t.back() == basis.last();
}

bool has_single_inner_knots(const BsplineBasis& basis) {
  const auto& t = basis.knots();
  for (std::size_t i = kNaseathDegree; i < basis.size(); ++i) {
    if (!(t[i] < t[i + 1])) return false;
  }
  return true;
}

BsplineCurve displacement_of(const NaseathSetting& setting, const ControlPolygon& polygon) {
  ControlPolygon moves = polygon;
  for (std::size_t i = 0; i < moves.size(); ++i) moves[i] -= setting.original[i];
  return setting.curve_of(std::move(moves));
}

std::vector<double> bounds_per_span(const NaseathSetting& setting, const ControlPolygon& polygon,
                                    double slack) {
  return displacement_bounds(displacement_of(setting, polygon), slack * setting.at_tube());
}

// The greatest displacement at `precision` equal steps in every span, as the thesis measures it.
double sampled_displacement(const BsplineCurve& displacement, int precision) {
  const std::vector<double> knots = displacement.breakpoints();
  double most = displacement.point_at(knots.back()).norm();
  for (std::size_t span = 0; span + 1 < knots.size(); ++span) {
    for (int i = 0; i < precision; ++i) {
      const double u = knots[span] + (knots[span + 1] - knots[span]) * i / precision;
      most = std::max(most, displacement.point_at(u).norm());
    }
  }
  return most;
}

// Below this (part of the move) the curve does not follow at all, and the quotient is rounding.
constexpr double kNoInfluence = 1e-12;

}  // namespace

BsplineCurve NaseathSetting::curve_of(ControlPolygon polygon) const {
  return {basis, std::move(polygon)};
}

bool NaseathSetting::is_held(std::size_t i) const {
  const auto held = static_cast<std::size_t>(std::max(0, options.held_points));
  return i < held || i + held >= original.size();
}

NaseathSetting naseath_setting(const BsplineCurve& curve, const NaseathOptions& options) {
  check(options);
  if (curve.degree() != static_cast<int>(kNaseathDegree) ||
      !has_single_inner_knots(curve.basis()) || !is_clamped(curve.basis())) {
    throw std::invalid_argument("smooth_naseath: degree " + std::to_string(curve.degree()) +
                                ", expected a clamped cubic with single inner knots");
  }
  return {curve.basis(), curve.control_points(), end_legs(curve.control_points()),
          parameters_of_influence(curve.basis()), options};
}

std::vector<double> parameters_of_influence(const BsplineBasis& basis) {
  const auto& t = basis.knots();
  const std::size_t points = basis.size();
  std::vector<double> parameters;
  for (std::size_t i = 0; i < points; ++i) parameters.push_back(t[i + 2]);
  parameters[1] = 0.5 * (t[3] + t[4]);
  parameters[points - 2] = 0.5 * (t[points - 1] + t[points]);
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

NaseathRoom naseath_room(const NaseathSetting& setting, const ControlPolygon& polygon) {
  const NaseathOptions& options = setting.options;
  const double radius = options.radius;
  const std::size_t m = polygon.size();
  NaseathRoom room;
  if (!options.repairs.exact_bound) {
    room.least =
        radius - sampled_displacement(displacement_of(setting, polygon), options.precision);
    room.per_point.assign(m, room.least);
    return room;
  }
  const std::vector<double> bounds = bounds_per_span(setting, polygon, kSlack);
  room.least = radius - *std::max_element(bounds.begin(), bounds.end());
  room.per_point.assign(m, kInside * (options.repairs.local_stop ? radius : room.least));
  if (!options.repairs.local_stop) return room;
  for (std::size_t j = 0; j < bounds.size(); ++j) {
    for (std::size_t i = j; i <= j + kNaseathDegree; ++i) {
      double& left = room.per_point[i];
      left = std::min(left, kInside * (radius - bounds[j]));
    }
  }
  return room;
}

double naseath_displacement(const NaseathSetting& setting, const ControlPolygon& polygon) {
  const std::vector<double> bounds = bounds_per_span(setting, polygon, kLastSlack);
  return *std::max_element(bounds.begin(), bounds.end());
}

}  // namespace batten::geometry
