#include "postproc/batch/process_pool.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <poll.h>
#include <sys/prctl.h>
#include <sys/wait.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <csignal>
#include <utility>

#include "postproc/system/output_file.h"

namespace batten::postproc {

namespace {

// What a job ends with when `work` threw: no shell's and no Batten's own code.
constexpr int kThrown = 70;

// Never returns. `parent` is asked for again since it may have ended before the request.
[[noreturn]] void run_job(const std::function<std::string(std::size_t)>& work, std::size_t job,
                          int pipe, pid_t parent) {
  ::prctl(PR_SET_PDEATHSIG, SIGKILL);
  if (::getppid() != parent) ::_exit(kThrown);
  int code = 0;
  try {
    const WriteResult result = write_to_descriptor(pipe, "pipe", work(job));
    code = result.status == WriteStatus::kWritten ? 0 : kThrown;
  } catch (...) {
    code = kThrown;
  }
  ::_exit(code);  // buffers of the copied process belong to the parent
}

int wait_for(pid_t process) {
  int status = 0;
  while (::waitpid(process, &status, 0) < 0 && errno == EINTR) {
  }
  return status;
}

std::string trouble_in(int status) {
  if (WIFSIGNALED(status)) return fmt::format("ended by signal {}", WTERMSIG(status));
  const int code = WEXITSTATUS(status);
  return code == 0 ? "" : fmt::format("ended with code {}", code);
}

}  // namespace

ProcessPool::ProcessPool(std::size_t most, std::function<std::string(std::size_t)> work)
    : most_(most), work_(std::move(work)) {}

ProcessPool::~ProcessPool() {
  for (const Running& running : running_) {
    ::kill(running.process, SIGKILL);
    wait_for(running.process);
    ::close(running.pipe);
  }
}

bool ProcessPool::start(std::size_t job) {
  std::array<int, 2> ends{};
  if (::pipe2(ends.data(), O_CLOEXEC) != 0) return false;
  const pid_t parent = ::getpid();
  const pid_t process = ::fork();
  if (process == 0) {
    ::close(ends[0]);
    run_job(work_, job, ends[1], parent);
  }
  ::close(ends[1]);
  if (process < 0) {
    ::close(ends[0]);
    return false;
  }
  running_.push_back({job, process, ends[0], {}});
  return true;
}

std::optional<JobEnd> ProcessPool::wait(std::chrono::milliseconds longest) {
  std::vector<pollfd> pipes;
  pipes.reserve(running_.size());
  for (const Running& running : running_) pipes.push_back({running.pipe, POLLIN, 0});
  if (::poll(pipes.data(), pipes.size(), static_cast<int>(longest.count())) <= 0) {
    return std::nullopt;
  }
  for (std::size_t i = 0; i < pipes.size(); ++i) {
    if (pipes[i].revents == 0) continue;
    if (auto end = read_from(i)) return end;
  }
  return std::nullopt;
}

// The end of the pipe is the end of the job.
std::optional<JobEnd> ProcessPool::read_from(std::size_t index) {
  std::array<char, 4096> part{};
  Running& running = running_[index];
  const ssize_t count = ::read(running.pipe, part.data(), part.size());
  if (count > 0) {
    running.answer.append(part.data(), static_cast<std::size_t>(count));
    return std::nullopt;
  }
  if (count < 0 && (errno == EINTR || errno == EAGAIN)) return std::nullopt;
  ::close(running.pipe);
  JobEnd end{running.job, std::move(running.answer), trouble_in(wait_for(running.process))};
  running_.erase(running_.begin() + static_cast<std::ptrdiff_t>(index));
  return end;
}

void ProcessPool::stop() const {
  for (const Running& running : running_) ::kill(running.process, SIGTERM);
}

}  // namespace batten::postproc
