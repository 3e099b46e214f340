#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <nlohmann/json.hpp>
#include <utility>

#include "gcode/control/control.h"
#include "gcode/controls/built_in.h"
#include "postproc/commands/commands.h"
#include "postproc/commands/files.h"
#include "postproc/machine/files/machine_file.h"
#include "postproc/machine/machine_fields.h"
#include "postproc/profile/target_profile.h"
#include "postproc/system/exit_code.h"
#include "postproc/text/json_values.h"

namespace batten::postproc {

namespace {

struct Listing {
  std::string text;
  std::string_view kind;  // of the report, and the name of what it holds
  Json json = Json::array();
};

std::string planes_of(const gcode::Control& target) {
  std::string planes;
  for (const auto& [plane, name] : {std::pair{gcode::Plane::kXY, "G17"},
                                    {gcode::Plane::kZX, "G18"},
                                    {gcode::Plane::kYZ, "G19"}}) {
    if (takes_arcs_in(target, plane)) planes += (planes.empty() ? "" : " ") + std::string(name);
  }
  return planes.empty() ? "none" : planes;
}

Listing list_targets() {
  Listing listing;
  listing.kind = "targets";
  listing.text = fmt::format("{:<15} {:>8} {:>8} {:>5}  {:<12} {:<8} {:<12} {}\n", "target",
                             "mm places", "inch pl.", "line", "arcs in", "helices", "machine", "");
  for (const gcode::Control& target : gcode::controls()) {
    const int mm = place_format(target, gcode::Units::kMillimetre).decimals;
    const int inch = place_format(target, gcode::Units::kInch).decimals;
    listing.text += fmt::format("{:<15} {:>8} {:>8} {:>5}  {:<12} {:<8} {:<12} {}\n", target.name,
                                mm, inch, target.max_line_length, planes_of(target),
                                target.helices ? "yes" : "no", target.machine, target.description);
    listing.json.push_back({{"name", target.name},
                            {"description", target.description},
                            {"decimals_mm", mm},
                            {"decimals_inch", inch},
                            {"max_line_length", target.max_line_length},
                            {"arcs_in", planes_of(target)},
                            {"helices", target.helices},
                            {"default_machine", target.machine}});
  }
  return listing;
}

Listing list_methods() {
  Listing listing;
  listing.kind = "methods";
  for (const auto& method : methods()) {
    listing.text += fmt::format("{:<16} {}\n", method.name, method.text);
    listing.json.push_back({{"name", method.name}, {"description", method.text}});
  }
  return listing;
}

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

// Columns of the table: name, control, limits, blocks per second and ahead, bytes, description.
template <typename... Columns>
std::string table_line(const Columns&... columns) {
  return fmt::format("{:<13} {:<11} {:>8} {:>8} {:>7} {:>7} {:>9} {:>6} {:>8}  {}\n", columns...);
}

std::string table_of(std::span<const Machine> machines) {
  constexpr double kMetre = 1000;  // mm
  std::string text =
      table_line("", "", "cutting", "rapid", "accel.", "jerk", "", "ahead", "stream", "") +
      table_line("machine", "control", "mm/s", "mm/s", "mm/s2", "m/s3", "blocks/s", "blocks",
                 "bytes/s", "");
  for (const Machine& m : machines) {
    text += table_line(m.name, name_of(m.model), xyz(m, &AxisLimits::velocity),
                       xyz(m, &AxisLimits::rapid_velocity), xyz(m, &AxisLimits::acceleration),
                       xyz(m, &AxisLimits::jerk, kMetre), fmt::format("{:.0f}", 1 / m.block_period),
                       m.look_ahead, short_number(m.stream_rate), m.description);
  }
  text += "\nwhere the numbers come from\n";
  for (const Machine& m : machines) text += fmt::format("{:<13} {}\n", m.name, m.source);
  return text;
}

// --- JSON --------------------------------------------------------------------------------------

// By Quantity.
constexpr std::array<std::string_view, 13> kSuffixes = {
    "_mm",         "_mm_per_s", "_mm_per_s2",    "_mm_per_s3",   "_deg_per_s", "_deg_per_s2",
    "_deg_per_s3", "_s",        "_blocks_per_s", "_bytes_per_s", "",           "_per_mm",
    "_per_deg"};

// "block-period" and seconds: "block_period_s".
std::string json_key(std::string_view key, Quantity quantity) {
  std::string name(key);
  std::ranges::replace(name, '-', '_');
  return name.append(kSuffixes.at(static_cast<std::size_t>(quantity)));
}

// Without a limit: infinite, which JSON writes as null.
Json json_of(const Machine& machine) {
  Json json = {{"name", machine.name},
               {"description", machine.description},
               {"source", machine.source},
               {"model", name_of(machine.model)},
               {"path_mode", name_of(machine.path_mode)},
               {"max_velocity_mm_per_s", machine.max_velocity()},
               {"max_acceleration_mm_per_s2", machine.max_acceleration()},
               {"rapid_velocity_mm_per_s", machine.rapid_velocity()},
               {"look_ahead_blocks", machine.look_ahead}};
  for (const MachineField& field : machine_fields()) {
    json[json_key(field.key, field.quantity)] = machine.*field.place;
  }
  Json axes;
  for (std::size_t i = 0; i < kAxes; ++i) {
    const auto axis = static_cast<Axis>(i);
    Json limits;
    for (const AxisField& field : axis_fields()) {
      limits[json_key(field.key, i < kLinearAxes ? field.linear : field.rotary)] =
          machine.axis(axis).*field.place;
    }
    axes[std::string(name_of(axis))] = std::move(limits);
  }
  json["axes"] = std::move(axes);
  return json;
}

Listing listing_of(const ListCommand& command) {
  if (command.target != nullptr) {
    std::string profile = profile_text(*command.target);
    Json json = {{"name", command.target->name}, {"profile", profile}};
    return {std::move(profile), "target", std::move(json)};
  }
  if (command.machine != nullptr) {
    return {machine_file_text(*command.machine), "machine", json_of(*command.machine)};
  }
  if (command.what == BuiltIn::kTargets) return list_targets();
  if (command.what == BuiltIn::kMethods) return list_methods();
  const auto item = [](const Machine& machine) { return json_of(machine); };
  return {table_of(built_in_machines()), "machines", json_list(built_in_machines(), item)};
}

}  // namespace

int run(const ListCommand& command) {
  const Listing listing = listing_of(command);
  if (command.json_file != "-") {
    if (const int code = write_result("-", listing.text, false); code != 0) return code;
  }
  write_report(command.json_file, command.force, [&] {
    return json_text(as_report(listing.kind, {{listing.kind, listing.json}}));
  });
  return static_cast<int>(ExitCode::kDone);
}

}  // namespace batten::postproc
