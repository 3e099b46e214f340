// Runs of one shape: the passes of a contour in several depths, the same pocket in several places.
// What is found for the first serves all.
#pragma once

#include <cstddef>
#include <optional>
#include <span>
#include <vector>

#include "geometry/basic/point.h"
#include "postproc/options/options.h"
#include "postproc/runs/section.h"
#include "postproc/smooth/selection/candidate.h"

namespace batten::postproc {

struct RunInContext {
  const Run* run = nullptr;
  const RunContext* context = nullptr;
};

// mm: how far `run` lies from `first`, where it is the same run in another place: the same
// vertices, arcs and feeds between the same states, for the same tolerance, without comments, a
// whole number of the target's printed steps away, and of pieces of longer runs the same moves
// before and behind. Nothing where it is not.
[[nodiscard]] std::optional<geometry::Vector3> offset_of_repeat(RunInContext first,
                                                                RunInContext run,
                                                                const SmoothOptions& options);

// For each run the first one that it is a repeat of; itself where there is none. Linear time.
[[nodiscard]] std::vector<std::size_t> firsts_of_shapes(std::span<const RunInContext> runs,
                                                        const SmoothOptions& options);

// The plan in another place. Nothing for one with curves of the target.
[[nodiscard]] std::optional<OutputPlan> translated(OutputPlan plan,
                                                   const geometry::Vector3& offset);

}  // namespace batten::postproc
