// Machines whose settings are words: what Marlin answers to M503, and RepRapFirmware's config.g.
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <span>
#include <string_view>

#include "gcode/text/characters.h"
#include "postproc/machine/files/machine_file.h"
#include "postproc/machine/files/settings_file.h"

namespace batten::postproc {
namespace {

// A word of X, Y and Z.
struct AxisWord {
  std::string_view command;
  double factor;  // to mm and s
  double AxisLimits::*place;
  bool needed;
};

// A word of the machine.
struct MachineWord {
  std::string_view command;
  char letter;
  double Machine::*place;
  std::string_view key;
};

struct WordRules {
  std::string_view control;
  std::string_view answers_to;  // how its settings are got
  std::string_view built_in;
  std::span<const AxisWord> of_axes;
  std::span<const MachineWord> of_machine;
};

// Marlin 2: M204 T is for moves that extrude nothing.
constexpr std::array kMarlinAxes = {AxisWord{"M92", 1, &AxisLimits::steps, false},
                                    AxisWord{"M201", 1, &AxisLimits::acceleration, true},
                                    AxisWord{"M203", 1, &AxisLimits::velocity, true},
                                    AxisWord{"M205", 1, &AxisLimits::velocity_step, false}};
constexpr std::array kMarlinMachine = {
    MachineWord{"M204", 'T', &Machine::path_acceleration, "path-acceleration"},
    MachineWord{"M205", 'J', &Machine::junction_deviation, "junction-deviation"}};
// RepRapFirmware 3: mm/min, but M205, which says M566 in mm/s. It plans with ends as programmed.
constexpr std::array kRepRapAxes = {AxisWord{"M201", 1, &AxisLimits::acceleration, true},
                                    AxisWord{"M203", 1 / kMinute, &AxisLimits::velocity, true},
                                    AxisWord{"M566", 1 / kMinute, &AxisLimits::velocity_step, true},
                                    AxisWord{"M205", 1, &AxisLimits::velocity_step, false}};
constexpr std::array kRepRapMachine = {
    MachineWord{"M204", 'T', &Machine::path_acceleration, "path-acceleration"}};

constexpr WordRules kMarlin{"Marlin", "what Marlin answers to M503", "marlin-router", kMarlinAxes,
                            kMarlinMachine};
constexpr WordRules kRepRap{"RepRapFirmware", "RepRapFirmware's config.g", "marlin-router",
                            kRepRapAxes, kRepRapMachine};

class WordFile {
 public:
  WordFile(std::string_view text, const std::string& file) {
    for_each_line(
        text, [&](std::string_view line, std::size_t number) { read_line(line, file, number); });
  }

  // The last one; null when there is none.
  [[nodiscard]] const SettingEntry* find(std::string_view command, char letter) const {
    const std::string key = fmt::format("{} {}", command, letter);
    const auto found = std::find_if(settings_.rbegin(), settings_.rend(),
                                    [&](const SettingEntry& each) { return each.key == key; });
    return found == settings_.rend() ? nullptr : &*found;
  }
  // Whether a command stands there: "G20".
  [[nodiscard]] bool has(std::string_view command) const {
    return std::ranges::find(commands_, command) != commands_.end();
  }

 private:
  // "echo:  M203 X500.00 Y500.00 ; mm/s"
  void read_line(std::string_view line, const std::string& file, std::size_t number) {
    constexpr std::string_view kEcho = "echo:";
    std::string_view text = line.substr(0, line.find(';'));
    const std::string_view begin = without_blanks_around(text);
    if (begin.starts_with(kEcho)) text.remove_prefix(begin.data() - text.data() + kEcho.size());
    std::string command;
    while (!(text = without_blanks_around(text)).empty()) {
      const std::string_view word = text.substr(0, text.find_first_of(" \t"));
      if (command.empty()) {
        command = gcode::in_capitals(word);
        commands_.push_back(command);
      } else if (word.size() > 1) {
        const auto column = static_cast<std::size_t>(word.data() - line.data()) + 2;
        settings_.push_back({"", fmt::format("{} {}", command, gcode::upper(word.front())),
                             std::string(word.substr(1)), file, number, column});
      }
      text.remove_prefix(word.size());
    }
  }

  std::vector<SettingEntry> settings_;
  std::vector<std::string> commands_;
};

std::shared_ptr<const Machine> machine_of_words(const std::string& file, const WordRules& rules,
                                                std::vector<std::string>& problems) {
  const auto text = mapped_file(file, problems);
  if (!text) return nullptr;
  const WordFile words(text->text(), file);
  const bool any = std::ranges::any_of(
      rules.of_axes, [&](const AxisWord& word) { return words.has(word.command); });
  if (!any || words.has("G20")) {
    problems.push_back(
        any ? fmt::format("{}: G20: its numbers are in inches, expected millimetres", file)
            : fmt::format("{}: no M203 in it, expected {}", file, rules.answers_to));
    return nullptr;
  }
  SettingTaker taker(file, problems);
  Machine machine = machine_like(rules.built_in, rules.control, file);
  for (std::size_t i = 0; i < kLinearAxes; ++i) {
    for (const AxisWord& word : rules.of_axes) {
      const SettingEntry* setting = words.find(word.command, "XYZ"[i]);
      const auto axis = static_cast<Axis>(i);
      if (setting == nullptr && !word.needed) continue;
      taker.require_of_axis(setting, fmt::format("{} {}", word.command, "XYZ"[i]), word.factor,
                            axis, word.place, machine);
    }
  }
  if (&rules == &kRepRap) {
    for (AxisLimits& axis : machine.axes) axis.steps = Machine::kNone;
  }
  for (const MachineWord& word : rules.of_machine) {
    taker.take(words.find(word.command, word.letter), 1, machine.*word.place,
               {std::string(word.key)});
  }
  return taker.machine(std::move(machine));
}

}  // namespace

std::shared_ptr<const Machine> read_marlin_settings(const std::string& file,
                                                    std::vector<std::string>& problems) {
  return machine_of_words(file, kMarlin, problems);
}

std::shared_ptr<const Machine> read_reprap_config(const std::string& file,
                                                  std::vector<std::string>& problems) {
  return machine_of_words(file, kRepRap, problems);
}

}  // namespace batten::postproc
