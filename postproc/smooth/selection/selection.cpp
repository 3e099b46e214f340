#include "postproc/smooth/selection/selection.h"

#include <algorithm>
#include <optional>
#include <string_view>

#include "gcode/state/reason.h"

namespace batten::postproc {

namespace {

double sum_of(const Times& times) { return times.as_set + times.without_merging; }

double most_blocks_for_accuracy(Prefer prefer) {
  return prefer == Prefer::kAccuracy ? kChoice.more_blocks : 1;
}

bool is_smoother(double kink, double before) {
  return before > 0 && kink <= kChoice.smoother * before;
}

bool gains(const Candidate& c, const SmoothedRun& run, const RunContext& context, Prefer prefer) {
  const RunFacts& old = run.facts;
  const auto blocks = static_cast<double>(c.text.blocks);
  const auto blocks_before = static_cast<double>(context.blocks);
  const auto bytes = static_cast<double>(c.text.text.size());
  const double less = blocks > blocks_before ? kChoice.less_time_for_more : kChoice.less_time;
  const bool faster = sum_of(c.times) < (1 - less) * sum_of(old.times);
  const bool smaller = blocks <= kChoice.fewer_blocks * blocks_before;
  const bool nearer = c.error <= kChoice.nearer * old.error &&
                      blocks <= most_blocks_for_accuracy(prefer) * blocks_before;
  const bool quicker_flat_out =
      c.times.flat_out < (1 - kChoice.less_time_for_more) * old.times.flat_out;
  const double more =
      quicker_flat_out ? std::max(1.0, kChoice.more_for_smoother * blocks_before) : 0;
  const bool smoother = is_smoother(c.kink, old.kink) && blocks <= blocks_before + more;
  if (prefer == Prefer::kSize)
    return bytes <= kChoice.fewer_bytes * static_cast<double>(context.bytes);
  return faster || smaller || nearer || smoother;
}

bool is_much_better(const Candidate& c, const RunFacts& old, const RunContext& context) {
  return far_smaller(c.text.blocks, context.blocks) ||
         (is_smoother(c.kink, old.kink) && c.text.blocks <= context.blocks);
}

// Who asks for arcs or curves by name asks for few of them.
bool better(const Candidate& a, const Candidate& b, const SmoothOptions& options) {
  const Prefer prefer = options.prefer;
  const bool a_is_curves = a.form == Form::kCurves;
  if (options.output == Form::kCurves && a_is_curves != (b.form == Form::kCurves)) {
    return a_is_curves;
  }
  if (prefer == Prefer::kSize) return a.text.text.size() < b.text.text.size();
  if (prefer == Prefer::kTime) {
    const auto [fewer, more] = std::minmax(a.text.blocks, b.text.blocks);
    const double same =
        far_smaller(fewer, more) ? kChoice.same_time_where_far_smaller : kChoice.same_time;
    if (sum_of(a.times) < (1 - same) * sum_of(b.times)) return true;
    if (sum_of(b.times) < (1 - same) * sum_of(a.times)) return false;
    if (!compares_kinks(options)) return a.text.blocks < b.text.blocks;
    if (a.times.exact_path < kChoice.fewer_kinks * b.times.exact_path) return true;
    if (b.times.exact_path < kChoice.fewer_kinks * a.times.exact_path) return false;
    if (a.error * kChoice.same_error < b.error) return true;
    if (b.error * kChoice.same_error < a.error) return false;
    return a.text.blocks < b.text.blocks;
  }
  return a.error < b.error;
}

}  // namespace

bool slower(const Times& now, const Times& before, bool much_better, bool wanted) {
  if (wanted) return now.as_set > (1 + kChoice.wanted_costs) * before.as_set;
  // With the feed turned up that may cost a little.
  const double flat_out = much_better ? kChoice.same_time_where_far_smaller : kChoice.same_time;
  return now.as_set > (1 + kChoice.slower) * before.as_set ||
         now.without_merging > (1 + kChoice.slower) * before.without_merging ||
         now.flat_out > (1 + flat_out) * before.flat_out;
}

bool far_smaller(std::size_t blocks, std::size_t others) { return 4 * blocks <= others; }

bool compares_kinks(const SmoothOptions& options) {
  return options.prefer == Prefer::kTime && options.output != Form::kArcs &&
         options.output != Form::kCurves;
}

bool keeps_speed(const Times& times, double least_time) {
  return least_time >= kChoice.fewer_kinks * times.exact_path;
}

std::size_t most_moves_for_accuracy(std::size_t blocks) {
  return static_cast<std::size_t>(kChoice.more_blocks * static_cast<double>(blocks));
}

bool may_gain(const Bound& bound, const RunFacts& before, std::size_t blocks, Prefer prefer) {
  if (prefer == Prefer::kSize) return true;
  const double least = bound.blocks / kChoice.estimate / static_cast<double>(blocks);
  const bool faster = 2 * bound.least_time < (1 - kChoice.less_time) * sum_of(before.times);
  const bool nearer =
      bound.error <= kChoice.nearer * before.error && least <= most_blocks_for_accuracy(prefer);
  return faster || least <= kChoice.fewer_blocks || nearer;
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
  if (2 * bound.least_time < (1 - kChoice.same_time) * sum_of(c.times)) return false;
  if (!keeps_speed(c.times, std::max(bound.least_time, bound.exact_path))) return false;
  if (c.error * kChoice.same_error < bound.error) return true;
  // Both may be multiples of one share of the tolerance that are just so far apart.
  constexpr double kRounding = 1 + 1e-6;
  if (bound.error * kChoice.same_error < kRounding * c.error) return false;
  return static_cast<double>(c.text.blocks) < bound.blocks / kChoice.estimate;
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

std::vector<MethodTime> joined_times(const TriedSection& first, const TriedSection& second) {
  const auto in = [](const TriedSection& tried, std::string_view method) {
    return std::ranges::find(tried.methods, method, &MethodTime::method);
  };
  std::vector<MethodTime> joined = first.methods;
  for (MethodTime& each : joined) {
    const auto other = in(second, each.method);
    each.time_s += other == second.methods.end() ? second.time_s : other->time_s;
  }
  for (const MethodTime& each : second.methods) {
    if (in(first, each.method) != first.methods.end()) continue;
    joined.push_back({each.method, first.time_s + each.time_s});
  }
  return joined;
}

}  // namespace batten::postproc
