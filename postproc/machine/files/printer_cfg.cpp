// The printer.cfg of a machine with Klipper.
#include <fmt/format.h>

#include <algorithm>
#include <string_view>

#include "postproc/machine/files/machine_file.h"
#include "postproc/machine/files/settings_file.h"

namespace batten::postproc {
namespace {

constexpr std::string_view kPrinter = "printer";
constexpr std::string_view kArcs = "gcode_arcs";
constexpr double kLeastShare = 0.001;  // of the acceleration: the ratio stays below 1

class PrinterCfgReader {
 public:
  PrinterCfgReader(const SectionFile& cfg, const std::string& file,
                   std::vector<std::string>& problems)
      : cfg_(cfg),
        taker_(file, problems),
        machine_(machine_like("klipper-router", "Klipper", file)) {}

  std::shared_ptr<const Machine> read() {
    read_limits();
    take("square_corner_velocity", machine_.square_corner_velocity, {"square-corner-velocity"});
    read_cruise_ratio();
    taker_.take(cfg_.find(kArcs, "resolution"), 1, machine_.arc_resolution, {"arc-resolution"});
    return taker_.machine(std::move(machine_));
  }

 private:
  // X and Y go along the path as fast as it; Z has limits of its own where the file says them.
  void read_limits() {
    AxisLimits limits;
    require("max_velocity", limits.velocity,
            {"axis.x.velocity", "axis.y.velocity", "axis.z.velocity", "axis.x.rapid-velocity",
             "axis.y.rapid-velocity", "axis.z.rapid-velocity"});
    require("max_accel", limits.acceleration,
            {"axis.x.acceleration", "axis.y.acceleration", "axis.z.acceleration"});
    // A value that is too small is wrong once.
    machine_.path_feed = machine_.path_acceleration = Machine::kNone;
    if (limits.velocity > 0) machine_.path_feed = limits.velocity;
    if (limits.acceleration > 0) machine_.path_acceleration = limits.acceleration;
    limits.rapid_velocity = limits.velocity;
    limits.jerk = Machine::kNone;
    for (std::size_t i = 0; i < kLinearAxes; ++i) machine_.axes[i] = limits;
    AxisLimits& z = machine_.axis(Axis::kZ);
    take("max_z_velocity", z.velocity, {"axis.z.velocity", "axis.z.rapid-velocity"});
    take("max_z_accel", z.acceleration, {"axis.z.acceleration"});
    z.rapid_velocity = z.velocity;
  }

  // Older files say the acceleration for smoothed speeds itself.
  void read_cruise_ratio() {
    if (take("minimum_cruise_ratio", machine_.minimum_cruise_ratio, {"minimum-cruise-ratio"})) {
      return;
    }
    double smoothed = 0;
    if (take("max_accel_to_decel", smoothed, {})) {
      machine_.minimum_cruise_ratio =
          1 - std::clamp(smoothed / machine_.path_acceleration, kLeastShare, 1.0);
    }
  }

  void require(std::string_view key, double& place, std::initializer_list<std::string> keys) {
    taker_.require(cfg_.find(kPrinter, key), fmt::format("{} in [{}]", key, kPrinter), 1, place,
                   keys);
  }

  bool take(std::string_view key, double& place, std::initializer_list<std::string> keys) {
    return taker_.take(cfg_.find(kPrinter, key), 1, place, keys);
  }

  const SectionFile& cfg_;
  SettingTaker taker_;
  Machine machine_;
};

}  // namespace

std::shared_ptr<const Machine> read_printer_cfg(const std::string& file,
                                                std::vector<std::string>& problems) {
  const std::size_t problems_before = problems.size();
  const SectionFile cfg(file,
                        {.separators = ":=",
                         .comments_anywhere = true,
                         .indented_goes_on = true,
                         .last_counts = true},
                        problems);
  if (problems.size() > problems_before) return nullptr;
  if (!cfg.has_section(kPrinter)) {
    problems.push_back(fmt::format(
        "{}: no [printer] in it or what it includes, expected the file that has it", file));
    return nullptr;
  }
  return PrinterCfgReader(cfg, file, problems).read();
}

}  // namespace batten::postproc
