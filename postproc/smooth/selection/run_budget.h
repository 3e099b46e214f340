// How much the search for a run's candidates may compute, so that no run, whatever its shape, takes
// long: a number of operations (geometry/basic/operations.h) for each of its moves.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>

#include "geometry/basic/operations.h"

namespace batten::postproc {

struct BudgetTuning {
  std::uint64_t per_move = 12'500;         // some 0.75 ms
  std::size_t least_moves = 50;            // that a run counts as
  std::uint64_t per_program = 30'000'000;  // at least, for all moves of its runs: some 1.8 s
};
inline constexpr BudgetTuning kBudget;

// Counts from when it is made, on the thread that makes it.
class RunBudget {
 public:
  // `of_program`: moves of all runs of the program, or of a window of a long one.
  RunBudget(std::size_t moves, std::size_t of_program)
      : end_(geometry::operations_so_far() + operations(moves, of_program)) {}

  [[nodiscard]] static std::uint64_t operations(std::size_t moves, std::size_t of_program) {
    const std::uint64_t share = kBudget.per_program * moves / std::max(moves, of_program);
    return std::max(kBudget.per_move * std::max(moves, kBudget.least_moves), share);
  }

  // Then nothing else is begun.
  [[nodiscard]] bool is_spent() const { return left() == 0; }

  [[nodiscard]] std::uint64_t left() const {
    const std::uint64_t now = geometry::operations_so_far();
    return now < end_ ? end_ - now : 0;
  }

 private:
  std::uint64_t end_;
};

}  // namespace batten::postproc
