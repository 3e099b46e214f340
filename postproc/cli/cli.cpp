#include "postproc/cli/cli.h"

#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <array>

#include "postproc/cli/cli_commands.h"
#include "postproc/cli/cli_completion.h"
#include "postproc/cli/cli_config.h"
#include "postproc/cli/cli_given.h"
#include "postproc/cli/cli_table.h"
#include "postproc/cli/explain.h"

namespace batten::postproc {

std::vector<CommandRow> command_rows() {
  return {
      {"smooth",
       "Bend fair curves through the short G01 moves of a program and write it again, proved.",
       smooth_rows(),
       {{"IN", "the program, - is standard input"}},
       "Example:\n"
       "  batten smooth part.nc --target linuxcnc --tolerance 0.01\n"
       "writes part.smooth.nc, nowhere more than 0.01 mm from part.nc."},
      {"verify",
       "Prove that a new program does what the old one did, within a tolerance.",
       verify_rows(),
       {{"OLD", "the old program"}, {"NEW", "the new program"}},
       "Example:\n"
       "  batten verify part.nc part.smooth.nc --tolerance 0.01\n"
       "exits with 0 when proved, with 3 on a breach or without a proof."},
      {"inspect",
       "Show the runs of a program, their segments, and why the rest would be kept.",
       inspect_rows(),
       {{"IN", "the program, - is standard input"}},
       "Example:\n  batten inspect part.nc --json part.json"},
      {"time",
       "ProgressCallback how long a machine needs for a program, and where the time goes.",
       time_rows(),
       {{"FILE", "the program, - is standard input"}},
       "Examples:\n"
       "  batten time part.nc --machine linuxcnc\n"
       "  batten time part.nc --machine mill --json part.json --from 0,0,50\n"
       "  batten time part.nc --machine router.toml --profile part.csv\n"
       "The profile has a row for each millisecond: t_s, line, x_mm, y_mm, z_mm,\n"
       "feed_mm_per_min, then acceleration (mm/s2) and jerk (mm/s3) of X, Y and Z.\n"
       "Times are those of the control's model; what the text does not tell is listed."},
      {"batch",
       "Smooth all programs of a folder tree into another one; a run that was stopped goes on.",
       batch_rows(),
       {{"IN_TREE", "the folder with the programs, never written to"},
        {"OUT_TREE", "the folder for the new ones, with reports in OUT_TREE/batten-batch"}},
       "Example:\n"
       "  batten batch programs smooth --target linuxcnc --tolerance 0.01"},
      {"freecad",
       "Put the post script for FreeCAD where FreeCAD looks for posts.",
       freecad_rows(),
       {{"ACTION", "install"}},
       "Example:\n"
       "  batten freecad install\n"
       "asks the installed FreeCAD for the folder of your macros and writes batten_post.py there."},
      {"targets",
       "List the controls that programs can be written for, or show one as a profile.",
       target_list_rows(),
       {},
       "Example:\n"
       "  batten targets --show haas > mine.toml\n"
       "prints a profile; batten smooth part.nc --target mine.toml reads it."},
      {"machines",
       "List the built-in machines, or print one machine as a file.",
       machines_rows(),
       {},
       "Examples:\n"
       "  batten machines\n"
       "  batten machines --show router > my.toml\n"
       "  batten machines --show mill.ini\n"
       "  batten machines --grbl-settings settings.txt > my.toml"},
      {"methods", "List the ways of smoothing.", list_rows(), {}, "Example:\n  batten methods"},
      {"explain",
       "Say what the id of a kept run, a message or a breach means, and what to do about it.",
       {},
       {{"ID", "as it stands in a report; without it, all of them are listed"}},
       "Example:\n  batten explain exact-stop"},
      {"completion",
       "Write the completion of commands and options for a shell.",
       {},
       {{"SHELL", "bash or zsh"}},
       "Example:\n  batten completion bash > ~/.local/share/bash-completion/completions/batten"},
      {"man", "Write the manual page.", {}, {}, "Example:\n  batten man | man -l -"},
  };
}

std::string_view short_form_of(const OptionRow& row) { return row.name == "out" ? "-o" : ""; }

namespace {

constexpr std::string_view kExitCodes =
    "Exit codes: 0 done, 1 wrong options, 2 program not understood, 3 not proved, 4 file error,\n"
    "5 internal error. `batten COMMAND --help` tells more about a command, `batten explain ID`\n"
    "about an id in a message or a report.";

void add_row(const OptionRow& row, CLI::App& command) {
  const std::string_view brief = short_form_of(row);
  const std::string name = fmt::format("{}{}--{}", brief, brief.empty() ? "" : ",", row.name);
  std::string help(row.help);
  if (row.kind == OptionKind::kFlag) {
    command.add_flag(name)->description(help);
    return;
  }
  if (!row.default_value.empty()) help += fmt::format("; default: {}", row.default_value);
  CLI::Option* option =
      command.add_option(name)->description(help)->type_name(std::string(row.value));
  if (row.kind == OptionKind::kList) {
    option->multi_option_policy(CLI::MultiOptionPolicy::TakeAll)->expected(1);
  }
}

void add_command(const CommandRow& row, CLI::App& app) {
  CLI::App* command = app.add_subcommand(std::string(row.name), std::string(row.description));
  command->allow_extras();  // told of together with everything else
  command->footer(std::string(row.example));
  for (const auto& [name, help] : row.files) {
    command->add_option(std::string(name))->description(std::string(help))->type_name("");
  }
  for (const OptionRow& option : row.rows) add_row(option, *command);
}

Given given_in(const CLI::App& command, std::span<const OptionRow> rows) {
  Given given;
  for (const OptionRow& row : rows) {
    const CLI::Option* option = command.get_option("--" + std::string(row.name));
    if (option->count() == 0) continue;
    if (row.kind == OptionKind::kFlag) {
      given.add(row.name, "true");
      continue;
    }
    for (const std::string& value : option->results()) {
      row.kind == OptionKind::kList ? given.add_list(row.name, value) : given.add(row.name, value);
    }
  }
  return given;
}

// The words that are no options, in order; unknown options become problems.
std::vector<std::string> files_in(const CLI::App& command, const CommandRow& row,
                                  Problems& problems) {
  std::vector<std::string> files;
  for (const auto& [name, help] : row.files) {
    for (const std::string& file : command.get_option(std::string(name))->results()) {
      files.push_back(file);
    }
  }
  std::vector<std::string_view> names;
  for (const OptionRow& option : row.rows) names.push_back(option.name);
  bool unknown_option = false;
  for (const std::string& word : command.remaining()) {
    if (!word.starts_with("-") || word == "-") {
      // After an unknown option it is likely the value of that option.
      if (!unknown_option) files.push_back(word);
      continue;
    }
    unknown_option = true;
    const std::string name = word.substr(word.find_first_not_of('-'));
    const std::string_view nearest = nearest_name(name.substr(0, name.find('=')), names);
    problems.push_back(
        fmt::format("{}: {} has no such option{}", word, row.name,
                    nearest.empty() ? "" : fmt::format(", did you mean --{}?", nearest)));
  }
  return files;
}

Command smooth_or_config(Given given, const std::vector<std::string>& files, Problems& problems) {
  if (const auto file = given.value("config")) {
    given.complete_from(read_config(*file, problems));
  }
  SmoothCommand command = smooth_command(given, files, problems);
  if (given.flag("print-config")) return PrintText{config_text(given)};
  return command;
}

void refuse_words_after(std::size_t expected, const std::vector<std::string>& words,
                        Problems& problems) {
  for (std::size_t i = expected; i < words.size(); ++i) {
    problems.push_back(fmt::format("'{}': one word too many", words[i]));
  }
}

PrintText explain_text(const std::vector<std::string>& words, Problems& problems) {
  refuse_words_after(1, words, problems);
  if (words.empty()) return {all_explanations()};
  const auto ids = explained_ids();
  const std::string text = explanation_of(words.front());
  if (text.empty()) {
    const std::string_view nearest = nearest_name(words.front(), ids);
    problems.push_back(fmt::format(
        "there is no reason, message or breach '{}'{}; batten explain lists all", words.front(),
        nearest.empty() ? "" : fmt::format(", did you mean '{}'?", nearest)));
  }
  return {text};
}

PrintText completion_text(const std::vector<std::string>& words, Problems& problems) {
  refuse_words_after(1, words, problems);
  const auto text = completion_for(words.empty() ? "" : words.front());
  if (!text) {
    problems.push_back(
        words.empty()
            ? std::string("SHELL: no shell given; possible: bash, zsh")
            : fmt::format("there is no completion for '{}'; possible: bash, zsh", words.front()));
  }
  return {text.value_or("")};
}

PrintText man_text(const std::vector<std::string>& words, Problems& problems) {
  refuse_words_after(0, words, problems);
  return {man_page()};
}

// `batten --explain ID` is `batten explain ID`.
std::vector<std::string> with_explain_as_command(std::vector<std::string> arguments) {
  constexpr std::string_view kOption = "--explain";
  if (arguments.empty() || !arguments.front().starts_with(kOption)) return arguments;
  const std::string rest = arguments.front().substr(kOption.size());
  if (!rest.empty() && rest.front() != '=') return arguments;
  arguments.front() = "explain";
  if (!rest.empty()) arguments.insert(arguments.begin() + 1, rest.substr(1));
  return arguments;
}

BatchCommand batch_with_config(Given given, const std::vector<std::string>& files,
                               Problems& problems) {
  if (const auto file = given.value("config")) {
    given.complete_from(read_config(*file, problems));
  }
  return batch_command(given, files, problems);
}

Command command_of(std::string_view name, const Given& given, const std::vector<std::string>& files,
                   Problems& problems) {
  if (name == "smooth") return smooth_or_config(given, files, problems);
  if (name == "verify") return verify_command(given, files, problems);
  if (name == "inspect") return inspect_command(given, files, problems);
  if (name == "time") return time_command(given, files, problems);
  if (name == "batch") return batch_with_config(given, files, problems);
  if (name == "freecad") return freecad_command(given, files, problems);
  if (name == "targets") return list_command(BuiltIn::kTargets, given, files, problems);
  if (name == "machines") return machines_command(given, files, problems);
  if (name == "methods") return list_command(BuiltIn::kMethods, given, files, problems);
  if (name == "explain") return explain_text(files, problems);
  if (name == "completion") return completion_text(files, problems);
  return man_text(files, problems);
}

// The command line as one could type it again.
std::string shell_words(const std::vector<std::string>& arguments) {
  constexpr std::string_view kPlain =
      "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789_./:+,@%=-";
  std::string text = "batten";
  for (const std::string& word : arguments) {
    text += ' ';
    if (!word.empty() && word.find_first_not_of(kPlain) == std::string::npos) {
      text += word;
      continue;
    }
    text += '\'';
    for (const char c : word) text += c == '\'' ? std::string("'\\''") : std::string(1, c);
    text += '\'';
  }
  return text;
}

std::string no_command(const CLI::App& app, const std::vector<CommandRow>& rows) {
  std::string possible;
  std::vector<std::string_view> names;
  for (const CommandRow& row : rows) {
    possible += (possible.empty() ? "" : ", ") + std::string(row.name);
    names.push_back(row.name);
  }
  const auto words = app.remaining();
  if (words.empty()) return "no command given; possible: " + possible;
  const std::string_view nearest = nearest_name(words.front(), names);
  return fmt::format("there is no command '{}'{}; possible: {}", words.front(),
                     nearest.empty() ? "" : fmt::format(", did you mean '{}'?", nearest), possible);
}

}  // namespace

CommandLine read_command_line(const std::vector<std::string>& given_arguments) {
  const std::vector<std::string> arguments = with_explain_as_command(given_arguments);
  CLI::App app("Smooths CAM programs made of short lines and proves what it wrote.", "batten");
  app.set_version_flag("--version", std::string("batten " BATTEN_VERSION));
  app.footer(std::string(kExitCodes));
  app.require_subcommand(0, 1);
  app.allow_extras();
  const auto rows = command_rows();
  for (const CommandRow& row : rows) add_command(row, app);

  CommandLine line;
  line.help_hint = "batten --help";
  std::vector<std::string> reversed(arguments.rbegin(), arguments.rend());  // as CLI11 wants it
  try {
    app.parse(reversed);
  } catch (const CLI::CallForHelp&) {
    line.command = PrintText{app.help()};
    return line;
  } catch (const CLI::CallForVersion& version) {
    line.command = PrintText{std::string(version.what()) + "\n"};
    return line;
  } catch (const CLI::ParseError& error) {
    line.problems.emplace_back(error.what());
    return line;
  }

  const auto commands = app.get_subcommands();
  if (commands.empty()) {
    line.problems.push_back(no_command(app, rows));
    return line;
  }
  const CLI::App& command = *commands.front();
  const auto row = std::ranges::find(rows, command.get_name(), &CommandRow::name);
  line.help_hint = "batten " + command.get_name() + " --help";
  const Given given = given_in(command, row->rows);
  const auto files = files_in(command, *row, line.problems);
  line.command = command_of(command.get_name(), given, files, line.problems);
  if (auto* smooth = std::get_if<SmoothCommand>(&line.command)) {
    smooth->command_line = shell_words(arguments);
  }
  return line;
}

}  // namespace batten::postproc
