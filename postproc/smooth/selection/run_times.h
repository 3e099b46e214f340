// What a run, and what could be written instead of it, takes on the machine.
#pragma once

#include <span>
#include <vector>

#include "postproc/machine/machine.h"
#include "postproc/machine/models/cycle_time.h"
#include "postproc/smooth/selection/candidate.h"

namespace batten::postproc {

// Of a chain from rest to rest. `path`: as the program says. Throws as cutting_time does.
[[nodiscard]] Times times_of(std::span<const TimedPiece> chain, const Machine& machine,
                             const gcode::PathControl& path, WorthAPlan worth = kAmongForms);

// Of a long chain that need not be held: part by part. The moves about a cut are timed in both of
// its parts, and by themselves to be taken off again, so that what is left is the time of the whole
// as far as the machine looks ahead, and brakes, over no more of them.
class ChainTimes {
 public:
  // All must live as long.
  ChainTimes(const Machine& machine, const gcode::PathControl& path)
      : machine_(machine), path_(path) {}

  void add(std::span<const TimedPiece> moves);  // that follow those before
  [[nodiscard]] Times finish();

 private:
  const Machine& machine_;
  const gcode::PathControl& path_;
  std::vector<TimedPiece> open_;  // not counted yet, and what overlaps the part before
  Times times_;
};

// Of a run between its neighbours (RunContext). From rest to rest where it has none.
class RunTimes {
 public:
  // Both must live as long. `worth`: as TimedChain::time has it.
  RunTimes(const RunContext& context, const Machine& machine, WorthAPlan worth = kAmongForms);

  [[nodiscard]] Times of_run(const std::vector<TimedPiece>& motions) const;

  // The programmed time alone.
  [[nodiscard]] double programmed(const std::vector<TimedPiece>& moves) const;

  // Of moves that are slower than the run (`old`) as programmed the other times are the run's.
  [[nodiscard]] Times of_candidate(const std::vector<TimedPiece>& moves, const Times& old) const;

 private:
  [[nodiscard]] Times of_neighbours() const;
  [[nodiscard]] std::vector<TimedPiece> in_place(const std::vector<TimedPiece>& moves) const;

  const RunContext& context_;
  const Machine& machine_;
  WorthAPlan worth_;
  Times around_;
};

// s: what nobody measures on this machine.
[[nodiscard]] double control_period(const Machine& machine);

}  // namespace batten::postproc
