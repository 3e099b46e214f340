// Ctrl-C, the request to end and a terminal that was closed (SIGINT, SIGTERM, SIGHUP) as a flag
// that the work asks for, so that it stops at a place where nothing is half done.
#pragma once

namespace batten::postproc {

// From now on the first signal sets the flag; system calls that wait return with EINTR. Work that
// does not end within kPatience after it, in the midst of one long search, is ended as a second
// signal ends the program: at once, after the file named by `remove_when_killed` is removed. So do,
// with a message: a mapped file that becomes shorter than it was (SIGBUS), with the code of a file
// error, and an exception that nobody may catch, with the code of an internal error. A broken pipe
// and a file beyond the size that is allowed (ulimit -f) no longer end the program: writing fails
// instead. SIGHUP stays ignored where it is, as under nohup.
void install_interrupt_handlers();

// Seconds.
inline constexpr unsigned kPatience = 1;

// What becomes of work that does not end in time. A process that only looks after the work of
// others has to wait for them; these have nobody to tell.
enum class LateWork { kEndsAndTells, kEnds, kMayEndLater };
void when_late(LateWork work);  // at first kEndsAndTells; child processes inherit it

[[nodiscard]] bool interrupted();

// 128 + the signal's number, as shells expect it: 130 after SIGINT, 143 after SIGTERM, 129 after
// SIGHUP. Requires interrupted().
[[nodiscard]] int interrupt_exit_code();

// Names the half-written file that the second signal removes; an empty name: none. Names longer
// than the system allows for a path are not kept.
void remove_when_killed(const char* path);

}  // namespace batten::postproc
