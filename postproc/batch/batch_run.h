// All programs of a batch, several at a time.
#pragma once

#include <cstddef>
#include <functional>
#include <span>
#include <vector>

#include "postproc/batch/batch_progress.h"
#include "postproc/batch/manifest.h"
#include "postproc/batch/program_tree.h"
#include "postproc/batch/program_worker.h"

namespace batten::postproc {

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

}  // namespace batten::postproc
