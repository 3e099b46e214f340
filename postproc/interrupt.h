// Ctrl-C and the request to end (SIGINT, SIGTERM) as a flag that the work asks for, so that it
// stops at a place where nothing is half done.
#pragma once

namespace batten::postproc {

// From now on the first signal sets the flag; system calls that wait return with EINTR. A second
// signal ends the program at once, after the file named by `remove_when_killed` is removed.
// A broken pipe no longer ends the program: writing to it fails instead.
void install_interrupt_handlers();

[[nodiscard]] bool interrupted();

// 128 + the signal's number, as shells expect it: 130 after SIGINT, 143 after SIGTERM.
// Requires interrupted().
[[nodiscard]] int interrupt_exit_code();

// Names the half-written file that the second signal removes; an empty name: none. Names longer
// than the system allows for a path are not kept.
void remove_when_killed(const char* path);

}  // namespace batten::postproc
