// All programs of a batch on one page for a browser, as it is opened from a disk: it needs nothing
// else.
#pragma once

#include <span>
#include <string>

#include "postproc/batch/batch_summary.h"
#include "postproc/options/options.h"

namespace batten::postproc {

// `input_tree`: its folder's name. The page is to lie in the batch's folder, where its links lead
// from: to each program's page, where it has one, its JSON report, and the new program. What was
// not written comes first, the rest in the order of the records. The same records give the same
// bytes.
[[nodiscard]] std::string batch_index(std::span<const ProgramRecord> records,
                                      const std::string& input_tree, const SmoothOptions& options);

}  // namespace batten::postproc
