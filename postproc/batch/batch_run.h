// All programs of a batch, several at a time.
#pragma once

#include <cstddef>
#include <filesystem>
#include <functional>
#include <optional>
#include <set>
#include <string>
#include <string_view>
#include <vector>

#include "postproc/batch/batch_summary.h"
#include "postproc/batch/program_tree.h"
#include "postproc/options/options.h"

namespace batten::postproc {

struct BatchPlan {
  std::filesystem::path input_tree;
  std::filesystem::path output_tree;
  SmoothOptions options;               // its `threads` do not count: a worker has one
  std::string settings_sha256;         // of everything that the bytes of the result depend on
  std::vector<std::string> drop = {};  // of SmoothingCommand
  bool strict = false;
  bool force = false;  // programs in the new tree may be replaced whoever wrote them
  bool pages = false;  // each program's report as a page, too
};

struct BatchRequest {
  BatchPlan plan;
  std::vector<TreeProgram> programs;
  std::size_t jobs = 1;    // processes at a time, each with one thread
  bool fail_fast = false;  // the first failure stops the others
};

struct BatchResult {
  std::vector<ProgramRecord> records;  // of all programs asked for, in their order
  std::size_t were_done = 0;           // found done
};

// `count` after each program and several times a second between; `ended` is the program that
// ended just now, or null.
using BatchObserver = std::function<void(const BatchCount& count, const ProgramRecord* ended)>;

// The largest programs first, so that none of them is left alone at the end; the result does not
// depend on it. After Ctrl-C or SIGTERM (postproc/system/interrupt.h) what runs is stopped, and the
// rest is not done.
//
// A process that ends without a result is a failed program with the code of an internal error.
[[nodiscard]] BatchResult run_batch(const BatchRequest& request, const BatchObserver& observer);

// Two runs of one batch at a time would do the same work twice, each removing the half-written
// files of the other. Held until the end of its life, and let go by the system however the process
// ends. Shards of one batch may run together, a run of the whole tree only alone.
class BatchLock {
 public:
  // `folder` is where the batch keeps its manifest; it must exist.
  BatchLock(const std::filesystem::path& folder, const Shard& shard);
  BatchLock(const BatchLock&) = delete;
  BatchLock& operator=(const BatchLock&) = delete;
  ~BatchLock();

  // Why the lock was not taken; empty when it was. File systems that know no locks count as taken.
  [[nodiscard]] const std::string& problem() const { return problem_; }

 private:
  void take(const std::filesystem::path& file, int operation);

  std::vector<int> descriptors_;
  std::string problem_;
};

// What killed runs left half written (postproc/system/output_file.h): the name that a half-written
// file would have got: "part.nc" of ".part.nc.4711.batten-part".
[[nodiscard]] std::optional<std::string> intended_name(std::string_view half_written);

// Removes below `root` the half-written files of these targets, links to folders not followed.
// Requires that nobody writes the targets now. Returns how many there were.
std::size_t remove_half_written(const std::filesystem::path& root,
                                const std::set<std::filesystem::path>& targets);

}  // namespace batten::postproc
