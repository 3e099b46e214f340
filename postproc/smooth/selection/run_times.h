// What a run, and what could be written instead of it, takes on the machine where it stands.
#pragma once

#include <vector>

#include "postproc/machine/machine.h"
#include "postproc/smooth/selection/candidate.h"

namespace batten::postproc {

// Of a run between its neighbours: what it adds to the time that they take alone. From rest to rest
// where it has none.
class RunTimes {
 public:
  // Both must live as long.
  RunTimes(const RunContext& context, const Machine& machine);

  // `exact_path` is 0: nobody compares with it.
  [[nodiscard]] Times of_run(const std::vector<TimedPiece>& motions) const;

  // The first of them alone.
  [[nodiscard]] double as_set_of_run(const std::vector<TimedPiece>& motions) const;

  // As far as they must be known: of moves in so many blocks that are slower than the run (`old`)
  // in one way, the others are those of the run. `wanted`: see `slower`.
  [[nodiscard]] Times of_candidate(const std::vector<TimedPiece>& moves, std::size_t blocks,
                                   const Times& old, bool exact_path, bool wanted) const;

  // What moves take whose kinks are so many times smaller, as the control is set and under exact
  // path: about, and rather too little, where moves take longer than two block periods. 0 where
  // nothing is known of it.
  [[nodiscard]] double as_set_with_less_kinks(const std::vector<TimedPiece>& moves,
                                              double times_less) const;
  [[nodiscard]] double exact_path_with_less_kinks(const std::vector<TimedPiece>& moves,
                                                  double times_less) const;

 private:
  [[nodiscard]] double multiple_for_kinks(const std::vector<TimedPiece>& moves,
                                          double times_less) const;
  [[nodiscard]] Times of_neighbours() const;
  [[nodiscard]] SettingTimes in_place(const std::vector<TimedPiece>& moves,
                                      const Machine& machine) const;
  [[nodiscard]] std::vector<TimedPiece> with_neighbours(const std::vector<TimedPiece>& moves) const;

  const RunContext& context_;
  const Machine& machine_;
  Times around_;
};

}  // namespace batten::postproc
