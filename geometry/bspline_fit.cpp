#include "geometry/bspline_fit.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <stdexcept>
#include <utility>

#include "geometry/banded_cholesky.h"

namespace batten::geometry {

namespace {

constexpr int kDegree = 3;

// A sample's weight starts at this many times the stiffness of its span: close to the
// least-squares curve. From there weights fall where there is room.
constexpr double kTightStart = 30;

// Weights stay above this part of the stiffness, so that a stretch whose samples all have
// room is still held somewhere and the system stays regular; and below this multiple of it:
// heavier weights no longer move the curve where its knots cannot follow.
constexpr double kWeightFloor = 1e-8;
constexpr double kWeightCap = 1e4;

// Scatter is judged over this many neighbours on either side: enough for a standard error of
// a fifth, few enough to follow a change of noise along the path.
constexpr std::size_t kScatterWindow = 10;

// Sliding along is drawn back by this part in every pass, so that the parameter stays near
// the place it was made for and the curve cannot fold.
constexpr double kSlidePull = 0.05;

// No sample slides further than this many limits: the path turns away from its direction.
constexpr double kSlideRoom = 2;

// In one pass a weight changes by this factor at the most.
constexpr double kWeightStep = 8;

// So many passes in a row that change the energy by less than this, inside the limits but for
// this excess, end the work.
constexpr int kSettled = 3;
constexpr double kSteady = 0.005;
constexpr double kInside = 1.03;

// A blend of two solutions changes from one to the other over five control points.
constexpr double kFade = 0.2;

// A sample this far above its limit asks for another knot; so does a span whose samples
// scatter this much more than expected (a tight fit leaves about half of the scatter).
constexpr double kTooFar = 1.05;
constexpr double kTooScattered = 1.5;

struct BasisRow {
  std::size_t first = 0;  // index of the first of four control points
  std::array<double, 4> value{};
};

std::vector<double> knots_with_pins(const std::vector<double>& breakpoints,
                                    const std::vector<Pin>& pins) {
  std::vector<double> knots;
  knots.reserve(breakpoints.size() + 2 * pins.size() + 2);
  std::size_t pin = 0;
  for (const double u : breakpoints) {
    int copies = 1;
    if (pin < pins.size() && u == pins[pin].parameter) {
      const bool end = pin == 0 || pin + 1 == pins.size();
      copies = end ? kDegree + 1 : kDegree;
      ++pin;
    }
    knots.insert(knots.end(), copies, u);
  }
  if (pin != pins.size()) throw std::invalid_argument("fit_bspline: a pin is no breakpoint");
  return knots;
}

// The fit on one set of knots. Weights belong to the samples and outlive it.
class FitOnKnots {
 public:
  FitOnKnots(const FitProblem& problem, const std::vector<double>& breakpoints)
      : problem_(problem),
        basis_(kDegree, knots_with_pins(breakpoints, problem.pins)),
        energy_(basis_.size()),
        matrix_(basis_.size()),
        points_(basis_.size(), Point3::Zero()) {
    make_energy();
    make_rows();
    make_fixed();
  }

  [[nodiscard]] BsplineBasis basis() const { return basis_; }
  [[nodiscard]] const std::vector<Point3>& points() const { return points_; }

  // Stiffness of the curve at each sample: what a weight has to be compared with.
  [[nodiscard]] std::vector<double> stiffness() const {
    std::vector<double> at(rows_.size());
    std::vector<double> share(basis_.size(), 0);
    for (const BasisRow& row : rows_) {
      for (int j = 0; j < 4; ++j) share[row.first + j] += row.value[j] * row.value[j];
    }
    for (std::size_t i = 0; i < rows_.size(); ++i) {
      double most = 0;
      for (int j = 0; j < 4; ++j) {
        const std::size_t c = rows_[i].first + j;
        most = std::max(most, energy_.at(c, 0) / std::max(share[c], 1e-3));
      }
      at[i] = most;
    }
    return at;
  }

  void set_points(std::vector<Point3> points) { points_ = std::move(points); }

  // The integral of |C'''|^2 of the present control points.
  [[nodiscard]] double energy() const {
    double sum = 0;
    for (std::size_t i = 0; i < points_.size(); ++i) {
      for (int k = 0; k <= kDegree && k <= static_cast<int>(i); ++k) {
        sum += (k == 0 ? 1 : 2) * energy_.at(i, k) * points_[i].dot(points_[i - k]);
      }
    }
    return sum;
  }

  // Solves for the control points; `targets` are the samples' targets, slid along.
  [[nodiscard]] bool solve(const std::vector<double>& weights, const std::vector<Point3>& targets) {
    matrix_ = energy_;
    std::vector<Point3> right(basis_.size(), Point3::Zero());
    for (std::size_t i = 0; i < rows_.size(); ++i) {
      const BasisRow& row = rows_[i];
      for (int j = 0; j < 4; ++j) {
        const double weighted = weights[i] * row.value[j];
        right[row.first + j] += weighted * targets[i];
        for (int k = 0; k <= j; ++k) matrix_.at(row.first + j, j - k) += weighted * row.value[k];
      }
    }
    for (const auto& [index, place] : fixed_) matrix_.fix(index, place, right);
    if (!matrix_.solve(right)) return false;
    points_ = std::move(right);
    return true;
  }

  [[nodiscard]] Point3 at_sample(std::size_t i) const { return at_sample(i, points_); }

  // The same place on the curve with other control points.
  [[nodiscard]] Point3 at_sample(std::size_t i, const std::vector<Point3>& points) const {
    const BasisRow& row = rows_[i];
    Point3 p = Point3::Zero();
    for (int j = 0; j < 4; ++j) p += row.value[j] * points[row.first + j];
    return p;
  }

  // After solve(): the inverse of the last system, and the compliance of the curve at a sample,
  // how far a unit force there moves it.
  [[nodiscard]] BandedMatrix inverse() const {
    BandedMatrix inverse = matrix_.inverse_band();
    // Fixed control points do not move: their unit rows stand for no compliance.
    for (const auto& [index, place] : fixed_) inverse.at(index, 0) = 0;
    return inverse;
  }
  [[nodiscard]] double leverage(std::size_t i, const BandedMatrix& inverse) const {
    const BasisRow& row = rows_[i];
    double sum = 0;
    for (int j = 0; j < 4; ++j) {
      sum += row.value[j] * row.value[j] * inverse.at(row.first + j, 0);
      for (int k = 0; k < j; ++k) {
        sum += 2 * row.value[j] * row.value[k] * inverse.at(row.first + j, j - k);
      }
    }
    return sum;
  }

  // The first of the four control points that hold sample i.
  [[nodiscard]] std::size_t first_control_point(std::size_t i) const { return rows_[i].first; }

 private:
  void make_energy() {
    const auto& t = basis_.knots();
    std::array<double, 16> n{};
    for (std::size_t span = kDegree; span < basis_.size(); ++span) {
      const double width = t[span + 1] - t[span];
      if (!(width > 0)) continue;
      basis_.evaluate_derivatives(span, t[span], 3, n.data());
      const double* third = &n[12];
      for (int j = 0; j < 4; ++j) {
        for (int k = 0; k <= j; ++k) {
          energy_.at(span - kDegree + j, j - k) += width * third[j] * third[k];
        }
      }
    }
  }

  void make_rows() {
    rows_.resize(problem_.samples.size());
    const auto& t = basis_.knots();
    std::size_t span = kDegree;
    for (std::size_t i = 0; i < rows_.size(); ++i) {
      const double u = problem_.samples[i].parameter;
      while (span + 1 < basis_.size() && t[span + 1] <= u) ++span;
      rows_[i].first = span - kDegree;
      basis_.evaluate(span, u, rows_[i].value.data());
    }
  }

  void make_fixed() {
    for (const Pin& pin : problem_.pins) {
      // The control point at a pin is the one whose Greville abscissa is the pin.
      const std::size_t span = basis_.find_span(pin.parameter);
      const std::size_t index = pin.parameter >= basis_.last() ? basis_.size() - 1 : span - kDegree;
      fixed_.emplace_back(index, pin.place);
    }
    for (const StraightZone& zone : problem_.zones) {
      const std::size_t span = basis_.find_span(0.5 * (zone.from + zone.to));
      const Vector3 per_unit = (zone.end - zone.start) / (zone.to - zone.from);
      for (int j = 0; j < 4; ++j) {
        const std::size_t index = span - kDegree + j;
        const double u = basis_.greville(index);
        fixed_.emplace_back(index, zone.start + (u - zone.from) * per_unit);
      }
    }
  }

  const FitProblem& problem_;
  BsplineBasis basis_;
  BandedMatrix energy_;
  BandedMatrix matrix_;
  std::vector<Point3> points_;
  std::vector<BasisRow> rows_;
  std::vector<std::pair<std::size_t, Point3>> fixed_;
};

// The state of the samples between passes.
struct Samples {
  std::vector<double> base;       // weight that makes the distances scatter as expected
  std::vector<double> weights;    // multiplier of the limit, on top of it
  std::vector<Point3> targets;    // slid along
  std::vector<double> distances;  // mm
};

// How much of the way from the target to the curve counts: what is left after sliding.
Vector3 across(const FitSample& sample, const Vector3& off) {
  const double room = kSlideRoom * sample.limit;
  return off - std::clamp(off.dot(sample.along), -room, room) * sample.along;
}

void measure(const FitProblem& problem, const FitOnKnots& fit, Samples& state) {
  for (std::size_t i = 0; i < problem.samples.size(); ++i) {
    const FitSample& sample = problem.samples[i];
    const Vector3 off = fit.at_sample(i) - sample.target;
    const Vector3 left = across(sample, off);
    state.targets[i] = sample.target + (1 - kSlidePull) * (off - left);
    state.distances[i] = left.norm();
  }
}

double bounded(double weight, double stiffness) {
  return std::clamp(weight, kWeightFloor * stiffness, kWeightCap * stiffness);
}

// The multiplier of a limit is felt only where the limit holds the curve. Where there is room
// it falls by the ratio (C. L. Lawson's reweighting). Where the limit is passed it takes half
// of Newton's step: with leverage h, the compliance of the curve at the sample, a weight w
// leaves a distance proportional to 1 / (w + k), k = 1 / h - w, so that w + (ratio - 1) / h
// would meet the limit if no other sample moved.
void reweight_limits(const FitProblem& problem, const std::vector<double>& stiffness,
                     const FitOnKnots& fit, Samples& state) {
  constexpr double kStep = 0.5;
  const BandedMatrix inverse = fit.inverse();
  for (std::size_t i = 0; i < state.weights.size(); ++i) {
    const double ratio = state.distances[i] / problem.samples[i].limit;
    double& weight = state.weights[i];
    if (ratio <= 1) {
      weight *= std::max(ratio, 1 / kWeightStep);
    } else {
      const double leverage = fit.leverage(i, inverse);
      if (leverage > 0) weight += kStep * (std::min(ratio, kWeightStep) - 1) / leverage;
    }
    weight = bounded(weight, stiffness[i]);
  }
}

// The discrepancy principle, locally: the base weight falls where the distances of the
// neighbourhood are smaller than their scatter and grows where they are greater.
void reweight_scatter(const FitProblem& problem, const std::vector<double>& stiffness,
                      Samples& state) {
  const std::size_t n = state.base.size();
  double sum = 0;  // of squared distances over scatter in [begin, end[
  std::size_t count = 0;
  std::size_t begin = 0;
  std::size_t end = 0;
  const auto square = [&](std::size_t i) {
    const double ratio = state.distances[i] / problem.samples[i].scatter;
    return ratio * ratio;
  };
  for (std::size_t i = 0; i < n; ++i) {
    for (; end < n && end <= i + kScatterWindow; ++end) {
      if (problem.samples[end].scatter > 0) sum += square(end), ++count;
    }
    for (; begin + kScatterWindow < i; ++begin) {
      if (problem.samples[begin].scatter > 0) sum -= square(begin), --count;
    }
    if (!(problem.samples[i].scatter > 0) || count == 0) continue;
    const double rms = std::sqrt(std::max(sum, 0.0) / static_cast<double>(count));
    const double factor = std::clamp(rms, 1 / kWeightStep, kWeightStep);
    state.base[i] = bounded(state.base[i] * factor, stiffness[i]);
  }
}

// Whether the samples [begin, end[ of one span show that its knots cannot follow them.
bool needs_knot(const FitProblem& problem, const std::vector<double>& distances, std::size_t begin,
                std::size_t end) {
  double squares = 0;
  std::size_t count = 0;
  for (std::size_t i = begin; i < end; ++i) {
    const FitSample& sample = problem.samples[i];
    if (distances[i] > kTooFar * sample.limit) return true;
    if (!(sample.scatter > 0)) continue;
    squares += distances[i] * distances[i] / (sample.scatter * sample.scatter);
    ++count;
  }
  return squares > kTooScattered * kTooScattered * static_cast<double>(count);
}

// Splits such spans at the middle one of the samples inside them. Returns whether any was.
bool refine(const FitProblem& problem, const std::vector<double>& distances,
            std::vector<double>& breakpoints) {
  std::vector<double> refined;
  refined.reserve(breakpoints.size() * 2);
  std::size_t end = 0;
  for (std::size_t b = 0; b + 1 < breakpoints.size(); ++b) {
    const double from = breakpoints[b];
    refined.push_back(from);
    const std::size_t begin = end;
    while (end < distances.size() && problem.samples[end].parameter < breakpoints[b + 1]) ++end;
    std::size_t inside = begin;
    while (inside < end && problem.samples[inside].parameter <= from) ++inside;
    if (inside < end && needs_knot(problem, distances, begin, end)) {
      refined.push_back(problem.samples[inside + (end - inside) / 2].parameter);
    }
  }
  refined.push_back(breakpoints.back());
  const bool changed = refined.size() > breakpoints.size();
  breakpoints = std::move(refined);
  return changed;
}

void start_tight(const FitProblem& problem, const std::vector<double>& stiffness, Samples& state) {
  for (std::size_t i = 0; i < stiffness.size(); ++i) {
    const bool scatters = problem.samples[i].scatter > 0;
    state.base[i] = scatters ? kTightStart * stiffness[i] : 0;
    state.weights[i] = (scatters ? 0.1 : 1) * kTightStart * stiffness[i];
  }
}

double worst_of(const FitProblem& problem, const Samples& state) {
  double worst = 0;
  for (std::size_t i = 0; i < state.distances.size(); ++i) {
    worst = std::max(worst, state.distances[i] / problem.samples[i].limit);
  }
  return worst;
}

// The greatest part of the way from `tight` to `smooth` at which one sample is still inside its
// limit: the root of |a + part (b - a)| = limit, a and b being the distances across the sample.
double part_inside(const Vector3& a, const Vector3& b, double limit) {
  if (b.norm() <= limit) return 1;
  const Vector3 d = b - a;
  const double half = a.dot(d);
  const double outside = limit * limit - a.squaredNorm();
  if (outside <= 0) return 0;
  return (-half + std::sqrt(half * half + d.squaredNorm() * outside)) / d.squaredNorm();
}

// Draws `fit` back towards a solution that is inside the limits, only where it is outside, and
// fading over the control points around. Distances are convex in the control points, so a
// blend of two curves is no further out than the further of the two.
void draw_inside(const FitProblem& problem, const std::vector<Point3>& tight, FitOnKnots& fit,
                 Samples& state) {
  const std::vector<Point3> smooth = fit.points();
  std::vector<double> part(smooth.size(), 1);
  for (std::size_t i = 0; i < state.distances.size(); ++i) {
    const FitSample& sample = problem.samples[i];
    if (state.distances[i] <= sample.limit) continue;
    const double inside =
        part_inside(across(sample, fit.at_sample(i, tight) - sample.target),
                    across(sample, fit.at_sample(i, smooth) - sample.target), sample.limit);
    const std::size_t first = fit.first_control_point(i);
    for (std::size_t j = first; j < first + 4; ++j) part[j] = std::min(part[j], inside);
  }
  for (std::size_t j = 1; j < part.size(); ++j) part[j] = std::min(part[j], part[j - 1] + kFade);
  for (std::size_t j = part.size() - 1; j-- > 0;) part[j] = std::min(part[j], part[j + 1] + kFade);
  std::vector<Point3> blend(smooth.size());
  for (std::size_t j = 0; j < blend.size(); ++j) {
    blend[j] = tight[j] + part[j] * (smooth[j] - tight[j]);
  }
  fit.set_points(std::move(blend));
  measure(problem, fit, state);
}

// The solution that a curve is drawn back to: the smoothest one that was inside the limits, or
// the one that was least outside.
class Refuge {
 public:
  void offer(const FitOnKnots& fit, double worst, double energy) {
    const bool inside = worst <= 1;
    const bool was_inside = worst_ <= 1;
    const bool better = inside && was_inside ? energy < energy_ : worst < worst_;
    if (!better || (was_inside && !inside)) return;
    worst_ = worst;
    energy_ = energy;
    points_ = fit.points();
  }
  [[nodiscard]] const std::vector<Point3>& points() const { return points_; }

 private:
  double worst_ = std::numeric_limits<double>::infinity();
  double energy_ = std::numeric_limits<double>::infinity();
  std::vector<Point3> points_;
};

// Solves and reweights in turn. Weights approach their values from both sides, so in the end
// the curve may be slightly outside somewhere: it is drawn back there.
void run_passes(const FitProblem& problem, int passes, const std::vector<double>& stiffness,
                FitOnKnots& fit, Samples& state) {
  std::vector<double> weights(state.weights.size());
  Refuge refuge;
  double energy = std::numeric_limits<double>::infinity();
  int settled = 0;
  for (int pass = 0; pass < passes && settled < kSettled; ++pass) {
    if (pass > 0) {
      reweight_limits(problem, stiffness, fit, state);
      reweight_scatter(problem, stiffness, state);
    }
    for (std::size_t i = 0; i < weights.size(); ++i) weights[i] = state.base[i] + state.weights[i];
    if (!fit.solve(weights, state.targets)) break;
    measure(problem, fit, state);
    const double worst = worst_of(problem, state);
    const double before = std::exchange(energy, fit.energy());
    refuge.offer(fit, worst, energy);
    const bool steady = std::abs(energy - before) <= kSteady * before && worst <= kInside;
    settled = steady ? settled + 1 : 0;
  }
  if (!refuge.points().empty()) draw_inside(problem, refuge.points(), fit, state);
}

bool in_zone(const std::vector<StraightZone>& zones, double u) {
  const auto after = std::upper_bound(zones.begin(), zones.end(), u,
                                      [](double v, const StraightZone& z) { return v < z.from; });
  return after != zones.begin() && u < std::prev(after)->to;
}

BsplineFit result_of(const FitProblem& given, const FitProblem& problem, const FitOnKnots& fit,
                     const Samples& state) {
  BsplineFit result{BsplineCurve(fit.basis(), fit.points()), {}, 0};
  result.ratios.reserve(given.samples.size());
  std::size_t i = 0;
  for (const FitSample& sample : given.samples) {
    const bool straight = in_zone(problem.zones, sample.parameter);
    result.ratios.push_back(straight ? 0 : state.distances[i++] / sample.limit);
    result.worst_ratio = std::max(result.worst_ratio, result.ratios.back());
  }
  return result;
}

}  // namespace

BsplineFit fit_bspline(const FitProblem& given, const FitOptions& options) {
  if (given.pins.size() < 2) {
    throw std::invalid_argument("fit_bspline: " + std::to_string(given.pins.size()) +
                                " pins, expected 2 or more");
  }
  FitProblem problem = given;
  std::erase_if(problem.samples,
                [&](const FitSample& s) { return in_zone(problem.zones, s.parameter); });

  const std::size_t n = problem.samples.size();
  Samples state{std::vector<double>(n), std::vector<double>(n), std::vector<Point3>(n),
                std::vector<double>(n)};
  for (std::size_t i = 0; i < n; ++i) state.targets[i] = problem.samples[i].target;

  std::vector<double> breakpoints = problem.breakpoints;
  for (int round = 0;; ++round) {
    FitOnKnots fit(problem, breakpoints);
    const std::vector<double> stiffness = fit.stiffness();
    start_tight(problem, stiffness, state);
    run_passes(problem, options.passes, stiffness, fit, state);
    if (round < options.max_refinements && refine(problem, state.distances, breakpoints)) continue;
    run_passes(problem, options.last_passes, stiffness, fit, state);
    return result_of(given, problem, fit, state);
  }
}

}  // namespace batten::geometry
