#include "postproc/cli/cli_smooth_options.h"

#include <algorithm>
#include <optional>
#include <string>
#include <utility>

#include "postproc/cli/cli_arguments.h"

namespace batten::postproc {

namespace {

void read_target(const Given& given, SmoothCommand& command, Problems& problems) {
  GivenTarget target = target_given(given, problems);
  if (target.is_wrong) return;
  command.options.target = target.built_in;
  if (target.profile != nullptr) {
    command.profile = std::move(target.profile);
    command.options.target = &command.profile->adapted;
    command.options.words = command.profile->words;
    command.options.profile = command.profile->file;
  }
  if (command.options.target != nullptr) return;
  std::string possible;
  for (const auto each : target_names()) {
    possible += (possible.empty() ? "" : ", ") + std::string(each);
  }
  problems.push_back("--target: no target given; possible: " + possible +
                     ", or a profile NAME.toml");
}

void read_machine(const Given& given, SmoothCommand& command, Problems& problems) {
  const gcode::Control* target = command.options.target;
  command.own_machine = machine_given(given, target == nullptr ? "" : target->machine, problems);
  command.options.machine = command.own_machine.get();
}

void read_tolerance_into(const Given& given, SmoothOptions& options, Problems& problems) {
  const auto text = given.value("tolerance");
  if (!text) return;
  const auto tolerance = read_tolerance(*text, problems);
  if (!tolerance) return;
  options.tolerance_mm = tolerance->mm;
  options.tolerance_inch = tolerance->inch;
}

}  // namespace

void read_tolerance_kind_into(geometry::ToleranceKind& kind, const Given& given,
                              Problems& problems) {
  if (const auto text = given.value("tolerance-kind")) {
    read_into(kind, read_choice("tolerance-kind", *text, tolerance_kinds(), problems));
  }
}

void read_side_into(geometry::Side& side, const Given& given, Problems& problems) {
  if (const auto text = given.value("side")) {
    read_into(side, read_choice("side", *text, sides(), problems));
  }
}

void read_smooth_options(const Given& given, SmoothCommand& command, Problems& problems) {
  SmoothOptions& options = command.options;
  read_target(given, command, problems);
  read_machine(given, command, problems);
  read_tolerance_into(given, options, problems);
  read_tolerance_kind_into(options.tolerance_kind, given, problems);
  read_side_into(options.side, given, problems);
  read_units_into(options.units, given, problems);
  read_source_into(options.source, given, problems);
  read_decimals_into(options.decimals, given, problems);
  if (const auto text = given.value("method")) {
    read_into(options.method, read_choice("method", *text, methods(), problems));
  }
  if (const auto text = given.value("output")) {
    read_into(options.output, read_choice("output", *text, forms(), problems));
  }
  if (const auto text = given.value("prefer")) {
    read_into(options.prefer, read_choice("prefer", *text, preferences(), problems));
  }
  if (const auto text = given.value("linearize")) {
    options.linearize = read_choice("linearize", *text, linearizations(), problems);
  }
  if (const auto text = given.value("keep-corners")) {
    options.keep_corners_deg = read_decimal("keep-corners", *text, problems);
  }
  if (const auto text = given.value("threads")) {
    read_into(options.threads, read_integer("threads", *text, problems));
  }
  options.allowed = given.values("allow");
  options.convert = given.flag("convert");
}

void check_options(const SmoothOptions& options, const Given& given, Problems& problems) {
  for (std::string& problem : problems_of(options)) {
    const std::string option = problem.substr(0, problem.find(':'));
    const bool said = std::ranges::any_of(
        problems, [&](const std::string& other) { return other.starts_with(option + ":"); });
    const bool follows =
        option == "--machine" &&
        (options.target == nullptr || given.has("machine") || given.has("grbl-settings"));
    if (!said && !follows) problems.push_back(std::move(problem));
  }
}

}  // namespace batten::postproc
