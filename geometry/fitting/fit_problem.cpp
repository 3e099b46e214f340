#include "geometry/fitting/fit_problem.h"

#include <algorithm>

namespace batten::geometry {

namespace {

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

bool by_start(const ParameterRange& a, const ParameterRange& b) { return a.from < b.from; }

}  // namespace

bool SampleChanges::any() const {
  return !gone.empty() || std::find(altered.begin(), altered.end(), true) != altered.end();
}

SampleChanges changes_of(std::span<const FitSample> before, std::span<const FitSample> after) {
  SampleChanges changes;
  changes.was.assign(after.size(), SampleChanges::kNew);
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

std::vector<ParameterRange> changed_places(std::span<const Pin> pins_before,
                                           std::span<const Pin> pins_after,
                                           std::span<const StraightZone> zones_before,
                                           std::span<const StraightZone> zones_after) {
  std::vector<ParameterRange> changed;
  add_changed(pins_before, pins_after, changed);
  add_changed(zones_before, zones_after, changed);
  std::sort(changed.begin(), changed.end(), by_start);
  return changed;
}

std::vector<double> required_breaks(const FitProblem& problem) {
  std::vector<double> required;
  required.reserve(problem.pins.size() + 2 * problem.zones.size());
  for (const Pin& pin : problem.pins) required.push_back(pin.parameter);
  for (const StraightZone& zone : problem.zones) {
    required.push_back(zone.from);
    required.push_back(zone.to);
  }
  std::sort(required.begin(), required.end());
  required.erase(std::unique(required.begin(), required.end()), required.end());
  return required;
}

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
  std::size_t next = 0;  // required break at u or behind it
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

}  // namespace batten::geometry
