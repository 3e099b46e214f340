#include "postproc/smooth/selection/candidate.h"

namespace batten::postproc {

Times& Times::operator+=(const Times& other) {
  as_set += other.as_set;
  without_merging += other.without_merging;
  flat_out += other.flat_out;
  exact_path += other.exact_path;
  return *this;
}

Times& Times::operator-=(const Times& other) {
  as_set -= other.as_set;
  without_merging -= other.without_merging;
  flat_out -= other.flat_out;
  exact_path -= other.exact_path;
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
  Times all;
  all.as_set = times.as_set();
  all.without_merging = times.without_merging();
  all.exact_path = times.exact_path();
  all.flat_out = times.flat_out();
  return all;
}

}  // namespace batten::postproc
