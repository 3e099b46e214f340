#include "postproc/machine/models/speed_levels.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <queue>
#include <utility>

#include "postproc/machine/models/jerk_motion.h"
#include "postproc/machine/models/stretch_motion.h"

namespace batten::postproc {
namespace {

// Speeds this close, as part of the greater one, are one level: rounding of the profile.
constexpr double kSameSpeed = 1e-9;

constexpr std::size_t kNone = std::numeric_limits<std::size_t>::max();

// Halvings that find a speed to the last digit.
constexpr int kHalvings = 60;

class LevelBuilder {
 public:
  explicit LevelBuilder(std::vector<SpeedLevel>& levels) : levels_(levels) {
    levels_.push_back({});
  }

  void add(const MotionPhase& phase, double jerk) {
    const double end = phase.velocity + phase.acceleration * phase.duration;
    const double way = phase.length;
    const double change = end - phase.velocity;
    if (std::abs(change) <= kSameSpeed * std::max(end, phase.velocity)) {
      close_change(phase.velocity);
      levels_.back().way += way;
      return;
    }
    if (changing_ && (change > 0) != rises_) close_change(phase.velocity);
    if (!changing_) start_ = phase.velocity;
    rises_ = change > 0;
    changing_ = true;
    change_.way += way;
    time_ += phase.duration;
    change_.jerk = std::min(change_.jerk, jerk);
    end_ = end;
  }

  void finish() { close_change(0); }

 private:
  void close_change(double velocity) {
    if (!changing_) return;
    change_.acceleration = even_acceleration();
    levels_.back().after = change_;
    levels_.push_back({velocity, 0, {}});
    change_ = {0, 0, kNoLimit};
    time_ = 0;
    changing_ = false;
  }

  // The way that an even acceleration loses against the faster speed is (change of speed)^2 / 2a;
  // that of the change is what its stretches, each with its own acceleration, have lost.
  [[nodiscard]] double even_acceleration() const {
    const double change = end_ - start_;
    const double lost = std::max(start_, end_) * time_ - change_.way;
    return change * change / (2 * lost);
  }

  std::vector<SpeedLevel>& levels_;
  SpeedChange change_{0, 0, kNoLimit};
  double start_ = 0;
  double end_ = 0;
  double time_ = 0;
  bool changing_ = false;
  bool rises_ = false;
};

double s_ramp_way(double from, double to, const SpeedChange& change) {
  return (from + to) / 2 * s_ramp_time(std::abs(to - from), change.acceleration, change.jerk);
}

// Levels as a list in which one can vanish. The way of a change belongs to its faster level.
class LevelList {
 public:
  explicit LevelList(std::vector<SpeedLevel>& levels) : levels_(levels) {
    const std::size_t n = levels.size();
    for (std::size_t i = 0; i < n; ++i) {
      before_.push_back(i == 0 ? kNone : i - 1);
      after_.push_back(i + 1 == n ? kNone : i + 1);
      gone_.push_back(false);
    }
    for (std::size_t i = 0; i + 1 < n; ++i) {
      SpeedLevel& faster = levels[i].velocity >= levels[i + 1].velocity ? levels[i] : levels[i + 1];
      faster.way += levels[i].after.way;
    }
    for (std::size_t i = 0; i < n; ++i) ask(i);
  }

  void fit() {
    while (!queue_.empty()) {
      const auto [speed, level] = queue_.top();
      queue_.pop();
      if (!gone_[level] && speed == levels_[level].velocity) fit(level);
    }
    give_back_ways();
  }

 private:
  using Entry = std::pair<double, std::size_t>;

  void ask(std::size_t level) { queue_.emplace(levels_[level].velocity, level); }

  [[nodiscard]] const SpeedChange& change(std::size_t level, std::size_t neighbour) const {
    return levels_[std::min(level, neighbour)].after;
  }

  // Way that the changes to slower neighbours take when the level has this speed.
  [[nodiscard]] double need(std::size_t level, double velocity) const {
    double way = 0;
    for (const std::size_t neighbour : {before_[level], after_[level]}) {
      if (neighbour == kNone || levels_[neighbour].velocity >= velocity) continue;
      way += s_ramp_way(levels_[neighbour].velocity, velocity, change(level, neighbour));
    }
    return way;
  }

  void fit(std::size_t level) {
    SpeedLevel& own = levels_[level];
    if (need(level, own.velocity) <= own.way) return;
    double floor = 0;
    std::size_t nearest = kNone;  // the fastest of the slower neighbours
    for (const std::size_t neighbour : {before_[level], after_[level]}) {
      if (neighbour == kNone || levels_[neighbour].velocity > own.velocity) continue;
      if (nearest == kNone || levels_[neighbour].velocity > floor) nearest = neighbour;
      floor = std::max(floor, levels_[neighbour].velocity);
    }
    if (nearest == kNone) return;  // both ends are rests: there is always a slower neighbour
    if (need(level, floor) > own.way) return join(level, nearest);
    double low = floor;
    double high = own.velocity;
    for (int i = 0; i < kHalvings; ++i) {
      const double middle = (low + high) / 2;
      (need(level, middle) <= own.way ? low : high) = middle;
    }
    own.velocity = low;
    ask_faster_neighbours(level);
  }

  // Not even the speed of its neighbour is reached: the level is a part of the neighbour's way.
  void join(std::size_t level, std::size_t into) {
    levels_[into].way += levels_[level].way;
    const bool before = into < level;
    const std::size_t other = before ? after_[level] : before_[level];
    // The change on the far side is that of the level that stays.
    if (before) {
      levels_[into].after = levels_[level].after;
      after_[into] = other;
      if (other != kNone) before_[other] = into;
    } else {
      before_[into] = other;
      if (other != kNone) after_[other] = into;
    }
    gone_[level] = true;
    ask(into);
    ask_faster_neighbours(into);
  }

  void ask_faster_neighbours(std::size_t level) {
    for (const std::size_t neighbour : {before_[level], after_[level]}) {
      if (neighbour != kNone && levels_[neighbour].velocity > levels_[level].velocity) {
        ask(neighbour);
      }
    }
  }

  // Takes the ways of the S-curves out of the levels again and drops what is gone.
  void give_back_ways() {
    std::vector<SpeedLevel> left;
    for (std::size_t i = 0; i < levels_.size(); ++i) {
      if (gone_[i]) continue;
      SpeedLevel level = levels_[i];
      level.way = std::max(0.0, level.way - need(i, level.velocity));
      if (after_[i] != kNone) {
        level.after.way = s_ramp_way(level.velocity, levels_[after_[i]].velocity, level.after);
      }
      left.push_back(level);
    }
    levels_ = std::move(left);
  }

  std::vector<SpeedLevel>& levels_;
  std::vector<std::size_t> before_;
  std::vector<std::size_t> after_;
  std::vector<bool> gone_;
  std::priority_queue<Entry, std::vector<Entry>, std::greater<>> queue_;  // the slowest first
};

}  // namespace

std::vector<SpeedLevel> speed_levels(std::span<const VelocityStretch> chain,
                                     std::span<const double> velocities,
                                     const ProfileRules& rules) {
  std::vector<SpeedLevel> levels;
  LevelBuilder builder(levels);
  for (std::size_t i = 0; i < chain.size(); ++i) {
    const StretchMotion motion(chain[i], velocities[i], velocities[i + 1], rules);
    for (const MotionPhase& phase : motion.phases()) builder.add(phase, chain[i].jerk);
  }
  builder.finish();
  return levels;
}

void fit_s_curves(std::vector<SpeedLevel>& levels) { LevelList(levels).fit(); }

}  // namespace batten::postproc
