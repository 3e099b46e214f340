#include "postproc/batch/batch_lock.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/file.h>
#include <unistd.h>

#include <cerrno>
#include <chrono>
#include <system_error>
#include <thread>

namespace batten::postproc {

namespace {

// The processes of a run that was killed end with it, but on a busy machine not at once.
constexpr int kTries = 20;
constexpr std::chrono::milliseconds kBetweenTries{100};

// False when somebody else holds it.
bool lock_file(int descriptor, int operation) {
  for (int i = 0; i < kTries; ++i) {
    if (::flock(descriptor, operation | LOCK_NB) == 0 || errno != EWOULDBLOCK) return true;
    std::this_thread::sleep_for(kBetweenTries);
  }
  return false;
}

}  // namespace

BatchLock::BatchLock(const std::filesystem::path& folder, const Shard& shard) {
  const bool whole_tree = shard.count == 1;
  take(folder / "lock", whole_tree ? LOCK_EX : LOCK_SH);
  if (whole_tree || !problem_.empty()) return;
  take(folder / fmt::format("lock-{}-of-{}", shard.index, shard.count), LOCK_EX);
}

BatchLock::~BatchLock() {
  for (const int descriptor : descriptors_) ::close(descriptor);
}

void BatchLock::take(const std::filesystem::path& file, int operation) {
  const int descriptor = ::open(file.c_str(), O_RDWR | O_CREAT | O_CLOEXEC, 0666);
  if (descriptor < 0) {
    problem_ = file.string() + ": cannot be made: " + std::generic_category().message(errno);
    return;
  }
  descriptors_.push_back(descriptor);
  if (!lock_file(descriptor, operation)) {
    problem_ = file.string() + ": another run of this batch is at work on these programs";
  }
}

}  // namespace batten::postproc
