// Jobs in processes of their own, several at a time: a job that crashes or takes too much memory
// ends alone, and jobs share nothing. The processes are copies of this one (fork), so it must have
// no other threads; they end when it ends, however it ends.
#pragma once

#include <sys/types.h>

#include <chrono>
#include <cstddef>
#include <functional>
#include <optional>
#include <string>
#include <vector>

namespace batten::postproc {

struct JobEnd {
  std::size_t job = 0;
  std::string answer;   // what the job returned
  std::string trouble;  // not empty: it ended without an answer, and how
};

class ProcessPool {
 public:
  // `work` runs in the new process; what it throws is an end without an answer. `most` >= 1.
  ProcessPool(std::size_t most, std::function<std::string(std::size_t job)> work);
  ProcessPool(const ProcessPool&) = delete;
  ProcessPool& operator=(const ProcessPool&) = delete;
  ~ProcessPool();  // ends what still runs, at once

  [[nodiscard]] bool has_room() const { return running_.size() < most_; }
  [[nodiscard]] bool is_idle() const { return running_.empty(); }

  // False when the system refuses one more process. Requires has_room().
  [[nodiscard]] bool start(std::size_t job);

  // The next job that ended; nothing after `longest`, or when a signal came.
  [[nodiscard]] std::optional<JobEnd> wait(std::chrono::milliseconds longest);

  // Asks all that run to stop, as SIGTERM does.
  void stop() const;

 private:
  struct Running {
    std::size_t job = 0;
    pid_t process = 0;
    int pipe = -1;
    std::string answer;
  };

  [[nodiscard]] std::optional<JobEnd> read_from(std::size_t index);

  std::size_t most_;
  std::function<std::string(std::size_t)> work_;
  std::vector<Running> running_;
};

}  // namespace batten::postproc
