#include "postproc/machine_file.h"

#include <fmt/format.h>
#include <toml++/toml.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <filesystem>
#include <string_view>

namespace batten::postproc {

namespace {

struct Quantity {
  std::string_view key;
  std::string_view unit;
  double Machine::*place;
  bool may_be_zero;
};

constexpr std::array kQuantities = {
    Quantity{"max-velocity", "mm/s", &Machine::max_velocity, false},
    Quantity{"max-acceleration", "mm/s2", &Machine::max_acceleration, false},
    Quantity{"rapid-velocity", "mm/s", &Machine::rapid_velocity, false},
    Quantity{"block-period", "s", &Machine::block_period, true},
    Quantity{"junction-deviation", "mm", &Machine::junction_deviation, true},
    Quantity{"arc-tolerance", "mm", &Machine::arc_tolerance, false},
    Quantity{"blend-tolerance", "mm", &Machine::blend_tolerance, true},
    Quantity{"naive-cam-tolerance", "mm", &Machine::naive_cam_tolerance, true},
};

class MachineReader {
 public:
  MachineReader(const std::string& file, std::vector<std::string>& problems)
      : file_(file), problems_(problems) {}

  Machine read(const toml::table& table) {
    Machine machine = base_of(table);
    machine.name = std::filesystem::path(file_).stem().string();
    machine.description = "from " + file_;
    for (const auto& [key, node] : table) read_entry(key.str(), node, machine);
    return machine;
  }

 private:
  void complain(const toml::node& node, std::string_view key, std::string_view expected) {
    problems_.push_back(
        fmt::format("{}:{}: {}: expected {}", file_, node.source().begin.line, key, expected));
  }

  Machine base_of(const toml::table& table) {
    const auto name = table["based-on"].value<std::string>();
    const Machine* base = name ? find_machine(*name) : nullptr;
    if (base != nullptr) return *base;
    std::string names;
    for (const Machine& machine : built_in_machines()) {
      names += (names.empty() ? "" : ", ") + machine.name;
    }
    problems_.push_back(fmt::format(
        "{}: based-on: {}; possible: {}", file_,
        name ? fmt::format("there is no machine '{}'", *name) : "no machine given", names));
    return {};
  }

  void read_entry(std::string_view key, const toml::node& node, Machine& machine) {
    if (key == "based-on") return;
    if (key == "name" || key == "description") {
      std::string& place = key == "name" ? machine.name : machine.description;
      if (const auto text = node.value<std::string>()) {
        place = *text;
      } else {
        complain(node, key, "a text");
      }
      return;
    }
    if (key == "look-ahead") {
      const auto blocks = node.value<int>();
      if (blocks && *blocks > 0) {
        machine.look_ahead = *blocks;
      } else {
        complain(node, key, "a number of blocks above 0");
      }
      return;
    }
    read_quantity(key, node, machine);
  }

  void read_quantity(std::string_view key, const toml::node& node, Machine& machine) {
    const auto quantity = std::ranges::find(kQuantities, key, &Quantity::key);
    if (quantity == kQuantities.end()) {
      std::string keys = "based-on, name, description, look-ahead";
      for (const Quantity& known : kQuantities) keys += ", " + std::string(known.key);
      complain(node, key, "one of " + keys);
      return;
    }
    const auto value = node.value<double>();
    if (value && std::isfinite(*value) && (*value > 0 || (*value == 0 && quantity->may_be_zero))) {
      machine.*quantity->place = *value;
    } else {
      complain(node, key,
               fmt::format("a number {} ({})", quantity->may_be_zero ? "of 0 or more" : "above 0",
                           quantity->unit));
    }
  }

  const std::string& file_;
  std::vector<std::string>& problems_;
};

}  // namespace

std::shared_ptr<const Machine> read_machine_file(const std::string& file,
                                                 std::vector<std::string>& problems) {
  const std::size_t problems_before = problems.size();
  try {
    const toml::table table = toml::parse_file(file);
    Machine machine = MachineReader(file, problems).read(table);
    if (problems.size() == problems_before) return std::make_shared<Machine>(std::move(machine));
  } catch (const toml::parse_error& error) {
    problems.push_back(
        fmt::format("{}:{}: {}", file, error.source().begin.line, error.description()));
  }
  return nullptr;
}

}  // namespace batten::postproc
