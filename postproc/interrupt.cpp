#include "postproc/interrupt.h"

#include <unistd.h>

#include <climits>
#include <csignal>
#include <cstring>

namespace batten::postproc {

namespace {

volatile std::sig_atomic_t received_signal = 0;
volatile std::sig_atomic_t has_half_written = 0;
char half_written[PATH_MAX] = "";

// Only what may be called in a signal handler: unlink and _exit.
void on_signal(int signal_number) {
  if (received_signal == 0) {
    received_signal = signal_number;
    return;
  }
  if (has_half_written != 0) unlink(half_written);
  _exit(128 + signal_number);
}

}  // namespace

void install_interrupt_handlers() {
  struct sigaction action = {};
  action.sa_handler = on_signal;
  sigemptyset(&action.sa_mask);
  action.sa_flags = 0;  // not SA_RESTART: a program that waits for input must wake up
  sigaction(SIGINT, &action, nullptr);
  sigaction(SIGTERM, &action, nullptr);
  std::signal(SIGPIPE, SIG_IGN);
}

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
