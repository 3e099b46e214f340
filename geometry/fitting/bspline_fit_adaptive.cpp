#include "geometry/fitting/bspline_fit_adaptive.h"

#include <algorithm>
#include <limits>
#include <numeric>
#include <stdexcept>
#include <string>
#include <utility>

namespace batten::geometry {

namespace {

// A control point that wakes is solved for so many times, whatever comes of it: a number that is
// the same for all does not depend on rounding, and weights have found their places by then.
constexpr std::uint8_t kSolutions = 20;

// A solution in which it moves by less than this part of its limit counts as several: what the
// solutions that are left would still move it by is a fiftieth of the limit at the most.
constexpr double kStill = 1e-3;
constexpr std::uint8_t kStillCounts = 4;

// One that rests wakes when it is moved by this part of its limit, for so many solutions.
constexpr double kMoved = 0.01;
constexpr std::uint8_t kWoken = 8;

// Control points on either side that are solved for with those that are awake: the influence of a
// sample dies out over some of them. Where more of them move, these wake in turn.
constexpr std::size_t kReach = 8;

// So many control points known beforehand in a row part the spline in two.
constexpr std::size_t kWall = 3;

// From one control point to the next, what counts as stiffness changes by this factor at the most:
// samples that weigh much less than their neighbours are left to the swing of these.
constexpr double kStiffnessStep = 4;

// Rounding is no excess; what is left of one this small after the last solution is no reason for
// another knot.
constexpr double kInsideWhenAdapted = 1 + 1e-9;
constexpr double kNearlyInside = 1.05;

// Samples from `begin` on that share a span.
std::size_t end_of_span(std::span<const FitRow> rows, std::size_t begin) {
  std::size_t end = begin;
  while (end < rows.size() && rows[end].first == rows[begin].first) ++end;
  return end;
}

// The samples outside the zones.
std::vector<FitSample> free_samples(std::vector<FitSample> samples,
                                    std::span<const StraightZone> zones) {
  std::size_t zone = 0;
  std::erase_if(samples, [&](const FitSample& sample) {
    while (zone < zones.size() && zones[zone].to <= sample.parameter) ++zone;
    return zone < zones.size() && sample.parameter >= zones[zone].from;
  });
  return samples;
}

void require_pins(const FitProblem& problem) {
  if (problem.pins.size() >= 2) return;
  throw std::invalid_argument("fit_bspline: " + std::to_string(problem.pins.size()) +
                              " pins, expected 2 or more");
}

}  // namespace

AdaptiveFit::AdaptiveFit(FitProblem problem, const FitOptions& options) : options_(options) {
  require_pins(problem);
  samples_ = free_samples(std::move(problem.samples), problem.zones);
  zones_ = problem.zones;
  pins_ = problem.pins;
  states_.resize(samples_.size());
  for (std::size_t i = 0; i < samples_.size(); ++i) states_[i].target = samples_[i].target;
  rows_.assign(samples_.size(), FitRow{kNotCarried, {}});
  tight_.assign(samples_.size(), 1);
  set_breaks(problem.breakpoints);
  run();
}

void AdaptiveFit::refit(FitProblem problem, double closest) {
  require_pins(problem);
  std::vector<FitSample> samples = free_samples(std::move(problem.samples), problem.zones);
  const SampleChanges changes = changes_of(samples_, samples);
  const auto rebuilt = changed_places(pins_, problem.pins, zones_, problem.zones);
  for (PointState& point : points_) point.moved = 0;
  if (!changes.any() && rebuilt.empty()) return;
  const bool may_differ = !rebuilt.empty() || has_new_breaks_ || closest != closest_;
  std::vector<double> breaks;
  if (may_differ) breaks = breaks_of(problem, spline_.breaks, rebuilt, closest);
  const bool same_spline = !may_differ || (rebuilt.empty() && breaks == spline_.breaks);
  has_new_breaks_ = false;
  closest_ = closest;

  std::vector<SampleState> states(samples.size());
  std::vector<FitRow> rows(samples.size(), FitRow{kNotCarried, {}});
  tight_.assign(samples.size(), 0);
  for (std::size_t i = 0; i < samples.size(); ++i) {
    if (changes.was[i] == SampleChanges::kNew) {
      states[i].target = samples[i].target;
      tight_[i] = 1;
    } else {
      states[i] = states_[changes.was[i]];
      rows[i] = rows_[changes.was[i]];
    }
  }
  samples_ = std::move(samples);
  states_ = std::move(states);
  rows_ = std::move(rows);
  zones_ = problem.zones;
  pins_ = problem.pins;
  if (same_spline) {
    std::vector<std::size_t> same_places(spline_.size());
    std::iota(same_places.begin(), same_places.end(), std::size_t{0});
    set_samples(same_places);
  } else {
    set_breaks(std::move(breaks));
  }

  for (std::size_t i = 0; i < samples_.size(); ++i) {
    if (changes.altered[i]) wake(rows_[i].first);
  }
  wake_at(changes.gone);
  run();
}

// The same fit on other knots: what they leave as it was is carried over.
void AdaptiveFit::set_breaks(std::vector<double> breaks) {
  FitSpline next = spline_on(std::move(breaks), pins_, zones_);
  const std::vector<std::size_t> now_at = carry_points(spline_, next);
  std::vector<PointState> points(next.size(), PointState{kSolutions, 1, 1, 0});
  for (std::size_t i = 0; i < now_at.size(); ++i) {
    if (now_at[i] != kNotCarried) points[now_at[i]] = points_[i];
  }
  spline_ = std::move(next);
  points_ = std::move(points);
  set_samples(now_at);
}

// What is known of the samples on a spline whose control points were elsewhere before.
void AdaptiveFit::set_samples(const std::vector<std::size_t>& now_at) {
  set_rows(now_at);
  set_first_samples();
  set_stiffness();
  measure_fixed();
}

// Nothing is solved for between zones that leave no control point free: what is off there is known
// beforehand, and asks for knots.
void AdaptiveFit::measure_fixed() {
  for (std::size_t i = 0; i < rows_.size(); ++i) {
    const std::uint8_t* fixed = &spline_.fixed[rows_[i].first];
    if (!std::all_of(fixed, fixed + 4, [](std::uint8_t one) { return one != 0; })) continue;
    measure(samples_[i], place_of(rows_[i], spline_.points), states_[i]);
  }
}

void AdaptiveFit::set_rows(const std::vector<std::size_t>& now_at) {
  const auto carried = [&](std::size_t first) {
    if (first == kNotCarried || now_at[first] == kNotCarried) return false;
    for (std::size_t k = 1; k < 4; ++k) {
      if (now_at[first + k] != now_at[first] + k) return false;
    }
    return true;
  };
  constexpr std::size_t kDegree = 3;
  std::size_t span = kDegree;
  for (std::size_t i = 0; i < rows_.size(); ++i) {
    FitRow& row = rows_[i];
    if (carried(row.first)) {
      row.first = now_at[row.first];
      span = row.first + kDegree;
    } else {
      row = row_at(spline_, samples_[i].parameter, span);
      tight_[i] = 1;
    }
  }
}

void AdaptiveFit::set_first_samples() {
  first_sample_.assign(points_.size() + 1, rows_.size());
  for (std::size_t i = rows_.size(); i-- > 0;) first_sample_[rows_[i].first] = i;
  for (std::size_t point = points_.size(); point-- > 0;) {
    first_sample_[point] = std::min(first_sample_[point], first_sample_[point + 1]);
  }
}

// The stiffness of the curve at every sample; weights that start anew start with it.
void AdaptiveFit::set_stiffness() {
  std::vector<double> stiffness(spline_.size(), 0);
  for (PointState& point : points_) point.limit = std::numeric_limits<double>::infinity();
  for (std::size_t i = 0; i < rows_.size(); ++i) {
    for (std::size_t j = 0; j < 4; ++j) {
      const std::size_t point = rows_[i].first + j;
      stiffness[point] += rows_[i].value[j] * rows_[i].value[j];
      points_[point].limit = std::min(points_[point].limit, samples_[i].limit);
    }
  }
  constexpr double kLeastShare = 1e-3;
  for (std::size_t i = 0; i < stiffness.size(); ++i) {
    stiffness[i] = spline_.energy[i][0] / std::max(stiffness[i], kLeastShare);
  }
  for (std::size_t i = 1; i < stiffness.size(); ++i) {
    stiffness[i] = std::max(stiffness[i], stiffness[i - 1] / kStiffnessStep);
  }
  for (std::size_t i = stiffness.size() - 1; i-- > 0;) {
    stiffness[i] = std::max(stiffness[i], stiffness[i + 1] / kStiffnessStep);
  }
  for (std::size_t i = 0; i < rows_.size(); ++i) {
    const double* at = &stiffness[rows_[i].first];
    states_[i].stiffness = std::max(std::max(at[0], at[1]), std::max(at[2], at[3]));
    if (tight_[i] != 0) start_tight(states_[i]);
  }
}

// Knots first: spans are split until all can hold their samples. Then weights settle, which may
// show that some spans are too long after all.
void AdaptiveFit::run() {
  for (int round = 0;; ++round) {
    decide_spans();
    const bool last = round >= options_.max_refinements;
    if (!last && split_spans([](const SpanNeed& need, bool tight) { return tight && need.knot; })) {
      continue;
    }
    settle();
    const bool is_split =
        !last && split_spans([](const SpanNeed& need, bool) { return need.worst > kNearlyInside; });
    if (is_split) continue;
    out_of_rounds_ = last;
    return;
  }
}

// Solves until every span is known to need a knot or not to.
void AdaptiveFit::decide_spans() {
  const IndexRange all{0, points_.size()};
  for (int pass = 0; pass < options_.passes; ++pass) {
    const auto awake = ranges([&](std::size_t i) { return points_[i].undecided != 0; }, {&all, 1});
    for (PointState& point : points_) point.undecided = 0;
    for (const IndexRange& range : awake) {
      solve(range, Phase::kDecide);
      mark_undecided(samples_of(range));
    }
    if (awake.empty()) return;
  }
}

void AdaptiveFit::mark_undecided(IndexRange samples) {
  for (std::size_t begin = samples.begin; begin < samples.end;) {
    const std::size_t end = end_of_span(rows_, begin);
    const SpanNeed need = need_of({&samples_[begin], end - begin}, {&states_[begin], end - begin});
    if (tight_[begin] != 0 && need.knot && !need.far) {
      for (std::size_t j = 0; j < 4; ++j) points_[rows_[begin].first + j].undecided = 1;
    }
    begin = end;
  }
}

void AdaptiveFit::settle() {
  for (std::size_t i = 0; i < tight_.size(); ++i) {
    if (std::exchange(tight_[i], std::uint8_t{0}) != 0) forget_limit(states_[i]);
  }
  std::vector<IndexRange> where{{0, points_.size()}};
  for (int pass = 0; pass < kSolutions + options_.last_passes; ++pass) {
    std::vector<IndexRange> awake =
        ranges([&](std::size_t i) { return points_[i].left > 0; }, where);
    if (awake.empty()) break;
    for (const IndexRange& range : awake) {
      solve(range, pass < kSolutions ? Phase::kRelax : Phase::kClose);
    }
    where = std::move(awake);
  }
  for (PointState& point : points_) point.left = 0;
}

// Splits the spans that ask for it at the middle one of the samples inside them: those that were
// solved for in this fit or cannot be, since the others needed no knot at the end of the last one.
// Returns whether any was.
template <typename Asks>
bool AdaptiveFit::split_spans(const Asks& asks) {
  constexpr std::size_t kDegree = 3;
  std::vector<double> middles;
  std::size_t free_until = 0;   // behind the last control point that is
  std::size_t moved_until = 0;  // the same of those that were solved for
  for (std::size_t last = 0; last < points_.size(); ++last) {
    if (spline_.fixed[last] == 0) free_until = last + 1;
    if (points_[last].moved != 0) moved_until = last + 1;
    if (last < kDegree) continue;
    const std::size_t point = last - kDegree;
    const std::size_t begin = first_sample_[point];
    const std::size_t end = first_sample_[point + 1];
    const bool may_ask = moved_until > point || free_until <= point || out_of_rounds_;
    if (begin == end || !may_ask) continue;
    const double from = spline_.knots[point + kDegree];
    std::size_t inside = begin;
    while (inside < end && samples_[inside].parameter <= from) ++inside;
    if (inside == end) continue;
    const SpanNeed need = need_of({&samples_[begin], end - begin}, {&states_[begin], end - begin});
    if (asks(need, tight_[begin] != 0)) {
      middles.push_back(samples_[inside + (end - inside) / 2].parameter);
    }
  }
  if (middles.empty()) return false;
  std::vector<double> breaks(spline_.breaks.size() + middles.size());
  std::merge(spline_.breaks.begin(), spline_.breaks.end(), middles.begin(), middles.end(),
             breaks.begin());
  breaks.erase(std::unique(breaks.begin(), breaks.end()), breaks.end());
  const bool finer = breaks.size() > spline_.breaks.size();
  if (!finer) return false;
  set_breaks(std::move(breaks));
  has_new_breaks_ = true;
  return true;
}

void AdaptiveFit::solve(IndexRange free, Phase phase) {
  const IndexRange samples = samples_of(free);
  const bool solved = system_.solve(spline_, rows_, states_, samples, free);
  for (std::size_t i = free.begin; i < free.end; ++i) {
    PointState& point = points_[i];
    if (!solved || spline_.fixed[i] != 0) {
      point.left = 0;
      continue;
    }
    const Point3& place = system_.place(i);
    const double move = (place - spline_.points[i]).norm();
    if (point.left == 0) {
      if (move > kMoved * point.limit) point.left = phase == Phase::kClose ? 1 : kWoken;
    } else if (phase != Phase::kDecide) {
      const std::uint8_t counts = move <= kStill * point.limit ? kStillCounts : 1;
      point.left -= std::min(point.left, counts);
    }
    point.moved = 1;
    spline_.points[i] = place;
  }
  for (std::size_t i = samples.begin; i < samples.end; ++i) {
    measure(samples_[i], place_of(rows_[i], spline_.points), states_[i]);
    if (solved && states_[i].distance > kInsideWhenAdapted * samples_[i].limit) {
      for (std::size_t j = 0; j < 4; ++j) {
        std::uint8_t& left = points_[rows_[i].first + j].left;
        left = std::max<std::uint8_t>(left, 1);
      }
    }
  }
  if (solved) reweight(samples, phase);
}

void AdaptiveFit::reweight(IndexRange samples, Phase phase) {
  const double part = phase == Phase::kClose ? 1 : 0.5;
  bool inverted = false;
  for (std::size_t i = samples.begin; i < samples.end; ++i) {
    const double ratio = states_[i].distance / samples_[i].limit;
    const bool inside = ratio <= kAimInside;
    const bool fades = phase == Phase::kRelax || (phase == Phase::kDecide && inside);
    if (fades && !(samples_[i].scatter > 0)) let_go(states_[i]);
    if (inside) {
      if (phase != Phase::kClose) relax_limit(ratio, states_[i]);
      continue;
    }
    if (!std::exchange(inverted, true)) system_.invert(spline_, rows_[i].first);
    press_limit(ratio, system_.leverage(rows_[i]), part, states_[i]);
  }
  if (phase != Phase::kClose) {
    const ScatterStep step = phase == Phase::kRelax ? ScatterStep::kBothWays : ScatterStep::kGrow;
    reweight_scatter(samples_, states_, samples.begin, samples.end, step);
  }
}

// The control points of a span that start with this one.
void AdaptiveFit::wake(std::size_t first_point) {
  for (std::size_t j = 0; j < 4; ++j) {
    std::uint8_t& left = points_[first_point + j].left;
    left = std::max(left, kWoken);
    points_[first_point + j].undecided = 1;
  }
}

void AdaptiveFit::wake_at(const std::vector<double>& places) {
  constexpr std::size_t kDegree = 3;
  std::size_t span = kDegree;
  for (const double u : places) {
    while (span + 1 < spline_.size() && spline_.knots[span + 1] <= u) ++span;
    wake(span - kDegree);
  }
}

// Those whose rows touch the range.
IndexRange AdaptiveFit::samples_of(IndexRange free) const {
  const std::size_t first = free.begin < 3 ? 0 : free.begin - 3;
  return {first_sample_[first], first_sample_[free.end]};
}

// Ranges of control points around those that are awake; a wall parts them. A solution of the ranges
// `where` wakes none that is not in one of them or in the span beside it.
template <typename IsAwake>
std::vector<IndexRange> AdaptiveFit::ranges(const IsAwake& is_awake,
                                            std::span<const IndexRange> where) const {
  constexpr std::size_t kDegree = 3;
  const std::size_t size = spline_.size();
  const auto awake = [&](std::size_t i) { return spline_.fixed[i] == 0 && is_awake(i); };
  std::vector<IndexRange> found;
  std::size_t i = 0;
  for (const IndexRange& part : where) {
    i = std::max(i, std::max(part.begin, kDegree) - kDegree);
    for (const std::size_t last = std::min(part.end + kDegree, size); i < last; ++i) {
      if (!awake(i)) continue;
      const std::size_t first = i;
      while (i < size && awake(i)) ++i;
      add_range({first, i}, found);
    }
  }
  return found;
}

// With the control points around that are solved for as well.
void AdaptiveFit::add_range(IndexRange awake, std::vector<IndexRange>& found) const {
  std::size_t begin = awake.begin;
  std::size_t wall = 0;
  for (std::size_t k = 0; k < kReach && begin > 0 && wall < kWall; ++k) {
    wall = spline_.fixed[--begin] != 0 ? wall + 1 : 0;
  }
  std::size_t end = awake.end;
  wall = 0;
  for (std::size_t k = 0; k < kReach && end < spline_.size() && wall < kWall; ++k) {
    wall = spline_.fixed[end++] != 0 ? wall + 1 : 0;
  }
  if (!found.empty() && begin <= found.back().end) {
    found.back().end = end;
  } else {
    found.push_back({begin, end});
  }
}

std::vector<ParameterRange> AdaptiveFit::moved() const {
  constexpr std::size_t kSupport = 4;  // spans of one control point
  std::vector<ParameterRange> parts;
  for (std::size_t i = 0; i < points_.size(); ++i) {
    if (points_[i].moved == 0) continue;
    const double from = spline_.knots[i];
    const double to = spline_.knots[i + kSupport];
    if (!parts.empty() && from <= parts.back().to) {
      parts.back().to = to;
    } else {
      parts.push_back({from, to});
    }
  }
  return parts;
}

std::vector<double> AdaptiveFit::ratios(std::span<const FitSample> given) const {
  std::vector<double> ratios(given.size(), 0);
  std::size_t next = 0;
  for (std::size_t i = 0; i < given.size() && next < samples_.size(); ++i) {
    if (given[i].parameter != samples_[next].parameter) continue;
    ratios[i] = states_[next].distance / samples_[next].limit;
    ++next;
  }
  return ratios;
}

}  // namespace batten::geometry
