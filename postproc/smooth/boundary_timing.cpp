#include "postproc/smooth/boundary_timing.h"

#include <algorithm>
#include <iterator>
#include <variant>
#include <vector>

#include "postproc/runs/run_path.h"
#include "postproc/smooth/kept_neighbours.h"
#include "postproc/smooth/selection/run_times.h"

namespace batten::postproc {

namespace {

// Runs that were cut from one are not run from rest to rest. Each is timed with some moves of its
// neighbours, and the time of the moves about a cut, which are in two of these times, is shared
// between them: so the times of all are that of the whole.
class BoundaryTiming {
 public:
  BoundaryTiming(const ProgramPart& part, const SmoothOptions& options, const BoundaryCuts& cuts,
                 const std::vector<Section>& sections, std::vector<RunState>& works)
      : part_(part), options_(options), cuts_(cuts), sections_(sections), works_(works) {}

  void run() {
    for (RunState& work : works_) {
      const Section& section = sections_[work.section];
      const std::uint32_t end = section.last_block + 1;
      const bool begins = is_cut(section.first_block);
      const bool ends = is_cut(end);
      if (!begins && !ends) {
        if (options_.method == Method::kNone) continue;
        put_between(before(section.first_block), after(end), std::get<Run>(section.content),
                    *options_.machine, work.context);
        continue;
      }
      Times shared;
      if (begins) {
        work.context.lead = before(section.first_block);
        shared += times_about(section.first_block, work.context.after.path);
      }
      if (ends) {
        work.context.tail = after(end);
        shared += times_about(end, work.context.after.path);
      }
      work.context.of_neighbours = Times().add(shared, 0.5);
    }
  }

 private:
  [[nodiscard]] bool is_cut(std::uint32_t block) const {
    if (part_.window && block == 0) return !part_.window->moves_before.empty();
    if (part_.window && block == part_.program.blocks.size()) {
      return !part_.window->moves_behind.empty();
    }
    return is_cut_of_long_run(block) || std::ranges::binary_search(cuts_.at_copied, block);
  }

  [[nodiscard]] bool is_cut_of_long_run(std::uint32_t block) const {
    return std::ranges::binary_search(cuts_.of_long_runs, block);
  }

  // The whole looks no further than a window that ends at the cuts of long runs.
  [[nodiscard]] std::uint32_t window_begin(std::uint32_t block) const {
    if (is_cut_of_long_run(block)) return 0;
    const auto next = std::ranges::upper_bound(cuts_.of_long_runs, block);
    return next == cuts_.of_long_runs.begin() ? 0 : *std::prev(next);
  }

  [[nodiscard]] std::uint32_t window_end(std::uint32_t block) const {
    const auto next = std::ranges::upper_bound(cuts_.of_long_runs, block);
    const bool is_last = is_cut_of_long_run(block) || next == cuts_.of_long_runs.end();
    return is_last ? static_cast<std::uint32_t>(part_.program.blocks.size()) : *next;
  }

  [[nodiscard]] std::vector<TimedPiece> before(std::uint32_t block) const {
    if (part_.window && block == 0) return part_.window->moves_before;
    return moves_before(part_.program, part_.meaning, block, window_begin(block));
  }

  [[nodiscard]] std::vector<TimedPiece> after(std::uint32_t block) const {
    if (part_.window && block == part_.program.blocks.size()) return part_.window->moves_behind;
    return moves_from(part_.program, part_.meaning, block, window_end(block));
  }

  [[nodiscard]] Times times_about(std::uint32_t block, const gcode::PathControl& path) const {
    std::vector<TimedPiece> moves = before(block);
    const std::vector<TimedPiece> rest = after(block);
    moves.insert(moves.end(), rest.begin(), rest.end());
    return times_of(moves, *options_.machine, path);
  }

  const ProgramPart& part_;
  const SmoothOptions& options_;
  const BoundaryCuts& cuts_;
  const std::vector<Section>& sections_;
  std::vector<RunState>& works_;
};

}  // namespace

void time_at_boundaries(const ProgramPart& part, const SmoothOptions& options,
                        const BoundaryCuts& cuts, const std::vector<Section>& sections,
                        std::vector<RunState>& works) {
  BoundaryTiming(part, options, cuts, sections, works).run();
}

}  // namespace batten::postproc
