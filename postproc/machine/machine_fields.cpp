#include "postproc/machine/machine_fields.h"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <cmath>

#include "postproc/machine/machine.h"

namespace batten::postproc {
namespace {

constexpr double kGravity = 9806.65;  // mm/s^2
constexpr double kTurn = 360;         // degrees
constexpr double kBitsPerByte = 10;   // of a serial line: a start bit, eight of data, a stop bit

constexpr std::array kLengths = {Unit{"mm", 1}, Unit{"um", 1e-3}, Unit{"in", kInch},
                                 Unit{"inch", kInch}};
constexpr std::array kVelocities = {Unit{"mm/s", 1},
                                    Unit{"mm/min", 1 / kMinute},
                                    Unit{"m/min", 1000 / kMinute},
                                    Unit{"m/s", 1000},
                                    Unit{"in/s", kInch},
                                    Unit{"in/min", kInch / kMinute},
                                    Unit{"ipm", kInch / kMinute}};
constexpr std::array kAccelerations = {
    Unit{"mm/s2", 1},    Unit{"mm/s^2", 1},    Unit{"m/s2", 1000},   Unit{"m/s^2", 1000},
    Unit{"g", kGravity}, Unit{"in/s2", kInch}, Unit{"in/s^2", kInch}};
constexpr std::array kJerks = {Unit{"mm/s3", 1},    Unit{"mm/s^3", 1},    Unit{"m/s3", 1000},
                               Unit{"m/s^3", 1000}, Unit{"in/s3", kInch}, Unit{"in/s^3", kInch}};
constexpr std::array kAngularVelocities = {Unit{"deg/s", 1}, Unit{"deg/min", 1 / kMinute},
                                           Unit{"rpm", kTurn / kMinute}, Unit{"rad/s", kRadian}};
constexpr std::array kAngularAccelerations = {Unit{"deg/s2", 1}, Unit{"deg/s^2", 1},
                                              Unit{"rad/s2", kRadian}, Unit{"rad/s^2", kRadian}};
constexpr std::array kAngularJerks = {Unit{"deg/s3", 1}, Unit{"deg/s^3", 1},
                                      Unit{"rad/s3", kRadian}, Unit{"rad/s^3", kRadian}};
constexpr std::array kTimes = {Unit{"s", 1}, Unit{"ms", 1e-3}, Unit{"us", 1e-6},
                               Unit{"min", kMinute}};
constexpr std::array kBlockRates = {Unit{"blocks/s", 1}, Unit{"blocks/min", 1 / kMinute}};
constexpr std::array kShares = {Unit{"share", 1}, Unit{"%", 0.01}};
constexpr std::array kStepRates = {Unit{"steps/mm", 1}, Unit{"steps/in", 1 / kInch}};
constexpr std::array kAngularStepRates = {Unit{"steps/deg", 1}};
constexpr std::array kByteRates = {Unit{"bytes/s", 1}, Unit{"baud", 1 / kBitsPerByte}};

constexpr Allowed kPositive;
constexpr Allowed kOrZero{.zero = true};
constexpr Allowed kOrInfinite{.infinite = true};
constexpr Allowed kBelowOne{.zero = true, .one_and_more = false};

constexpr std::array kMachineFields = {
    MachineField{"path-feed", Quantity::kVelocity, &Machine::path_feed, kOrInfinite,
                 "greatest speed along the path of X Y Z"},
    MachineField{"path-acceleration", Quantity::kAcceleration, &Machine::path_acceleration,
                 kOrInfinite, "greatest acceleration along the path"},
    MachineField{"path-jerk", Quantity::kJerk, &Machine::path_jerk, kOrInfinite,
                 "greatest jerk along the path"},
    MachineField{"block-period", Quantity::kTime, &Machine::block_period, kPositive,
                 "no block is passed faster"},
    MachineField{"stream-rate", Quantity::kByteRate, &Machine::stream_rate, kOrInfinite,
                 "of the line that feeds the control; inf: it reads a file"},
    MachineField{"servo-period", Quantity::kTime, &Machine::servo_period, kPositive,
                 "how often the axes get a new position"},
    MachineField{"junction-deviation", Quantity::kLength, &Machine::junction_deviation, kOrZero,
                 "grbl's $11"},
    MachineField{"arc-tolerance", Quantity::kLength, &Machine::arc_tolerance, kPositive,
                 "arcs become chords this near to them: grbl's $12"},
    MachineField{"square-corner-velocity", Quantity::kVelocity, &Machine::square_corner_velocity,
                 kOrZero, "Klipper's speed at a right angle", true},
    MachineField{"minimum-cruise-ratio", Quantity::kShare, &Machine::minimum_cruise_ratio,
                 kBelowOne, "Klipper's, which keeps short moves from speeding up", true},
    MachineField{"arc-resolution", Quantity::kLength, &Machine::arc_resolution, kPositive,
                 "Klipper's chords of arcs: [gcode_arcs] resolution", true},
    MachineField{"blend-tolerance", Quantity::kLength, &Machine::blend_tolerance, kOrZero,
                 "LinuxCNC's G64 P when the program sets none; 0: no P"},
    MachineField{"naive-cam-tolerance", Quantity::kLength, &Machine::naive_cam_tolerance, kOrZero,
                 "LinuxCNC's G64 Q when the program sets none; 0: no lines are joined"},
    MachineField{"tool-change-time", Quantity::kTime, &Machine::tool_change_time, kOrZero,
                 "for each tool change"},
    MachineField{"spindle-start-time", Quantity::kTime, &Machine::spindle_start_time, kOrZero,
                 "until a spindle that was started or turned round is up"},
    MachineField{"extra-dwell-time", Quantity::kTime, &Machine::extra_dwell_time, kOrZero,
                 "that each dwell takes beyond what it says"},
};

constexpr std::array kAxisFields = {
    AxisField{"velocity", "max-velocity", Quantity::kVelocity, Quantity::kAngularVelocity,
              &AxisLimits::velocity, kPositive, "while cutting"},
    AxisField{"acceleration", "max-acceleration", Quantity::kAcceleration,
              Quantity::kAngularAcceleration, &AxisLimits::acceleration, kPositive, "always"},
    AxisField{"jerk", "max-jerk", Quantity::kJerk, Quantity::kAngularJerk, &AxisLimits::jerk,
              kOrInfinite, "inf: no limit"},
    AxisField{"rapid-velocity", "rapid-velocity", Quantity::kVelocity, Quantity::kAngularVelocity,
              &AxisLimits::rapid_velocity, kPositive, "in a rapid move"},
    AxisField{"steps", "steps-per-mm", Quantity::kStepRate, Quantity::kAngularStepRate,
              &AxisLimits::steps, kOrInfinite,
              "moves end on whole ones: grbl's $100; inf: anywhere", true},
    AxisField{"velocity-step", "velocity-step", Quantity::kVelocity, Quantity::kAngularVelocity,
              &AxisLimits::velocity_step, kOrInfinite,
              "that an axis may take at a joint: Marlin's jerk; inf: by junction-deviation", true},
};

bool is_within(double value, Allowed allowed) {
  if (std::isinf(value)) return allowed.infinite && value > 0;
  if (!allowed.one_and_more && value >= 1) return false;
  return value > 0 || (value == 0 && allowed.zero);
}

std::string words_of(Allowed allowed, Quantity quantity) {
  return fmt::format("{}{}{} ({})", allowed.zero ? "0 or more" : "above 0",
                     allowed.infinite ? ", or inf" : "", allowed.one_and_more ? "" : ", below 1",
                     units_of(quantity).front().name);
}

// `key`: a call that makes it. Machines are asked for each time they are used, and hardly ever have
// a problem.
template <typename Key>
void check(double value, Allowed allowed, Quantity quantity, const Key& key,
           std::vector<MachineProblem>& problems) {
  if (is_within(value, allowed)) return;
  problems.push_back({key(), value, words_of(allowed, quantity)});
}

}  // namespace

// In the order of Quantity.
std::span<const Unit> units_of(Quantity quantity) {
  static constexpr std::array<std::span<const Unit>, 13> kUnits = {kLengths,
                                                                   kVelocities,
                                                                   kAccelerations,
                                                                   kJerks,
                                                                   kAngularVelocities,
                                                                   kAngularAccelerations,
                                                                   kAngularJerks,
                                                                   kTimes,
                                                                   kBlockRates,
                                                                   kByteRates,
                                                                   kShares,
                                                                   kStepRates,
                                                                   kAngularStepRates};
  return kUnits[static_cast<std::size_t>(quantity)];
}

std::optional<double> read_quantity(std::string_view text, Quantity quantity) {
  double value = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (error != std::errc{} || !std::isfinite(value)) return std::nullopt;
  std::string_view name = text.substr(static_cast<std::size_t>(end - text.data()));
  while (name.starts_with(' ')) name.remove_prefix(1);
  const auto units = units_of(quantity);
  const auto unit = std::ranges::find(units, name, &Unit::name);
  if (unit == units.end()) return std::nullopt;
  return value * unit->factor;
}

std::span<const MachineField> machine_fields() { return kMachineFields; }
std::span<const AxisField> axis_fields() { return kAxisFields; }

std::string axis_key(Axis axis, const AxisField& field) {
  return fmt::format("axis.{}.{}", name_of(axis), field.key);
}

std::vector<MachineProblem> problems_of(const Machine& machine) {
  std::vector<MachineProblem> problems;
  for (const MachineField& field : machine_fields()) {
    // A corner within 0 would stop grbl at every joint; its model needs something to go by.
    const bool by_deviation = is_grbl(machine.model) || machine.model == ControllerModel::kMarlin;
    const bool stops = by_deviation && field.place == &Machine::junction_deviation;
    Allowed allowed = field.allowed;
    allowed.zero = allowed.zero && !stops;
    check(
        machine.*field.place, allowed, field.quantity, [&] { return std::string(field.key); },
        problems);
  }
  for (std::size_t i = 0; i < kAxes; ++i) {
    const auto axis = static_cast<Axis>(i);
    for (const AxisField& field : axis_fields()) {
      check(
          machine.axis(axis).*field.place, field.allowed,
          i < kLinearAxes ? field.linear : field.rotary, [&] { return axis_key(axis, field); },
          problems);
    }
  }
  if (machine.look_ahead < 1) {
    problems.push_back({std::string(kLookAheadKey), static_cast<double>(machine.look_ahead),
                        "1 or more (blocks)"});
  }
  return problems;
}

std::string ValueOrigins::sentence(const MachineProblem& problem) const {
  const auto found = places_.find(problem.key);
  if (found == places_.end()) {
    return fmt::format("{}: {}: {:g}, expected {}", file_, problem.key, problem.value,
                       problem.expected);
  }
  const ValueOrigin& origin = found->second;
  const std::string column = origin.column > 0 ? fmt::format(":{}", origin.column) : "";
  return fmt::format("{}:{}{}: {}: {:g}, expected {}", origin.file.empty() ? file_ : origin.file,
                     origin.line, column, origin.name, problem.value, problem.expected);
}

void ValueOrigins::add_problems_of(const Machine& machine,
                                   std::vector<std::string>& problems) const {
  for (const MachineProblem& problem : problems_of(machine)) {
    std::string text = sentence(problem);
    if (std::ranges::find(problems, text) == problems.end()) problems.push_back(std::move(text));
  }
}

}  // namespace batten::postproc
