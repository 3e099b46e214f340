#include "postproc/smooth/selection/run_times.h"

#include <algorithm>

#include "gcode/text/large_pages.h"
#include "postproc/machine/models/junction_speed.h"
#include "postproc/smooth/selection/selection.h"

namespace batten::postproc {

Times& Times::add(const Times& other, double multiple) {
  as_set += multiple * other.as_set;
  without_merging += multiple * other.without_merging;
  flat_out += multiple * other.flat_out;
  exact_path += multiple * other.exact_path;
  return *this;
}

SettingTimes::SettingTimes(std::span<const TimedPiece> chain, const Machine& machine,
                           gcode::PathMode path)
    : machine_(machine), path_(path), chain_(chain, machine) {}

double SettingTimes::as_set() {
  if (!as_set_) as_set_ = chain_.time(machine_, path_);
  return *as_set_;
}

double SettingTimes::without_merging() {
  if (!(machine_.naive_cam_tolerance > 0)) return as_set();
  Machine unmerged = machine_;
  unmerged.naive_cam_tolerance = 0;
  return chain_.time(unmerged, path_);
}

double SettingTimes::exact_path() const {
  return chain_.time(machine_, gcode::PathMode::kExactPath);
}

double SettingTimes::flat_out() {
  chain_.lift_feeds(machine_);
  return chain_.time(machine_, path_);
}

Times times_of(std::span<const TimedPiece> chain, const Machine& machine, gcode::PathMode path) {
  SettingTimes times(chain, machine, path);
  Times all{times.as_set(), times.without_merging(), 0, times.exact_path()};
  all.flat_out = times.flat_out();
  return all;
}

namespace {

Machine with_accelerations(Machine machine, double multiple) {
  for (AxisLimits& axis : machine.axes) axis.acceleration *= multiple;
  machine.path_acceleration *= multiple;
  return machine;
}

}  // namespace

RunTimes::RunTimes(const RunContext& context, const Machine& machine)
    : context_(context), machine_(machine), around_(of_neighbours()) {}

Times RunTimes::of_run(const std::vector<TimedPiece>& motions) const {
  SettingTimes place = in_place(motions, machine_);
  Times times{place.as_set() - around_.as_set, place.without_merging() - around_.without_merging};
  times.flat_out = place.flat_out() - around_.flat_out;
  return times;
}

double RunTimes::as_set_of_run(const std::vector<TimedPiece>& motions) const {
  return in_place(motions, machine_).as_set() - around_.as_set;
}

Times RunTimes::of_candidate(const std::vector<TimedPiece>& moves, std::size_t blocks,
                             const Times& old, bool exact_path, bool wanted) const {
  const bool much_smaller = far_smaller(blocks, context_.blocks);
  SettingTimes place = in_place(moves, machine_);
  Times times = old;
  // What a piece adds may be less than nothing: there one setting says nothing of the others.
  const auto is_slower = [&] {
    return !context_.is_piece() && slower(times, old, much_smaller, wanted);
  };
  times.as_set = place.as_set() - around_.as_set;
  if (is_slower()) return times;
  times.without_merging = place.without_merging() - around_.without_merging;
  if (is_slower()) return times;
  if (exact_path) times.exact_path = place.exact_path() - around_.exact_path;
  times.flat_out = place.flat_out() - around_.flat_out;
  return times;
}

// Axes that can do more pass the same kinks as these axes smaller ones, and do everything else
// quicker. On LinuxCNC a kink that is not blended is passed or stopped at by what it asks of the
// axes (multiple_for_kinks); a blended one is passed at a speed whose square goes with what the
// axes can do, and inversely with the square of the kink.
double RunTimes::as_set_with_less_kinks(const std::vector<TimedPiece>& moves,
                                        double times_less) const {
  const double multiple = multiple_for_kinks(moves, times_less);
  if (multiple == 0) return 0;
  const Machine stronger =
      with_accelerations(machine_, std::max(multiple, times_less * times_less));
  return in_place(moves, stronger).as_set() - around_.as_set;
}

double RunTimes::exact_path_with_less_kinks(const std::vector<TimedPiece>& moves,
                                            double times_less) const {
  const double multiple = multiple_for_kinks(moves, times_less);
  if (multiple == 0) return 0;
  const Machine stronger = with_accelerations(machine_, multiple);
  return in_place(moves, stronger).exact_path() - around_.exact_path;
}

// What a kink k asks, as a part of the acceleration a, is k (v / T + a) / a at speed v and servo
// period T (docs/algorithms/cycle_time.md): k (s + 1) with s = v / T a. With m times the
// acceleration k asks k (s / m + 1), which is to be no more than k (s + 1) / times_less. The
// slowest move decides. 0: no multiple does, or the control is another one.
double RunTimes::multiple_for_kinks(const std::vector<TimedPiece>& moves, double times_less) const {
  if (machine_.model != ControllerModel::kLinuxcnc) return 0;
  double slowest = machine_.max_velocity();
  for (const TimedPiece& move : moves) slowest = std::min(slowest, move.feed / 60);
  const double steps = slowest / (machine_.servo_period * axis_accelerations(machine_).maxCoeff());
  const double left = steps + 1 - times_less;
  return left > 0 ? times_less * steps / left : 0;
}

// What the neighbours take without this piece, each from rest to rest. Of neighbours in a long run
// that was cut: their part of the time.
Times RunTimes::of_neighbours() const {
  if (context_.of_neighbours) return *context_.of_neighbours;
  Times sum;
  for (const auto* chain : {&context_.lead, &context_.tail}) {
    if (!chain->empty()) sum += times_of(*chain, machine_, context_.after.path);
  }
  return sum;
}

SettingTimes RunTimes::in_place(const std::vector<TimedPiece>& moves,
                                const Machine& machine) const {
  const gcode::PathMode path = context_.after.path;
  if (context_.lead.empty() && context_.tail.empty()) return {moves, machine, path};
  std::vector<TimedPiece> chain;
  gcode::reserve_in_large_pages(chain, context_.lead.size() + moves.size() + context_.tail.size());
  for (const auto* part : {&context_.lead, &moves, &context_.tail}) {
    chain.insert(chain.end(), part->begin(), part->end());
  }
  return {chain, machine, path};
}

}  // namespace batten::postproc
