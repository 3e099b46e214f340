#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <filesystem>
#include <optional>
#include <span>
#include <string_view>

#include "gcode/reading/parser.h"
#include "gcode/text/characters.h"
#include "gcode/text/source_text.h"
#include "postproc/machine/files/machine_file.h"
#include "postproc/machine/files/settings_file.h"
#include "postproc/machine/machine_fields.h"

namespace batten::postproc {

namespace {

// --- the machine ---------------------------------------------------------------------------------

constexpr double kNanosecond = 1e-9;
constexpr double kStartTolerance = 0.001 * kInch;  // mm, with which LinuxCNC starts

// As LinuxCNC knows them; mm.
constexpr std::array kLengthUnits = {Unit{"mm", 1}, Unit{"metric", 1}, Unit{"in", kInch},
                                     Unit{"inch", kInch}, Unit{"imperial", kInch}};

// Degrees.
constexpr std::array kAngleUnits = {Unit{"deg", 1},         Unit{"degree", 1}, Unit{"degrees", 1},
                                    Unit{"grad", 0.9},      Unit{"gon", 0.9},  Unit{"rad", kRadian},
                                    Unit{"radian", kRadian}};

// The number that the text starts with: what follows it does not matter to LinuxCNC.
std::optional<double> number_of(std::string_view text) {
  if (text.starts_with('+')) text.remove_prefix(1);
  double value = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (error != std::errc{} || !std::isfinite(value)) return std::nullopt;
  const bool ends =
      end == text.data() + text.size() || *end == ' ' || *end == '\t' || *end == '#' || *end == ';';
  return ends ? std::optional(value) : std::nullopt;
}

class MachineIniReader {
 public:
  MachineIniReader(const SectionFile& ini, const std::string& file,
                   std::vector<std::string>& problems)
      : ini_(ini), file_(file), problems_(problems), origins_(file) {}

  Machine read() {
    machine_ = *find_machine("linuxcnc");
    machine_.name = std::filesystem::path(file_).stem().string();
    machine_.description = "LinuxCNC machine from " + file_;
    machine_.source = file_;
    machine_.blend_tolerance = kStartTolerance;
    machine_.naive_cam_tolerance = 0;
    mm_ = unit_of("LINEAR_UNITS", kLengthUnits);
    degrees_ =
        ini_.find("TRAJ", "ANGULAR_UNITS") == nullptr ? 1 : unit_of("ANGULAR_UNITS", kAngleUnits);
    read_axes();
    read_path();
    read_startup_code();
    origins_.add_problems_of(machine_, problems_);
    release_absent();
    return machine_;
  }

 private:
  void complain(const SettingEntry& entry, const std::string& expected) {
    problems_.push_back(fmt::format("{}:{}:{}: [{}]{}: {}, expected {}", entry.file, entry.line,
                                    entry.column, entry.section, entry.key, entry.value, expected));
  }

  // 1 where it is not known, which has been said then. Older files say how many of their units a
  // millimetre or a degree has.
  double unit_of(std::string_view key, std::span<const Unit> units) {
    const SettingEntry* entry = ini_.find("TRAJ", key);
    if (entry == nullptr) {
      problems_.push_back(fmt::format(
          "{}: no [TRAJ]{}, so its lengths mean nothing; expected mm or inch", file_, key));
      return 1;
    }
    std::string names;
    for (const Unit& unit : units) {
      if (unit.name == entry->value) return unit.factor;
      names += (names.empty() ? "" : ", ") + std::string(unit.name);
    }
    const auto per_unit = number_of(entry->value);
    if (per_unit && *per_unit > 0) return 1 / *per_unit;
    complain(*entry, "one of " + names);
    return 1;
  }

  // Nothing when there is none or it is no number, which has been said then.
  std::optional<double> number_at(const SettingEntry* entry) {
    if (entry == nullptr) return std::nullopt;
    const auto value = number_of(entry->value);
    if (!value) complain(*entry, "a number");
    return value;
  }

  void remember(const std::string& key, const SettingEntry& entry) {
    origins_.add(key, {fmt::format("[{}]{}", entry.section, entry.key), entry.line, entry.column,
                       entry.file});
  }

  // --- axes ----------------------------------------------------------------------------------

  // The letters of the joints in order: "XYYZ".
  [[nodiscard]] std::string joints() const {
    std::string letters;
    if (const SettingEntry* kinematics = ini_.find("KINS", "KINEMATICS")) {
      constexpr std::string_view kCoordinates = "coordinates=";
      const std::size_t at = kinematics->value.find(kCoordinates);
      if (at != std::string::npos) {
        std::string_view rest =
            std::string_view(kinematics->value).substr(at + kCoordinates.size());
        letters = rest.substr(0, rest.find(' '));
      }
    }
    const SettingEntry* coordinates = ini_.find("TRAJ", "COORDINATES");
    if (letters.empty() && coordinates != nullptr) letters = coordinates->value;
    return gcode::in_capitals(gcode::without_blanks(letters));
  }

  // Where the limit is: the axis' own, else that of its joint. Null: nowhere.
  [[nodiscard]] const SettingEntry* find_limit(char letter, const std::string& joints,
                                               std::string_view key) const {
    const SettingEntry* entry = ini_.find(fmt::format("AXIS_{}", letter), key);
    const std::size_t joint = joints.find(letter);
    if (entry == nullptr && joint != std::string::npos) {
      entry = ini_.find(fmt::format("JOINT_{}", joint), key);
      if (entry == nullptr) entry = ini_.find(fmt::format("AXIS_{}", joint), key);
    }
    return entry;
  }

  void read_axes() {
    const std::string letters = joints();
    for (std::size_t i = 0; i < kAxes; ++i) {
      const char letter = "XYZABC"[i];
      present_[i] = letters.find(letter) != std::string::npos ||
                    ini_.has_section(fmt::format("AXIS_{}", letter));
      if (present_[i]) read_axis(static_cast<Axis>(i), letter, letters);
    }
    if (!present_[0] && !present_[1] && !present_[2]) {
      problems_.push_back(fmt::format(
          "{}: no X, Y or Z in [TRAJ]COORDINATES and no [AXIS_X]: not the INI of a machine",
          file_));
    }
  }

  void read_axis(Axis axis, char letter, const std::string& joints) {
    AxisLimits& limits = machine_.axis(axis);
    const double unit = static_cast<std::size_t>(axis) < kLinearAxes ? mm_ : degrees_;
    const std::string table = fmt::format("axis.{}.", name_of(axis));
    const auto read_limit = [&](std::string_view ini_key, double& place, const std::string& key) {
      const SettingEntry* entry = find_limit(letter, joints, ini_key);
      if (entry == nullptr) {
        problems_.push_back(fmt::format("{}: no {} for axis {}, expected in [AXIS_{}]", file_,
                                        ini_key, letter, letter));
      } else if (const auto value = number_at(entry)) {
        place = *value * unit;
        remember(table + key, *entry);
      }
    };
    read_limit("MAX_VELOCITY", limits.velocity, "velocity");
    read_limit("MAX_ACCELERATION", limits.acceleration, "acceleration");
    limits.rapid_velocity = limits.velocity;
    if (const SettingEntry* entry = find_limit(letter, joints, "MAX_VELOCITY")) {
      remember(table + "rapid-velocity", *entry);
    }
  }

  // A lathe has no Y. What is the least over X, Y and Z must not come from an axis that is none.
  void release_absent() {
    AxisLimits most;
    for (std::size_t i = 0; i < kLinearAxes; ++i) {
      if (!present_[i]) continue;
      for (const AxisField& field : axis_fields()) {
        most.*field.place = std::max(most.*field.place, machine_.axes[i].*field.place);
      }
    }
    for (std::size_t i = 0; i < kLinearAxes; ++i) {
      if (!present_[i]) machine_.axes[i] = most;
    }
  }

  // --- the planner ---------------------------------------------------------------------------

  void read_path() {
    const SettingEntry* feed = ini_.find("TRAJ", "MAX_LINEAR_VELOCITY");
    if (feed == nullptr) feed = ini_.find("TRAJ", "MAX_VELOCITY");  // up to LinuxCNC 2.7
    machine_.path_feed = Machine::kNone;
    if (const auto value = number_at(feed)) {
      machine_.path_feed = *value * mm_;
      remember("path-feed", *feed);
    }
    const SettingEntry* period = ini_.find("EMCMOT", "SERVO_PERIOD");
    if (const auto nanoseconds = number_at(period)) {
      machine_.servo_period = *nanoseconds * kNanosecond;
      machine_.block_period = machine_.servo_period;
      remember("servo-period", *period);
      remember("block-period", *period);
    }
    const SettingEntry* depth = ini_.find("TRAJ", "ARC_BLEND_OPTIMIZATION_DEPTH");
    if (const auto blocks = number_at(depth)) {
      constexpr double kQueue = 2000;  // blocks that the planner holds
      machine_.look_ahead = static_cast<int>(std::clamp(*blocks, 0.0, kQueue));
      remember(std::string(kLookAheadKey), *depth);
    }
  }

  // Run before each program; the units of the machine count in it unless it says G20 or G21.
  void read_startup_code() {
    const SettingEntry* entry = ini_.find("RS274NGC", "RS274NGC_STARTUP_CODE");
    if (entry == nullptr) entry = ini_.find("EMC", "RS274NGC_STARTUP_CODE");
    if (entry == nullptr) return;
    gcode::Diagnostics found;
    const gcode::Program code =
        gcode::parse(gcode::SourceText(entry->file, entry->value + "\n"), found);
    double unit = mm_;
    double mode = 0;
    std::optional<double> p;
    std::optional<double> q;
    for (const gcode::Word& word : code.words) {
      if (!word.is_number) continue;
      if (word.letter == 'P') p = word.value;
      if (word.letter == 'Q') q = word.value;
      if (word.letter != 'G') continue;
      if (word.value == 20) unit = kInch;
      if (word.value == 21) unit = 1;
      if (word.value == 64 || word.value == 61 || word.value == 61.1) mode = word.value;
    }
    if (mode == 61) machine_.path_mode = gcode::PathMode::kExactPath;
    if (mode == 61.1) machine_.path_mode = gcode::PathMode::kExactStop;
    if (mode != 64) return;
    machine_.blend_tolerance = p.value_or(0) * unit;
    machine_.naive_cam_tolerance = q.value_or(p.value_or(0)) * unit;
    remember("blend-tolerance", *entry);
    remember("naive-cam-tolerance", *entry);
  }

  const SectionFile& ini_;
  const std::string& file_;
  std::vector<std::string>& problems_;
  ValueOrigins origins_;
  Machine machine_;
  std::array<bool, kAxes> present_ = {};
  double mm_ = 1;
  double degrees_ = 1;
};

}  // namespace

std::shared_ptr<const Machine> read_machine_ini(const std::string& file,
                                                std::vector<std::string>& problems) {
  const std::size_t problems_before = problems.size();
  const SectionFile ini(file, {.includes_by_comment = true}, problems);
  if (problems.size() > problems_before) return nullptr;
  Machine machine = MachineIniReader(ini, file, problems).read();
  if (problems.size() > problems_before) return nullptr;
  return std::make_shared<const Machine>(std::move(machine));
}

}  // namespace batten::postproc
