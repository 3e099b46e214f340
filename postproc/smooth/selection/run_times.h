// What a run, and what could be written instead of it, takes on the machine.
#pragma once

#include <optional>
#include <span>
#include <vector>

#include "postproc/machine/machine.h"
#include "postproc/machine/models/cycle_time.h"
#include "postproc/smooth/selection/candidate.h"

namespace batten::postproc {

// Of a chain from rest to rest, each when it is asked for.
class SettingTimes {
 public:
  // `path`: as the program says. The machine must live as long. Throws as cutting_time does.
  SettingTimes(std::span<const TimedPiece> chain, const Machine& machine, gcode::PathMode path);

  [[nodiscard]] double as_set();
  [[nodiscard]] double without_merging();
  [[nodiscard]] double exact_path() const;
  [[nodiscard]] double flat_out();  // the last that may be asked for: the feeds are gone then

 private:
  const Machine& machine_;
  gcode::PathMode path_;
  TimedChain chain_;
  std::optional<double> as_set_;
};

// All of them.
[[nodiscard]] Times times_of(std::span<const TimedPiece> chain, const Machine& machine,
                             gcode::PathMode path);

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

  // With kinks so many times smaller, as the control is set and under exact path: about, and rather
  // too little, where moves take longer than two block periods. 0 where nothing is known of it.
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

  const RunContext& context_;
  const Machine& machine_;
  Times around_;
};

}  // namespace batten::postproc
