// batten: smooths CAM programs made of short lines and proves what it wrote.

#include <cstdio>
#include <exception>
#include <string>
#include <variant>
#include <vector>

#include "postproc/cli.h"
#include "postproc/commands/files.h"
#include "postproc/exit_code.h"
#include "postproc/interrupt.h"

namespace {

using namespace batten::postproc;

int done(const PrintText& text) { return write_result("-", text.text, false); }

template <typename AnyCommand>
int done(const AnyCommand& command) {
  return run(command);
}

int run_command_line(const std::vector<std::string>& arguments) {
  const CommandLine line = read_command_line(arguments);
  if (!line.problems.empty()) {
    for (const std::string& problem : line.problems) say(problem);
    say("nothing was done; see " + line.help_hint);
    return static_cast<int>(ExitCode::kUsage);
  }
  return std::visit([](const auto& command) { return done(command); }, line.command);
}

}  // namespace

int main(int argc, char** argv) {
  install_interrupt_handlers();
  try {
    return run_command_line(std::vector<std::string>(argv + (argc > 0 ? 1 : 0), argv + argc));
  } catch (const std::exception& error) {
    say(std::string("internal error, nothing was written: ") + error.what());
    say("please report it with the program and the options that led to it");
  } catch (...) {
    say("internal error of an unknown kind, nothing was written");
  }
  return static_cast<int>(ExitCode::kInternalError);
}
