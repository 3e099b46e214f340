#include "postproc/smooth/selection/candidate_bounds.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include "postproc/machine/models/junction_speed.h"
#include "postproc/runs/run_path.h"
#include "postproc/smooth/selection/candidate.h"
#include "postproc/smooth/selection/selection.h"

namespace batten::postproc {

namespace {

// mm/s: the machine's speed at a feed in mm/min.
double speed_at(double feed, const Machine& machine) {
  return std::min(feed / 60, machine.max_velocity());
}

// Times of a piece leave out what its neighbours need to stop and start; what it could gain is
// judged by its time alone.
Times judged_times(const RunTask& task, const Times& in_place) {
  if (!task.context.is_piece()) return in_place;
  const std::vector<TimedPiece> alone = timed_pieces(task.run, 0, task.run.points.size() - 1);
  SettingTimes times(alone, *task.options.machine, task.context.after.path);
  return {times.as_set(), times.without_merging(), in_place.flat_out, in_place.exact_path};
}

}  // namespace

CandidateBounds::CandidateBounds(const RunTask& task, const RunTimes& times,
                                 const SmoothedRun& so_far)
    : task_(task),
      times_(times),
      so_far_(so_far),
      least_time_(postproc::least_time(task.run, task.options.tolerance_mm, *task.options.machine,
                                       task.options.tolerance_kind)),
      before_(judged_times(task, so_far.facts.times)) {}

RunFacts CandidateBounds::facts_before() const {
  RunFacts facts = so_far_.facts;
  facts.times = before_;
  return facts;
}

bool CandidateBounds::is_hopeless() const {
  const auto& [run, context, options, scope] = task_;
  if (coarse_part(run, options.tolerance_mm) < kBounds.coarse) return false;
  const RunFacts before = facts_before();
  const Bound corners{least_time_, before.error, 2.0 * static_cast<double>(context.blocks), 0};
  return !may_gain(corners, before, context.blocks, options.prefer);
}

bool CandidateBounds::are_hopeless(const LinesAhead& lines) const {
  const Prefer prefer = task_.options.prefer;
  const Bound chords{least_time_, known(lines.deviation), blocks_of(lines), 0};
  return prefer == Prefer::kTime && !may_gain(chords, facts_before(), task_.context.blocks, prefer);
}

bool CandidateBounds::arcs_are_hopeless(const geometry::MarkedPieces& curve) const {
  const SmoothOptions& options = task_.options;
  // Each straight part is a line, and what joins two of them gently takes two arcs or more.
  return options.prefer == Prefer::kTime && options.output == Form::kAuto &&
         3 * curve.straight_runs.size() > task_.context.blocks;
}

double CandidateBounds::known(double error) const {
  return std::max(error, kBounds.known * so_far_.facts.noise);
}

// About how many of them there will be, as plan_lines lays them.
double CandidateBounds::blocks_of(const LinesAhead& lines) const {
  const Machine& machine = *task_.options.machine;
  const double feed = greatest_feed(task_.run);
  return lines.bends.chords(0.5 * lines.deviation,
                            2 * speed_at(feed, machine) * machine.block_period);
}

// What no form of the run takes less than, s: `least_time_`, and to start and to stop.
double CandidateBounds::least_time_at_rest() const {
  const Machine& machine = *task_.options.machine;
  const double least_feed = std::ranges::min(task_.run.feeds, {}, &FeedFrom::feed).feed;
  const double lost = speed_at(least_feed, machine) / axis_accelerations(machine).norm();
  return least_time_ > lost ? least_time_ + lost : least_time_;
}

bool CandidateBounds::keeps_speed(const Times& times) const {
  return postproc::keeps_speed(times, least_time_at_rest());
}

bool CandidateBounds::beats_form(const Candidate& candidate, double deviation,
                                 double blocks) const {
  const Bound bound{least_time_at_rest(), known(deviation), blocks, 0};
  return beats(candidate, bound, so_far_, task_.context, task_.options);
}

bool CandidateBounds::beats_lines(const Candidate& candidate, const LinesAhead& lines) const {
  return beats_form(candidate, lines.deviation, blocks_of(lines));
}

// The kinks of chords go with the root of their deviation.
bool CandidateBounds::beats_finer(const Candidate& lines, double deviation,
                                  const LinesAhead& finer) const {
  const auto beats_it = [&](const Bound& bound) {
    return beats(lines, bound, so_far_, task_.context, task_.options);
  };
  const double time = 0.5 * (lines.times.as_set + lines.times.without_merging);
  Bound bound{time, known(finer.deviation), blocks_of(finer), lines.times.exact_path};
  if (!beats_it(bound)) return false;
  const double less_kinks = kBounds.even_less * std::sqrt(deviation / finer.deviation);
  bound.exact_path = times_.exact_path_with_less_kinks(lines.moves, less_kinks);
  if (!beats_it(bound)) return false;
  // Without merging they gain as little as these do.
  const double share = std::min(time / lines.times.as_set, 1.0);
  bound.least_time = std::max(least_time_at_rest(),
                              share * times_.as_set_with_less_kinks(lines.moves, less_kinks));
  return beats_it(bound);
}

using geometry::Vector3;

namespace {

// What a path within `tolerance` of a corner can save by cutting it: a chord across the corner at
// the height h above it is 2 h tan(turn / 4) shorter than the legs. It joins the middles of the
// legs at most.
double saved_at(const Vector3& a, const Vector3& b, double tolerance,
                geometry::ToleranceKind kind) {
  const double to_middles = 0.5 * (a.norm() + b.norm() - (a + b).norm());
  const double across = a.cross(b).norm();
  // A sine is less than its turn, and a tangent greater.
  const double sine = across / (a.norm() * b.norm());
  if (to_middles <= tolerance * sine / 2) return to_middles;
  const double turn = std::atan2(across, a.dot(b));
  if (kind == geometry::ToleranceKind::kBand) {
    tolerance /= std::max(std::cos(turn / 2), std::sin(geometry::kSharpestCut / 2));
  }
  return std::min(to_middles, 2 * tolerance * std::tan(turn / 4));
}

}  // namespace

double least_time(const Run& run, double tolerance, const Machine& machine,
                  geometry::ToleranceKind kind) {
  const auto& p = run.points;
  double time = 0;
  std::size_t next = 0;
  double speed = machine.max_velocity();
  for (std::size_t i = 0; i + 1 < p.size(); ++i) {
    while (next < run.feeds.size() && run.feeds[next].vertex <= i) {
      speed = std::min(run.feeds[next++].feed / 60, machine.max_velocity());
    }
    double length = (p[i + 1] - p[i]).norm();
    if (i > 0) length -= saved_at(p[i] - p[i - 1], p[i + 1] - p[i], tolerance, kind);
    time += length / speed;
  }
  return time;
}

double coarse_part(const Run& run, double tolerance) {
  const auto& p = run.points;
  std::size_t coarse = 0;
  for (std::size_t i = 1; i + 1 < p.size(); ++i) {
    const Vector3 a = p[i] - p[i - 1];
    const Vector3 b = p[i + 1] - p[i];
    const double across = a.cross(b).norm();
    const auto [shorter, longer] = std::minmax({a.norm(), b.norm()});
    // A turn of less than a right angle is less than 1.6 of its sine.
    if (a.dot(b) > 0 && 1.6 * across / 8 <= tolerance * longer) continue;
    if (std::atan2(across, a.dot(b)) * shorter / 8 > tolerance) ++coarse;
  }
  return p.size() > 2 ? static_cast<double>(coarse) / static_cast<double>(p.size() - 2) : 0;
}

std::vector<Method> methods_worth_trying(double corners, std::size_t points, double least_time,
                                         double time) {
  if (corners < kBounds.corners || least_time > (1 - kBounds.worth_trying) * time) return {};
  if (points > kBounds.most_searched) return {Method::kGuo};
  return {Method::kGuo, Method::kOzcan, Method::kTimeOptimal};
}

}  // namespace batten::postproc
