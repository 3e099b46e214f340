// Which candidate replaces a run, if any: never one that is worse than what stood there.
#pragma once

#include <string_view>
#include <vector>

#include "postproc/options.h"
#include "postproc/smoothing.h"

namespace batten::postproc {

struct Choosing {
  std::vector<std::size_t> order;  // indices of the candidates worth writing, the best first
  std::string_view reason;         // why there is none
};

// A candidate is worth writing when it is not slower and gains time, blocks or accuracy by a
// margin. Between candidates `prefer` decides. A form that the user asked for by name may be
// somewhat slower.
[[nodiscard]] Choosing choose(const SmoothedRun& run, const RunContext& context,
                              const SmoothOptions& options);

}  // namespace batten::postproc
