// What was given for the options of a command, still as text: on the command line, in a
// configuration file, or both.
#pragma once

#include <map>
#include <optional>
#include <set>
#include <string>
#include <string_view>
#include <vector>

namespace batten::postproc {

using Problems = std::vector<std::string>;

// Option names to the values given for them; a flag that was given has the value "true".
class Given {
 public:
  void add(std::string_view name, std::string value);

  // Of a list: each part between commas, without blanks around it. Empty parts are values, too, so
  // that they can be reported.
  void add_list(std::string_view name, std::string_view values);

  [[nodiscard]] bool has(std::string_view name) const;
  [[nodiscard]] bool flag(std::string_view name) const;

  // The value given, or nothing; `text`: or an empty one.
  [[nodiscard]] std::optional<std::string> value(std::string_view name) const;
  [[nodiscard]] std::string text(std::string_view name) const { return value(name).value_or(""); }
  [[nodiscard]] std::vector<std::string> values(std::string_view name) const;

  // Takes from `other` what is not given here.
  void complete_from(const Given& other);

  // Whether anybody has asked for it, given or not: an option without a reader would be taken and
  // do nothing.
  [[nodiscard]] bool was_read(std::string_view name) const { return read_.contains(name); }

 private:
  mutable std::set<std::string, std::less<>> read_;
  std::map<std::string, std::vector<std::string>, std::less<>> values_;
};

// A configuration file is TOML, with one key per long option of `batten smooth`:
//
//   target = "linuxcnc"
//   tolerance = "0.01mm"
//   allow = ["exact-stop"]
//   strict = true
//
// Numbers, strings and booleans count as their text on the command line. A file that cannot be
// read, a key that is no option, and a value of another kind are problems, each with file and line.
[[nodiscard]] Given read_config(const std::string& file, Problems& problems);

// All options of such a file: those given and those with a default as they are, the others as
// comments. `read_config` reads it back to the same options.
[[nodiscard]] std::string config_text(const Given& given);

}  // namespace batten::postproc
