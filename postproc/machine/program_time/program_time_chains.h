// The steps of a program cut where its motion comes to rest, as a machine's control runs them.
#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <vector>

#include "postproc/machine/machine.h"
#include "postproc/machine/models/cycle_time.h"
#include "postproc/machine/models/jerk_motion.h"
#include "postproc/machine/models/planned_chain.h"
#include "postproc/machine/models/velocity_profile.h"
#include "postproc/machine/program_time/program_time_steps.h"

namespace batten::postproc {

// Motions from rest to rest, or one wait.
struct RunChain {
  StepKind wait = StepKind::kRest;  // meaningful where there are no pieces
  double seconds = 0;               // of the wait
  std::vector<TimedPiece> pieces;   // each with a length and a feed
  std::vector<std::size_t> steps;   // the step of each piece; of a wait its own
  gcode::PathControl path;          // that holds
  StretchChain stretches;           // with places
  std::uint32_t first_counted = 0;  // pieces of a part of a longer chain that count here
  std::uint32_t end_counted = 0;

  [[nodiscard]] bool counts(std::uint32_t piece) const {
    return piece >= first_counted && piece < end_counted;
  }
  // mm, of the pieces that a stretch serves.
  [[nodiscard]] double length_of(const StretchPlace& place) const;
};

// What times a chain in place of its stretches.
struct ChainPlan {
  FeedPlanner planner = FeedPlanner::kJerk;
  double density = kPlanDensity;
};

// Nothing where its stretches do: they are asked for (kControl), and near enough (takes_a_plan).
[[nodiscard]] std::optional<ChainPlan> plan_of(const RunChain& chain, FeedPlanner asked);

// Cuts steps, numbered from 0 as they are added, into chains. Times of tool changes and of the
// spindle are the machine's.
class ChainCutter {
 public:
  using Use = std::function<void(const RunChain&)>;

  // A chain of `most_pieces` or more is used in parts that overlap: kMargin pieces from its ends a
  // part moves as the whole. No control looks further ahead, no machine takes longer to its speed.
  ChainCutter(const Machine& machine, std::size_t most_pieces)
      : machine_(machine), most_pieces_(most_pieces) {}

  void add(const ProgramStep& step, const std::vector<gcode::PathControl>& controls,
           const Use& use);
  void finish(const Use& use) { close(ChainEnd::kEndOfMotion, use); }

  static constexpr std::uint32_t kMargin = 512;
  static constexpr std::size_t kMostPieces = std::size_t{4} * kMargin;

 private:
  [[nodiscard]] double seconds_of(const ProgramStep& step) const;
  void add_motion(const ProgramStep& step, const std::vector<gcode::PathControl>& controls,
                  const Use& use);
  void close(ChainEnd end, const Use& use);
  void use_part(ChainEnd end, std::size_t end_counted, const Use& use);

  Machine machine_;
  std::size_t most_pieces_;
  RunChain chain_;
  gcode::PathControl control_;
  std::size_t steps_ = 0;  // that were added
  int sent_ = 0;           // bytes since the last piece
};

// A chain of stretches in time, whatever limits its control keeps.

// From rest to rest; its duration is profile_time of the chain.
class ChainMotion {
 public:
  // Keeps a reference to `chain`.
  explicit ChainMotion(const StretchChain& chain);

  [[nodiscard]] double duration() const { return ends_.empty() ? 0 : ends_.back(); }

  // When stretch i begins and ends, s; the rest after a stop is part of the stretch.
  [[nodiscard]] double start_of(std::size_t i) const { return i == 0 ? 0 : ends_[i - 1]; }
  [[nodiscard]] double end_of(std::size_t i) const { return ends_[i]; }

  // The share, from 0 to 1, of the stretch's way at a time within it.
  [[nodiscard]] double share_at(std::size_t i, double time) const;

  // Seconds of the stretch at less than this speed (mm/s).
  [[nodiscard]] double time_below(std::size_t i, double velocity) const;

 private:
  [[nodiscard]] StretchMotion motion_of(std::size_t i) const;

  const StretchChain& chain_;
  std::vector<double> velocities_;
  std::vector<double> ends_;
  // With a limit on jerk only: the whole chain, and the way before each stretch (mm).
  std::unique_ptr<const JerkMotion> with_jerk_;
  std::vector<double> ways_;
};

}  // namespace batten::postproc
