// The quantities of a machine as tables: its file, its listing and its checks all go by them. A
// quantity to add: a member of Machine or AxisLimits, a row here.
#pragma once

#include <array>
#include <cstddef>
#include <map>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "postproc/machine/machine.h"

namespace batten::postproc {

inline constexpr std::array kControllerModels = {
    ControllerModel::kLinuxcnc, ControllerModel::kGrbl,   ControllerModel::kGrblhal,
    ControllerModel::kKlipper,  ControllerModel::kMarlin, ControllerModel::kLookAhead};
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
  kShare,
  kStepRate,
  kAngularStepRate,
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

// Above 0, and what else a value may be.
struct Allowed {
  bool zero = false;
  bool infinite = false;
  bool one_and_more = true;
};

struct MachineField {
  std::string_view key;  // in a machine file
  Quantity quantity;
  double Machine::*place;
  Allowed allowed;
  std::string_view text;        // what it is, for people
  bool may_be_missing = false;  // in a file that is based on no machine
};

struct AxisField {
  std::string_view key;         // in the table of an axis
  std::string_view key_of_xyz;  // for X, Y and Z at once, outside of such a table
  Quantity linear;
  Quantity rotary;
  double AxisLimits::*place;
  Allowed allowed;
  std::string_view text;
  bool may_be_missing = false;  // in a file that is based on no machine
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

// Where the values of a machine stand in the file that it was read from, so that what is wrong with
// it can be said in the words of that file.

struct ValueOrigin {
  std::string name;        // as the file calls it: "max-velocity", "$110", "[AXIS_X]MAX_VELOCITY"
  std::size_t line = 0;    // from 1
  std::size_t column = 0;  // from 1; 0: not known
  std::string file = {};   // another one than the first, which includes it; else empty
};

class ValueOrigins {
 public:
  explicit ValueOrigins(std::string file) : file_(std::move(file)) {}

  // `key`: as in MachineProblem. A later origin replaces an earlier one.
  void add(const std::string& key, ValueOrigin origin) { places_[key] = std::move(origin); }

  // A sentence for each problem of the machine, one for those that come from the same place:
  // "router.toml:3:16: max-velocity: -200, expected above 0 (mm/s)".
  void add_problems_of(const Machine& machine, std::vector<std::string>& problems) const;

 private:
  [[nodiscard]] std::string sentence(const MachineProblem& problem) const;

  std::string file_;
  std::map<std::string, ValueOrigin> places_;
};

}  // namespace batten::postproc
