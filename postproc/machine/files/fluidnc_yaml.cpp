// The configuration of a machine with FluidNC.
#include <fmt/format.h>

#include <algorithm>
#include <string_view>
#include <utility>

#include "postproc/machine/files/machine_file.h"
#include "postproc/machine/files/settings_file.h"

namespace batten::postproc {
namespace {

// `key: value` lines, nested by how far they are indented; comments from # on. A list or a text in
// several lines is nothing that we ask for.
class YamlFile {
 public:
  YamlFile(std::string_view text, const std::string& file) {
    for_each_line(
        text, [&](std::string_view line, std::size_t number) { read_line(line, file, number); });
  }

  // "axes/x/steps_per_mm"; null when there is none.
  [[nodiscard]] const SettingEntry* find(std::string_view path) const {
    const auto found = std::ranges::find(settings_, path, &SettingEntry::key);
    return found == settings_.end() ? nullptr : &*found;
  }

 private:
  void read_line(std::string_view line, const std::string& file, std::size_t number) {
    const std::string_view text = without_blanks_around(line.substr(0, line.find('#')));
    const std::size_t colon = text.find(':');
    if (text.empty() || colon == std::string_view::npos) return;
    const auto indent = static_cast<std::size_t>(text.data() - line.data());
    while (!above_.empty() && above_.back().first >= indent) above_.pop_back();
    std::string path = above_.empty() ? "" : above_.back().second + "/";
    path += without_blanks_around(text.substr(0, colon));
    const std::string_view value = without_blanks_around(text.substr(colon + 1));
    if (value.empty()) {
      above_.emplace_back(indent, std::move(path));
      return;
    }
    settings_.push_back({"", std::move(path), std::string(value), file, number,
                         static_cast<std::size_t>(value.data() - line.data()) + 1});
  }

  std::vector<SettingEntry> settings_;
  std::vector<std::pair<std::size_t, std::string>> above_;  // by how much they are indented
};

}  // namespace

std::shared_ptr<const Machine> read_fluidnc_yaml(const std::string& file,
                                                 std::vector<std::string>& problems) {
  const auto text = mapped_file(file, problems);
  if (!text) return nullptr;
  const YamlFile yaml(text->text(), file);
  SettingTaker taker(file, problems);
  Machine machine = machine_like("router", "FluidNC", file);
  const auto require = [&](Axis axis, std::string_view key, double factor,
                           double AxisLimits::*place) {
    const std::string path = fmt::format("axes/{}/{}", name_of(axis), key);
    taker.require_of_axis(yaml.find(path), path, factor, axis, place, machine);
  };
  for (const Axis axis : {Axis::kX, Axis::kY, Axis::kZ}) {
    require(axis, "steps_per_mm", 1, &AxisLimits::steps);
    require(axis, "max_rate_mm_per_min", 1 / kMinute, &AxisLimits::velocity);
    require(axis, "acceleration_mm_per_sec2", 1, &AxisLimits::acceleration);
  }
  taker.take(yaml.find("junction_deviation_mm"), 1, machine.junction_deviation,
             {"junction-deviation"});
  taker.take(yaml.find("arc_tolerance_mm"), 1, machine.arc_tolerance, {"arc-tolerance"});
  taker.take_look_ahead(yaml.find("planner_blocks"), machine);
  return taker.machine(std::move(machine));
}

}  // namespace batten::postproc
