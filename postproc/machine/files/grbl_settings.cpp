// The settings of a grbl control, as it prints them when asked for `$$`.
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <cstddef>
#include <filesystem>
#include <initializer_list>
#include <map>
#include <optional>
#include <string_view>

#include "gcode/reading/foreign_file.h"
#include "gcode/text/characters.h"
#include "gcode/text/source_text.h"
#include "postproc/machine/files/machine_file.h"
#include "postproc/machine/files/settings_file.h"
#include "postproc/machine/machine_fields.h"

namespace batten::postproc {
namespace {

using gcode::without_blanks_before;

constexpr int kJunctionDeviation = 11;
constexpr int kArcTolerance = 12;
constexpr int kSteps = 100;          // per mm of X, then of the other axes
constexpr int kMaxRate = 110;        // mm/min of X, then of the other axes
constexpr int kAcceleration = 120;   // mm/s^2
constexpr int kPlannerBlocks = 398;  // of grblHAL alone

constexpr double kMostPlannerBlocks = 1000;  // that grblHAL takes

struct Setting {
  double value = 0;
  std::size_t line = 0;
  std::size_t column = 0;
};

// What controls and senders write beside settings: "ok", "[MSG:..]", "<Idle|..>", ">>> $$", the
// greeting, comments; "$$" itself and settings with names, such as "$N0=".
bool is_passed_over(std::string_view line) {
  constexpr std::array<std::string_view, 4> kWords = {"ok", "Grbl", "GrblHAL", "grbl"};
  constexpr std::string_view kFirstLetters = "[<>;(#%";
  if (line.empty() || kFirstLetters.find(line.front()) != std::string_view::npos) return true;
  for (const std::string_view word : kWords) {
    if (line.starts_with(word)) return true;
  }
  return line.front() == '$' && (line.size() == 1 || line[1] < '0' || line[1] > '9');
}

class DumpReader {
 public:
  DumpReader(const std::string& file, std::vector<std::string>& problems)
      : file_(file), problems_(problems) {}

  void read(std::string_view dump) {
    if (dump.starts_with(gcode::kByteOrderMark)) dump.remove_prefix(gcode::kByteOrderMark.size());
    for_each_line(dump,
                  [this](std::string_view line, std::size_t number) { read_line(line, number); });
  }

  // Nothing when the setting is not in the dump.
  [[nodiscard]] const Setting* find(int number) const {
    const auto found = settings_.find(number);
    return found == settings_.end() ? nullptr : &found->second;
  }

 private:
  void read_line(std::string_view line, std::size_t number) {
    const std::string_view text = without_blanks_before(line);
    if (is_passed_over(text)) return;
    const auto column = static_cast<std::size_t>(text.data() - line.data()) + 1;
    const bool is_error = text.starts_with("error") || text.starts_with("ALARM");
    if (!is_error && read_setting(text, number, column)) return;
    problems_.push_back(fmt::format("{}:{}:{}: '{}'{}", file_, number, column, text,
                                    is_error ? " is what a control answers that prints no settings"
                                             : ", expected a setting such as $110=5000.000"));
  }

  // "$110=5000.000 (x max rate, mm/min)"
  bool read_setting(std::string_view text, std::size_t line, std::size_t column) {
    if (text.front() != '$') return false;
    int number = 0;
    const char* const last = text.data() + text.size();
    const auto [after_number, bad_number] = std::from_chars(text.data() + 1, last, number);
    if (bad_number != std::errc{}) return false;
    std::string_view rest = without_blanks_before({after_number, last});
    if (!rest.starts_with('=')) return false;
    rest = without_blanks_before(rest.substr(1));
    double value = 0;
    const auto [after_value, bad_value] = std::from_chars(rest.data(), last, value);
    const std::string_view comment = without_blanks_before({after_value, last});
    const bool is_number = bad_value == std::errc{} && std::isfinite(value) &&
                           (comment.empty() || comment.front() == '(' || comment.front() == ';');
    if (is_number) {
      const auto at = column + static_cast<std::size_t>(rest.data() - text.data());
      settings_[number] = {value, line, at};
      return true;
    }
    // Of the settings that do not matter here some are texts (a network's name in grblHAL).
    return !matters(number);
  }

  static bool matters(int number) {
    const auto is_of_axis = [number](int first) {
      return number >= first && number < first + static_cast<int>(kAxes);
    };
    return number == kJunctionDeviation || number == kArcTolerance || number == kPlannerBlocks ||
           is_of_axis(kSteps) || is_of_axis(kMaxRate) || is_of_axis(kAcceleration);
  }

  const std::string& file_;
  std::vector<std::string>& problems_;
  std::map<int, Setting> settings_;
};

// Nothing where a line is no setting, no answer of the control and no comment, where a value is no
// number or too small, or a setting is missing: `problems` have file and place then. All other
// settings are passed over; one that is there twice counts as it is last.
std::optional<Machine> with_settings(const Machine& base, std::string_view dump,
                                     const std::string& file, std::vector<std::string>& problems) {
  const std::size_t problems_before = problems.size();
  DumpReader reader(file, problems);
  reader.read(dump);
  if (problems.size() > problems_before) {
    // One line of another kind is a slip; in a file of another kind each line is.
    const std::size_t wrong = problems.size() - problems_before;
    problems.resize(problems_before + 1);
    if (wrong > 1) problems.back() += fmt::format("; {} more lines are none either", wrong - 1);
    return std::nullopt;
  }

  Machine machine = base;
  ValueOrigins origins(file);
  std::string missing;
  const auto take = [&](int number, double& place, std::initializer_list<std::string> keys,
                        bool required) {
    const Setting* setting = reader.find(number);
    if (setting == nullptr) {
      if (required) missing += fmt::format("{}${}", missing.empty() ? "" : ", ", number);
      return false;
    }
    place = setting->value;
    for (const std::string& key : keys) {
      origins.add(key, {fmt::format("${}", number), setting->line, setting->column});
    }
    return true;
  };
  take(kJunctionDeviation, machine.junction_deviation, {"junction-deviation"}, true);
  take(kArcTolerance, machine.arc_tolerance, {"arc-tolerance"}, true);
  for (std::size_t i = 0; i < kAxes; ++i) {
    const auto axis = static_cast<Axis>(i);
    AxisLimits& limits = machine.axis(axis);
    const std::string table = fmt::format("axis.{}.", name_of(axis));
    const bool required = i < kLinearAxes;
    if (take(kMaxRate + static_cast<int>(i), limits.velocity,
             {table + "velocity", table + "rapid-velocity"}, required)) {
      limits.velocity /= kMinute;
      limits.rapid_velocity = limits.velocity;
    }
    take(kSteps + static_cast<int>(i), limits.steps, {table + "steps"}, false);
    take(kAcceleration + static_cast<int>(i), limits.acceleration, {table + "acceleration"},
         required);
  }
  if (const Setting* blocks = reader.find(kPlannerBlocks); blocks != nullptr) {
    machine.model = ControllerModel::kGrblhal;
    machine.look_ahead = static_cast<int>(std::clamp(blocks->value, 0.0, kMostPlannerBlocks));
    origins.add(std::string(kLookAheadKey),
                {fmt::format("${}", kPlannerBlocks), blocks->line, blocks->column});
  }
  if (!missing.empty()) {
    problems.push_back(fmt::format(
        "{}: no {} in it, expected all that grbl prints when asked for $$", file, missing));
    return std::nullopt;
  }
  origins.add_problems_of(machine, problems);
  if (problems.size() > problems_before) return std::nullopt;
  return machine;
}

}  // namespace

std::shared_ptr<const Machine> machine_with_grbl_settings(const Machine* base,
                                                          const std::string& file,
                                                          std::vector<std::string>& problems) {
  if (base != nullptr && !is_grbl(base->model)) {
    problems.push_back(
        fmt::format("--grbl-settings: the control of machine {} is {}, expected a machine with "
                    "grbl, such as router",
                    base->name, name_of(base->model)));
    return nullptr;
  }
  std::string error;
  const auto dump = gcode::SourceText::map_file(file, error);
  if (!dump) {
    problems.push_back("--grbl-settings: " + error);
    return nullptr;
  }
  if (const std::string_view is = gcode::foreign_kind_of(dump->text()); !is.empty()) {
    problems.push_back(fmt::format(
        "--grbl-settings: {} is {}; expected what grbl answers to $$, saved as text", file, is));
    return nullptr;
  }
  auto machine =
      with_settings(base == nullptr ? *find_machine("grbl") : *base, dump->text(), file, problems);
  if (!machine) return nullptr;
  machine->name = std::filesystem::path(file).stem().string();
  machine->description = "grbl with the settings in " + file;
  machine->source = file;
  return std::make_shared<const Machine>(std::move(*machine));
}

}  // namespace batten::postproc
