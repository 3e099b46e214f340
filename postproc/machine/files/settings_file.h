// Configurations of controls as settings with their places, whatever their form; and how settings
// become numbers of a machine.
#pragma once

#include <filesystem>
#include <initializer_list>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "gcode/text/source_text.h"
#include "postproc/machine/machine.h"
#include "postproc/machine/machine_fields.h"

namespace batten::postproc {

// Nothing where it cannot be read, which is said then.
[[nodiscard]] std::optional<gcode::SourceText> mapped_file(const std::string& file,
                                                           std::vector<std::string>& problems);

struct SettingEntry {
  std::string section;
  std::string key;
  std::string value;  // without blanks around it
  std::string file;
  std::size_t line = 0;    // from 1
  std::size_t column = 0;  // of the value, from 1
};

// `read` gets each line without its end, and its number from 1.
template <typename Read>
void for_each_line(std::string_view text, const Read& read) {
  for (std::size_t number = 1; !text.empty(); ++number) {
    const std::size_t end = text.find('\n');
    std::string_view line = text.substr(0, end);
    if (line.ends_with('\r')) line.remove_suffix(1);
    read(line, number);
    if (end == std::string_view::npos) break;
    text.remove_prefix(end + 1);
  }
}

[[nodiscard]] std::string_view without_blanks_around(std::string_view text);

// How a file of [SECTION] lines and `key = value` lines is written.
struct SectionRules {
  std::string_view separators = "=";
  bool comments_anywhere = false;  // from # or ; on; else such lines are comments
  bool indented_goes_on = false;   // a line that is indented belongs to the value before it
  bool last_counts = false;        // of two values; else the first
  // "#INCLUDE FILE", whose files include no further ones; else [include FILE], where * and ? stand
  // for any names.
  bool includes_by_comment = false;
};

// Files that are included stand in the place of the line that names them; from its folder.
class SectionFile {
 public:
  // Adds to `problems` what could not be read, with file and line.
  SectionFile(const std::string& file, const SectionRules& rules,
              std::vector<std::string>& problems);

  // Null when there is none.
  [[nodiscard]] const SettingEntry* find(std::string_view section, std::string_view key) const;
  [[nodiscard]] bool has_section(std::string_view section) const;

 private:
  void read(const std::string& file);
  void read_line(std::string_view line, const std::string& file, std::size_t number);
  void include(std::string_view name, const std::string& by, std::size_t line);

  SectionRules rules_;
  std::vector<std::string>& problems_;
  std::vector<std::filesystem::path> being_read_;
  std::vector<SettingEntry> settings_;
  std::vector<std::string> sections_;
  std::string section_;
};

// Settings that are taken for a machine, with what is wrong with them in the words of their file.
class SettingTaker {
 public:
  SettingTaker(std::string file, std::vector<std::string>& problems)
      : file_(std::move(file)), problems_(problems), origins_(file_) {}

  // `keys`: of the machine, as in MachineProblem. False when there is none, and when it is no
  // number, which has been said then.
  bool take(const SettingEntry* setting, double factor, double& place,
            std::initializer_list<std::string> keys);
  // The same; that it is missing is said, too. `place` is above 0 in any case.
  bool require(const SettingEntry* setting, std::string_view name, double factor, double& place,
               std::initializer_list<std::string> keys);
  // Whole blocks.
  void take_look_ahead(const SettingEntry* setting, Machine& machine);
  // Of the axis, and its rapids where that is a velocity.
  bool require_of_axis(const SettingEntry* setting, std::string_view name, double factor, Axis axis,
                       double AxisLimits::*place, Machine& machine);

  // Nothing where anything is wrong.
  [[nodiscard]] std::shared_ptr<const Machine> machine(Machine machine);

 private:
  std::string file_;
  std::vector<std::string>& problems_;
  std::size_t problems_before_ = problems_.size();
  ValueOrigins origins_;
};

// A machine as the built-in one, named after the file: "machine with Klipper from printer.cfg".
[[nodiscard]] Machine machine_like(std::string_view built_in, std::string_view control,
                                   const std::string& file);

}  // namespace batten::postproc
