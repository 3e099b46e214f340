// Some runs of a part that stand for all of them, so that many settings can be looked at in a
// program of many runs.
// Method: docs/exploring.md, section How far the figures go.
#pragma once

#include <cstddef>
#include <cstdint>
#include <map>
#include <span>
#include <vector>

#include "postproc/smooth/part_runs.h"

namespace batten::postproc {

struct RunSampleTuning {
  // Runs that are looked at: one of so many, and at least so many.
  std::size_t one_of = 16;
  std::size_t least = 32;
};
inline constexpr RunSampleTuning kRunSample;

struct SampledRun {
  std::size_t run = 0;    // by its place among all
  double stands_for = 1;  // runs of its moves: what it gains counts so many times
};

// `moves`: of each run, in the order in which they are to be represented. Ascending; all of few.
// Runs are taken at even steps of their moves, so that one has its place in proportion to its
// length, and those of a step or more have one each: a systematic sample with probabilities
// proportional to size. Together they stand for as many moves as there are.
[[nodiscard]] std::vector<SampledRun> sample_of(std::span<const std::size_t> moves);

// The runs of a part that are looked at.
struct PartSample {
  PartRuns runs;                            // the others are copied
  std::map<std::uint32_t, double> by_line;  // what runs stand for, by their first line

  // Of the run that this line is of, or of its pieces; of other lines it is of no matter.
  [[nodiscard]] double stands_for(std::uint32_t line) const;
};

// Of all that have no reason yet to be copied. Runs of corners and others have their share each.
[[nodiscard]] PartSample sample_of_part(const ProgramPart& part, PartRuns runs,
                                        double user_tolerance_mm);

}  // namespace batten::postproc
