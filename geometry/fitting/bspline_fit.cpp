#include "geometry/fitting/bspline_fit.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <functional>
#include <iterator>
#include <limits>
#include <numeric>
#include <optional>
#include <stdexcept>
#include <string>
#include <utility>

#include "geometry/basic/operations.h"

namespace batten::geometry {

namespace {

void start_tight(SampleState& state) {
  state.base = kFitTuning.tight_start * state.stiffness;
  state.push = kFitTuning.weight_floor * state.stiffness;
  state.rms = 0;
}

double bounded_weight(double weight, double stiffness) {
  return std::clamp(weight, kFitTuning.weight_floor * stiffness, kFitTuning.weight_cap * stiffness);
}

// Slides the target to the foot of the curve and measures what is left.
void measure(const FitSample& sample, std::span<const Point3> points, SampleState& state) {
  const Vector3 off = state.row.on(points) - sample.target;
  const double room = kFitTuning.slide_room * sample.limit;
  const Vector3 slide = std::clamp(off.dot(sample.along), -room, room) * sample.along;
  state.target = sample.target + (1 - kFitTuning.slide_pull) * slide;
  state.distance = (off - slide).norm();
}

// The discrepancy principle, locally: the base weights of these samples fall, by `least` at the
// most, where the distances of the neighbourhood are smaller than their scatter and grow where they
// are greater.
void reweight_scatter(std::span<const FitSample> samples, std::span<SampleState> states,
                      IndexRange range, double least) {
  constexpr std::size_t kWindow = kFitTuning.scatter_window;
  // Of the squared distance over scatter; none where no scatter is expected.
  const auto square_at = [&](std::size_t i) {
    const double ratio = states[i].distance / samples[i].scatter;
    return ratio * ratio;
  };
  double sum = 0;  // of those in [first, last[
  int count = 0;
  std::size_t first = range.begin < kWindow ? 0 : range.begin - kWindow;
  std::size_t last = first;
  for (std::size_t i = range.begin; i < range.end; ++i) {
    for (; last < samples.size() && last <= i + kWindow; ++last) {
      if (samples[last].scatter > 0) sum += square_at(last), ++count;
    }
    for (; first + kWindow < i; ++first) {
      if (samples[first].scatter > 0) sum -= square_at(first), --count;
    }
    if (!(samples[i].scatter > 0) || count == 0) continue;
    const double rms = std::sqrt(std::max(sum, 0.0) / count);
    SampleState& state = states[i];
    // Whether it hardly follows the falling weight.
    const bool is_numb = rms < 1 && 1 - rms > kFitTuning.numb * (1 - state.rms);
    const double factor = is_numb ? rms * rms * rms : rms;
    state.rms = rms;
    const double change = std::clamp(factor, least, kFitTuning.growth);
    state.base = bounded_weight(state.base * change, state.stiffness);
    // What a limit needed beside the heavier weight it will ask for again if need be.
    if (state.distance < samples[i].limit) {
      state.push = bounded_weight(state.push * std::min(change, 1.0), state.stiffness);
    }
  }
}

// Where a limit is passed its weight takes a part of Newton's step: with leverage h, the compliance
// of the curve at the sample, a weight w leaves a distance proportional to 1 / (w + k),
// k = 1 / h - w, so that w + (ratio - 1) / h would meet the limit if no other sample moved.
void press_limit(double ratio, double leverage, double part, SampleState& state) {
  if (!(leverage > 0)) return;
  const double excess = std::min(ratio / kFitTuning.aim_inside, kFitTuning.growth) - 1;
  state.push = bounded_weight(state.push + part * excess / leverage, state.stiffness);
}

// Whether the samples of a span show that it cannot follow them: `far` when not even heavier
// weights could help.
struct SpanNeed {
  double worst = 0;  // the greatest distance over its limit
  bool knot = false;
  bool far = false;
};

SpanNeed need_of(std::span<const FitSample> samples, std::span<const SampleState> states) {
  double squares = 0;
  double count = 0;
  double worst = 0;
  for (std::size_t i = 0; i < samples.size(); ++i) {
    worst = std::max(worst, states[i].distance / samples[i].limit);
    if (!(samples[i].scatter > 0)) continue;
    const double ratio = states[i].distance / samples[i].scatter;
    squares += ratio * ratio;
    ++count;
  }
  const double scattered = kFitTuning.too_scattered * kFitTuning.too_scattered * count;
  const double hopeless = kFitTuning.hopeless;
  // Samples that have a limit only may be holding the others back, for the moment.
  const bool alike = count == static_cast<double>(samples.size());
  return {worst, worst > kFitTuning.too_far || squares > scattered,
          worst > hopeless || (alike && squares > hopeless * hopeless * scattered)};
}

bool same(const Pin& a, const Pin& b) { return a.parameter == b.parameter && a.place == b.place; }

bool same(const StraightZone& a, const StraightZone& b) {
  return a.from == b.from && a.to == b.to && a.start == b.start && a.end == b.end;
}

double start_of(const Pin& pin) { return pin.parameter; }
double start_of(const StraightZone& zone) { return zone.from; }

ParameterRange extent_of(const Pin& pin) { return {pin.parameter, pin.parameter}; }
ParameterRange extent_of(const StraightZone& zone) { return {zone.from, zone.to}; }

// Those of two ordered lists that are in one of them only.
template <typename Thing>
void add_changed(std::span<const Thing> before, std::span<const Thing> after,
                 std::vector<ParameterRange>& changed) {
  std::size_t i = 0;
  std::size_t j = 0;
  while (i < before.size() || j < after.size()) {
    const bool both = i < before.size() && j < after.size();
    if (both && same(before[i], after[j])) {
      ++i;
      ++j;
    } else if (j == after.size() || (both && start_of(before[i]) <= start_of(after[j]))) {
      changed.push_back(extent_of(before[i++]));
    } else {
      changed.push_back(extent_of(after[j++]));
    }
  }
}

constexpr std::size_t kNew = static_cast<std::size_t>(-1);

struct SampleChanges {
  std::vector<std::size_t> was;  // per sample: the old one with the same target, or kNew
  std::vector<bool> altered;     // per sample: new, or with another direction, limit or scatter
  std::vector<double> gone;      // parameters of old samples that are no more, increasing

  [[nodiscard]] bool any() const {
    return !gone.empty() || std::find(altered.begin(), altered.end(), true) != altered.end();
  }
};

// Parameters increase in both.
SampleChanges changes_of(std::span<const FitSample> before, std::span<const FitSample> after) {
  SampleChanges changes;
  changes.was.assign(after.size(), kNew);
  changes.altered.assign(after.size(), true);
  std::size_t i = 0;
  for (std::size_t j = 0; j < after.size(); ++j) {
    for (; i < before.size() && before[i].parameter < after[j].parameter; ++i) {
      changes.gone.push_back(before[i].parameter);
    }
    if (i == before.size() || before[i].parameter != after[j].parameter) continue;
    if (before[i].target == after[j].target) {
      changes.was[j] = i;
      changes.altered[j] = before[i].along != after[j].along || before[i].limit != after[j].limit ||
                           before[i].scatter != after[j].scatter;
    }
    ++i;
  }
  for (; i < before.size(); ++i) changes.gone.push_back(before[i].parameter);
  return changes;
}

// Pins and zones that are in one problem only, increasing; some may overlap.
std::vector<ParameterRange> changed_places(std::span<const Pin> pins_before,
                                           std::span<const Pin> pins_after,
                                           std::span<const StraightZone> zones_before,
                                           std::span<const StraightZone> zones_after) {
  std::vector<ParameterRange> changed;
  add_changed(pins_before, pins_after, changed);
  add_changed(zones_before, zones_after, changed);
  std::ranges::sort(changed, {}, &ParameterRange::from);
  return changed;
}

// The breakpoints `now`, but for the parts that are `rebuilt`: these start again from the
// breakpoints of `problem`. With every pin and zone of `problem`, which replace breakpoints nearer
// than `closest`.
std::vector<double> breaks_of(const FitProblem& problem, std::span<const double> now,
                              std::span<const ParameterRange> rebuilt, double closest) {
  std::vector<double> breaks(now.begin(), now.end());
  std::size_t part = 0;
  for (const double u : problem.breakpoints) {
    while (part < rebuilt.size() && rebuilt[part].to < u) ++part;
    if (part < rebuilt.size() && rebuilt[part].from <= u) breaks.push_back(u);
  }
  if (breaks.size() > now.size()) std::sort(breaks.begin(), breaks.end());
  breaks.erase(std::unique(breaks.begin(), breaks.end()), breaks.end());

  const std::vector<double> required = required_breaks(problem);
  std::vector<double> kept;
  kept.reserve(breaks.size() + required.size());
  std::size_t zone = 0;
  std::size_t next = 0;  // required break at u or after it
  const auto add_required = [&](double to) {
    while (next < required.size() && required[next] <= to) kept.push_back(required[next++]);
  };
  for (const double u : breaks) {
    add_required(u);
    if (!kept.empty() && kept.back() == u) continue;
    while (zone < problem.zones.size() && problem.zones[zone].to <= u) ++zone;
    if (zone < problem.zones.size() && u > problem.zones[zone].from) continue;
    const bool near_last = next > 0 && u - required[next - 1] < closest;
    const bool near_next = next < required.size() && required[next] - u < closest;
    if (!near_last && !near_next) kept.push_back(u);
  }
  add_required(required.back());
  return kept;
}

// Takes over the control points of `before` whose knots are the same in `after`; one that is fixed
// in one of them has to be so in the other. Gives the new index of every old one, or kNoPoint.
std::vector<std::size_t> carry_points(const FitSpline& before, FitSpline& after) {
  constexpr std::ptrdiff_t kSupport = kSplineDegree + 2;  // knots of one control point
  std::vector<std::size_t> now_at(before.size(), kNoPoint);
  std::size_t j = 0;
  for (std::size_t i = 0; i < before.size() && j < after.size(); ++i) {
    const auto old_knots = before.knots.begin() + static_cast<std::ptrdiff_t>(i);
    const auto new_knots = [&] { return after.knots.begin() + static_cast<std::ptrdiff_t>(j); };
    while (j < after.size() && std::lexicographical_compare(new_knots(), new_knots() + kSupport,
                                                            old_knots, old_knots + kSupport)) {
      ++j;
    }
    if (j == after.size()) break;
    if (!std::equal(old_knots, old_knots + kSupport, new_knots())) continue;
    if (before.fixed[i] != after.fixed[j]) continue;
    if (after.fixed[j] != 0 && before.points[i] != after.points[j]) continue;
    after.points[j] = before.points[i];
    now_at[i] = j;
  }
  return now_at;
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

// Samples from `begin` on that share a span.
std::size_t end_of_span(std::span<const SampleState> states, std::size_t begin) {
  std::size_t end = begin;
  while (end < states.size() && states[end].row.first == states[begin].row.first) ++end;
  return end;
}

void join(ParameterRange range, std::vector<ParameterRange>& ranges) {
  if (!ranges.empty() && range.from <= ranges.back().to) {
    ranges.back().to = range.to;
  } else {
    ranges.push_back(range);
  }
}

}  // namespace

// A fit that works only where there is something to do, and that can be made again where its
// problem changed. Every control point rests once it has stopped moving and its samples are inside
// their limits; it wakes when the knots, the samples or the control points beside it change. A
// solution costs time for the control points that are awake and for some neighbours. No part of the
// run is special: what is solved together follows from the curve, and not from windows.
class AdaptiveFit {
 public:
  // Fits.
  AdaptiveFit(FitProblem problem, int max_refinements) : max_refinements_(max_refinements) {
    samples_ = free_samples(std::move(problem.samples), problem.zones);
    zones_ = std::move(problem.zones);
    pins_ = std::move(problem.pins);
    states_.resize(samples_.size());
    for (std::size_t i = 0; i < samples_.size(); ++i) states_[i].target = samples_[i].target;
    set_breaks(std::move(problem.breakpoints));
    run();
  }

  // Fits another problem on the same interval: the curve stays as it is where the samples, zones
  // and pins are the same, but for what the change moves.
  void refit(FitProblem problem, double closest) {
    std::vector<FitSample> samples = free_samples(std::move(problem.samples), problem.zones);
    const SampleChanges changes = changes_of(samples_, samples);
    const auto rebuilt = changed_places(pins_, problem.pins, zones_, problem.zones);
    for (PointState& point : points_) point.moved = false;
    if (!changes.any() && rebuilt.empty()) return;
    std::vector<SampleState> states(samples.size());
    for (std::size_t i = 0; i < samples.size(); ++i) {
      if (changes.was[i] == kNew) {
        states[i].target = samples[i].target;
      } else {
        states[i] = states_[changes.was[i]];
        states[i].tight = false;
      }
    }
    samples_ = std::move(samples);
    states_ = std::move(states);
    zones_ = problem.zones;
    pins_ = problem.pins;
    const bool may_differ = !rebuilt.empty() || has_new_breaks_ || closest != closest_;
    has_new_breaks_ = false;
    closest_ = closest;
    std::vector<double> breaks;
    if (may_differ) breaks = breaks_of(problem, spline_.breaks, rebuilt, closest);
    if (!may_differ || (rebuilt.empty() && breaks == spline_.breaks)) {
      std::vector<std::size_t> as_before(spline_.size());
      std::iota(as_before.begin(), as_before.end(), std::size_t{0});
      set_samples(as_before);
    } else {
      set_breaks(std::move(breaks));
    }
    for (std::size_t i = 0; i < samples_.size(); ++i) {
      if (changes.altered[i]) wake(states_[i].row.first);
    }
    std::size_t span = kSplineDegree;
    for (const double u : changes.gone) wake(row_at(spline_, u, span).first);
    run();
  }

  [[nodiscard]] const FitSpline& spline() const { return spline_; }

  // Where the curve moved in the last fit: increasing, apart.
  [[nodiscard]] std::vector<ParameterRange> moved() const {
    constexpr std::size_t kSupport = kSplineDegree + 1;  // spans of one control point
    std::vector<ParameterRange> parts;
    for (std::size_t i = 0; i < points_.size(); ++i) {
      if (points_[i].moved) join({spline_.knots[i], spline_.knots[i + kSupport]}, parts);
    }
    return parts;
  }

  // Appends the distance over limit of each of these samples, those of the problem; 0 in a zone.
  void add_ratios(std::span<const FitSample> given, std::vector<double>& ratios) const {
    std::size_t next = 0;
    for (const FitSample& sample : given) {
      const bool known = next < samples_.size() && sample.parameter == samples_[next].parameter;
      ratios.push_back(known ? states_[next].distance / samples_[next].limit : 0);
      if (known) ++next;
    }
  }

 private:
  // What is known of a control point from one solution to the next.
  struct PointState {
    int left = kFitTuning.solutions;  // solutions until it rests
    bool undecided = true;            // whether its spans need a knot is not known
    bool moved = true;                // in this fit
    double limit = 0;                 // mm, the least of the samples that it holds
  };

  enum class Phase { kDecide, kRelax, kClose };

  // The same fit on other knots: what they leave as it was is carried over.
  void set_breaks(std::vector<double> breaks) {
    FitSpline next = spline_on(std::move(breaks), pins_, zones_);
    const std::vector<std::size_t> now_at = carry_points(spline_, next);
    std::vector<PointState> points(next.size());
    for (std::size_t i = 0; i < now_at.size(); ++i) {
      if (now_at[i] != kNoPoint) points[now_at[i]] = points_[i];
    }
    spline_ = std::move(next);
    points_ = std::move(points);
    set_samples(now_at);
  }

  // What is known of the samples on a spline whose control points were elsewhere before.
  void set_samples(const std::vector<std::size_t>& now_at) {
    set_rows(now_at);
    set_stiffness();
    // Nothing is solved for between zones that leave no control point free: what is off there is
    // known beforehand, and asks for knots.
    for (std::size_t i = 0; i < states_.size(); ++i) {
      const std::uint8_t* fixed = &spline_.fixed[states_[i].row.first];
      if (std::all_of(fixed, fixed + 4, [](std::uint8_t one) { return one != 0; })) {
        measure(samples_[i], spline_.points, states_[i]);
      }
    }
  }

  // The rows of the samples on a spline whose control points were elsewhere before.
  void set_rows(const std::vector<std::size_t>& now_at) {
    const auto carried = [&](std::size_t first) {
      if (first == kNoPoint || now_at[first] == kNoPoint) return false;
      for (std::size_t k = 1; k < 4; ++k) {
        if (now_at[first + k] != now_at[first] + k) return false;
      }
      return true;
    };
    std::size_t span = kSplineDegree;
    for (std::size_t i = 0; i < states_.size(); ++i) {
      FitRow& row = states_[i].row;
      if (carried(row.first)) {
        row.first = now_at[row.first];
        span = row.first + kSplineDegree;
      } else {
        row = row_at(spline_, samples_[i].parameter, span);
        states_[i].tight = true;
      }
    }
    first_sample_.assign(points_.size() + 1, states_.size());
    for (std::size_t i = states_.size(); i-- > 0;) first_sample_[states_[i].row.first] = i;
    for (std::size_t point = points_.size(); point-- > 0;) {
      first_sample_[point] = std::min(first_sample_[point], first_sample_[point + 1]);
    }
  }

  // The stiffness of the curve at every sample; weights that start anew start with it.
  void set_stiffness() {
    std::vector<double> stiffness(spline_.size(), 0);
    for (PointState& point : points_) point.limit = std::numeric_limits<double>::infinity();
    for (std::size_t i = 0; i < states_.size(); ++i) {
      const FitRow& row = states_[i].row;
      for (std::size_t j = 0; j < 4; ++j) {
        stiffness[row.first + j] += row.value[j] * row.value[j];
        double& limit = points_[row.first + j].limit;
        limit = std::min(limit, samples_[i].limit);
      }
    }
    for (std::size_t i = 0; i < stiffness.size(); ++i) {
      stiffness[i] = spline_.energy[i][0] / std::max(stiffness[i], kFitTuning.least_share);
    }
    for (std::size_t i = 1; i < stiffness.size(); ++i) {
      stiffness[i] = std::max(stiffness[i], stiffness[i - 1] / kFitTuning.stiffness_step);
    }
    for (std::size_t i = stiffness.size() - 1; i-- > 0;) {
      stiffness[i] = std::max(stiffness[i], stiffness[i + 1] / kFitTuning.stiffness_step);
    }
    for (SampleState& state : states_) {
      const double* at = &stiffness[state.row.first];
      state.stiffness = *std::max_element(at, at + 4);
      if (state.tight) start_tight(state);
    }
  }

  // Knots first: spans are split until all can hold their samples. Then weights settle, which may
  // show that some spans are too long after all.
  void run() {
    for (int round = 0;; ++round) {
      decide_spans();
      const bool last = round >= max_refinements_;
      if (!last &&
          split_spans([](const SpanNeed& need, bool tight) { return tight && need.knot; })) {
        continue;
      }
      settle();
      const bool is_split = !last && split_spans([](const SpanNeed& need, bool) {
        return need.worst > kFitTuning.nearly_inside;
      });
      if (is_split) continue;
      out_of_rounds_ = last;
      return;
    }
  }

  // Solves until every span is known to need a knot or not to.
  void decide_spans() {
    for (int pass = 0; pass < kFitTuning.passes; ++pass) {
      const IndexRange all{0, points_.size()};
      const auto awake = ranges([](const PointState& point) { return point.undecided; }, {&all, 1});
      for (PointState& point : points_) point.undecided = false;
      for (const IndexRange& range : awake) {
        solve(range, Phase::kDecide);
        mark_undecided(samples_of(range));
      }
      if (awake.empty()) return;
    }
  }

  void mark_undecided(IndexRange samples) {
    for (std::size_t begin = samples.begin; begin < samples.end;) {
      const std::size_t end = end_of_span(states_, begin);
      const SpanNeed need = need_at({begin, end});
      if (states_[begin].tight && need.knot && !need.far) {
        for (std::size_t j = 0; j < 4; ++j) points_[states_[begin].row.first + j].undecided = true;
      }
      begin = end;
    }
  }

  [[nodiscard]] SpanNeed need_at(IndexRange samples) const {
    const std::size_t count = samples.end - samples.begin;
    return need_of({&samples_[samples.begin], count}, {&states_[samples.begin], count});
  }

  void settle() {
    for (SampleState& state : states_) {
      // A limit is asked for again if need be.
      if (state.tight) state.push = kFitTuning.weight_floor * state.stiffness;
      state.tight = false;
    }
    std::vector<IndexRange> awake{{0, points_.size()}};
    for (int pass = 0; pass < kFitTuning.solutions + kFitTuning.last_passes; ++pass) {
      awake = ranges([](const PointState& point) { return point.left > 0; }, awake);
      if (awake.empty()) break;
      for (const IndexRange& range : awake) {
        solve(range, pass < kFitTuning.solutions ? Phase::kRelax : Phase::kClose);
      }
    }
    for (PointState& point : points_) point.left = 0;
  }

  // Splits the spans that ask for it at the middle one of the samples inside them: those that were
  // solved for in this fit or cannot be, since the others needed no knot at the end of the last
  // one. Returns whether any was.
  template <typename Asks>
  [[nodiscard]] bool split_spans(const Asks& asks) {
    std::vector<double> middles;
    std::size_t free_until = 0;   // after the last control point that is
    std::size_t moved_until = 0;  // the same of those that were solved for
    for (std::size_t last = 0; last < points_.size(); ++last) {
      if (spline_.fixed[last] == 0) free_until = last + 1;
      if (points_[last].moved) moved_until = last + 1;
      if (last < kSplineDegree) continue;
      const std::size_t point = last - kSplineDegree;
      const std::size_t begin = first_sample_[point];
      const std::size_t end = first_sample_[point + 1];
      const bool may_ask = moved_until > point || free_until <= point || out_of_rounds_;
      if (begin == end || !may_ask) continue;
      std::size_t inside = begin;
      while (inside < end && samples_[inside].parameter <= spline_.knots[last]) ++inside;
      if (inside == end || !asks(need_at({begin, end}), states_[begin].tight)) continue;
      middles.push_back(samples_[inside + (end - inside) / 2].parameter);
    }
    std::vector<double> breaks;
    std::ranges::set_union(spline_.breaks, middles, std::back_inserter(breaks));
    if (breaks.size() == spline_.breaks.size()) return false;
    set_breaks(std::move(breaks));
    has_new_breaks_ = true;
    return true;
  }

  void solve(IndexRange free, Phase phase) {
    const IndexRange samples = samples_of(free);
    count_operations(samples.end - samples.begin);
    const bool solved = system_.solve(spline_, states_, samples, free);
    for (std::size_t i = free.begin; i < free.end; ++i) {
      PointState& point = points_[i];
      if (!solved || spline_.fixed[i] != 0) {
        point.left = 0;
        continue;
      }
      const Point3& place = system_.place(i);
      const double move = (place - spline_.points[i]).norm();
      if (point.left == 0) {
        const bool wakes = move > kFitTuning.moved * point.limit;
        if (wakes) point.left = phase == Phase::kClose ? 1 : kFitTuning.solutions;
      } else if (phase != Phase::kDecide) {
        const bool is_still = move <= kFitTuning.still * point.limit;
        point.left = std::max(0, point.left - (is_still ? kFitTuning.still_counts : 1));
      }
      point.moved = true;
      spline_.points[i] = place;
    }
    for (std::size_t i = samples.begin; i < samples.end; ++i) {
      measure(samples_[i], spline_.points, states_[i]);
      if (!solved || states_[i].distance <= samples_[i].limit) continue;
      for (std::size_t j = 0; j < 4; ++j) {
        int& left = points_[states_[i].row.first + j].left;
        left = std::max(left, 1);
      }
    }
    if (solved) reweight(samples, phase);
  }

  void reweight(IndexRange samples, Phase phase) {
    const double part = phase == Phase::kClose ? 1 : kFitTuning.press;
    bool inverted = false;
    for (std::size_t i = samples.begin; i < samples.end; ++i) {
      SampleState& state = states_[i];
      const double ratio = state.distance / samples_[i].limit;
      const bool inside = ratio <= kFitTuning.aim_inside;
      const bool fades = phase == Phase::kRelax || (phase == Phase::kDecide && inside);
      // A sample without scatter is held by its limit alone in the end.
      if (fades && !(samples_[i].scatter > 0)) {
        const double left = phase == Phase::kRelax ? kFitTuning.let_go : kFitTuning.fade;
        state.base = bounded_weight(left * state.base, state.stiffness);
      }
      if (!inside) {
        if (!std::exchange(inverted, true)) system_.invert(spline_, state.row.first);
        press_limit(ratio, system_.leverage(state.row), part, state);
      } else if (phase != Phase::kClose) {
        // Where a limit leaves room its weight falls by the ratio of distance and limit (C. L.
        // Lawson's reweighting), so that it vanishes where the limit is not felt.
        const double change = std::clamp(ratio / kFitTuning.aim_inside, kFitTuning.fall, 1.0);
        state.push = bounded_weight(state.push * change, state.stiffness);
      }
    }
    if (phase == Phase::kClose) return;
    reweight_scatter(samples_, states_, samples, phase == Phase::kRelax ? kFitTuning.fall : 1);
  }

  // The control points of a span that start with this one.
  void wake(std::size_t first_point) {
    for (std::size_t j = 0; j < 4; ++j) {
      PointState& point = points_[first_point + j];
      point.left = std::max(point.left, kFitTuning.solutions);
      point.undecided = true;
    }
  }

  // Those whose rows touch the range.
  [[nodiscard]] IndexRange samples_of(IndexRange free) const {
    const std::size_t first = free.begin < kSplineDegree ? 0 : free.begin - kSplineDegree;
    return {first_sample_[first], first_sample_[free.end]};
  }

  // Ranges of control points around those that are awake; a wall of known ones, as many in a row
  // as the degree, parts them. A solution of the ranges `where` wakes none that is not in one of
  // them or in the span beside it.
  template <typename IsAwake>
  [[nodiscard]] std::vector<IndexRange> ranges(const IsAwake& is_awake,
                                               std::span<const IndexRange> where) const {
    const std::size_t size = spline_.size();
    const auto awake = [&](std::size_t i) { return spline_.fixed[i] == 0 && is_awake(points_[i]); };
    std::vector<IndexRange> found;
    std::size_t i = 0;
    for (const IndexRange& part : where) {
      i = std::max(i, std::max(part.begin, kSplineDegree) - kSplineDegree);
      for (const std::size_t last = std::min(part.end + kSplineDegree, size); i < last; ++i) {
        if (!awake(i)) continue;
        const std::size_t first = i;
        while (i < size && awake(i)) ++i;
        add_range({first, i}, found);
      }
    }
    return found;
  }

  // With the control points around that are solved for as well.
  void add_range(IndexRange awake, std::vector<IndexRange>& found) const {
    auto [begin, end] = awake;
    std::size_t wall = 0;
    for (std::size_t k = 0; k < kFitTuning.reach && begin > 0 && wall < kSplineDegree; ++k) {
      wall = spline_.fixed[--begin] != 0 ? wall + 1 : 0;
    }
    wall = 0;
    for (std::size_t k = 0; k < kFitTuning.reach && end < spline_.size() && wall < kSplineDegree;
         ++k) {
      wall = spline_.fixed[end++] != 0 ? wall + 1 : 0;
    }
    if (!found.empty() && begin <= found.back().end) {
      found.back().end = end;
    } else {
      found.push_back({begin, end});
    }
  }

  int max_refinements_;
  std::vector<FitSample> samples_;  // those outside the zones
  std::vector<StraightZone> zones_;
  std::vector<Pin> pins_;
  FitSpline spline_;
  std::vector<SampleState> states_;        // per sample
  std::vector<PointState> points_;         // per control point
  std::vector<std::size_t> first_sample_;  // per control point, and one more: the first whose row
                                           // starts there or after it
  bool has_new_breaks_ = true;             // that may be too near to pins and zones
  double closest_ = 0;                     // mm, how near that is
  bool out_of_rounds_ = false;             // the last fit ended before all spans were known to do
  FitSystem system_;
};

namespace {

// Every pin, and the middle of every zone: a zone may grow later, but keeps its middle.
std::vector<double> borders_of(const FitProblem& problem) {
  std::vector<double> borders;
  borders.reserve(problem.pins.size() + problem.zones.size());
  for (const Pin& pin : problem.pins) borders.push_back(pin.parameter);
  for (const StraightZone& zone : problem.zones) borders.push_back(0.5 * (zone.from + zone.to));
  std::sort(borders.begin(), borders.end());
  return borders;
}

// The pin or the place in a zone that parts a problem at u; nothing when there is none any more.
std::optional<Pin> border_at(const FitProblem& problem, double u) {
  const auto pin = std::ranges::lower_bound(problem.pins, u, {}, &Pin::parameter);
  if (pin != problem.pins.end() && pin->parameter == u) return *pin;
  const auto after = std::ranges::upper_bound(problem.zones, u, {}, &StraightZone::from);
  if (after == problem.zones.begin()) return std::nullopt;
  const StraightZone& zone = *std::prev(after);
  if (!(zone.from < u && u < zone.to)) return std::nullopt;
  const double part = (u - zone.from) / (zone.to - zone.from);
  return Pin{u, zone.start + part * (zone.end - zone.start)};
}

// Walks along a problem and cuts off one part after the other.
class SplineCutter {
 public:
  explicit SplineCutter(const FitProblem& problem) : whole_(problem) {}

  FitProblem cut(const Pin& from, const Pin& to) {
    FitProblem part;
    const auto by_itself = [](double u) { return u; };
    part.pins = {from};
    part.breakpoints = {from.parameter};
    take(whole_.samples, &FitSample::parameter, from, to, sample_, part.samples);
    take(whole_.pins, &Pin::parameter, from, to, pin_, part.pins);
    take(whole_.breakpoints, by_itself, from, to, break_, part.breakpoints);
    part.pins.push_back(to);
    part.breakpoints.push_back(to.parameter);
    // Zones that go over a border are cut there.
    while (zone_ < whole_.zones.size() && whole_.zones[zone_].to <= from.parameter) ++zone_;
    for (std::size_t i = zone_; i < whole_.zones.size(); ++i) {
      StraightZone zone = whole_.zones[i];
      if (zone.from >= to.parameter) break;
      if (zone.from < from.parameter) zone.from = from.parameter, zone.start = from.place;
      if (zone.to > to.parameter) zone.to = to.parameter, zone.end = to.place;
      part.zones.push_back(zone);
    }
    return part;
  }

 private:
  // Those inside ]from, to[, from `next` on.
  template <typename Item, typename ParameterOf>
  static void take(const std::vector<Item>& list, const ParameterOf& parameter_of, const Pin& from,
                   const Pin& to, std::size_t& next, std::vector<Item>& taken) {
    const auto at = [&] { return std::invoke(parameter_of, list[next]); };
    while (next < list.size() && at() <= from.parameter) ++next;
    const auto first = list.begin() + static_cast<std::ptrdiff_t>(next);
    while (next < list.size() && at() < to.parameter) ++next;
    taken.insert(taken.end(), first, list.begin() + static_cast<std::ptrdiff_t>(next));
  }

  const FitProblem& whole_;
  std::size_t sample_ = 0;
  std::size_t zone_ = 0;
  std::size_t pin_ = 0;
  std::size_t break_ = 0;
};

}  // namespace

PartedFit::PartedFit(const FitProblem& problem, int max_refinements)
    : max_refinements_(max_refinements) {
  start(problem);
}

PartedFit::PartedFit(const PartedFit& other) = default;
PartedFit::PartedFit(PartedFit&& other) noexcept = default;
PartedFit& PartedFit::operator=(const PartedFit& other) = default;
PartedFit& PartedFit::operator=(PartedFit&& other) noexcept = default;
PartedFit::~PartedFit() = default;

void PartedFit::start(const FitProblem& problem) {
  if (problem.pins.size() < 2) {
    throw std::invalid_argument("fit_bspline: " + std::to_string(problem.pins.size()) +
                                " pins, expected 2 or more");
  }
  const auto is_break = [&](const Pin& pin) {
    return std::binary_search(problem.breakpoints.begin(), problem.breakpoints.end(),
                              pin.parameter);
  };
  if (!std::ranges::all_of(problem.pins, is_break)) {
    throw std::invalid_argument("fit_bspline: a pin is no breakpoint");
  }
  borders_ = borders_of(problem);
  parts_.clear();
  parts_.reserve(borders_.size() - 1);
  const std::vector<Pin> ends = ends_of_parts(problem);
  SplineCutter cutter(problem);
  for (std::size_t i = 1; i < ends.size(); ++i) {
    parts_.emplace_back(cutter.cut(ends[i - 1], ends[i]), max_refinements_);
  }
  assemble(problem);
}

// Part by part: each gives its problem away for the new one.
void PartedFit::refit(const FitProblem& problem, double closest) {
  const std::vector<Pin> ends = ends_of_parts(problem);
  if (ends.empty()) return start(problem);
  SplineCutter cutter(problem);
  for (std::size_t i = 1; i < ends.size(); ++i) {
    parts_[i - 1].refit(cutter.cut(ends[i - 1], ends[i]), closest);
  }
  assemble(problem);
}

// At the borders; none when one of them is none any more.
std::vector<Pin> PartedFit::ends_of_parts(const FitProblem& problem) const {
  std::vector<Pin> ends;
  ends.reserve(borders_.size());
  for (const auto& border : borders_) {
    const std::optional<Pin> end = border_at(problem, border);
    if (!end) return {};
    ends.push_back(*end);
  }
  return ends;
}

// The knots of the parts in a row, but for borders within a zone, and their control points.
void PartedFit::assemble(const FitProblem& problem) {
  std::vector<double> breaks;
  for (const AdaptiveFit& part : parts_) {
    const std::vector<double>& own = part.spline().breaks;
    const bool joins = !breaks.empty() && breaks.back() == own.front();
    if (joins) breaks.pop_back();
    const bool in_zone =
        joins && !std::ranges::binary_search(problem.pins, own.front(), {}, &Pin::parameter);
    breaks.insert(breaks.end(), own.begin() + (in_zone ? 1 : 0), own.end());
  }
  const bool same_spline = breaks == spline_.breaks &&
                           changed_places(pins_, problem.pins, zones_, problem.zones).empty();
  if (!same_spline) {
    spline_ = spline_on(std::move(breaks), problem.pins, problem.zones);
    pins_ = problem.pins;
    zones_ = problem.zones;
  }
  std::size_t next = 0;
  for (const AdaptiveFit& part : parts_) {
    const FitSpline& own = part.spline();
    for (std::size_t i = 0; i < own.size(); ++i) {
      if (own.fixed[i] != 0) continue;
      while (spline_.fixed[next] != 0) ++next;
      spline_.points[next++] = own.points[i];
    }
  }
}

BsplineCurve PartedFit::curve() const {
  return {BsplineBasis(kSplineDegree, spline_.knots), spline_.points};
}

std::vector<ParameterRange> PartedFit::moved() const {
  std::vector<ParameterRange> moved;
  for (const AdaptiveFit& part : parts_) {
    for (const ParameterRange& range : part.moved()) join(range, moved);
  }
  return moved;
}

std::vector<double> PartedFit::ratios(std::span<const FitSample> given) const {
  std::vector<double> ratios;
  ratios.reserve(given.size());
  for (std::size_t i = 0; i < parts_.size(); ++i) {
    const std::size_t begin = ratios.size();
    std::size_t end = begin;
    while (end < given.size() &&
           (i + 1 == parts_.size() || given[end].parameter < borders_[i + 1])) {
      ++end;
    }
    parts_[i].add_ratios(given.subspan(begin, end - begin), ratios);
  }
  return ratios;
}

BsplineFit fit_bspline(const FitProblem& problem, int max_refinements) {
  const PartedFit fit(problem, max_refinements);
  BsplineFit result{fit.curve(), fit.ratios(problem.samples), 0};
  for (const double ratio : result.ratios) result.worst_ratio = std::max(result.worst_ratio, ratio);
  return result;
}

}  // namespace batten::geometry
