#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <nlohmann/json.hpp>

#include "postproc/commands/commands.h"
#include "postproc/commands/files.h"
#include "postproc/machine/files/machine_file.h"
#include "postproc/machine/machine_fields.h"
#include "postproc/system/exit_code.h"
#include "postproc/text/json_values.h"

namespace batten::postproc {

namespace {

// "-" without a limit.
std::string short_number(double value) {
  return std::isinf(value) ? "-" : fmt::format("{:.4g}", value);
}

// One number where X, Y and Z agree, else three.
std::string xyz(const Machine& machine, double AxisLimits::*limit, double unit = 1) {
  const auto of = [&](Axis axis) { return short_number(machine.axis(axis).*limit / unit); };
  const std::string x = of(Axis::kX);
  const std::string y = of(Axis::kY);
  const std::string z = of(Axis::kZ);
  return x == y && y == z ? x : fmt::format("{}/{}/{}", x, y, z);
}

std::string table_line(std::string_view name, std::string_view model, std::string_view velocity,
                       std::string_view rapid, std::string_view acceleration, std::string_view jerk,
                       std::string_view blocks, std::string_view ahead, std::string_view bytes,
                       std::string_view description) {
  return fmt::format("{:<12} {:<11} {:>7} {:>7} {:>7} {:>7} {:>9} {:>6} {:>8}  {}\n", name, model,
                     velocity, rapid, acceleration, jerk, blocks, ahead, bytes, description);
}

std::string line_of(const Machine& m) {
  constexpr double kMetre = 1000;  // mm
  return table_line(m.name, name_of(m.model), xyz(m, &AxisLimits::velocity),
                    xyz(m, &AxisLimits::rapid_velocity), xyz(m, &AxisLimits::acceleration),
                    xyz(m, &AxisLimits::jerk, kMetre), fmt::format("{:.0f}", 1 / m.block_period),
                    fmt::format("{}", m.look_ahead), short_number(m.stream_rate), m.description);
}

std::string table_of(std::span<const Machine> machines) {
  std::string text =
      table_line("", "", "cutting", "rapid", "accel.", "jerk", "", "ahead", "stream", "") +
      table_line("machine", "control", "mm/s", "mm/s", "mm/s2", "m/s3", "blocks/s", "blocks",
                 "bytes/s", "");
  for (const Machine& machine : machines) text += line_of(machine);
  return text;
}

// --- JSON --------------------------------------------------------------------------------------

// By Quantity.
constexpr std::array<std::string_view, 10> kSuffixes = {
    "_mm",         "_mm_per_s",   "_mm_per_s2", "_mm_per_s3",    "_deg_per_s",
    "_deg_per_s2", "_deg_per_s3", "_s",         "_blocks_per_s", "_bytes_per_s"};

// "block-period" and seconds: "block_period_s".
std::string json_key(std::string_view key, Quantity quantity) {
  std::string name(key);
  std::ranges::replace(name, '-', '_');
  return name.append(kSuffixes.at(static_cast<std::size_t>(quantity)));
}

Json number_or_null(double value) { return std::isinf(value) ? Json(nullptr) : Json(value); }

Json json_of(const Machine& machine) {
  Json json = {{"name", machine.name},
               {"description", machine.description},
               {"model", name_of(machine.model)},
               {"path_mode", name_of(machine.path_mode)},
               {"max_velocity_mm_per_s", machine.max_velocity()},
               {"max_acceleration_mm_per_s2", machine.max_acceleration()},
               {"rapid_velocity_mm_per_s", machine.rapid_velocity()},
               {"look_ahead_blocks", machine.look_ahead}};
  for (const MachineField& field : machine_fields()) {
    json[json_key(field.key, field.quantity)] = number_or_null(machine.*field.place);
  }
  Json axes;
  for (std::size_t i = 0; i < kAxes; ++i) {
    const auto axis = static_cast<Axis>(i);
    Json limits;
    for (const AxisField& field : axis_fields()) {
      limits[json_key(field.key, i < kLinearAxes ? field.linear : field.rotary)] =
          number_or_null(machine.axis(axis).*field.place);
    }
    axes[std::string(name_of(axis))] = std::move(limits);
  }
  json["axes"] = std::move(axes);
  return json;
}

Json json_of(std::span<const Machine> machines) {
  Json list = Json::array();
  for (const Machine& machine : machines) list.push_back(json_of(machine));
  return list;
}

}  // namespace

int run(const MachinesCommand& command) {
  const bool one = command.shown != nullptr;
  if (command.json_file != "-") {
    const std::string text =
        one ? machine_file_text(*command.shown) : table_of(built_in_machines());
    if (const int code = write_result("-", text, false); code != 0) return code;
  }
  if (command.json_file.empty()) return static_cast<int>(ExitCode::kDone);
  const Json json = one ? json_of(*command.shown) : json_of(built_in_machines());
  return write_result(command.json_file, json_text(json), command.force);
}

}  // namespace batten::postproc
