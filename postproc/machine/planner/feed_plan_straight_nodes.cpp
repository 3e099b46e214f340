#include "postproc/machine/planner/feed_plan_straight_nodes.h"

#include <algorithm>
#include <cmath>

namespace batten::postproc {
namespace {

// Times this close, as part of the whole, are the same: rounding of sums.
constexpr double kSamePart = 1e-12;

double time_at(const StraightMove& move, double distance) {
  double below = 0;
  double above = move.time();
  while (true) {
    const double middle = 0.5 * (below + above);
    if (middle <= below || middle >= above) return middle;
    (state_at(move, middle).distance < distance ? below : above) = middle;
  }
}

double time_at(const StraightRun& run, const LimitsAlong& limits, double distance) {
  double below = 0;
  double above = run.time;
  while (true) {
    const double middle = 0.5 * (below + above);
    if (middle <= below || middle >= above) return middle;
    (state_at(run, middle, limits).distance < distance ? below : above) = middle;
  }
}

}  // namespace

// From rest to the end of the first phase, and in the last, the plan's intervals are exact; but
// after an end of a piece there they are not, and must be short against the time from rest.
std::vector<double> node_times(const StraightMove& move, const std::vector<double>& ends,
                               double density) {
  const bool jerk = move.jerk_time > 0;
  const double first = jerk ? move.jerk_time : move.acceleration_time;
  const double inner[] = {jerk ? move.acceleration_time : 0, jerk ? move.jerk_time : 0,
                          move.cruise_time, jerk ? move.jerk_time : 0,
                          jerk ? move.acceleration_time : 0};
  const int parts = std::max(1, static_cast<int>(std::ceil(density)));
  std::vector<double> times;
  double start = first;
  times.push_back(start);
  for (const double phase : inner) {
    const int count = phase > kSamePart * move.time() ? parts : 0;
    for (int i = 1; i <= count; ++i) times.push_back(start + phase * i / count);
    start += phase;
  }
  times.push_back(move.time());
  double nearest_start = first;
  double nearest_end = first;
  for (std::size_t i = 0; i + 1 < ends.size(); ++i) {
    const double time = time_at(move, ends[i]);
    times.push_back(time);
    nearest_start = std::min(nearest_start, time);
    nearest_end = std::min(nearest_end, move.time() - time);
  }
  const double growth = 1 + 1 / density;
  for (double t = nearest_start * growth; t < first; t *= growth) times.push_back(t);
  for (double t = nearest_end * growth; t < first; t *= growth) times.push_back(move.time() - t);
  std::sort(times.begin(), times.end());
  return times;
}

// Times of nodes of a run between two speeds. Near a slow end, and after the end of a piece, nodes
// lie in geometric progression: there the plan's intervals are exact only where they are short.
std::vector<double> node_times(const StraightRun& run, const LimitsAlong& limits,
                               const std::vector<double>& ends, double density) {
  const double growth = 1 + 1 / density;
  const int parts = std::max(1, static_cast<int>(std::ceil(density)));
  std::vector<double> joints = {0, run.time};
  for (std::size_t i = 0; i + 1 < ends.size(); ++i) joints.push_back(time_at(run, limits, ends[i]));
  std::vector<double> times = joints;
  const auto add_ramp = [&](double speed, double direction) {
    const RampTimes ramp = ramp_times(speed, run.peak, limits);
    const double origin = direction > 0 ? 0 : run.time;
    const auto add = [&](double time) { times.push_back(origin + direction * time); };
    const auto add_evenly = [&](double from, double to) {
      if (!(to - from > kSamePart * run.time)) return;
      for (int i = 1; i <= parts; ++i) add(from + (to - from) * i / parts);
    };
    double nearest = speed > 0 ? std::sqrt(speed / limits.jerk) / density : ramp.growing;
    for (const double joint : joints) {
      const double time = direction * (joint - origin);
      if (time > 0) nearest = std::min(nearest, time);
    }
    for (double time = nearest; time < ramp.growing; time *= growth) add(time);
    if (ramp.growing > 0) add(ramp.growing);
    add_evenly(ramp.growing, ramp.whole - ramp.growing);
    add_evenly(ramp.whole - ramp.growing, ramp.whole);
  };
  add_ramp(run.from, 1);
  add_ramp(run.to, -1);
  std::sort(times.begin(), times.end());
  const auto same = [&](double a, double b) { return b - a <= kSamePart * run.time; };
  times.erase(std::unique(times.begin(), times.end(), same), times.end());
  times.erase(times.begin());
  times.back() = run.time;
  return times;
}

}  // namespace batten::postproc
