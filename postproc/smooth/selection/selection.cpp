#include "postproc/smooth/selection/selection.h"

#include <algorithm>
#include <functional>
#include <limits>
#include <optional>
#include <string_view>
#include <tuple>

#include "gcode/state/reason.h"

namespace batten::postproc {

namespace {

struct Ranked {
  bool forced = false;
  double cost = 0;
  std::size_t index = 0;

  // Forced ones first.
  friend bool operator<(const Ranked& a, const Ranked& b) {
    return std::tuple(!a.forced, a.cost, a.index) < std::tuple(!b.forced, b.cost, b.index);
  }
};

}  // namespace

std::string_view reason_for(Objection objection) {
  switch (objection) {
    case Objection::kSlower:
      return gcode::reason::kSlower;
    case Objection::kLarger:
      return gcode::reason::kLarger;
    case Objection::kFarther:
      return gcode::reason::kFarther;
    case Objection::kNoGain:
      return gcode::reason::kNoGain;
    case Objection::kNone:
      break;
  }
  return {};
}

bool is_forced(Form form, const RunFacts& facts, const SmoothOptions& options) {
  return options.output != Form::kAuto && form == options.output && form != facts.form;
}

std::string_view reason_against(const Figures& figures, Form form, const RunFacts& facts,
                                const SmoothOptions& options) {
  if (is_forced(form, facts, options)) {
    return any_gain(figures, facts.scale) ? std::string_view() : gcode::reason::kNoGain;
  }
  const Objection objection = objection_to(figures, facts.scale, options.prefer);
  if (objection != Objection::kNone) return reason_for(objection);
  const bool costs_less = cost_of(figures, facts.scale, options.prefer) <
                          cost_of(facts.scale.original, facts.scale, options.prefer);
  return costs_less ? std::string_view() : gcode::reason::kNoGain;
}

Selection choose(const SmoothedRun& run, const SmoothOptions& options, Among among) {
  Selection selection;
  if (run.candidates.empty()) {
    selection.reason = run.reason;
    return selection;
  }
  std::vector<Ranked> ranked;
  std::optional<Ranked> cheapest;  // of those that something speaks against
  for (std::size_t i = 0; i < run.candidates.size(); ++i) {
    const Candidate& c = run.candidates[i];
    if (among == Among::kFormsAlone && (c.has_run_in_place || c.has_vertices)) continue;
    const Ranked here{is_forced(c.form, run.facts, options),
                      cost_of(c.figures, run.facts.scale, options.prefer), i};
    const std::string_view against = reason_against(c.figures, c.form, run.facts, options);
    if (against.empty()) {
      ranked.push_back(here);
    } else if (!cheapest || here < *cheapest) {
      cheapest = here;
      selection.reason = against;
    }
  }
  std::ranges::sort(ranked, std::less<>());
  for (const Ranked& each : ranked) selection.order.push_back(each.index);
  if (!ranked.empty()) selection.reason = {};
  return selection;
}

Outlook& Outlook::operator+=(const Outlook& other) {
  others += other.others;
  at_feeds_s += other.at_feeds_s;
  better += other.better;
  return *this;
}

SmoothOptions other_options(SmoothOptions options, int row) {
  const auto index = static_cast<std::size_t>(row);
  if (index < forms().size()) {
    options.output = forms()[index].value;
  } else {
    options.prefer = preferences()[index - forms().size()].value;
  }
  return options;
}

Outlook outlook_of(const SmoothedRun& run, const SmoothOptions& options) {
  const CostScale& scale = run.facts.scale;
  const Figures& old = scale.original;
  Outlook outlook;
  for (int i = 0; i < outlook.others.rows(); ++i) {
    const Selection selection = choose(run, other_options(options, i));
    if (selection.order.empty()) continue;
    const Figures& now = run.candidates[selection.order.front()].figures;
    outlook.others.row(i) << now.times.programmed - old.times.programmed, now.blocks - old.blocks,
        (now.distance * now.distance - old.distance * old.distance) * run.facts.length;
  }
  const auto better = [&](const Candidate& c) { return is_clearly_better(c.figures, scale); };
  outlook.better = std::ranges::any_of(run.candidates, better) ? 1 : 0;
  return outlook;
}

BestSoFar best_so_far(const SmoothedRun& run, const SmoothOptions& options) {
  const CostScale& scale = run.facts.scale;
  const bool forced = is_forced(options.output, run.facts, options);
  BestSoFar best;
  best.cost = forced ? std::numeric_limits<double>::infinity()
                     : cost_of(scale.original, scale, options.prefer);
  for (const Candidate& c : run.candidates) {
    if (forced && c.form != options.output) continue;
    if (!reason_against(c.figures, c.form, run.facts, options).empty()) continue;
    const double cost = cost_of(c.figures, scale, options.prefer);
    if (cost < best.cost) best = {c.key, cost};
  }
  return best;
}

double cost_to_beat(const SmoothedRun& run, const SmoothOptions& options) {
  return best_so_far(run, options).cost;
}

std::vector<FormRecord::Outcome> outcomes_of(const SmoothedRun& run, const SmoothOptions& options) {
  const CostScale& scale = run.facts.scale;
  std::vector<FormRecord::Outcome> outcomes;
  outcomes.reserve(run.tried.size());
  for (const TriedForm& tried : run.tried) outcomes.push_back({tried});
  for (const std::size_t best : choose(run, options).order) {
    const Candidate& c = run.candidates[best];
    const auto of = std::ranges::find(outcomes, c.key, [](const auto& o) { return o.tried.key; });
    if (of == outcomes.end() || of->may_be_written) continue;
    of->may_be_written = true;
    of->cost = cost_of(c.figures, scale, options.prefer);
    of->blocks = c.figures.blocks / scale.original.blocks;
  }
  return outcomes;
}

std::vector<MethodTime> method_times(const SmoothedRun& run) {
  std::vector<MethodTime> times;
  for (const Candidate& candidate : run.candidates) {
    const auto known = std::ranges::find(times, candidate.method, &MethodTime::method);
    if (known == times.end()) {
      times.push_back({candidate.method, candidate.figures.times.programmed});
    } else {
      known->time_s = std::min(known->time_s, candidate.figures.times.programmed);
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
