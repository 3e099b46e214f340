// One program of a batch: smoothed, proved, written, recorded; or found done already.
#pragma once

#include <filesystem>
#include <string>

#include "postproc/batch/manifest.h"
#include "postproc/options/options.h"

namespace batten::postproc {

struct BatchPlan {
  std::filesystem::path input_tree;
  std::filesystem::path output_tree;
  SmoothOptions options;        // its `threads` do not count: a worker has one
  std::string settings_sha256;  // of everything that the bytes of the result depend on
  bool strict = false;
  bool force = false;  // programs in the new tree may be replaced whoever wrote them
};

struct WorkerResult {
  ProgramRecord record;
  bool was_done = false;  // by an earlier run; nothing was written now
};

// A program is done when its record has the same input and settings and its files still have the
// bytes that the record says. Otherwise it is smoothed, and written in the order report, program,
// record.
//
// A program in the new tree that no record explains and that is not what would be written now is
// left as it is, without `force`. When nothing may be written, a program that an earlier batch
// wrote is removed: it no longer belongs to its source. Nothing is written where a link leads into
// the input tree.
//
// The status is kFailed after file errors and kNotDone after an interrupt; these leave no record.
[[nodiscard]] WorkerResult process_program(const BatchPlan& plan, const std::string& program);

}  // namespace batten::postproc
