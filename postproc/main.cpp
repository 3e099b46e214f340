// batten: smooths CAM programs made of short lines and proves what it wrote.

#include <fcntl.h>
#include <malloc.h>
#include <unistd.h>

#include <cstdio>
#include <exception>
#include <new>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

#include "postproc/cli/cli.h"
#include "postproc/commands/answer.h"
#include "postproc/commands/files.h"
#include "postproc/system/exit_code.h"
#include "postproc/system/interrupt.h"

namespace {

using namespace batten::postproc;

// Of end_command, where there is no memory to make it.
constexpr const char* kNoMemoryForAnswer =
    R"({"schema": "batten-report/1", "kind": "failure", "batten": ")" BATTEN_VERSION
    R"(", "command": "", "meaning": "internal error",
 "advice": "Give it more memory, or --threads 1.", "diagnostics": [],
 "exit_code": 5, "messages": ["not enough memory for a report"]}
)";

int run(const PrintText& text) { return write_result("-", text.text, false); }

// A standard stream that was closed (`2>&-`) would give its number to the next file that is opened,
// and messages would go into that file. Input and output become streams on which reading and
// writing fail, as they do on a closed one; what is said on a closed standard error is lost.
void fill_closed_streams() {
  constexpr int kModes[] = {O_WRONLY, O_RDONLY, O_WRONLY};
  for (int stream = STDIN_FILENO; stream <= STDERR_FILENO; ++stream) {
    if (::fcntl(stream, F_GETFD) >= 0) continue;
    // The lowest free number is that of the stream.
    if (::open("/dev/null", kModes[stream]) != stream) return;
  }
}

// Each stage holds a run in blocks of some megabytes and gives them back at its end. The system
// would clear them page by page for the next stage, which took a quarter of all time; so they stay
// with the program, up to a bound.
void keep_freed_memory() {
#ifdef __GLIBC__
  constexpr int kGreatestOfHeap = 32 << 20;  // the most that glibc takes; greater ones come alone
  constexpr int kKept = 64 << 20;
  ::mallopt(M_MMAP_THRESHOLD, kGreatestOfHeap);
  ::mallopt(M_TRIM_THRESHOLD, kKept);
#endif
}

int run_command_line(const std::vector<std::string>& arguments) {
  const CommandLine line = read_command_line(arguments);
  if (!line.problems.empty()) {
    for (const std::string& problem : line.problems) say(problem);
    say("nothing was done; see " + line.help_hint);
    return static_cast<int>(ExitCode::kUsage);
  }
  for (const std::string& note : line.notes) say("options " + note);
  return std::visit([](const auto& command) { return run(command); }, line.command);
}

// What ends it becomes an exit code and a message.
int run_safely(const std::vector<std::string>& arguments) {
  try {
    return run_command_line(arguments);
  } catch (const std::bad_alloc&) {
    // Plain text: there may be no memory for more.
    std::fputs("batten: not enough memory, nothing was written\n", stderr);
    answer_with("not enough memory, nothing was written");
  } catch (const std::exception& error) {
    if (std::string_view(error.what()).find("pthread_create") != std::string_view::npos) {
      say("not enough memory for threads, or too many of them, nothing was written; --threads 1 "
          "needs least");
      return static_cast<int>(ExitCode::kInternalError);
    }
    say(std::string("internal error, nothing was written: ") + error.what());
    say("please report it with the program and the options that led to it");
  } catch (...) {
    say("internal error of an unknown kind, nothing was written");
  }
  return static_cast<int>(ExitCode::kInternalError);
}

}  // namespace

int main(int argc, char** argv) {
  fill_closed_streams();
  keep_freed_memory();
  install_interrupt_handlers();
  std::vector<std::string> arguments;
  try {
    arguments.assign(argv + (argc > 0 ? 1 : 0), argv + argc);
    return end_command(run_safely(arguments), arguments);
  } catch (const std::exception&) {
    std::fputs("batten: not enough memory for a report\n", stderr);
    if (wants_json(arguments)) std::fputs(kNoMemoryForAnswer, stdout);
    return static_cast<int>(ExitCode::kInternalError);
  }
}
