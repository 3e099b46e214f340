#include "postproc/smooth/selection/run_times.h"

#include <algorithm>

#include "gcode/text/large_pages.h"

namespace batten::postproc {

namespace {

constexpr double kHalf = 0.5;
constexpr double kOneAndHalf = 1.5;

double time_at(std::span<const TimedPiece> chain, const Machine& machine, gcode::PathMode path,
               double feed_override) {
  return TimedChain(chain, machine, feed_override).time(machine, path);
}

}  // namespace

double control_period(const Machine& machine) {
  return std::max(machine.block_period, machine.servo_period);
}

Times times_of(std::span<const TimedPiece> chain, const Machine& machine, gcode::PathMode path) {
  return {time_at(chain, machine, path, 1), time_at(chain, machine, path, kHalf),
          time_at(chain, machine, path, kOneAndHalf)};
}

RunTimes::RunTimes(const RunContext& context, const Machine& machine)
    : context_(context), machine_(machine), around_(of_neighbours()) {}

Times RunTimes::of_run(const std::vector<TimedPiece>& motions) const {
  return times_of(in_place(motions), machine_, context_.after.path).add(around_, -1);
}

double RunTimes::programmed(const std::vector<TimedPiece>& moves) const {
  return time_at(in_place(moves), machine_, context_.after.path, 1) - around_.programmed;
}

Times RunTimes::of_candidate(const std::vector<TimedPiece>& moves, const Times& old) const {
  const std::vector<TimedPiece> chain = in_place(moves);
  const auto own = [&](double feed_override) {
    return time_at(chain, machine_, context_.after.path, feed_override);
  };
  Times times = old;
  times.programmed = own(1) - around_.programmed;
  // What a piece adds may be less than nothing: there one time says nothing of the others.
  if (!context_.is_piece() && is_slower(times, old, control_period(machine_))) return times;
  times.at_half = own(kHalf) - around_.at_half;
  times.at_one_and_half = own(kOneAndHalf) - around_.at_one_and_half;
  return times;
}

// What the neighbours take without this piece, each from rest to rest. Of neighbours in a long run
// that was cut: their part of the time.
Times RunTimes::of_neighbours() const {
  if (context_.of_neighbours) return *context_.of_neighbours;
  Times sum;
  for (const auto* chain : {&context_.lead, &context_.tail}) {
    if (!chain->empty()) sum += times_of(*chain, machine_, context_.after.path);
  }
  return sum;
}

std::vector<TimedPiece> RunTimes::in_place(const std::vector<TimedPiece>& moves) const {
  if (context_.lead.empty() && context_.tail.empty()) return moves;
  std::vector<TimedPiece> chain;
  gcode::reserve_in_large_pages(chain, context_.lead.size() + moves.size() + context_.tail.size());
  for (const auto* part : {&context_.lead, &moves, &context_.tail}) {
    chain.insert(chain.end(), part->begin(), part->end());
  }
  return chain;
}

}  // namespace batten::postproc
