// `batten setup`: asks for what a user would give with every program, or takes it from options.

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <filesystem>
#include <iostream>
#include <string>

#include "gcode/controls/built_in.h"
#include "postproc/cli/cli.h"
#include "postproc/cli/cli_config.h"
#include "postproc/cli/cli_table.h"
#include "postproc/commands/files.h"
#include "postproc/machine/machine.h"
#include "postproc/system/output_file.h"
#include "postproc/text/words.h"

namespace batten::postproc {
namespace {

constexpr std::array<std::string_view, 5> kKept = {"target", "machine", "grbl-settings",
                                                   "tolerance", "units"};

// Names of files are kept so that they mean the same from every folder.
void make_absolute(std::string_view option, std::string& value) {
  const bool is_file = option == "grbl-settings" || value.ends_with(".toml") ||
                       (option == "machine" && value.ends_with(".ini"));
  if (is_file) value = std::filesystem::absolute(value).lexically_normal().string();
}

// What is wrong with these options, as `smooth` would say it.
Problems problems_in(const Given& kept) {
  Arguments check = {kept, {}};
  check.given.add("print-config", "true");
  (void)smooth_command(check);
  return check.problems;
}

std::string machine_by_default(const Given& kept) {
  const gcode::Control* target = gcode::find_control(kept.text("target"));
  return target == nullptr ? "" : std::string(target->machine);
}

// A question, the option that its answer is for, and the answer of an empty line.
void ask(std::string_view question, std::string_view option, const std::string& usual, Given& kept,
         Problems& problems) {
  for (;;) {
    say_lines(fmt::format("{}{}\n> ", question, usual.empty() ? "" : fmt::format(" [{}]", usual)));
    std::string answer;
    if (!std::getline(std::cin, answer)) {
      problems.push_back(fmt::format("--{}: no answer; give it as an option", option));
      return;
    }
    answer = std::string(trimmed(answer, " \t\r"));
    if (answer.empty()) answer = usual;
    if (answer.empty() && option != "target") return;
    // Any other file is what grbl answered.
    std::error_code error;
    const bool settings = option == "machine" && !answer.ends_with(".toml") &&
                          !answer.ends_with(".ini") &&
                          std::filesystem::is_regular_file(answer, error);
    Given with = kept;
    const std::string_view name = settings ? "grbl-settings" : option;
    make_absolute(name, answer);
    with.add(name, answer);
    const Problems wrong =
        answer.empty() ? Problems{"--target: no control named"} : problems_in(with);
    if (wrong.empty()) {
      kept = with;
      return;
    }
    for (const std::string& problem : wrong) say(problem);
  }
}

void ask_all(Given& kept, Problems& problems) {
  ask("Which control runs your programs? (a name of `batten targets`, or a profile NAME.toml)",
      "target", "", kept, problems);
  if (!problems.empty()) return;
  ask("Its machine? (a name of `batten machines`, a NAME.toml, the NAME.ini of LinuxCNC, the "
      "NAME.cfg of Klipper, or a file with what grbl answers to $$)",
      "machine", machine_by_default(kept), kept, problems);
  if (!problems.empty()) return;
  ask("How far may the new path be from the old one?", "tolerance", "0.01mm", kept, problems);
  if (!problems.empty()) return;
  ask("Units of programs that do not say theirs? (mm, inch; an empty line: such programs are "
      "refused)",
      "units", "", kept, problems);
}

std::string text_of(Given kept) {
  const std::string machine = machine_by_default(kept);
  if (!kept.has("machine") && !kept.has("grbl-settings") && !machine.empty()) {
    kept.add("machine", machine);
  }
  std::string text =
      "# Options of batten, by `batten setup`. A batten.toml near a program goes before them, the\n"
      "# command line before all; batten smooth --print-config lists all options.\n";
  for (const std::string_view option : kKept) {
    if (const auto value = kept.value(option)) {
      text += fmt::format("{} = {}\n", option, toml_quoted(*value));
    }
  }
  return text;
}

}  // namespace

SetupCommand setup_command(Arguments& in) {
  SetupCommand command;
  command.force = in.given.flag("force");
  command.file = in.given.value("out").value_or(user_config_file().string());
  command.json_file = in.given.text("json");
  const std::string& json = command.json_file;
  if (!json.empty() && (json == command.file || same_file(json, command.file))) {
    in.complain("--json: {} takes the options already", json);
  }
  refuse_words_after(0, "word", in);
  if (command.file.empty())
    in.complain("--out: no home folder is known, so name the file to write");
  Given kept;
  for (const std::string_view option : kKept) {
    if (auto value = in.given.value(option)) {
      make_absolute(option, *value);
      kept.add(option, *value);
    }
  }
  if (in.problems.empty()) in.problems = problems_in(kept);
  std::error_code error;
  command.asks =
      in.problems.empty() && (command.force || !std::filesystem::exists(command.file, error));
  if (std::ranges::any_of(kKept, [&](auto option) { return kept.has(option); })) {
    command.asks = false;
    command.text = text_of(kept);
  }
  return command;
}

void ask_for_setup(SetupCommand& command, Problems& problems) {
  Given kept;
  ask_all(kept, problems);
  command.text = text_of(kept);
}

}  // namespace batten::postproc
