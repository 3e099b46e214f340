#include "postproc/smooth/selection/selection.h"

#include <algorithm>
#include <optional>
#include <string_view>

#include "gcode/state/reason.h"

namespace batten::postproc {

namespace {

// Times are estimates, good to about a percent: a difference below this is none, and half of
// it already speaks against replacing what stood there.
constexpr double kSameTime = 0.01;
constexpr double kSlower = 0.005;

// A quarter of the blocks is worth a time that is just about measurable.
constexpr double kSameTimeWhereFarSmaller = 0.025;

// A form that the user asked for by name may cost this much.
constexpr double kWantedCosts = 0.15;

// Of two equals, one that would keep its speed under exact path is better when it takes less
// than this part of the other's time there: it has fewer kinks, on any control.
constexpr double kFewerKinks = 0.7;

// What counts as a gain: so much less time, so many fewer blocks or bytes, an error so much
// smaller.
constexpr double kLessTime = 0.01;
constexpr double kLessTimeForMore = 0.05;  // where it takes more blocks than before
constexpr double kFewerBlocks = 0.9;
constexpr double kFewerBytes = 0.9;
constexpr double kNearer = 0.6;

// Arcs of which no two meet in more than this part of the greatest kink before are a gain, and may
// be this part more, or one, where that saves time with the feed turned up.
constexpr double kSmoother = 0.1;
constexpr double kMoreForSmoother = 0.1;

// Who prefers accuracy may get this multiple of blocks for it.
constexpr double kMoreBlocks = 1.5;

// Errors within this factor are equal: then the smaller text is better.
constexpr double kSameError = 2.5;

// An estimate of blocks may be too high by this factor.
constexpr double kEstimate = 1.25;

double sum_of(const Times& times) { return times.as_set + times.without_merging; }

double most_blocks_for_accuracy(Prefer prefer) {
  return prefer == Prefer::kAccuracy ? kMoreBlocks : 1;
}

bool is_smoother(double kink, double before) { return before > 0 && kink <= kSmoother * before; }

bool gains(const Candidate& c, const SmoothedRun& run, const RunContext& context, Prefer prefer) {
  const RunFacts& old = run.facts;
  const auto blocks = static_cast<double>(c.text.blocks);
  const auto blocks_before = static_cast<double>(context.blocks);
  const auto bytes = static_cast<double>(c.text.text.size());
  const double less = blocks > blocks_before ? kLessTimeForMore : kLessTime;
  const bool faster = sum_of(c.times) < (1 - less) * sum_of(old.times);
  const bool smaller = blocks <= kFewerBlocks * blocks_before;
  const bool nearer =
      c.error <= kNearer * old.error && blocks <= most_blocks_for_accuracy(prefer) * blocks_before;
  const bool quicker_flat_out = c.times.flat_out < (1 - kLessTimeForMore) * old.times.flat_out;
  const double more = quicker_flat_out ? std::max(1.0, kMoreForSmoother * blocks_before) : 0;
  const bool smoother = is_smoother(c.kink, old.kink) && blocks <= blocks_before + more;
  if (prefer == Prefer::kSize) return bytes <= kFewerBytes * static_cast<double>(context.bytes);
  return faster || smaller || nearer || smoother;
}

bool is_much_better(const Candidate& c, const RunFacts& old, const RunContext& context) {
  return far_smaller(c.text.blocks, context.blocks) ||
         (is_smoother(c.kink, old.kink) && c.text.blocks <= context.blocks);
}

// Who asks for arcs or curves by name asks for few of them.
bool better(const Candidate& a, const Candidate& b, const SmoothOptions& options) {
  const Prefer prefer = options.prefer;
  const bool a_is_curves = a.form == OutputForm::kCurves;
  if (options.output == Form::kCurves && a_is_curves != (b.form == OutputForm::kCurves)) {
    return a_is_curves;
  }
  if (prefer == Prefer::kSize) return a.text.text.size() < b.text.text.size();
  if (prefer == Prefer::kTime) {
    const auto [fewer, more] = std::minmax(a.text.blocks, b.text.blocks);
    const double same = far_smaller(fewer, more) ? kSameTimeWhereFarSmaller : kSameTime;
    if (sum_of(a.times) < (1 - same) * sum_of(b.times)) return true;
    if (sum_of(b.times) < (1 - same) * sum_of(a.times)) return false;
    if (!compares_kinks(options)) return a.text.blocks < b.text.blocks;
    if (a.times.exact_path < kFewerKinks * b.times.exact_path) return true;
    if (b.times.exact_path < kFewerKinks * a.times.exact_path) return false;
    if (a.error * kSameError < b.error) return true;
    if (b.error * kSameError < a.error) return false;
    return a.text.blocks < b.text.blocks;
  }
  return a.error < b.error;
}

}  // namespace

bool slower(const Times& now, const Times& before, bool much_better, bool wanted) {
  if (wanted) return now.as_set > (1 + kWantedCosts) * before.as_set;
  // With the feed turned up that may cost a little.
  const double flat_out = much_better ? kSameTimeWhereFarSmaller : kSameTime;
  return now.as_set > (1 + kSlower) * before.as_set ||
         now.without_merging > (1 + kSlower) * before.without_merging ||
         now.flat_out > (1 + flat_out) * before.flat_out;
}

bool far_smaller(std::size_t blocks, std::size_t others) { return 4 * blocks <= others; }

bool compares_kinks(const SmoothOptions& options) {
  return options.prefer == Prefer::kTime && options.output != Form::kArcs &&
         options.output != Form::kCurves;
}

bool keeps_speed(const Times& times, double least_time) {
  return least_time >= kFewerKinks * times.exact_path;
}

std::size_t most_moves_for_accuracy(std::size_t blocks) {
  return static_cast<std::size_t>(kMoreBlocks * static_cast<double>(blocks));
}

bool may_gain(const Prospect& prospect, const RunFacts& before, std::size_t blocks, Prefer prefer) {
  if (prefer == Prefer::kSize) return true;
  const double least = prospect.blocks / kEstimate / static_cast<double>(blocks);
  const bool faster = 2 * prospect.least_time < (1 - kLessTime) * sum_of(before.times);
  const bool nearer =
      prospect.error <= kNearer * before.error && least <= most_blocks_for_accuracy(prefer);
  return faster || least <= kFewerBlocks || nearer;
}

// As `better` of the two.
bool beats(const Candidate& c, const Bound& bound, const SmoothedRun& run,
           const RunContext& context, const SmoothOptions& options) {
  const bool wanted = options.output != Form::kAuto;
  if (!compares_kinks(options) ||
      slower(c.times, run.facts.times, is_much_better(c, run.facts, context), wanted) ||
      !gains(c, run, context, options.prefer)) {
    return false;
  }
  if (2 * bound.least_time < (1 - kSameTime) * sum_of(c.times)) return false;
  if (!keeps_speed(c.times, std::max(bound.least_time, bound.exact_path))) return false;
  if (c.error * kSameError < bound.error) return true;
  // Both may be multiples of one share of the tolerance that are just so far apart.
  constexpr double kRounding = 1 + 1e-6;
  if (bound.error * kSameError < kRounding * c.error) return false;
  return static_cast<double>(c.text.blocks) < bound.blocks / kEstimate;
}

Selection choose(const SmoothedRun& run, const RunContext& context, const SmoothOptions& options) {
  const Prefer prefer = options.prefer;
  const bool wanted = options.output != Form::kAuto;
  Selection selection;
  if (run.candidates.empty()) {
    selection.reason = run.reason;
    return selection;
  }
  bool all_slower = true;
  for (std::size_t i = 0; i < run.candidates.size(); ++i) {
    const Candidate& c = run.candidates[i];
    if (slower(c.times, run.facts.times, is_much_better(c, run.facts, context), wanted)) continue;
    all_slower = false;
    if (gains(c, run, context, prefer)) selection.order.push_back(i);
  }
  // With three or more candidates "better" is no order (its margins do not add up), so the best
  // is found by one pass and the rest follow as they are.
  for (std::size_t i = 1; i < selection.order.size(); ++i) {
    if (better(run.candidates[selection.order[i]], run.candidates[selection.order[0]], options)) {
      std::swap(selection.order[0], selection.order[i]);
    }
  }
  if (selection.order.empty()) {
    selection.reason = all_slower ? gcode::reason::kSlower : gcode::reason::kNoGain;
  }
  return selection;
}

std::vector<MethodTime> method_times(const SmoothedRun& run) {
  std::vector<MethodTime> times;
  for (const Candidate& candidate : run.candidates) {
    const auto known = std::ranges::find(times, candidate.method, &MethodTime::method);
    if (known == times.end()) {
      times.push_back({candidate.method, candidate.times.as_set});
    } else {
      known->time_s = std::min(known->time_s, candidate.times.as_set);
    }
  }
  return times;
}

double lead_of(std::string_view method, double time_s, const std::vector<MethodTime>& times) {
  std::optional<double> other;
  for (const MethodTime& each : times) {
    if (each.method == method) continue;
    other = other ? std::min(*other, each.time_s) : each.time_s;
  }
  return other ? *other - time_s : 0;
}

std::vector<MethodTime> joined_times(const TriedStretch& first, const TriedStretch& second) {
  const auto is = [](std::string_view name) {
    return [name](const MethodTime& each) { return each.method == name; };
  };
  std::vector<MethodTime> joined;
  for (const MethodTime& each : first.methods) {
    const auto other = std::ranges::find_if(second.methods, is(each.method));
    const double rest = other == second.methods.end() ? second.time_s : other->time_s;
    joined.push_back({each.method, each.time_s + rest});
  }
  for (const MethodTime& each : second.methods) {
    if (std::ranges::any_of(first.methods, is(each.method))) continue;
    joined.push_back({each.method, first.time_s + each.time_s});
  }
  return joined;
}

}  // namespace batten::postproc
