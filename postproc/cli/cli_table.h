// The commands of the program as one table: what help, the manual page and the completions of
// shells are made from.
#pragma once

#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "postproc/cli/cli_given.h"

namespace batten::postproc {

struct CommandRow {
  std::string_view name;
  std::string_view description;
  std::span<const OptionRow> rows;
  std::vector<std::pair<std::string_view, std::string_view>> files;  // name, help
  std::string_view example;
};

// A command to add: a row here, a line in command_of (cli.cpp).
[[nodiscard]] std::vector<CommandRow> command_rows();

// "-o" for --out: the one option with a short form.
[[nodiscard]] std::string_view short_form_of(const OptionRow& row);

// The manual page, made from the table of commands.

// batten(1) in the man macros of roff.
[[nodiscard]] std::string man_page();

}  // namespace batten::postproc
