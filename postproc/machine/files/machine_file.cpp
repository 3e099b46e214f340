#include "postproc/machine/files/machine_file.h"

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <toml++/toml.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
#include <set>
#include <sstream>
#include <string_view>
#include <system_error>

#include "gcode/text/characters.h"
#include "postproc/machine/machine_fields.h"
#include "postproc/text/words.h"

namespace batten::postproc {

namespace {

namespace fs = std::filesystem;

constexpr std::string_view kBasedOn = "based-on";
constexpr std::string_view kName = "name";
constexpr std::string_view kDescription = "description";
constexpr std::string_view kSource = "source";
constexpr std::string_view kModel = "model";
constexpr std::string_view kPathMode = "path-mode";
constexpr std::string_view kBlockRate = "block-rate";
constexpr std::string_view kBlockPeriod = "block-period";
constexpr std::string_view kAxis = "axis";

// Keys outside of the tables of axes.
std::vector<std::string_view> possible_keys() {
  std::vector<std::string_view> keys = {kBasedOn,  kName,         kDescription, kSource, kModel,
                                        kPathMode, kLookAheadKey, kBlockRate,   kAxis};
  for (const MachineField& field : machine_fields()) keys.push_back(field.key);
  for (const AxisField& field : axis_fields()) keys.push_back(field.key_of_xyz);
  return keys;
}

std::vector<std::string_view> axis_names() {
  std::vector<std::string_view> names;
  for (std::size_t i = 0; i < kAxes; ++i) names.push_back(name_of(static_cast<Axis>(i)));
  return names;
}

std::string list_of(const std::vector<std::string_view>& names) {
  return fmt::format("{}", fmt::join(names, ", "));
}

std::string list_of_units(Quantity quantity) {
  std::vector<std::string_view> names;
  for (const Unit& unit : units_of(quantity)) {
    // Names such as mm/s^2 are other spellings.
    if (unit.name.find('^') == std::string_view::npos) names.push_back(unit.name);
  }
  return list_of(names);
}

// The value as it is in the file.
std::string text_of(const toml::node& node) {
  if (node.is_table()) return "a table";
  if (node.is_array()) return "a list";
  if (const auto* text = node.as_string()) return toml_quoted(text->get());
  std::ostringstream stream;
  stream << toml::node_view<const toml::node>(node);
  return stream.str();
}

std::optional<double> number_of(const toml::node& node) {
  return node.is_number() ? node.value<double>() : std::nullopt;
}

// One spelling for each file.
fs::path whole_path(const fs::path& file) {
  std::error_code error;
  fs::path whole = fs::weakly_canonical(file, error);
  return error ? file : whole;
}

class MachineReader {
 public:
  MachineReader(const std::string& file, const std::vector<fs::path>& being_read,
                std::vector<std::string>& problems)
      : file_(file), being_read_(being_read), problems_(problems), origins_(file) {}

  Machine read(const toml::table& table) {
    machine_ = base_of(table);
    machine_.name = fs::path(file_).stem().string();
    machine_.description = "from " + file_;
    machine_.source = file_;
    read_xyz(table);
    for (const auto& [key, node] : table) read_entry(key, node);
    if (!table.contains(kBasedOn)) require_everything();
    origins_.add_problems_of(machine_, problems_);
    return machine_;
  }

 private:
  void complain(const toml::source_position& at, std::string_view key, const std::string& what) {
    problems_.push_back(fmt::format("{}:{}:{}: {}: {}", file_, at.line, at.column, key, what));
  }

  void complain(const toml::node& node, std::string_view key, const std::string& expected) {
    complain(node.source().begin, key, fmt::format("{}, expected {}", text_of(node), expected));
  }

  void found(const std::string& key, std::string_view name, const toml::node& node) {
    const toml::source_position at = node.source().begin;
    origins_.add(key, {std::string(name), at.line, at.column});
    said_.insert(key);
  }

  Machine base_of(const toml::table& table) {
    const toml::node* node = table.get(kBasedOn);
    if (node == nullptr) return {};
    const auto choice = node->value<std::string>();
    if (!choice || !node->is_string()) {
      complain(*node, kBasedOn, "the name of a machine; possible: " + possible_machines());
      return {};
    }
    const std::string asked_by = fmt::format("{}:{}:{}: {}", file_, node->source().begin.line,
                                             node->source().begin.column, kBasedOn);
    const auto base = based_on(*choice, asked_by);
    return base == nullptr ? Machine() : *base;
  }

  std::shared_ptr<const Machine> based_on(const std::string& choice, const std::string& asked_by) {
    if (!fs::path(choice).has_extension()) return choose_machine(choice, asked_by, problems_);
    // A file is beside the one that is based on it.
    const fs::path base = (fs::path(file_).parent_path() / choice).lexically_normal();
    std::vector<fs::path> being_read = being_read_;
    being_read.push_back(whole_path(file_));
    if (std::ranges::find(being_read, whole_path(base)) == being_read.end()) {
      return choose_machine(base.string(), asked_by, problems_, being_read);
    }
    problems_.push_back(fmt::format("{}: {} is based on itself", asked_by, choice));
    return nullptr;
  }

  void read_entry(const toml::key& key, const toml::node& node) {
    const std::string_view name = key.str();
    const auto fields = machine_fields();
    const auto field = std::ranges::find(fields, name, &MachineField::key);
    if (field != fields.end()) {
      read_into(machine_.*field->place, field->quantity, name, node);
      found(std::string(name), name, node);
    } else if (name == kName) {
      read_text(machine_.name, name, node);
    } else if (name == kDescription || name == kSource) {
      read_text(name == kSource ? machine_.source : machine_.description, name, node);
    } else if (name == kModel) {
      read_choice_into(machine_.model, kControllerModels, name, node);
    } else if (name == kPathMode) {
      read_choice_into(machine_.path_mode, kPathModes, name, node);
    } else if (name == kLookAheadKey) {
      read_look_ahead(node);
    } else if (name == kBlockRate) {
      read_block_rate(key, node);
    } else if (name == kAxis) {
      read_axes(node);
    } else if (name != kBasedOn && !is_of_xyz(name)) {
      complain_of_unknown(key, name, possible_keys());
    }
  }

  static bool is_of_xyz(std::string_view name) {
    const auto fields = axis_fields();
    return std::ranges::find(fields, name, &AxisField::key_of_xyz) != fields.end();
  }

  void complain_of_unknown(const toml::key& key, std::string_view name,
                           const std::vector<std::string_view>& names) {
    const std::string meant = suggestion(key.str(), names);
    complain(key.source().begin, name,
             "there is no such key" + (meant.empty() ? "; possible: " + list_of(names) : meant));
  }

  void read_text(std::string& place, std::string_view key, const toml::node& node) {
    said_.insert(std::string(key));
    if (const auto* text = node.as_string()) {
      place = text->get();
    } else {
      complain(node, key, "a text in quotes");
    }
  }

  template <typename Value, std::size_t count>
  void read_choice_into(Value& place, const std::array<Value, count>& choices, std::string_view key,
                        const toml::node& node) {
    said_.insert(std::string(key));
    std::vector<std::string_view> names;
    for (const Value choice : choices) {
      names.push_back(name_of(choice));
      if (node.is_string() && node.as_string()->get() == names.back()) {
        place = choice;
        return;
      }
    }
    complain(node, key, "one of " + list_of(names));
  }

  void read_look_ahead(const toml::node& node) {
    found(std::string(kLookAheadKey), kLookAheadKey, node);
    const auto blocks = node.is_integer() ? node.value<int>() : std::nullopt;
    if (blocks) {
      machine_.look_ahead = *blocks;
    } else {
      complain(node, kLookAheadKey, "a whole number above 0 (blocks)");
    }
  }

  void read_block_rate(const toml::key& key, const toml::node& node) {
    if (said_.contains(std::string(kBlockPeriod))) {
      complain(key.source().begin, kBlockRate, "block-period says the same in another way");
      return;
    }
    found(std::string(kBlockPeriod), kBlockRate, node);
    double rate = 1;
    if (!read_into(rate, Quantity::kBlockRate, kBlockRate, node)) return;
    if (rate > 0 && std::isfinite(rate)) {
      machine_.block_period = 1 / rate;
    } else {
      complain(node, kBlockRate, "above 0 (blocks/s)");
    }
  }

  // Before the tables of single axes, which may say otherwise.
  void read_xyz(const toml::table& table) {
    for (const AxisField& field : axis_fields()) {
      const toml::node* node = table.get(field.key_of_xyz);
      double value = 0;
      if (node == nullptr || !read_into(value, field.linear, field.key_of_xyz, *node)) continue;
      for (const Axis axis : {Axis::kX, Axis::kY, Axis::kZ}) {
        machine_.axis(axis).*field.place = value;
        found(axis_key(axis, field), field.key_of_xyz, *node);
      }
    }
  }

  void read_axes(const toml::node& node) {
    const toml::table* axes = node.as_table();
    if (axes == nullptr) {
      complain(node, kAxis, "tables such as [axis.x]");
      return;
    }
    const auto names = axis_names();
    for (const auto& [key, limits] : *axes) {
      const auto name = std::ranges::find(names, key.str());
      const std::string full_name = fmt::format("axis.{}", key.str());
      if (name == names.end()) {
        complain(key.source().begin, full_name,
                 "there is no such axis; possible: " + list_of(names));
      } else if (const toml::table* values = limits.as_table()) {
        read_axis(static_cast<Axis>(name - names.begin()), *values);
      } else {
        complain(limits, full_name, fmt::format("a table [{}]", full_name));
      }
    }
  }

  void read_axis(Axis axis, const toml::table& values) {
    const bool linear = static_cast<std::size_t>(axis) < kLinearAxes;
    const auto fields = axis_fields();
    for (const auto& [key, node] : values) {
      const auto field = std::ranges::find(fields, key.str(), &AxisField::key);
      if (field == fields.end()) {
        std::vector<std::string_view> names;
        for (const AxisField& possible : fields) names.push_back(possible.key);
        complain_of_unknown(key, fmt::format("axis.{}.{}", name_of(axis), key.str()), names);
        continue;
      }
      const std::string name = axis_key(axis, *field);
      read_into(machine_.axis(axis).*field->place, linear ? field->linear : field->rotary, name,
                node);
      found(name, name, node);
    }
  }

  // A number in our unit, or a text with one of the units.
  bool read_into(double& place, Quantity quantity, std::string_view key, const toml::node& node) {
    std::optional<double> value = number_of(node);
    if (const auto* text = node.as_string()) value = read_quantity(text->get(), quantity);
    if (value) {
      place = *value;
    } else {
      complain(node, key,
               fmt::format("a number ({}), or one with its unit as text: {}",
                           units_of(quantity).front().name, list_of_units(quantity)));
    }
    return value.has_value();
  }

  void require_everything() {
    std::vector<std::string> needed = {std::string(kModel), std::string(kPathMode),
                                       std::string(kLookAheadKey)};
    for (const MachineField& field : machine_fields()) {
      if (!field.may_be_missing) needed.emplace_back(field.key);
    }
    for (std::size_t i = 0; i < kAxes; ++i) {
      for (const AxisField& field : axis_fields()) {
        if (!field.may_be_missing) needed.push_back(axis_key(static_cast<Axis>(i), field));
      }
    }
    std::erase_if(needed, [this](const std::string& key) { return said_.contains(key); });
    if (needed.empty()) return;
    problems_.push_back(
        fmt::format("{}: no based-on in it, and without one these are missing: {}; machines to be "
                    "based on: {}",
                    file_, fmt::join(needed, ", "), possible_machines()));
  }

  const std::string& file_;
  const std::vector<fs::path>& being_read_;
  std::vector<std::string>& problems_;
  ValueOrigins origins_;
  std::set<std::string> said_;
  Machine machine_;
};

std::vector<std::string_view> built_in_names() {
  std::vector<std::string_view> names;
  for (const Machine& machine : built_in_machines()) names.emplace_back(machine.name);
  return names;
}

// Built-in machines live as long as the program.
std::shared_ptr<const Machine> shared_built_in(const Machine& machine) {
  return {std::shared_ptr<const Machine>(), &machine};
}

bool has_suffix(const std::string& file, std::string_view in_capitals) {
  return gcode::is_same_word(fs::path(file).extension().string(), in_capitals);
}

}  // namespace

std::shared_ptr<const Machine> read_machine_file(const std::string& file,
                                                 std::vector<std::string>& problems,
                                                 const std::vector<fs::path>& being_read) {
  const std::size_t problems_before = problems.size();
  try {
    const toml::table table = toml::parse_file(file);
    Machine machine = MachineReader(file, being_read, problems).read(table);
    if (problems.size() == problems_before) return std::make_shared<Machine>(std::move(machine));
  } catch (const toml::parse_error& error) {
    const toml::source_position at = error.source().begin;
    problems.push_back(
        at.line > 0 ? fmt::format("{}:{}:{}: {}", file, at.line, at.column, error.description())
                    : fmt::format("{}: {}", file, error.description()));
  }
  return nullptr;
}

std::string possible_machines() {
  return list_of(built_in_names()) +
         ", a file NAME.toml, the NAME.ini of a LinuxCNC machine, the NAME.cfg of one with "
         "Klipper, "
         "the NAME.yaml of one with FluidNC, the config.g of one with RepRapFirmware, or a "
         "NAME.txt "
         "with what Marlin answers to M503";
}

std::shared_ptr<const Machine> choose_machine(
    const std::string& choice, const std::string& asked_by, std::vector<std::string>& problems,
    const std::vector<std::filesystem::path>& being_read) {
  if (const Machine* machine = find_machine(choice)) return shared_built_in(*machine);
  if (has_suffix(choice, ".TOML")) return read_machine_file(choice, problems, being_read);
  struct Reader {
    std::string_view suffix;
    std::shared_ptr<const Machine> (*read)(const std::string&, std::vector<std::string>&);
  };
  constexpr std::array<Reader, 6> kReaders = {{{".CFG", read_printer_cfg},
                                               {".INI", read_machine_ini},
                                               {".YAML", read_fluidnc_yaml},
                                               {".YML", read_fluidnc_yaml},
                                               {".G", read_reprap_config},
                                               {".TXT", read_marlin_settings}}};
  for (const Reader& reader : kReaders) {
    if (has_suffix(choice, reader.suffix)) return reader.read(choice, problems);
  }
  problems.push_back(fmt::format("{}: there is no machine '{}'{}; possible: {}", asked_by, choice,
                                 suggestion(choice, built_in_names()), possible_machines()));
  return nullptr;
}

namespace {

// The number is the shortest that is read as the same value.
std::string line_of(std::string_view key, double value, std::string_view unit,
                    std::string_view text) {
  return fmt::format("{} = {}  # {}, {}\n", key, value, unit, text);
}

}  // namespace

std::string machine_file_text(const Machine& machine) {
  std::string text =
      "# A machine for --machine FILE.toml; docs/machine_file.md describes the keys. A value in\n"
      "# another unit is a text: \"5000 mm/min\". With based-on = \"NAME\" only what differs is "
      "needed.\n";
  text += fmt::format("name = {}\n", toml_quoted(machine.name));
  text += fmt::format("description = {}\n", toml_quoted(machine.description));
  text += fmt::format("source = {}  # where the numbers come from\n", toml_quoted(machine.source));
  text += fmt::format("model = \"{}\"  # linuxcnc, grbl, grblhal, klipper, marlin or look-ahead\n",
                      name_of(machine.model));
  text += fmt::format(
      "path-mode = \"{}\"  # until the program says: blend (G64), exact-path (G61) or exact-stop\n",
      name_of(machine.path_mode));
  text += fmt::format("look-ahead = {}  # blocks\n", machine.look_ahead);
  for (const MachineField& field : machine_fields()) {
    text +=
        line_of(field.key, machine.*field.place, units_of(field.quantity).front().name, field.text);
  }
  for (std::size_t i = 0; i < kAxes; ++i) {
    const auto axis = static_cast<Axis>(i);
    text += fmt::format("\n[axis.{}]\n", name_of(axis));
    for (const AxisField& field : axis_fields()) {
      const Quantity quantity = i < kLinearAxes ? field.linear : field.rotary;
      text += line_of(field.key, machine.axis(axis).*field.place, units_of(quantity).front().name,
                      field.text);
    }
  }
  return text;
}

}  // namespace batten::postproc
