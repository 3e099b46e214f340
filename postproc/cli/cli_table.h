// The commands of the program and their options as one table: what help, the manual page, the
// completions of shells and configuration files are made from.
#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace batten::postproc {

enum class OptionKind {
  kValue,  // --name VALUE, once
  kList,   // --name VALUE, as often as wanted, or several with commas
  kTexts,  // --name VALUE, as often as wanted; commas are part of it
  kFlag,   // --name
};

// An option to add: a row in the .cpp, a line in cli_commands.cpp that reads its value.
struct OptionRow {
  std::string_view name;  // without the dashes
  OptionKind kind = OptionKind::kValue;
  std::string_view value = {};          // how help calls the value
  std::string_view help = {};           // one line
  std::string_view default_value = {};  // what counts when it is not given; may be empty
  bool in_config = false;               // may stand in a configuration file
};

// A command to add: a row in the .cpp, a line in command_of (cli.cpp).
struct CommandRow {
  std::string_view name;
  std::string_view description;
  std::vector<OptionRow> rows;
  std::vector<std::pair<std::string_view, std::string_view>> files;  // name, help
  std::string_view example;
};

[[nodiscard]] const std::vector<CommandRow>& command_rows();

[[nodiscard]] constexpr bool may_be_repeated(const OptionRow& row) {
  return row.kind == OptionKind::kList || row.kind == OptionKind::kTexts;
}

// Requires that there is such a command.
[[nodiscard]] const std::vector<OptionRow>& option_rows(std::string_view command);

// "-o" for --out: the one option with a short form.
[[nodiscard]] std::string_view short_form_of(const OptionRow& row);

// Completion of commands, options and their values, by the name of a shell: "bash" or "zsh";
// nothing for others.
[[nodiscard]] std::optional<std::string> completion_for(std::string_view shell);

// The manual page batten(1) in the man macros of roff.
[[nodiscard]] std::string man_page();

}  // namespace batten::postproc
