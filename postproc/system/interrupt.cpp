#include "postproc/system/interrupt.h"

#include <unistd.h>

#include <climits>
#include <csignal>
#include <cstring>
#include <string_view>

#include "postproc/system/exit_code.h"

namespace batten::postproc {

namespace {

volatile std::sig_atomic_t received_signal = 0;
volatile std::sig_atomic_t late_work = static_cast<std::sig_atomic_t>(LateWork::kEndsAndTells);
volatile std::sig_atomic_t has_half_written = 0;
char half_written[PATH_MAX] = "";

// Below, only what may be called in a signal handler: alarm, unlink, write and _exit.

[[noreturn]] void end_now(int code) {
  if (has_half_written != 0) unlink(half_written);
  _exit(code);
}

void on_signal(int signal_number) {
  if (received_signal == 0) {
    received_signal = signal_number;
    if (late_work != static_cast<std::sig_atomic_t>(LateWork::kMayEndLater)) alarm(kPatience);
    return;
  }
  end_now(128 + signal_number);
}

void tell(std::string_view message) {
  const ssize_t told = write(STDERR_FILENO, message.data(), message.size());
  (void)told;  // nobody is left to tell it to where this fails
}

// Nobody has asked for the flag in time.
void on_patience_over(int /*signal_number*/) {
  if (received_signal == 0) return;  // somebody else's alarm
  if (late_work == static_cast<std::sig_atomic_t>(LateWork::kEndsAndTells)) {
    tell("batten: interrupted in the midst of a long search; no output was left half written\n");
  }
  end_now(128 + received_signal);
}

// A mapped file became shorter than it was, or its disk cannot be read any more. What was to be
// read is not there: there is nothing to go on with.
void on_lost_file(int /*signal_number*/) {
  tell(
      "batten: an input file became shorter or could not be read any more while it was read; "
      "no output was left half written\n");
  end_now(static_cast<int>(ExitCode::kFileError));
}

// An exception that nobody may catch: a library that cannot have another thread, or no memory where
// there must be some.
[[noreturn]] void on_terminate() {
  tell(
      "batten: internal error, mostly of missing memory or threads; no output was left half "
      "written\n");
  end_now(static_cast<int>(ExitCode::kInternalError));
}

void handle(int signal_number, void (*handler)(int)) {
  struct sigaction action = {};
  action.sa_handler = handler;
  sigemptyset(&action.sa_mask);
  action.sa_flags = 0;  // not SA_RESTART: a program that waits for input must wake up
  sigaction(signal_number, &action, nullptr);
}

// `nohup` and its like have asked for that.
bool is_ignored(int signal_number) {
  struct sigaction action = {};
  return sigaction(signal_number, nullptr, &action) == 0 && action.sa_handler == SIG_IGN;
}

}  // namespace

void install_interrupt_handlers() {
  handle(SIGINT, on_signal);
  handle(SIGTERM, on_signal);
  if (!is_ignored(SIGHUP)) handle(SIGHUP, on_signal);
  handle(SIGALRM, on_patience_over);
  handle(SIGBUS, on_lost_file);
  std::set_terminate(on_terminate);
  std::signal(SIGPIPE, SIG_IGN);
  std::signal(SIGXFSZ, SIG_IGN);
}

void when_late(LateWork work) { late_work = static_cast<std::sig_atomic_t>(work); }

bool interrupted() { return received_signal != 0; }

int interrupt_exit_code() { return 128 + received_signal; }

void remove_when_killed(const char* path) {
  has_half_written = 0;
  const std::size_t length = std::strlen(path);
  if (length == 0 || length >= sizeof half_written) return;
  std::memcpy(half_written, path, length + 1);
  has_half_written = 1;
}

}  // namespace batten::postproc
