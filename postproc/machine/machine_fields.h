// The quantities of a machine as tables: its file, its listing and its checks all go by them. A
// quantity to add: a member of Machine or AxisLimits, a row here.
#pragma once

#include <array>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "postproc/machine/machine.h"

namespace batten::postproc {

inline constexpr std::array kControllerModels = {ControllerModel::kLinuxcnc, ControllerModel::kGrbl,
                                                 ControllerModel::kLookAhead};
inline constexpr std::array kPathModes = {gcode::PathMode::kBlending, gcode::PathMode::kExactPath,
                                          gcode::PathMode::kExactStop};

enum class Quantity {
  kLength,
  kVelocity,
  kAcceleration,
  kJerk,
  kAngularVelocity,
  kAngularAcceleration,
  kAngularJerk,
  kTime,
  kBlockRate,
  kByteRate,
};

// A unit in which a quantity may be given, and how many of our own it is.
struct Unit {
  std::string_view name;
  double factor;
};

// Ours first, which is the one a plain number is in: mm, s, degrees, bytes/s.
[[nodiscard]] std::span<const Unit> units_of(Quantity quantity);

// "5000 mm/min" as mm/s; nothing when it is no number with a unit of the quantity.
[[nodiscard]] std::optional<double> read_quantity(std::string_view text, Quantity quantity);

struct MachineField {
  std::string_view key;  // in a machine file
  Quantity quantity;
  double Machine::*place;
  std::string_view text;  // what it is, for people
  bool may_be_zero = false;
  bool may_be_infinite = false;
};

struct AxisField {
  std::string_view key;         // in the table of an axis
  std::string_view key_of_xyz;  // for X, Y and Z at once, outside of such a table
  Quantity linear;
  Quantity rotary;
  double AxisLimits::*place;
  std::string_view text;
  bool may_be_infinite = false;
};

[[nodiscard]] std::span<const MachineField> machine_fields();
[[nodiscard]] std::span<const AxisField> axis_fields();

inline constexpr std::string_view kLookAheadKey = "look-ahead";
[[nodiscard]] std::string axis_key(Axis axis, const AxisField& field);  // "axis.x.velocity"

// A value with which no model can work.
struct MachineProblem {
  std::string key;  // as in a machine file, with its tables: "axis.x.velocity"
  double value = 0;
  std::string expected;
};

// Everything that is wrong with the machine; empty when its times can be computed.
[[nodiscard]] std::vector<MachineProblem> problems_of(const Machine& machine);

}  // namespace batten::postproc
