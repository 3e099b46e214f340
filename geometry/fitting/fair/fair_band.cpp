#include "geometry/fitting/fair/fair_band.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "geometry/fitting/fair/denoised_path.h"

namespace batten::geometry {

namespace {

// The fit aims inside the band by this share, since between its samples the curve leaves the
// band by a percent or two.
constexpr double kAim = 0.96;

// Where the curve left an edge between its samples, the next fit gives out that much less of the
// limit there, but not less than this part of what it had.
constexpr double kAimAgain = 0.98;
constexpr double kLeastShare = 0.85;

// Among vertices that noise moved out of the band, a curve that leaves an edge has come from the
// next one: its samples bring it back, however far it was.
constexpr int kWatchedAmongNoise = 2;

// Elsewhere, where it left an edge by more than this, no closer watch is tried: there is a corner,
// and a curve that is forced round it inside the band would be sharper than the corner is worth.
constexpr double kSlightly = 1.2;

// Violations of an edge after which it stays a line between kept corners, and with it, at every
// further violation, twice as many edges around it. Fits until nothing is tried any more but the
// polyline itself.
constexpr int kWatched = 1;
constexpr int kAttempts = 9;

// Vertices that are met are met to this part of the tolerance.
constexpr double kMetLimit = 0.01;

// Rounds of widening for the machine's need, what one widens by, and the least part of a
// stretch's time that a round must win there to be kept.
constexpr int kRounds = 3;
constexpr double kWiden = 4;
constexpr double kWorthIt = 0.002;

// A stretch reaches so many vertices beyond those that were widened: the curve moves there too.
constexpr std::size_t kBeside = 16;

// The vertices beside which the curve is too tight for the feed, and three on either side of them.
std::vector<bool> tight_vertices(const BandFit& fit) {
  const std::size_t n = fit.points().size();
  std::vector<bool> tight(n, false);
  for (std::size_t i = 1; i + 1 < n; ++i) {
    if (fit.features().kinds[i] != VertexKind::kSmooth || !fit.is_tight(i)) continue;
    constexpr std::size_t kAround = 3;
    const std::size_t last = std::min(i + kAround, n - 1);
    for (std::size_t j = i < kAround ? 0 : i - kAround; j <= last; ++j) tight[j] = true;
  }
  return tight;
}

// More scatter for vertices where the curve is too tight for the feed, beyond what was tried
// before; nothing when there are none that could still be given more.
std::optional<std::vector<double>> widened(const BandFit& fit, const FairOptions& options,
                                           std::vector<double>& tried) {
  const std::vector<bool> tight = tight_vertices(fit);
  std::vector<double> loosen = fit.loosened();
  bool any = false;
  for (std::size_t i = 0; i < tight.size(); ++i) {
    if (!tight[i] || std::isinf(tried[i])) continue;
    tried[i] *= kWiden;
    const double scatter = std::max(fit.features().noise[i], options.rounding) * tried[i];
    if (scatter > 0.5 * options.tolerance) tried[i] = std::numeric_limits<double>::infinity();
    loosen[i] = tried[i];
    any = true;
  }
  if (!any) return std::nullopt;
  return loosen;
}

// Stretches of vertices in which one fit was told something else than the other, and some
// vertices around.
std::vector<IndexRange> stretches_apart(const BandFit& before, const BandFit& after) {
  const std::size_t n = before.points().size();
  std::vector<IndexRange> stretches;
  for (std::size_t i = 0; i < n; ++i) {
    if (before.loosened()[i] == after.loosened()[i] &&
        before.features().kinds[i] == after.features().kinds[i]) {
      continue;
    }
    const IndexRange around{i < kBeside ? 0 : i - kBeside, std::min(i + kBeside + 1, n)};
    if (!stretches.empty() && around.begin <= stretches.back().end) {
      stretches.back().end = around.end;
    } else {
      stretches.push_back(around);
    }
  }
  return stretches;
}

// A curve that had to keep edges as they were is not smoother, whatever its time says.
bool is_worth_it(const BandFit& before, const BandFit& after, IndexRange stretch,
                 double tolerance) {
  for (std::size_t i = stretch.begin; i < stretch.end; ++i) {
    if (before.features().kinds[i] != after.features().kinds[i]) return false;
    if (i + 1 == stretch.end) break;
    if (after.deviations()[i] > tolerance) return false;
  }
  return after.time_beside(stretch) <= (1 - kWorthIt) * before.time_beside(stretch);
}

bool is_inside(const BandFit& fit, double tolerance) {
  return std::ranges::all_of(fit.deviations(), [&](double off) { return off <= tolerance; });
}

}  // namespace

BandFit::BandFit(std::vector<Point3> points, const FairOptions& options,
                 std::vector<std::size_t> met, std::vector<double> rooms)
    : points_(std::move(points)),
      options_(options),
      met_(std::move(met)),
      features_(
          find_features(points_, {options.tolerance, options.keep_corner_angle, options.rounding})),
      loosen_(points_.size(), 1),
      rooms_(std::move(rooms)),
      care_(points_.size() - 1),
      at_(features_.parameters),
      off_(points_.size() - 1),
      tight_(points_.size()) {
  rooms_.resize(points_.size() - 1, 1);
  for (std::size_t edge = 0; edge < care_.size(); ++edge) care_[edge].share = rooms_[edge];
}

void BandFit::loosen(std::vector<double> factors) {
  for (std::size_t i = 0; i < factors.size(); ++i) {
    if (factors[i] != loosen_[i]) altered_.push_back(i);
  }
  loosen_ = std::move(factors);
  hold();
}

void BandFit::take_back(const BandFit& before, std::span<const IndexRange> stretches) {
  for (const IndexRange& stretch : stretches) {
    for (std::size_t i = stretch.begin; i < stretch.end; ++i) {
      altered_.push_back(i);
      loosen_[i] = before.loosen_[i];
      if (features_.kinds[i] != before.features_.kinds[i]) stated_ = false;
      features_.kinds[i] = before.features_.kinds[i];
      if (i + 1 == stretch.end) break;
      if (features_.lines[i] != before.features_.lines[i]) stated_ = false;
      features_.lines[i] = before.features_.lines[i];
      care_[i] = before.care_[i];
    }
  }
  hold();
}

SplineWalk BandFit::walk() const { return {fit_->spline().knots, fit_->spline().points}; }

// Fits, looks at the curve between the samples, and fits again where it left the band.
void BandFit::hold() {
  if (!fit_) find_denoised();
  for (int attempt = 0; attempt <= kAttempts; ++attempt) {
    fit();
    measure();
    if (attempt == kAttempts || !mend()) return;
    if (attempt + 1 < kAttempts) continue;
    // Nothing else is sure to hold.
    for (std::size_t edge = 0; edge < off_.size(); ++edge) keep_edges(edge, 0);
  }
}

BandOptions BandFit::band() const {
  BandOptions band;
  band.limit = kAim * options_.tolerance;
  band.rounding = std::min(options_.rounding, 0.25 * options_.tolerance);
  band.scatter = options_.scatter;
  band.accurate = options_.accurate;
  band.near = options_.near;
  band.meant = meant_;
  return band;
}

// Where noise takes much of the band, the smoothest curve in it swings from one of its sides to the
// other and is further from the path that was meant than the vertices. So that path is estimated
// first, but for who wants a simple curve further away.
void BandFit::find_denoised() {
  if (options_.scatter > 0) return;
  const BandOptions asked = band();
  meant_ = meant_among_noise(points_, features_, asked.limit, asked.rounding);
}

void BandFit::fit() {
  state();
  if (fit_) {
    fit_->refit(problem_, closest_knots(band()));
  } else {
    fit_.emplace(problem_, FitOptions{});
  }
}

// What each vertex is decides where knots, corners and lines are. As long as that stays, a problem
// differs from the one before only about the vertices that are asked for otherwise.
void BandFit::state() {
  if (stated_) {
    std::sort(altered_.begin(), altered_.end());
    restate_samples(points_, features_, loosen_, care_, band(), altered_, problem_);
  } else {
    problem_ = state_fair_problem(points_, features_, loosen_, care_, band());
  }
  stated_ = true;
  altered_.clear();
  hold_met();
}

void BandFit::hold_met() {
  std::vector<FitSample>& samples = problem_.samples;
  for (const std::size_t i : met_) {
    const auto at =
        std::lower_bound(samples.begin(), samples.end(), features_.parameters[i],
                         [](const FitSample& sample, double u) { return sample.parameter < u; });
    if (at == samples.end() || at->parameter != features_.parameters[i]) continue;
    at->limit = kMetLimit * options_.tolerance;
    at->scatter = 0;
  }
}

// Renews what depends on the curve, where it moved.
void BandFit::measure() {
  const std::vector<double>& start = features_.parameters;
  const std::size_t vertices = points_.size();
  SplineWalk curve = walk();
  const TravelLimits most = limits();
  const auto index_of = [&](double u) {
    return static_cast<std::size_t>(std::lower_bound(start.begin(), start.end(), u) -
                                    start.begin());
  };
  std::size_t done = 0;  // vertices before this one are measured
  for (const ParameterRange& part : fit_->moved()) {
    // A vertex belongs to a place up to half an edge away.
    const std::size_t first = std::max(done, std::max<std::size_t>(index_of(part.from), 2) - 2);
    const std::size_t last = std::min(index_of(part.to) + 2, vertices);
    for (std::size_t i = first; i < last; ++i) {
      at_[i] = nearest_parameter(curve, points_, start, i);
      tight_[i] = exceeds(curve, at_[i], most) ? 1 : 0;
    }
    const VertexPlaces path{points_, at_};
    const std::size_t first_edge = std::max<std::size_t>(first, 1) - 1;
    const std::size_t last_edge = std::min(last, vertices - 1);
    for (std::size_t edge = first_edge; edge < last_edge; ++edge) {
      off_[edge] = edge_deviation(curve, path, edge, rooms_[edge] * options_.tolerance);
      off_[edge] /= rooms_[edge];
    }
    done = last;
  }
}

TravelLimits BandFit::limits() const {
  return {options_.feed / 60, options_.acceleration, options_.jerk};
}

double BandFit::time_beside(const IndexRange& vertices) const {
  SplineWalk curve = walk();
  const VertexPlaces path{points_, at_};
  double time = 0;
  for (std::size_t i = vertices.begin; i + 1 < vertices.end; ++i) {
    time += edge_time(curve, path, i, limits());
  }
  return time;
}

// Tightens the problem where the curve left the band. Returns whether it did anywhere.
bool BandFit::mend() {
  bool left = false;
  for (std::size_t edge = 0; edge < off_.size(); ++edge) {
    if (off_[edge] <= options_.tolerance) continue;
    left = true;
    EdgeRefinement& care = care_[edge];
    altered_.push_back(edge);
    altered_.push_back(edge + 1);
    const int watched = is_noisy(edge) ? kWatchedAmongNoise : kWatched;
    const bool slightly = off_[edge] < kSlightly * options_.tolerance;
    care.violations += slightly || is_noisy(edge) ? 1 : watched + 1;
    care.share *= std::max(kLeastShare, kAimAgain * options_.tolerance / off_[edge]);
    if (care.violations > watched) {
      keep_edges(edge, (std::size_t{1} << (care.violations - watched - 1)) - 1);
    }
  }
  return left;
}

// Whether noise takes much of the band at an end of the edge.
bool BandFit::is_noisy(std::size_t edge) const {
  if (meant_.empty()) return false;
  return meant_[edge] != points_[edge] || meant_[edge + 1] != points_[edge + 1];
}

// An edge and so many on either side stay lines between kept corners.
void BandFit::keep_edges(std::size_t edge, std::size_t around) {
  stated_ = false;
  const std::size_t last = std::min(edge + around, off_.size() - 1);
  for (std::size_t e = edge < around ? 0 : edge - around; e <= last; ++e) {
    features_.lines[e] = true;
    features_.kinds[e] = VertexKind::kKeptCorner;
    features_.kinds[e + 1] = VertexKind::kKeptCorner;
  }
}

int widen_for_feed(BandFit& fit, const FairOptions& options) {
  std::vector<double> tried(fit.points().size(), 1);
  int rounds = 0;
  for (int round = 0; round < kRounds; ++round) {
    auto loosen = widened(fit, options, tried);
    if (!loosen) break;
    BandFit next = fit;
    next.loosen(std::move(*loosen));
    const std::vector<IndexRange> stretches = stretches_apart(fit, next);
    std::vector<IndexRange> in_vain;
    for (const IndexRange& stretch : stretches) {
      if (!is_worth_it(fit, next, stretch, options.tolerance)) in_vain.push_back(stretch);
    }
    if (in_vain.size() == stretches.size()) continue;
    if (!in_vain.empty()) next.take_back(fit, in_vain);
    if (!is_inside(next, options.tolerance)) break;
    fit = std::move(next);
    ++rounds;
  }
  return rounds;
}

}  // namespace batten::geometry
