// Steps 1 to 5 of docs/algorithms/naseath.md (Naseath 2007, chapter 3), and the repairs.
#include "geometry/fitting/naseath/naseath.h"

#include <algorithm>
#include <cstddef>
#include <optional>
#include <span>
#include <utility>

#include "geometry/basic/point.h"
#include "geometry/basic/require.h"
#include "geometry/path/parameter_samples.h"

namespace batten::geometry {
namespace {

using ControlPolygon = std::vector<Point3>;

// Span j of a cubic hangs on the control points j to j + 3.
constexpr std::size_t kNaseathDegree = 3;

// The turn at point i: the cross product of the legs before and after it, or exactly zero where
// the legs are parallel but for rounding, and at the ends.
std::vector<Vector3> turns_of(const ControlPolygon& polygon) {
  std::vector<Vector3> turns(polygon.size(), Vector3::Zero());
  for (std::size_t i = 1; i + 1 < polygon.size(); ++i) {
    const Vector3 before = polygon[i] - polygon[i - 1];
    const Vector3 after = polygon[i + 1] - polygon[i];
    const Vector3 turn = before.cross(after);
    const bool turned = turn.norm() > kNaseathTuning.no_turn * before.norm() * after.norm();
    if (turned) turns[i] = turn;
  }
  return turns;
}

// Neighbouring points that turn the same way.
struct TurnGroup {
  std::size_t first = 0;
  std::size_t count = 0;

  // The middle one, or the first of two middle ones.
  [[nodiscard]] std::size_t apex() const { return first + (count - 1) / 2; }
  [[nodiscard]] bool has_two_apexes() const { return count % 2 == 0; }
};

TurnGroup longest_from(const std::vector<Vector3>& turns, std::size_t first) {
  TurnGroup group{first, 1};
  for (std::size_t i = first + 1; i < turns.size() && turns[i - 1].dot(turns[i]) > 0; ++i) {
    ++group.count;
  }
  return group;
}

Vector3 unit(const Vector3& v) {
  const double size = v.norm();
  return size < kNaseathTuning.no_direction ? Vector3::Zero() : Vector3(v / size);
}

// `v` without its part along the unit vector `along`.
Vector3 across(const Vector3& v, const Vector3& along) { return v - v.dot(along) * along; }

Vector3 bisector(const ControlPolygon& polygon, std::size_t i) {
  const Vector3 back = unit(polygon[i - 1] - polygon[i]);
  const Vector3 on = unit(polygon[i + 1] - polygon[i]);
  return unit(back + on);
}

// Across the original leg, towards the line through the two neighbours.
Vector3 end_direction(const Point3& end, const Point3& near, const Point3& far,
                      const Vector3& leg) {
  const Vector3 to_line = across(near - end, unit(far - near));
  if (to_line.norm() < kNaseathTuning.no_direction) return Vector3::Zero();
  return unit(across(to_line, unit(leg)));
}

// Between the two apexes i and i + 1: across the leg that joins them, to the inner side.
Vector3 double_apex_direction(const ControlPolygon& polygon, std::size_t i) {
  const Vector3 leg = unit(polygon[i + 1] - polygon[i]);
  const Vector3 inward = polygon[i + 2] - polygon[i + 1] + polygon[i - 1] - polygon[i];
  return unit(across(inward, leg));
}

void set_group(const ControlPolygon& polygon, const TurnGroup& group,
               std::vector<Vector3>& directions) {
  const std::size_t apex = group.apex();
  const Vector3 with =
      group.has_two_apexes() ? double_apex_direction(polygon, apex) : bisector(polygon, apex);
  for (std::size_t i = group.first; i < group.first + group.count; ++i) {
    directions[i] = unit(kNaseathTuning.apex_share * with - bisector(polygon, i));
  }
  directions[apex] = with;
  if (group.has_two_apexes()) directions[apex + 1] = with;
}

// Unit vectors, one per point; zero where a point has nowhere to go. The ends move across the legs
// of the `original`.
std::vector<Vector3> naseath_directions(const ControlPolygon& polygon,
                                        const ControlPolygon& original) {
  const std::size_t m = polygon.size();
  const std::vector<Vector3> turns = turns_of(polygon);
  std::vector<Vector3> directions(m, Vector3::Zero());
  for (std::size_t i = 1; i + 1 < m;) {
    const TurnGroup group = longest_from(turns, i);
    if (group.count >= kNaseathTuning.fewest_in_group) {
      set_group(polygon, group, directions);
    } else {  // ripples
      for (std::size_t k = i; k < i + group.count; ++k) directions[k] = bisector(polygon, k);
    }
    i += group.count;
  }
  directions.front() = end_direction(polygon[0], polygon[1], polygon[2], original[1] - original[0]);
  directions.back() = end_direction(polygon[m - 1], polygon[m - 2], polygon[m - 3],
                                    original[m - 1] - original[m - 2]);
  return directions;
}

// The parameter at which a control point acts most, one per point: the middle knot of the five
// of its function; beside the ends, where that is the end itself, the middle of the first (last)
// span.
std::vector<double> parameters_of_influence(const BsplineBasis& basis) {
  const auto& t = basis.knots();
  const std::size_t points = basis.size();
  std::vector<double> parameters;
  for (std::size_t i = 0; i < points; ++i) parameters.push_back(t[i + 2]);
  parameters[1] = 0.5 * (t[3] + t[4]);
  parameters[points - 2] = 0.5 * (t[points - 1] + t[points]);
  return parameters;
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

std::vector<double> span_curvatures(const BsplineCurve& curve) {
  constexpr int kSteps = kNaseathTuning.steps_per_pass;
  const auto samples = parameter_samples(curve, kSteps);
  std::vector<double> greatest;
  for (std::size_t from = 0; from + 1 < samples.size(); from += kSteps) {
    greatest.push_back(max_curvature(std::span(samples).subspan(from, kSteps + 1)));
  }
  return greatest;
}

// How hard each span may bend: as hard as it or one of its neighbours did in the old curve.
std::vector<double> curvature_limits(const BsplineCurve& curve) {
  const std::vector<double> old = span_curvatures(curve);
  std::vector<double> limits;
  for (std::size_t j = 0; j < old.size(); ++j) {
    const double before = old[j > 0 ? j - 1 : j];
    const double after = old[j + 1 < old.size() ? j + 1 : j];
    limits.push_back(std::max({before, old[j], after}) * (1 + kNaseathTuning.same_bending));
  }
  return limits;
}

// What is left of the tube's radius.
struct TubeRoom {
  double least = 0;               // mm, over the whole curve
  std::vector<double> per_point;  // mm, over the spans that the point acts on
};

// Makes the passes of one curve. Curve and options must outlive it.
class NaseathPasses {
 public:
  // Measures the first sensitivities with a mock move by the radius.
  NaseathPasses(const BsplineCurve& curve, const NaseathOptions& options)
      : basis_(curve.basis()),
        original_(curve.control_points()),
        options_(options),
        at_tube_(options.accuracy * options.radius),
        influence_(parameters_of_influence(curve.basis())),
        sensitivities_(original_.size(), 1),
        parts_(original_.size(), 1) {
    if (options.repairs.guard_curvature) limits_ = curvature_limits(curve);
    measure(naseath_directions(original_, original_),
            std::vector<double>(original_.size(), options.radius));
  }

  [[nodiscard]] BsplineCurve curve_of(ControlPolygon polygon) const {
    return {basis_, std::move(polygon)};
  }

  [[nodiscard]] TubeRoom room_of(const ControlPolygon& polygon) const {
    const double radius = options_.radius;
    const std::size_t m = polygon.size();
    TubeRoom room;
    if (!options_.repairs.exact_bound) {
      room.least = radius - sampled_displacement(displacement_of(polygon), options_.precision);
      room.per_point.assign(m, room.least);
      return room;
    }
    const std::vector<double> bounds =
        displacement_bounds(displacement_of(polygon), kNaseathTuning.slack * at_tube_);
    const bool local = options_.repairs.local_stop;
    room.least = radius - std::ranges::max(bounds);
    room.per_point.assign(m, kNaseathTuning.inside * (local ? radius : room.least));
    for (std::size_t j = 0; local && j < bounds.size(); ++j) {
      for (std::size_t i = j; i <= j + kNaseathDegree; ++i) {
        double& left = room.per_point[i];
        left = std::min(left, kNaseathTuning.inside * (radius - bounds[j]));
      }
    }
    return room;
  }

  [[nodiscard]] bool has_any(const TubeRoom& room) const {
    return std::ranges::max(room.per_point) >= at_tube_;
  }

  // mm: no more than this between the curves at any parameter, and above the greatest by half of
  // what `inside` keeps free at most, so that it is inside the tube as well.
  [[nodiscard]] double greatest_displacement(const ControlPolygon& polygon) const {
    const double free = (1 - kNaseathTuning.inside) * options_.radius;
    return std::ranges::max(displacement_bounds(displacement_of(polygon), free / 2));
  }

  // Moves the points inside the room given. False when none has anywhere to go.
  bool move(ControlPolygon& polygon, const TubeRoom& room) {
    const auto directions = naseath_directions(polygon, original_);
    const std::vector<double> sizes = sizes_of(room);
    const ControlPolygon before = polygon;
    bool moved = false;
    for (std::size_t i = 0; i < polygon.size(); ++i) {
      if (is_held(i)) continue;
      const Vector3 step = sizes[i] * directions[i];
      moved = moved || !step.isZero(0);
      polygon[i] += step;
    }
    measure(directions, sizes);
    if (options_.repairs.guard_curvature) take_back(polygon, before);
    return moved;
  }

 private:
  [[nodiscard]] bool is_held(std::size_t i) const {
    const auto held = static_cast<std::size_t>(std::max(0, options_.held_points));
    return i < held || i + held >= original_.size();
  }

  [[nodiscard]] BsplineCurve displacement_of(const ControlPolygon& polygon) const {
    ControlPolygon moves = polygon;
    for (std::size_t i = 0; i < moves.size(); ++i) moves[i] -= original_[i];
    return curve_of(std::move(moves));
  }

  // The nominal moves: the room, all of it for the least sensitive point, and in proportion to 1/S
  // for the others.
  [[nodiscard]] std::vector<double> sizes_of(const TubeRoom& room) const {
    const NaseathRepairs& repairs = options_.repairs;
    std::vector<double> sizes(original_.size(), 0);
    for (std::size_t i = 0; i < sizes.size(); ++i) {
      const bool stopped = repairs.local_stop && room.per_point[i] < at_tube_;
      if (stopped || parts_[i] <= 0) continue;
      sizes[i] = 1 / std::max(sensitivities_[i], repairs.sensitivity_floor);
    }
    const double greatest = std::ranges::max(sizes);
    for (std::size_t i = 0; i < sizes.size(); ++i) {
      if (sizes[i] > 0) sizes[i] *= parts_[i] * room.per_point[i] / greatest;
    }
    return sizes;
  }

  [[nodiscard]] std::vector<std::size_t> spans_too_hard(const ControlPolygon& polygon) const {
    const std::vector<double> now = span_curvatures(curve_of(polygon));
    std::vector<std::size_t> spans;
    for (std::size_t j = 0; j < now.size(); ++j) {
      if (now[j] > limits_[j]) spans.push_back(j);
    }
    return spans;
  }

  // Where the curve would bend harder than the old one did thereabouts, its points go back to where
  // they were. That ends, since the polygon before the pass bends nowhere too hard.
  void take_back(ControlPolygon& polygon, const ControlPolygon& before) {
    std::vector<bool> back(polygon.size(), false);
    for (auto spans = spans_too_hard(polygon); !spans.empty(); spans = spans_too_hard(polygon)) {
      for (const std::size_t span : spans) {
        for (std::size_t k = span; k <= span + kNaseathDegree; ++k) {
          back[k] = true;
          polygon[k] = before[k];
        }
      }
    }
    for (std::size_t i = 0; i < polygon.size(); ++i) {
      if (back[i]) parts_[i] = parts_[i] / 2 < kNaseathTuning.least_part ? 0 : parts_[i] / 2;
    }
  }

  // Sensitivities: |D(t_i)| / size_i per point, where D is the spline of the moves as they were
  // made and size_i the nominal size of one, counted even if its direction was null. 1 where the
  // quotient is nothing; points without a size keep what they had.
  void measure(const std::vector<Vector3>& directions, const std::vector<double>& sizes) {
    ControlPolygon moves(sizes.size(), Point3::Zero());
    for (std::size_t i = 0; i < sizes.size(); ++i) {
      if (!is_held(i)) moves[i] = sizes[i] * directions[i];
    }
    const BsplineCurve moved = curve_of(std::move(moves));
    for (std::size_t i = 0; i < sizes.size(); ++i) {
      if (sizes[i] <= 0) continue;
      const double quotient = moved.point_at(influence_[i]).norm() / sizes[i];
      sensitivities_[i] = quotient < kNaseathTuning.no_influence ? 1 : quotient;
    }
  }

  const BsplineBasis& basis_;
  const ControlPolygon& original_;
  const NaseathOptions& options_;
  double at_tube_;                 // mm: less room is none
  std::vector<double> influence_;  // parameters, per point
  std::vector<double> sensitivities_;
  std::vector<double> parts_;   // of each point's move: halved each time one was taken back
  std::vector<double> limits_;  // 1/mm, per span; with guard_curvature
};

struct Fairness {
  double max_curvature = 0;  // 1/mm
  double bending = 0;        // 1/mm, the integral of curvature^2 over the length

  Fairness(const BsplineCurve& curve, int steps) {
    const auto samples = parameter_samples(curve, steps);
    max_curvature = geometry::max_curvature(samples);
    bending = geometry::bending(samples);
  }

  [[nodiscard]] bool no_worse_than(const Fairness& other) const {
    return max_curvature <= other.max_curvature * (1 + kNaseathTuning.same_bending) &&
           bending <= other.bending * (1 + kNaseathTuning.same_bending);
  }
};

// The pass that bends least among those that are no worse than the old curve, which is pass 0.
struct BestPass {
  explicit BestPass(const BsplineCurve& old_curve)
      : old(old_curve, kNaseathTuning.steps_per_pass),
        curve(old_curve),
        bending(old.bending),
        progress(old.bending) {}

  void offer(BsplineCurve other, int number) {
    const Fairness fairness(other, kNaseathTuning.steps_per_pass);
    if (!fairness.no_worse_than(old) || !(fairness.bending < bending)) return;
    curve = std::move(other);
    pass = number;
    bending = fairness.bending;
    if (bending < progress * (1 - kNaseathTuning.progress)) {
      progress = bending;
      last_progress = number;
    }
  }

  Fairness old;
  BsplineCurve curve;
  int pass = 0;
  double bending;   // of `curve`
  double progress;  // bending at the last pass that was progress
  int last_progress = 0;
};

void check(const BsplineCurve& curve, const NaseathOptions& options) {
  const auto above_zero = [](const char* what, double found) {
    require(found > 0, what, found, "above 0");
  };
  above_zero("smooth_naseath: radius", options.radius);
  above_zero("smooth_naseath: accuracy", options.accuracy);
  above_zero("smooth_naseath: precision", options.precision);
  above_zero("smooth_naseath: max_passes", options.max_passes);
  const BsplineBasis& basis = curve.basis();
  const auto& t = basis.knots();
  bool fits = curve.degree() == static_cast<int>(kNaseathDegree) && t.front() == basis.first() &&
              t.back() == basis.last();
  for (std::size_t i = kNaseathDegree; fits && i < basis.size(); ++i) fits = t[i] < t[i + 1];
  require(fits, "smooth_naseath: degree", curve.degree(),
          "a clamped cubic with single inner knots");
}

}  // namespace

NaseathResult smooth_naseath(const BsplineCurve& curve, const NaseathOptions& options) {
  check(curve, options);
  NaseathPasses passes(curve, options);
  ControlPolygon polygon = curve.control_points();
  const int patience = options.repairs.stall_passes;
  std::optional<BestPass> best;
  if (options.repairs.keep_best) best.emplace(curve);
  NaseathResult result{curve, {}, 0, 0, NaseathStop::kTouchesTube, 0};
  while (true) {
    const TubeRoom room = passes.room_of(polygon);
    result.remaining.push_back(room.least);
    if (!passes.has_any(room)) break;
    if (result.passes == options.max_passes) {
      result.stop = NaseathStop::kPassLimit;
      break;
    }
    if (best && patience > 0 && result.passes - best->last_progress >= patience) {
      result.stop = NaseathStop::kStalled;
      break;
    }
    if (!passes.move(polygon, room)) {
      result.stop = NaseathStop::kNothingToMove;
      break;
    }
    ++result.passes;
    if (best) best->offer(passes.curve_of(polygon), result.passes);
  }
  if (!best) {
    result.kept_pass = result.passes;
    if (result.passes > 0) result.curve = passes.curve_of(polygon);
  } else if (best->pass > 0 &&
             Fairness(best->curve, kNaseathSteps).no_worse_than(Fairness(curve, kNaseathSteps))) {
    result.kept_pass = best->pass;
    result.curve = best->curve;
  }
  result.displacement = passes.greatest_displacement(result.curve.control_points());
  return result;
}

}  // namespace batten::geometry
