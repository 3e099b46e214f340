#include "postproc/machine/files/settings_file.h"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <memory>
#include <utility>


namespace batten::postproc {
namespace {

namespace fs = std::filesystem;

// * stands for any text, ? for any letter.
bool name_fits(std::string_view name, std::string_view pattern) {
  if (pattern.empty()) return name.empty();
  if (pattern.front() == '*') {
    return name_fits(name, pattern.substr(1)) ||
           (!name.empty() && name_fits(name.substr(1), pattern));
  }
  return !name.empty() && (pattern.front() == '?' || pattern.front() == name.front()) &&
         name_fits(name.substr(1), pattern.substr(1));
}

bool is_pattern(std::string_view name) {
  return name.find_first_of("*?") != std::string_view::npos;
}

// In the order of their names.
std::vector<fs::path> files_that_fit(const fs::path& pattern) {
  std::vector<fs::path> files;
  std::error_code error;
  for (const auto& entry : fs::directory_iterator(pattern.parent_path(), error)) {
    if (entry.is_regular_file() &&
        name_fits(entry.path().filename().string(), pattern.filename().string())) {
      files.push_back(entry.path());
    }
  }
  std::ranges::sort(files);
  return files;
}

}  // namespace

std::string_view without_blanks_around(std::string_view text) {
  constexpr std::string_view kBlanks = " \t\r";
  const std::size_t first = text.find_first_not_of(kBlanks);
  if (first == std::string_view::npos) return {};
  return text.substr(first, text.find_last_not_of(kBlanks) - first + 1);
}

SectionFile::SectionFile(const std::string& file, const SectionRules& rules,
                         std::vector<std::string>& problems)
    : rules_(rules), problems_(problems) {
  read(file);
}

const SettingEntry* SectionFile::find(std::string_view section, std::string_view key) const {
  const SettingEntry* found = nullptr;
  for (const SettingEntry& setting : settings_) {
    if (setting.section != section || setting.key != key) continue;
    found = &setting;
    if (!rules_.last_counts) break;
  }
  return found;
}

bool SectionFile::has_section(std::string_view section) const {
  return std::ranges::find(sections_, section) != sections_.end();
}

std::optional<gcode::SourceText> mapped_file(const std::string& file,
                                             std::vector<std::string>& problems) {
  std::string error;
  auto source = gcode::SourceText::map_file(file, error);
  if (!source) problems.push_back(error);
  return source;
}

void SectionFile::read(const std::string& file) {
  const auto source = mapped_file(file, problems_);
  if (!source) return;
  being_read_.push_back(fs::weakly_canonical(file));
  for_each_line(source->text(),
                [&](std::string_view line, std::size_t number) { read_line(line, file, number); });
  being_read_.pop_back();
}

void SectionFile::read_line(std::string_view line, const std::string& file, std::size_t number) {
  constexpr std::string_view kIncludeComment = "#INCLUDE";
  constexpr std::string_view kIncludeSection = "include ";
  std::string_view text = without_blanks_around(line);
  if (rules_.includes_by_comment && being_read_.size() == 1 && text.starts_with(kIncludeComment)) {
    include(without_blanks_around(text.substr(kIncludeComment.size())), file, number);
    return;
  }
  if (rules_.comments_anywhere) {
    text = without_blanks_around(text.substr(0, text.find_first_of("#;")));
  }
  if (text.empty() || text.front() == '#' || text.front() == ';') return;
  if (rules_.indented_goes_on && text.data() != line.data()) return;
  if (text.front() == '[') {
    const std::string_view name = text.substr(1, text.find(']') - 1);
    if (!rules_.includes_by_comment && name.starts_with(kIncludeSection)) {
      include(without_blanks_around(name.substr(kIncludeSection.size())), file, number);
      return;
    }
    section_ = std::string(name);
    sections_.push_back(section_);
    return;
  }
  const std::size_t split = text.find_first_of(rules_.separators);
  if (split == std::string_view::npos) return;
  const std::string_view value = without_blanks_around(text.substr(split + 1));
  if (value.empty()) return;
  settings_.push_back({section_, std::string(without_blanks_around(text.substr(0, split))),
                       std::string(value), file, number,
                       static_cast<std::size_t>(value.data() - line.data()) + 1});
}

void SectionFile::include(std::string_view name, const std::string& by, std::size_t line) {
  const std::string_view word = rules_.includes_by_comment ? "#INCLUDE" : "[include]";
  const fs::path file = fs::path(by).parent_path() / name;
  std::error_code error;
  std::vector<fs::path> files;
  if (!rules_.includes_by_comment && is_pattern(name)) {
    files = files_that_fit(file);
  } else if (!name.empty() && fs::is_regular_file(file, error)) {
    files = {file};
  } else {
    problems_.push_back(fmt::format("{}:{}: {}: there is no file '{}'", by, line, word, name));
  }
  for (const fs::path& each : files) {
    if (std::ranges::find(being_read_, fs::weakly_canonical(each)) != being_read_.end()) {
      problems_.push_back(fmt::format("{}:{}: {}: '{}' is being read already", by, line, word,
                                      each.filename().string()));
      continue;
    }
    read(each.string());
  }
}

bool SettingTaker::take(const SettingEntry* setting, double factor, double& place,
                        std::initializer_list<std::string> keys) {
  if (setting == nullptr) return false;
  const std::string name = setting->section.empty()
                               ? setting->key
                               : fmt::format("[{}] {}", setting->section, setting->key);
  const char* const last = setting->value.data() + setting->value.size();
  double number = 0;
  const auto [end, error] = std::from_chars(setting->value.data(), last, number);
  if (error != std::errc{} || end != last || !std::isfinite(number)) {
    problems_.push_back(fmt::format("{}:{}:{}: {}: {}, expected a number", setting->file,
                                    setting->line, setting->column, name, setting->value));
    return false;
  }
  place = number * factor;
  for (const std::string& key : keys) {
    origins_.add(key, {name, setting->line, setting->column,
                       setting->file == file_ ? std::string() : setting->file});
  }
  return true;
}

bool SettingTaker::require(const SettingEntry* setting, std::string_view name, double factor,
                           double& place, std::initializer_list<std::string> keys) {
  if (setting == nullptr) problems_.push_back(fmt::format("{}: no {}", file_, name));
  if (take(setting, factor, place, keys)) return true;
  place = 1;
  return false;
}

void SettingTaker::take_look_ahead(const SettingEntry* setting, Machine& machine) {
  constexpr double kMost = 1e6;
  double blocks = 0;
  if (!take(setting, 1, blocks, {std::string(kLookAheadKey)})) return;
  machine.look_ahead = static_cast<int>(std::clamp(blocks, 0.0, kMost));
}

bool SettingTaker::require_of_axis(const SettingEntry* setting, std::string_view name,
                                   double factor, Axis axis, double AxisLimits::*place,
                                   Machine& machine) {
  const auto field = std::ranges::find(axis_fields(), place, &AxisField::place);
  AxisLimits& limits = machine.axis(axis);
  const bool is_velocity = place == &AxisLimits::velocity;
  const std::string key = axis_key(axis, *field);
  const std::string rapid = fmt::format("axis.{}.rapid-velocity", name_of(axis));
  const bool taken = is_velocity ? require(setting, name, factor, limits.*place, {key, rapid})
                                 : require(setting, name, factor, limits.*place, {key});
  if (is_velocity) limits.rapid_velocity = limits.velocity;
  return taken;
}

std::shared_ptr<const Machine> SettingTaker::machine(Machine machine) {
  if (problems_.size() == problems_before_) origins_.add_problems_of(machine, problems_);
  if (problems_.size() > problems_before_) return nullptr;
  return std::make_shared<const Machine>(std::move(machine));
}

Machine machine_like(std::string_view built_in, std::string_view control, const std::string& file) {
  Machine machine = *find_machine(built_in);
  machine.name = fs::path(file).stem().string();
  machine.description = fmt::format("machine with {} from {}", control, file);
  machine.source = file;
  return machine;
}

}  // namespace batten::postproc
