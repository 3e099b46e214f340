// What was given for the options of a command, still as text: on the command line, in a
// configuration file, or both.
#pragma once

#include <map>
#include <optional>
#include <set>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace batten::postproc {

using Problems = std::vector<std::string>;

// Option names to the values given for them; a flag that was given has the value "true".
class Given {
 public:
  void add(std::string_view name, std::string value);

  // All that is given from now on comes from there; nothing: from the command line.
  void come_from(std::string origin) { origin_ = std::move(origin); }

  // Of a list: each part between commas, without blanks around it. Empty parts are values, too, so
  // that they can be reported.
  void add_list(std::string_view name, std::string_view values);

  [[nodiscard]] bool has(std::string_view name) const;
  [[nodiscard]] bool flag(std::string_view name) const;

  // The value given, or nothing; `text`: or an empty one.
  [[nodiscard]] std::optional<std::string> value(std::string_view name) const;
  [[nodiscard]] std::string text(std::string_view name) const { return value(name).value_or(""); }
  [[nodiscard]] std::vector<std::string> values(std::string_view name) const;

  // Takes from `other` what is not given here. Who names a target here has named what belongs to
  // it: `goes_together`: then none of `other`'s target, profile, machine and grbl-settings is
  // taken.
  void complete_from(const Given& other, bool goes_together = false);

  // Where a value comes from: a file, or empty for the command line.
  [[nodiscard]] std::string origin(std::string_view name) const;

  // Option and file of all that comes from files, by option.
  [[nodiscard]] std::vector<std::pair<std::string, std::string>> origins() const;

  // Whether anybody has asked for it, given or not: an option without a reader would be taken and
  // do nothing.
  [[nodiscard]] bool was_read(std::string_view name) const { return read_.contains(name); }

 private:
  mutable std::set<std::string, std::less<>> read_;
  struct Values {
    std::vector<std::string> texts;
    std::string origin;
  };
  std::map<std::string, Values, std::less<>> values_;
  std::string origin_;
};

// A configuration file is TOML, with one key per long option of `batten smooth`:
//
//   target = "linuxcnc"
//   tolerance = "0.01mm"
//   allow = ["exact-stop"]
//   strict = true
//
// Numbers, strings and booleans count as their text on the command line, and files that they name
// are sought from the folder of the configuration file. A file that cannot be read, a key that is
// no option, and a value of another kind are problems, each with file and line.
[[nodiscard]] Given read_config(const std::string& file, Problems& problems);

// All options of such a file: those given and those with a default as they are, with where they
// come from, the others as comments. `read_config` reads it back to the same options.
[[nodiscard]] std::string config_text(const Given& given);

}  // namespace batten::postproc
