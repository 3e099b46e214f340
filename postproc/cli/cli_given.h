// The options of `batten smooth` as one table, and what was given for them, still as text: on the
// command line, in a configuration file, or both.
#pragma once

#include <map>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace batten::postproc {

enum class OptionKind {
  kValue,  // --name VALUE, once
  kList,   // --name VALUE, as often as wanted
  kFlag,   // --name
};

struct OptionRow {
  std::string_view name;  // without the dashes
  OptionKind kind = OptionKind::kValue;
  std::string_view value = {};          // how help calls the value
  std::string_view help = {};           // one line
  std::string_view default_value = {};  // what counts when it is not given; may be empty
  bool in_config = false;               // may stand in a configuration file
};

// An option to add: a row here, a line in cli_commands.cpp that reads its value.
[[nodiscard]] std::span<const OptionRow> smooth_rows();
[[nodiscard]] std::span<const OptionRow> verify_rows();
[[nodiscard]] std::span<const OptionRow> inspect_rows();
[[nodiscard]] std::span<const OptionRow> target_list_rows();
[[nodiscard]] std::span<const OptionRow> time_rows();
// Those of `smooth` that a configuration file may hold, and own ones.
[[nodiscard]] std::span<const OptionRow> batch_rows();
[[nodiscard]] std::span<const OptionRow> freecad_rows();
[[nodiscard]] std::span<const OptionRow> list_rows();
[[nodiscard]] std::span<const OptionRow> machines_rows();

// Option names to the values given for them; a flag that was given has the value "true".
class Given {
 public:
  void add(std::string_view name, std::string value);

  // Of an option that takes a list: each part between commas, without the blanks around it. Empty
  // parts are values, too, so that they can be told of.
  void add_list(std::string_view name, std::string_view values);

  [[nodiscard]] bool has(std::string_view name) const;
  [[nodiscard]] bool flag(std::string_view name) const;

  // The value given, or nothing.
  [[nodiscard]] std::optional<std::string> value(std::string_view name) const;
  [[nodiscard]] std::vector<std::string> values(std::string_view name) const;

  // Takes from `other` what is not given here.
  void complete_from(const Given& other);

 private:
  std::map<std::string, std::vector<std::string>, std::less<>> values_;
};

}  // namespace batten::postproc
