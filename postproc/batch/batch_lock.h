// Two runs of one batch at a time would do the same work twice, each removing the half-written
// files of the other.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "postproc/batch/program_tree.h"

namespace batten::postproc {

// Held until the end of its life, and let go by the system however the process ends. Shards of
// one batch may run together, a run of the whole tree only alone.
class BatchLock {
 public:
  // `folder` is where the batch keeps its manifest; it must exist.
  BatchLock(const std::filesystem::path& folder, const Shard& shard);
  BatchLock(const BatchLock&) = delete;
  BatchLock& operator=(const BatchLock&) = delete;
  BatchLock(BatchLock&&) = delete;
  BatchLock& operator=(BatchLock&&) = delete;
  ~BatchLock();

  // Why the lock was not taken; empty when it was. File systems that know no locks count as taken.
  [[nodiscard]] const std::string& problem() const { return problem_; }

 private:
  void take(const std::filesystem::path& file, int operation);

  std::vector<int> descriptors_;
  std::string problem_;
};

}  // namespace batten::postproc
