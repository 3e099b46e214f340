#include "postproc/cli/cli_config.h"

#include <fmt/format.h>

#include <algorithm>
#include <cstdlib>
#include <system_error>
#include <vector>

#include "postproc/cli/cli_table.h"

namespace batten::postproc {
namespace {

namespace fs = std::filesystem;

std::string variable(const char* name) {
  const char* value = std::getenv(name);
  return value == nullptr ? "" : value;
}

// Empty where there is none.
fs::path config_near(const std::string& program) {
  std::error_code error;
  fs::path folder = fs::absolute(program.empty() || program == "-" ? "." : program, error);
  if (error) return {};
  folder = folder.lexically_normal();
  if (!fs::is_directory(folder, error)) folder = folder.parent_path();
  for (;; folder = folder.parent_path()) {
    if (fs::is_regular_file(folder / "batten.toml", error)) return folder / "batten.toml";
    if (folder == folder.parent_path()) return {};
  }
}

// What the command takes of it.
Given taken_by(std::string_view command, const Given& config) {
  Given taken;
  for (const OptionRow& row : option_rows(command)) {
    const auto& rows = option_rows("smooth");
    const auto same = std::ranges::find(rows, row.name, &OptionRow::name);
    if (same == rows.end() || !same->in_config || same->value != row.value) continue;
    taken.come_from(config.origin(row.name));
    for (const std::string& value : config.values(row.name)) taken.add(row.name, value);
  }
  return taken;
}

}  // namespace

fs::path user_config_file() {
  // A relative one does not count, as the XDG specification has it.
  fs::path folder = variable("XDG_CONFIG_HOME");
  if (!folder.is_absolute()) {
    const std::string home = variable("HOME");
    if (home.empty()) return {};
    folder = fs::path(home) / ".config";
  }
  return folder / "batten" / "config.toml";
}

void complete_from_configs(std::string_view command, const std::string& program, Given& given,
                           Problems& problems) {
  const auto complete = [&](const std::string& file, bool named) {
    given.complete_from(taken_by(command, read_config(file, problems)), !named);
  };
  if (const auto file = given.value("config")) complete(*file, true);
  if (const fs::path near = config_near(program); !near.empty()) complete(near.string(), false);
  if (const std::string file = variable("BATTEN_CONFIG"); !file.empty()) complete(file, false);
  std::error_code error;
  const fs::path own = user_config_file();
  if (!own.empty() && fs::is_regular_file(own, error)) complete(own.string(), false);
}

}  // namespace batten::postproc
