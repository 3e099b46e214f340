#include "postproc/cli/cli.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <CLI/CLI.hpp>
#include <algorithm>

#include "postproc/cli/cli_table.h"
#include "postproc/report/smooth_report.h"
#include "postproc/text/explain.h"
#include "postproc/text/words.h"

namespace batten::postproc {

namespace {

constexpr std::string_view kExitCodes =
    "Exit codes: 0 done, 1 wrong options, 2 program not understood, 3 not proved, 4 file error,\n"
    "5 internal error. `batten COMMAND --help` shows more about a command, `batten explain ID`\n"
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
  if (may_be_repeated(row)) {
    option->multi_option_policy(CLI::MultiOptionPolicy::TakeAll)->expected(1);
  }
}

void add_command(const CommandRow& row, CLI::App& app) {
  CLI::App* command = app.add_subcommand(std::string(row.name), std::string(row.description));
  command->allow_extras();  // reported together with everything else
  command->footer(std::string(row.example));
  for (const auto& [name, help] : row.files) {
    command->add_option(std::string(name))->description(std::string(help))->type_name("");
  }
  for (const OptionRow& option : row.rows) add_row(option, *command);
}

Given given_in(const CLI::App& command, const CommandRow& row) {
  Given given;
  for (const OptionRow& option : row.rows) {
    const CLI::Option* found = command.get_option("--" + std::string(option.name));
    if (found->count() == 0) continue;
    if (option.kind == OptionKind::kFlag) {
      given.add(option.name, "true");
      continue;
    }
    for (const std::string& value : found->results()) {
      option.kind == OptionKind::kList ? given.add_list(option.name, value)
                                       : given.add(option.name, value);
    }
  }
  return given;
}

// The words that are no options in their order; unknown options become problems.
Arguments arguments_of(const CLI::App& command, const CommandRow& row) {
  Arguments in = {given_in(command, row), {}};
  for (const auto& [name, help] : row.files) {
    const auto& words = command.get_option(std::string(name))->results();
    in.files.insert(in.files.end(), words.begin(), words.end());
  }
  std::vector<std::string_view> names;
  for (const OptionRow& option : row.rows) names.push_back(option.name);
  bool unknown_option = false;
  for (const std::string& word : command.remaining()) {
    if (!word.starts_with("-") || word == "-") {
      // After an unknown option it is likely the value of that option.
      if (!unknown_option) in.files.push_back(word);
      continue;
    }
    unknown_option = true;
    const std::string name = word.substr(word.find_first_not_of('-'));
    const std::string_view nearest = nearest_name(name.substr(0, name.find('=')), names);
    in.complain("{}: {} has no such option{}", word, row.name,
                nearest.empty() ? "" : fmt::format(", did you mean --{}?", nearest));
  }
  return in;
}

PrintText explain_text(Arguments& in) {
  refuse_words_after(1, "word", in);
  if (in.files.empty()) return {all_explanations()};
  const std::string& id = in.files.front();
  const std::string text = explanation_of(id);
  if (text.empty()) {
    in.complain("there is no reason, message or violation '{}'{}; batten explain lists all", id,
                suggestion(id, explained_ids()));
  }
  return {text};
}

PrintText completion_text(Arguments& in) {
  refuse_words_after(1, "word", in);
  const auto text = completion_for(in.files.empty() ? "" : in.files.front());
  if (!text && in.files.empty()) in.complain("SHELL: no shell given; possible: bash, zsh");
  if (!text && !in.files.empty()) {
    in.complain("there is no completion for '{}'; possible: bash, zsh", in.files.front());
  }
  return {text.value_or("")};
}

// `batten help COMMAND` is `batten COMMAND --help`.
std::vector<std::string> with_help_as_option(std::vector<std::string> arguments) {
  if (arguments.empty() || arguments.front() != "help") return arguments;
  arguments.erase(arguments.begin());
  arguments.emplace_back("--help");
  return arguments;
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

Command any_command_of(std::string_view name, Arguments& in) {
  if (name == "explain") return explain_text(in);
  if (name == "completion") return completion_text(in);
  if (name != "man") return command_of(name, in);
  refuse_words_after(0, "word", in);
  return PrintText{man_page()};
}

std::string no_command(const CLI::App& app) {
  std::vector<std::string_view> names;
  for (const CommandRow& row : command_rows()) names.push_back(row.name);
  const auto words = app.remaining();
  const std::string wrong = words.empty() ? "no command given"
                                          : fmt::format("there is no command '{}'{}", words.front(),
                                                        suggestion(words.front(), names));
  return fmt::format("{}; possible: {}", wrong, fmt::join(names, ", "));
}

}  // namespace

CommandLine read_command_line(const std::vector<std::string>& given_arguments) {
  const std::vector<std::string> arguments =
      with_help_as_option(with_explain_as_command(given_arguments));
  CLI::App app("Smooths CAM programs made of short lines and proves what it wrote.", "batten");
  app.set_version_flag("-V,--version", std::string("batten " BATTEN_VERSION));
  app.footer(std::string(kExitCodes));
  app.require_subcommand(0, 1);
  app.allow_extras();
  for (const CommandRow& row : command_rows()) add_command(row, app);

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
    line.problems.push_back(no_command(app));
    return line;
  }
  const CLI::App& command = *commands.front();
  const std::string name = command.get_name();
  line.help_hint = "batten " + name + " --help";
  Arguments in = arguments_of(command, *std::ranges::find(command_rows(), name, &CommandRow::name));
  line.command = any_command_of(name, in);
  line.problems = std::move(in.problems);
  if (auto* setup = std::get_if<SetupCommand>(&line.command); setup != nullptr && setup->asks) {
    ask_for_setup(*setup, line.problems);
  }
  const bool smooths = std::holds_alternative<SmoothCommand>(line.command);
  if (!smooths && !in.given.flag("quiet") && !std::holds_alternative<SetupCommand>(line.command)) {
    line.notes = texts_of_origins(in.given.origins());
  }
  const std::string again = command_line_of(arguments);
  std::visit(
      [&again](auto& read) {
        if constexpr (requires { read.command_line; }) {
          read.command_line = again;
        } else if constexpr (requires { read.smooth; }) {
          read.smooth.command_line = again;
        } else if constexpr (requires { read.each; }) {
          for (auto& each : read.each) each.command_line = again;
        }
      },
      line.command);
  return line;
}

}  // namespace batten::postproc
