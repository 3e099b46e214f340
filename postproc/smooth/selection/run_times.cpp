#include "postproc/smooth/selection/run_times.h"

#include <algorithm>
#include <cmath>

#include "gcode/text/large_pages.h"

namespace batten::postproc {

namespace {

constexpr double kHalf = 0.5;
constexpr double kOneAndHalf = 1.5;

// A chain at settings of the feed override. Where a plan tells the programmed time, the others are
// those of the stretches in the same ratio: plans are dear.
class OverriddenTimes {
 public:
  // All must live as long.
  OverriddenTimes(std::span<const TimedPiece> chain, const Machine& machine,
                  const gcode::PathControl& path, WorthAPlan worth)
      : chain_(chain), machine_(machine), path_(path), programmed_(at(1, worth)) {}

  [[nodiscard]] double programmed() const { return programmed_; }

  // Sets the others in `times`.
  void put_others(Times& times) const {
    const double stretches = std::isfinite(machine_.max_jerk()) ? at(1, kNoPlan) : programmed_;
    const double ratio = stretches > 0 ? programmed_ / stretches : 1;
    times.at_half = ratio * at(kHalf, kNoPlan);
    times.at_one_and_half = ratio * at(kOneAndHalf, kNoPlan);
  }

 private:
  [[nodiscard]] double at(double feed_override, WorthAPlan worth) const {
    return TimedChain(chain_, machine_, feed_override).time(path_, ChainEnd::kStop, worth);
  }

  std::span<const TimedPiece> chain_;
  const Machine& machine_;
  gcode::PathControl path_;
  double programmed_;
};

}  // namespace

double control_period(const Machine& machine) {
  return std::max(machine.block_period, machine.servo_period);
}

Times times_of(std::span<const TimedPiece> chain, const Machine& machine,
               const gcode::PathControl& path, WorthAPlan worth) {
  const OverriddenTimes all(chain, machine, path, worth);
  Times times;
  times.programmed = all.programmed();
  all.put_others(times);
  return times;
}

void ChainTimes::add(std::span<const TimedPiece> moves) {
  constexpr std::size_t kAtOnce = 8192;
  constexpr std::size_t kAround = 512;  // on either side of a cut
  while (!moves.empty()) {
    const std::size_t room = std::min(moves.size(), kAtOnce - open_.size());
    open_.insert(open_.end(), moves.begin(), moves.begin() + static_cast<std::ptrdiff_t>(room));
    moves = moves.subspan(room);
    if (open_.size() < kAtOnce) continue;
    times_ += times_of(open_, machine_, path_);
    open_.erase(open_.begin(), open_.end() - 2 * std::ptrdiff_t{kAround});
    times_.add(times_of(open_, machine_, path_), -1);
  }
}

Times ChainTimes::finish() {
  times_ += times_of(open_, machine_, path_);
  open_.clear();
  return times_;
}

RunTimes::RunTimes(const RunContext& context, const Machine& machine, WorthAPlan worth)
    : context_(context), machine_(machine), worth_(worth), around_(of_neighbours()) {}

Times RunTimes::of_run(const std::vector<TimedPiece>& motions) const {
  return times_of(in_place(motions), machine_, context_.after.path, worth_).add(around_, -1);
}

double RunTimes::programmed(const std::vector<TimedPiece>& moves) const {
  const std::vector<TimedPiece> chain = in_place(moves);
  const OverriddenTimes all(chain, machine_, context_.after.path, worth_);
  return all.programmed() - around_.programmed;
}

Times RunTimes::of_candidate(const std::vector<TimedPiece>& moves, const Times& old) const {
  const std::vector<TimedPiece> chain = in_place(moves);
  const OverriddenTimes all(chain, machine_, context_.after.path, worth_);
  Times times = old;
  times.programmed = all.programmed() - around_.programmed;
  // What a piece adds may be less than nothing: there one time says nothing of the others.
  if (!context_.is_piece() && is_slower(times, old, control_period(machine_))) return times;
  all.put_others(times);
  times.at_half -= around_.at_half;
  times.at_one_and_half -= around_.at_one_and_half;
  return times;
}

// Of the time of the whole chain; of a piece what they take without it, each from rest to rest.
Times RunTimes::of_neighbours() const {
  if (context_.of_neighbours) return *context_.of_neighbours;
  Times sum;
  for (const auto* chain : {&context_.lead, &context_.tail}) {
    if (!chain->empty()) {
      sum += times_of(*chain, machine_, context_.after.path, worth_);
    }
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
