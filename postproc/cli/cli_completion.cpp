#include "postproc/cli/cli_completion.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cctype>

#include "gcode/control/control.h"
#include "gcode/controls/built_in.h"
#include "gcode/state/reason.h"
#include "postproc/cli/explain.h"
#include "postproc/machine/machine.h"

namespace batten::postproc {
namespace {

// "path|band": lower-case words between bars. "NAME|FILE.toml" is no list of names.
std::vector<std::string_view> names_in(std::string_view value) {
  std::vector<std::string_view> names;
  if (value.find('|') == std::string_view::npos) return names;
  const bool plain = std::ranges::all_of(value, [](char c) {
    return std::islower(static_cast<unsigned char>(c)) != 0 || c == '|' || c == '-';
  });
  if (!plain) return names;
  while (!value.empty()) {
    const std::size_t end = std::min(value.find('|'), value.size());
    names.push_back(value.substr(0, end));
    value.remove_prefix(std::min(end + 1, value.size()));
  }
  return names;
}

// What a word without dashes can be.
std::vector<std::string_view> names_for_file(std::string_view file) {
  if (file == "ID") return explained_ids();
  if (file == "SHELL") return {"bash", "zsh"};
  return {};
}

// --- bash ---------------------------------------------------------------------------------------

std::string bash_values(const CommandRow& command) {
  std::string cases;
  for (const OptionRow& row : command.rows) {
    if (row.kind == OptionKind::kFlag) continue;
    const std::string_view brief = short_form_of(row);
    const std::string name = fmt::format("--{}{}{}", row.name, brief.empty() ? "" : "|", brief);
    const auto names = names_for(row);
    cases += fmt::format("        {}) _batten_reply {} \"{}\"; return ;;\n", name,
                         takes_file(row) ? "files" : "names", fmt::join(names, " "));
  }
  return cases;
}

std::string bash_command(const CommandRow& command) {
  std::vector<std::string> options;
  for (const OptionRow& row : command.rows) options.push_back(fmt::format("--{}", row.name));
  std::vector<std::string_view> words;
  bool files = false;
  for (const auto& [name, help] : command.files) {
    const auto names = names_for_file(name);
    words.insert(words.end(), names.begin(), names.end());
    files = files || names.empty();
  }
  return fmt::format(
      "    {})\n"
      "      case $previous in\n{}      esac\n"
      "      if [[ $word == -* ]]; then _batten_reply names \"{} --help\"\n"
      "      else _batten_reply {} \"{}\"; fi ;;\n",
      command.name, bash_values(command), fmt::join(options, " "), files ? "files" : "names",
      fmt::join(words, " "));
}

// --- zsh ----------------------------------------------------------------------------------------

// For the inside of '..[help]..' of _arguments.
std::string zsh_text(std::string_view text) {
  std::string safe;
  for (const char c : text) {
    if (c == '\'') {
      safe += "'\\''";
      continue;
    }
    if (c == '[' || c == ']' || c == ':' || c == '\\') safe += '\\';
    safe += c;
  }
  return safe;
}

std::string zsh_value(const OptionRow& row) {
  const auto names = names_for(row);
  const std::string title = zsh_text(row.value);
  if (takes_file(row) && !names.empty()) {
    // Names first, files too.
    return fmt::format(":{}:{{compadd -- {}; _files}}", title, fmt::join(names, " "));
  }
  if (takes_file(row)) return fmt::format(":{}:_files", title);
  return fmt::format(":{}:({})", title, fmt::join(names, " "));
}

std::string zsh_option(const OptionRow& row) {
  const std::string help = zsh_text(row.help);
  const std::string_view brief = short_form_of(row);
  if (row.kind == OptionKind::kFlag) return fmt::format("'--{}[{}]'", row.name, help);
  const std::string_view again = row.kind == OptionKind::kList ? "*" : "";
  std::string text = fmt::format("'{}--{}=[{}]{}'", again, row.name, help, zsh_value(row));
  if (!brief.empty()) text += fmt::format(" \\\n        '{}[{}]{}'", brief, help, zsh_value(row));
  return text;
}

std::string zsh_command(const CommandRow& command) {
  std::string text = fmt::format("    {})\n      _arguments", command.name);
  for (const OptionRow& row : command.rows) text += " \\\n        " + zsh_option(row);
  text += " \\\n        '--help[show the options]'";
  std::size_t place = 0;
  for (const auto& [name, help] : command.files) {
    const auto names = names_for_file(name);
    text += fmt::format(
        " \\\n        '{}:{}:{}'", ++place, zsh_text(name),
        names.empty() ? std::string("_files") : fmt::format("({})", fmt::join(names, " ")));
  }
  return text + " ;;\n";
}

}  // namespace

std::vector<std::string_view> names_for(const OptionRow& row) {
  std::vector<std::string_view> names = names_in(row.value);
  if (row.name == "target") {
    for (const gcode::Control& control : gcode::controls()) names.push_back(control.name);
  } else if (row.name == "machine") {
    for (const Machine& machine : built_in_machines()) names.emplace_back(machine.name);
  } else if (row.name == "allow") {
    for (const auto& each : gcode::reason::explanations()) {
      if (each.can_be_allowed) names.push_back(each.id);
    }
  }
  return names;
}

bool takes_file(const OptionRow& row) {
  return row.value.find("FILE") != std::string_view::npos ||
         row.value.find("DIR") != std::string_view::npos ||
         row.value.find("TREE") != std::string_view::npos;
}

std::string bash_completion() {
  std::vector<std::string_view> commands;
  std::string cases;
  for (const CommandRow& command : command_rows()) {
    commands.push_back(command.name);
    cases += bash_command(command);
  }
  return fmt::format(
      "# Completion of batten for bash, made by `batten completion bash`.\n"
      "\n"
      "_batten_reply() {{  # files|names WORDS\n"
      "  COMPREPLY=($(compgen -W \"$2\" -- \"$word\"))\n"
      "  [[ $1 == files ]] || return 0\n"
      "  local file\n"
      "  compopt -o filenames 2>/dev/null\n"
      "  while IFS= read -r file; do COMPREPLY+=(\"$file\"); done < <(compgen -f -- \"$word\")\n"
      "}}\n"
      "\n"
      "_batten() {{\n"
      "  COMPREPLY=()\n"
      "  local word=${{COMP_WORDS[COMP_CWORD]}} previous=${{COMP_WORDS[COMP_CWORD-1]}}\n"
      "  if (( COMP_CWORD == 1 )); then\n"
      "    _batten_reply names \"{} --help --version --explain\"\n"
      "    return\n"
      "  fi\n"
      "  case ${{COMP_WORDS[1]}} in\n"
      "{}"
      "    --explain) _batten_reply names \"{}\" ;;\n"
      "  esac\n"
      "}}\n"
      "\n"
      "complete -F _batten batten\n",
      fmt::join(commands, " "), cases, fmt::join(explained_ids(), " "));
}

std::string zsh_completion() {
  std::string commands;
  std::string cases;
  for (const CommandRow& command : command_rows()) {
    commands += fmt::format("    '{}:{}'\n", command.name, zsh_text(command.description));
    cases += zsh_command(command);
  }
  return fmt::format(
      "#compdef batten\n"
      "# Completion of batten for zsh, made by `batten completion zsh`.\n"
      "\n"
      "_batten() {{\n"
      "  local -a commands\n"
      "  commands=(\n{}  )\n"
      "  if (( CURRENT == 2 )); then\n"
      "    _describe command commands\n"
      "    return\n"
      "  fi\n"
      "  local command=$words[2]\n"
      "  shift words\n"
      "  (( CURRENT-- ))\n"
      "  case $command in\n"
      "{}"
      "  esac\n"
      "}}\n"
      "\n"
      "_batten \"$@\"\n",
      commands, cases);
}

std::optional<std::string> completion_for(std::string_view shell) {
  if (shell == "bash") return bash_completion();
  if (shell == "zsh") return zsh_completion();
  return std::nullopt;
}

}  // namespace batten::postproc
