// The printer.cfg of a machine with Klipper.
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <cstddef>
#include <filesystem>
#include <map>
#include <optional>
#include <string_view>
#include <utility>

#include "gcode/text/characters.h"
#include "gcode/text/source_text.h"
#include "postproc/machine/files/machine_file.h"
#include "postproc/machine/machine_fields.h"

namespace batten::postproc {
namespace {

constexpr std::string_view kPrinter = "printer";
constexpr std::string_view kArcs = "gcode_arcs";

struct CfgValue {
  std::string text;
  std::size_t line = 0;    // from 1
  std::size_t column = 0;  // from 1
};

std::string_view without_trailing_blanks(std::string_view text) {
  const std::size_t last = text.find_last_not_of(" \t\r");
  return last == std::string_view::npos ? std::string_view{} : text.substr(0, last + 1);
}

// [SECTION] lines and `key: value` or `key = value` lines; comments from # or ; on; a line that is
// indented goes on with the value before it. Of two values the last counts.
class CfgFile {
 public:
  explicit CfgFile(std::string_view text) {
    for (std::size_t number = 1; !text.empty(); ++number) {
      const std::size_t end = text.find('\n');
      read_line(text.substr(0, end), number);
      if (end == std::string_view::npos) break;
      text.remove_prefix(end + 1);
    }
  }

  // Null when there is none.
  [[nodiscard]] const CfgValue* find(std::string_view section, std::string_view key) const {
    const auto found = values_.find({std::string(section), std::string(key)});
    return found == values_.end() ? nullptr : &found->second;
  }
  [[nodiscard]] bool has_printer() const { return has_printer_; }

 private:
  void read_line(std::string_view line, std::size_t number) {
    const std::string_view text = without_trailing_blanks(line.substr(0, line.find_first_of("#;")));
    if (text.empty()) return;
    if (text.front() == '[') {
      section_ = text.substr(1, text.find(']') - 1);
      has_printer_ = has_printer_ || section_ == kPrinter;
      return;
    }
    const std::size_t split = text.find_first_of(":=");
    if (text.front() == ' ' || text.front() == '\t' || split == std::string_view::npos) return;
    const std::string_view value = gcode::without_blanks_before(text.substr(split + 1));
    const auto column = static_cast<std::size_t>(value.data() - line.data()) + 1;
    values_[{section_, std::string(without_trailing_blanks(text.substr(0, split)))}] = {
        std::string(value), number, column};
  }

  std::map<std::pair<std::string, std::string>, CfgValue> values_;
  std::string section_;
  bool has_printer_ = false;
};

class PrinterCfgReader {
 public:
  PrinterCfgReader(const CfgFile& cfg, const std::string& file, std::vector<std::string>& problems)
      : cfg_(cfg), file_(file), problems_(problems), origins_(file) {}

  Machine read() {
    machine_ = *find_machine("klipper-router");
    machine_.name = std::filesystem::path(file_).stem().string();
    machine_.description = "machine with Klipper from " + file_;
    machine_.source = file_;
    if (!cfg_.has_printer()) {
      problems_.push_back(
          fmt::format("{}: no [printer] in it, expected the file that has it; [include ..] is not "
                      "followed",
                      file_));
      return machine_;
    }
    read_limits();
    take(kPrinter, "square_corner_velocity", machine_.square_corner_velocity,
         {"square-corner-velocity"});
    read_cruise_ratio();
    take(kArcs, "resolution", machine_.arc_resolution, {"arc-resolution"});
    origins_.add_problems_of(machine_, problems_);
    return machine_;
  }

 private:
  // X and Y go along the path as fast as it; Z has limits of its own where the file says them.
  void read_limits() {
    AxisLimits limits;
    require("max_velocity", limits.velocity,
            {"axis.x.velocity", "axis.y.velocity", "axis.z.velocity", "axis.x.rapid-velocity",
             "axis.y.rapid-velocity", "axis.z.rapid-velocity"});
    require("max_accel", limits.acceleration,
            {"axis.x.acceleration", "axis.y.acceleration", "axis.z.acceleration"});
    // A value that is too small is wrong once.
    machine_.path_feed = limits.velocity > 0 ? limits.velocity : Machine::kNone;
    machine_.path_acceleration = limits.acceleration > 0 ? limits.acceleration : Machine::kNone;
    limits.rapid_velocity = limits.velocity;
    limits.jerk = Machine::kNone;
    for (std::size_t i = 0; i < kLinearAxes; ++i) machine_.axes[i] = limits;
    AxisLimits& z = machine_.axis(Axis::kZ);
    take(kPrinter, "max_z_velocity", z.velocity, {"axis.z.velocity", "axis.z.rapid-velocity"});
    take(kPrinter, "max_z_accel", z.acceleration, {"axis.z.acceleration"});
    z.rapid_velocity = z.velocity;
  }

  // Older files say the acceleration for smoothed speeds itself.
  void read_cruise_ratio() {
    if (take(kPrinter, "minimum_cruise_ratio", machine_.minimum_cruise_ratio,
             {"minimum-cruise-ratio"})) {
      return;
    }
    double smoothed = 0;
    if (take(kPrinter, "max_accel_to_decel", smoothed, {})) {
      machine_.minimum_cruise_ratio =
          1 - std::clamp(smoothed / machine_.path_acceleration, kLeastShare, 1.0);
    }
  }

  void require(std::string_view key, double& place, std::initializer_list<std::string> keys) {
    if (cfg_.find(kPrinter, key) == nullptr) {
      problems_.push_back(fmt::format("{}: no {} in [{}]", file_, key, kPrinter));
      place = 1;
    } else if (!take(kPrinter, key, place, keys)) {
      place = 1;  // that it is no number has been said
    }
  }

  // False when there is none, and when it is no number, which has been said then.
  bool take(std::string_view section, std::string_view key, double& place,
            std::initializer_list<std::string> keys) {
    const CfgValue* value = cfg_.find(section, key);
    if (value == nullptr) return false;
    const char* const last = value->text.data() + value->text.size();
    double number = 0;
    const auto [end, error] = std::from_chars(value->text.data(), last, number);
    if (error != std::errc{} || end != last || !std::isfinite(number)) {
      problems_.push_back(fmt::format("{}:{}:{}: [{}] {}: {}, expected a number", file_,
                                      value->line, value->column, section, key, value->text));
      return false;
    }
    place = number;
    for (const std::string& of_machine : keys) {
      origins_.add(of_machine, {fmt::format("[{}] {}", section, key), value->line, value->column});
    }
    return true;
  }

  static constexpr double kLeastShare = 0.001;  // of the acceleration: the ratio stays below 1

  const CfgFile& cfg_;
  const std::string& file_;
  std::vector<std::string>& problems_;
  ValueOrigins origins_;
  Machine machine_;
};

}  // namespace

std::shared_ptr<const Machine> read_printer_cfg(const std::string& file,
                                                std::vector<std::string>& problems) {
  std::string error;
  const auto text = gcode::SourceText::map_file(file, error);
  if (!text) {
    problems.push_back(error);
    return nullptr;
  }
  const std::size_t problems_before = problems.size();
  Machine machine = PrinterCfgReader(CfgFile(text->text()), file, problems).read();
  if (problems.size() > problems_before) return nullptr;
  return std::make_shared<const Machine>(std::move(machine));
}

}  // namespace batten::postproc
