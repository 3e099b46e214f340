#include "geometry/naseath.h"

#include <algorithm>
#include <cmath>
#include <optional>
#include <stdexcept>
#include <string>
#include <utility>

#include "geometry/displacement.h"
#include "geometry/naseath_categories.h"
#include "geometry/naseath_directions.h"
#include "geometry/naseath_sensitivity.h"
#include "geometry/numeric.h"
#include "geometry/parameter_samples.h"

namespace batten::geometry {

namespace {

constexpr std::size_t kDegree = 3;

// A bound on the displacement may exceed it by this part of what `accuracy` resolves.
constexpr double kSlack = 0.1;

// Places per span at which the curves of single passes are compared. The one that is returned
// is compared with the old curve at kNaseathSteps.
constexpr int kStepsPerPass = 32;

// Curvatures and bendings this much above each other, relatively, are equal but for rounding.
constexpr double kSameBending = 1e-9;

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
  for (std::size_t i = kDegree; i < basis.size(); ++i) {
    if (!(t[i] < t[i + 1])) return false;
  }
  return true;
}

// What stays the same over the passes.
struct Setting {
  BsplineBasis basis;
  ControlPolygon original;
  EndLegs legs;
  std::vector<double> parameters;  // of influence, per point
  NaseathOptions options;

  // The curve of a polygon: on a ring its first three points come again at the end.
  [[nodiscard]] BsplineCurve curve_of(std::vector<Point3> points) const {
    if (original.closed) {
      for (std::size_t i = 0; i < kDegree; ++i) points.push_back(points[i]);
    }
    return {basis, std::move(points)};
  }
  [[nodiscard]] bool is_held(std::size_t i) const {
    const auto held = static_cast<std::size_t>(std::max(0, options.held_points));
    return !original.closed && (i < held || i + held >= original.size());
  }
};

Setting setting_of(const BsplineCurve& curve, const NaseathOptions& options) {
  check(options);
  const bool ring = is_periodic_ring(curve);
  if (curve.degree() != static_cast<int>(kDegree) || !has_single_inner_knots(curve.basis()) ||
      !(ring || is_clamped(curve.basis()))) {
    throw std::invalid_argument("smooth_naseath: degree " + std::to_string(curve.degree()) +
                                ", expected a cubic, clamped or a ring, with single inner knots");
  }
  ControlPolygon polygon{curve.control_points(), ring};
  if (ring) polygon.points.resize(polygon.size() - kDegree);
  const std::size_t m = polygon.size();
  const EndLegs legs = end_legs(polygon);
  return {curve.basis(), std::move(polygon), legs, parameters_of_influence(curve.basis(), m),
          options};
}

std::vector<Point3> difference(const std::vector<Point3>& a, const std::vector<Point3>& b) {
  std::vector<Point3> sum = a;
  for (std::size_t i = 0; i < sum.size(); ++i) sum[i] -= b[i];
  return sum;
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

// What is left of the tube's radius.
struct Room {
  double least = 0;               // mm, over the whole curve
  std::vector<double> per_point;  // mm, over the spans that the point acts on
};

Room room_of(const Setting& setting, const ControlPolygon& polygon) {
  const NaseathOptions& options = setting.options;
  const double radius = options.radius;
  const std::size_t m = polygon.size();
  const BsplineCurve displacement =
      setting.curve_of(difference(polygon.points, setting.original.points));
  Room room;
  if (!options.repairs.exact_bound) {
    room.least = radius - sampled_displacement(displacement, options.precision);
    room.per_point.assign(m, room.least);
    return room;
  }
  const std::vector<double> bounds =
      displacement_bounds(displacement, kSlack * options.accuracy * radius);
  room.least = radius - *std::max_element(bounds.begin(), bounds.end());
  room.per_point.assign(m, options.repairs.local_stop ? radius : room.least);
  if (!options.repairs.local_stop) return room;
  // Span j hangs on the four points from j on.
  for (std::size_t j = 0; j < bounds.size(); ++j) {
    for (std::size_t i = j; i <= j + kDegree; ++i) {
      double& left = room.per_point[i % m];
      left = std::min(left, radius - bounds[j]);
    }
  }
  return room;
}

// One pass: directions, sizes, moves.
class Mover {
 public:
  explicit Mover(const Setting& setting)
      : setting_(setting), sensitivities_(setting.original.size(), 1) {
    // The moves that the first sensitivities are measured with are not made.
    const std::size_t m = setting.original.size();
    const auto directions =
        naseath_directions(setting.original, categories_of(setting.original), setting.legs);
    measure(directions, std::vector<double>(m, setting.options.radius));
  }

  // Moves the polygon inside the room given. False when no point moves.
  bool move(ControlPolygon& polygon, const Room& room) {
    const NaseathCategories categories = categories_of(polygon);
    const auto directions = naseath_directions(polygon, categories, setting_.legs);
    const std::vector<double> sizes = sizes_of(polygon, categories, directions, room);
    bool moved = false;
    for (std::size_t i = 0; i < polygon.size(); ++i) {
      if (setting_.is_held(i)) continue;
      const Vector3 step = sizes[i] * directions[i];
      moved = moved || !step.isZero(0);
      polygon.points[i] += step;
    }
    measure(directions, sizes);
    return moved;
  }

 private:
  // The nominal moves: the room, all of it for the least sensitive point, and in proportion to
  // 1/S for the others. (3-39), (3-40)
  [[nodiscard]] std::vector<double> sizes_of(const ControlPolygon& polygon,
                                             const NaseathCategories& categories,
                                             const std::vector<Vector3>& directions,
                                             const Room& room) const {
    const NaseathRepairs& repairs = setting_.options.repairs;
    const std::size_t m = polygon.size();
    const double at_tube = setting_.options.accuracy * setting_.options.radius;
    std::vector<double> sizes(m, 0);
    double greatest = 0;
    for (std::size_t i = 0; i < m; ++i) {
      if (repairs.local_stop && room.per_point[i] < at_tube) continue;
      sizes[i] = 1 / std::max(sensitivities_[i], repairs.sensitivity_floor);
      greatest = std::max(greatest, sizes[i]);
    }
    for (std::size_t i = 0; i < m; ++i) {
      if (sizes[i] <= 0) continue;
      sizes[i] *= room.per_point[i] / greatest;
      if (repairs.clamp_moves) {
        const double target = distance_to_target(polygon, categories, i, directions[i]);
        sizes[i] = std::clamp(target, 0.0, sizes[i]);
      }
    }
    return sizes;
  }

  void measure(const std::vector<Vector3>& directions, const std::vector<double>& sizes) {
    std::vector<Point3> moves(sizes.size(), Point3::Zero());
    for (std::size_t i = 0; i < sizes.size(); ++i) {
      if (!setting_.is_held(i)) moves[i] = sizes[i] * directions[i];
    }
    sensitivities_ = naseath_sensitivities(setting_.curve_of(std::move(moves)), setting_.parameters,
                                           sizes, sensitivities_);
  }

  const Setting& setting_;
  std::vector<double> sensitivities_;
};

// How hard a curve bends, and how to compare two.
struct Fairness {
  double max_curvature = 0;
  double bending = 0;

  [[nodiscard]] bool no_worse_than(const Fairness& other) const {
    return max_curvature <= other.max_curvature * (1 + kSameBending) &&
           bending <= other.bending * (1 + kSameBending);
  }
};

Fairness fairness_of(const BsplineCurve& curve, int steps) {
  const auto samples = parameter_samples(curve, steps);
  return {max_curvature(samples), bending(samples)};
}

// The pass that bends least among those whose greatest curvature is not above the old one.
class Best {
 public:
  Best(const Setting& setting, const ControlPolygon& original)
      : setting_(setting), polygon_(original) {
    if (!setting.options.repairs.keep_best) return;
    old_ = fairness_of(setting.curve_of(original.points), kStepsPerPass);
    bending_ = old_.bending;
  }

  void offer(const ControlPolygon& polygon, int pass) {
    if (!setting_.options.repairs.keep_best) {
      take(polygon, pass);
      return;
    }
    const Fairness fairness = fairness_of(setting_.curve_of(polygon.points), kStepsPerPass);
    if (!fairness.no_worse_than(old_) || !(fairness.bending < bending_)) return;
    bending_ = fairness.bending;
    take(polygon, pass);
  }

  // Once more with a finer measure; the old curve comes back where that disagrees.
  void confirm() {
    if (!setting_.options.repairs.keep_best || pass_ == 0) return;
    const auto fine = [&](const ControlPolygon& polygon) {
      return fairness_of(setting_.curve_of(polygon.points), kNaseathSteps);
    };
    if (!fine(polygon_).no_worse_than(fine(setting_.original))) take(setting_.original, 0);
  }

  [[nodiscard]] int pass() const { return pass_; }
  [[nodiscard]] const ControlPolygon& polygon() const { return polygon_; }

 private:
  void take(const ControlPolygon& polygon, int pass) {
    polygon_ = polygon;
    pass_ = pass;
  }

  const Setting& setting_;
  ControlPolygon polygon_;
  int pass_ = 0;
  Fairness old_;
  double bending_ = 0;
};

}  // namespace

bool is_periodic_ring(const BsplineCurve& curve) {
  const auto& t = curve.basis().knots();
  const auto& points = curve.control_points();
  if (curve.degree() != static_cast<int>(kDegree) || points.size() < 2 * kDegree) return false;
  const std::size_t m = points.size() - kDegree;
  const double period = curve.last() - curve.first();
  for (std::size_t i = 0; i < kDegree; ++i) {
    if ((points[i] - points[m + i]).norm() > kSamePlace) return false;
  }
  for (std::size_t i = 0; i <= 2 * kDegree; ++i) {
    if (std::abs(t[m + i] - t[i] - period) > kSameKnot * period) return false;
  }
  return true;
}

NaseathResult smooth_naseath(const BsplineCurve& curve, const NaseathOptions& options) {
  const Setting setting = setting_of(curve, options);
  const double at_tube = options.accuracy * options.radius;
  ControlPolygon polygon = setting.original;
  NaseathResult result{curve, {}, 0, 0, NaseathStop::kTouchesTube, 0};
  Best best(setting, polygon);
  Mover mover(setting);

  while (true) {
    const Room room = room_of(setting, polygon);
    result.remaining.push_back(room.least);
    const bool anywhere = std::any_of(room.per_point.begin(), room.per_point.end(),
                                      [&](double left) { return left >= at_tube; });
    if (!anywhere) break;
    if (result.passes == options.max_passes) {
      result.stop = NaseathStop::kPassLimit;
      break;
    }
    const int idle = result.passes - best.pass();
    if (options.repairs.keep_best && options.repairs.stall_passes > 0 &&
        idle >= options.repairs.stall_passes) {
      result.stop = NaseathStop::kStalled;
      break;
    }
    if (categories_of(polygon).turns_one_way || !mover.move(polygon, room)) {
      result.stop = NaseathStop::kNothingToMove;
      break;
    }
    best.offer(polygon, ++result.passes);
  }
  best.confirm();

  result.kept_pass = best.pass();
  if (best.pass() > 0) result.curve = setting.curve_of(best.polygon().points);
  const auto bounds =
      displacement_bounds(displacement_between(curve, result.curve), kSlack * at_tube);
  result.displacement = *std::max_element(bounds.begin(), bounds.end());
  return result;
}

}  // namespace batten::geometry
