#include "postproc/machine/models/jerk_motion.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <queue>
#include <utility>

namespace batten::postproc {
namespace {

// Halvings that find a time or a speed to the last digit.
constexpr int kHalvings = 60;

// Speeds this close, as part of the greater one, are one level: rounding of the profile.
constexpr double kSameSpeed = 1e-9;

constexpr std::size_t kNone = std::numeric_limits<std::size_t>::max();

// --- the profile of a chain as speeds that are held and changes between them ------------------

// A change of speed without a limit on jerk.
struct SpeedChange {
  double way = 0;           // mm
  double acceleration = 0;  // mm/s^2, the even one that costs as much time
  double jerk = 0;          // mm/s^3 that it may have; infinite: no limit
  double turn = 0;          // radians, of the bends of its way
};

// A speed that is held over some way: on a plateau, or for an instant where the speed is greatest
// or least (no way then).
struct SpeedLevel {
  double velocity = 0;  // mm/s
  double way = 0;       // mm
  SpeedChange after;    // to the next level; none after the last one
  double held = 0;      // mm: the way without those of changes
  double turn = 0;      // radians, of its bends
};

// Seconds of the S-curve between two speeds under a limit of acceleration and one of jerk.
double s_ramp_time(double change, double acceleration, double jerk) {
  if (!std::isfinite(jerk)) return change / acceleration;
  if (change * jerk <= acceleration * acceleration) return 2 * std::sqrt(change / jerk);
  return change / acceleration + acceleration / jerk;
}

class LevelBuilder {
 public:
  explicit LevelBuilder(std::vector<SpeedLevel>& levels) : levels_(levels) {
    levels_.push_back({});
  }

  void add(const MotionPhase& phase, const VelocityStretch& stretch) {
    const double end = phase.velocity + phase.acceleration * phase.duration;
    const double way = phase.length;
    const double change = end - phase.velocity;
    if (std::abs(change) <= kSameSpeed * std::max(end, phase.velocity)) {
      close_change(phase.velocity);
      levels_.back().way += way;
      levels_.back().held += way;
      levels_.back().turn += stretch.curvature * way;
      return;
    }
    if (changing_ && (change > 0) != rises_) close_change(phase.velocity);
    if (!changing_) start_ = phase.velocity;
    rises_ = change > 0;
    changing_ = true;
    change_.way += way;
    time_ += phase.duration;
    change_.jerk = std::min(change_.jerk, stretch.jerk);
    change_.turn += stretch.curvature * way;
    end_ = end;
  }

  void finish() { close_change(0); }

 private:
  void close_change(double velocity) {
    if (!changing_) return;
    change_.acceleration = even_acceleration();
    levels_.back().after = change_;
    levels_.push_back({velocity, 0, {}});
    change_ = {0, 0, kNoLimit, 0};
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
  SpeedChange change_{0, 0, kNoLimit, 0};
  double start_ = 0;
  double end_ = 0;
  double time_ = 0;
  bool changing_ = false;
  bool rises_ = false;
};

// In a bend of curvature k an acceleration along the path, a, turns the normal one by 3 k v a more
// than at steady speed; this shares the limit on jerk with that of a itself.
constexpr double kTurningShare = 0.6;

// Between a level and a faster one: the S-curve goes on where the change without a limit on jerk
// has ended, into the way of the faster level.
double acceleration_of(const SpeedLevel& slower, double velocity, const SpeedLevel& faster,
                       const SpeedChange& change) {
  const double mean = (slower.velocity + velocity) / 2;
  const double way =
      mean * s_ramp_time(velocity - slower.velocity, change.acceleration, change.jerk);
  const double beyond = std::max(0.0, way - change.way);
  const double bend_beyond = faster.held > 0 ? faster.turn / faster.held : change.turn / change.way;
  const double turn = change.turn + bend_beyond * beyond;
  if (!(turn > 0)) return change.acceleration;
  const double bend = turn / (change.way + beyond);
  return std::min(change.acceleration, kTurningShare * change.jerk / (3 * bend * mean));
}

double s_ramp_way(const SpeedLevel& slower, double velocity, const SpeedLevel& faster,
                  const SpeedChange& change) {
  return (slower.velocity + velocity) / 2 *
         s_ramp_time(velocity - slower.velocity, acceleration_of(slower, velocity, faster, change),
                     change.jerk);
}

// Two changes that follow each other as one; `first` and `second`: by how much the speed changes.
SpeedChange joined(const SpeedChange& a, double first, const SpeedChange& b, double second) {
  const double way = a.way + b.way;
  const double part = way > 0 ? a.way / way : 0.5;
  const auto mean = [part](double x, double y) { return part * x + (1 - part) * y; };
  return {way, (first + second) / (first / a.acceleration + second / b.acceleration),
          mean(a.jerk, b.jerk), a.turn + b.turn};
}

// Of the change after `level`.
double acceleration_between(const SpeedLevel& level, const SpeedLevel& next) {
  const bool rises = next.velocity > level.velocity;
  const SpeedLevel& faster = rises ? next : level;
  return acceleration_of(rises ? level : next, faster.velocity, faster, level.after);
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
      way += s_ramp_way(levels_[neighbour], velocity, levels_[level], change(level, neighbour));
    }
    return way;
  }

  void fit(std::size_t level) {
    SpeedLevel& own = levels_[level];
    if (need(level, own.velocity) <= own.way) return;
    for (const std::size_t neighbour : {before_[level], after_[level]}) {
      if (neighbour != kNone && levels_[neighbour].velocity > own.velocity) {
        return run_through(level, neighbour);
      }
    }
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

  // A level half way up or down is not held but run through: where its S-curve does not end in
  // time, one of the whole change is no faster there.
  void run_through(std::size_t level, std::size_t faster) {
    const bool rises = faster > level;
    const std::size_t slower = rises ? before_[level] : after_[level];
    const SpeedChange& from = change(slower, level);
    const SpeedChange& to = change(level, faster);
    SpeedChange whole = joined(from, levels_[level].velocity - levels_[slower].velocity, to,
                               levels_[faster].velocity - levels_[level].velocity);
    whole.way += levels_[level].held;
    whole.turn += levels_[level].turn;
    levels_[std::min(slower, faster)].after = whole;
    levels_[faster].way += levels_[level].way;
    (rises ? after_ : before_)[slower] = faster;
    (rises ? before_ : after_)[faster] = slower;
    gone_[level] = true;
    ask(faster);
  }

  // Not even the speed of its neighbour is reached: the level is a part of the neighbour's way.
  void join(std::size_t level, std::size_t into) {
    levels_[into].way += levels_[level].way;
    levels_[into].held += levels_[level].held;
    levels_[into].turn += levels_[level].turn;
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
        level.after.acceleration = acceleration_between(level, levels_[after_[i]]);
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

// From rest to rest.
std::vector<SpeedLevel> speed_levels(std::span<const VelocityStretch> chain,
                                     std::span<const double> velocities,
                                     const ProfileRules& rules) {
  std::vector<SpeedLevel> levels;
  LevelBuilder builder(levels);
  for (std::size_t i = 0; i < chain.size(); ++i) {
    const StretchMotion motion(chain[i], velocities[i], velocities[i + 1], rules);
    for (const MotionPhase& phase : motion.phases()) builder.add(phase, chain[i]);
  }
  builder.finish();
  return levels;
}

// Lowers speeds until every change between two levels fits as an S-curve into the way that is
// there: that of the change itself and of the faster one of its levels. Levels that are no longer
// reached are gone. The sum of the ways stays. Cost: n log n.
void fit_s_curves(std::vector<SpeedLevel>& levels) { LevelList(levels).fit(); }

// --- phases ---------------------------------------------------------------------------------

double way_in(const JerkPhase& p, double t) {
  return t * (p.velocity + t * (p.acceleration / 2 + t * p.jerk / 6));
}

double velocity_in(const JerkPhase& p, double t) {
  return p.velocity + t * (p.acceleration + t * p.jerk / 2);
}

// The first time in [low, high] at which a rising function of time reaches `target`.
template <typename Function>
double time_of(const Function& value, double target, double low, double high) {
  for (int i = 0; i < kHalvings; ++i) {
    const double middle = (low + high) / 2;
    (value(middle) < target ? low : high) = middle;
  }
  return high;
}

}  // namespace

JerkMotion::JerkMotion(std::span<const VelocityStretch> chain, std::span<const double> velocities,
                       const ProfileRules& rules) {
  std::vector<SpeedLevel> levels = speed_levels(chain, velocities, rules);
  fit_s_curves(levels);
  for (std::size_t i = 0; i < levels.size(); ++i) {
    const SpeedLevel& level = levels[i];
    velocity_ = level.velocity;
    if (level.velocity > 0) add_phase(level.way / level.velocity, 0, 0);
    if (i + 1 < levels.size()) {
      add_change(level.velocity, levels[i + 1].velocity, level.after.acceleration,
                 level.after.jerk);
    }
  }
}

JerkMotion::JerkMotion(std::vector<JerkPhase> phases) : phases_(std::move(phases)) {
  if (phases_.empty()) return;
  const JerkPhase& last = phases_.back();
  duration_ = last.start + last.duration;
  way_ = last.way + way_in(last, last.duration);
}

void JerkMotion::add_phase(double duration, double acceleration, double jerk) {
  if (!(duration > 0)) return;
  const JerkPhase phase{duration_, duration, way_, velocity_, acceleration, jerk};
  phases_.push_back(phase);
  duration_ += duration;
  way_ += way_in(phase, duration);
  velocity_ = std::max(0.0, velocity_in(phase, duration));
}

void JerkMotion::add_change(double from, double to, double acceleration, double jerk) {
  const double change = std::abs(to - from);
  const double sign = to > from ? 1 : -1;
  if (!std::isfinite(jerk)) return add_phase(change / acceleration, sign * acceleration, 0);
  const bool reached = change * jerk > acceleration * acceleration;
  const double build_up = reached ? acceleration / jerk : std::sqrt(change / jerk);
  const double peak = jerk * build_up;
  const double held = reached ? change / acceleration - build_up : 0;
  add_phase(build_up, 0, sign * jerk);
  add_phase(held, sign * peak, 0);
  add_phase(build_up, sign * peak, -sign * jerk);
}

double JerkMotion::way_at(double time) const {
  if (phases_.empty() || time >= duration_) return way_;
  const JerkPhase& phase = *phase_at(phases_, time);
  return std::min(way_, phase.way + way_in(phase, std::max(0.0, time - phase.start)));
}

double JerkMotion::velocity_at(double time) const {
  if (phases_.empty() || time >= duration_) return 0;
  const JerkPhase& phase = *phase_at(phases_, time);
  return std::max(0.0, velocity_in(phase, std::max(0.0, time - phase.start)));
}

double JerkMotion::time_at(double way) const {
  if (phases_.empty() || way >= way_) return duration_;
  const JerkPhase& phase = *phase_at(phases_, way, &JerkPhase::way);
  return phase.start +
         time_of([&](double t) { return way_in(phase, t); }, way - phase.way, 0, phase.duration);
}

double JerkMotion::time_below(double velocity, double from, double to) const {
  double time = 0;
  for (auto phase = phase_at(phases_, from); phase != phases_.end() && phase->start < to; ++phase) {
    const double low = std::clamp(from - phase->start, 0.0, phase->duration);
    const double high = std::clamp(to - phase->start, 0.0, phase->duration);
    const double at_low = velocity_in(*phase, low);
    const double at_high = velocity_in(*phase, high);
    if (std::max(at_low, at_high) < velocity) {
      time += high - low;
    } else if (at_low < velocity) {
      time += time_of([&](double t) { return velocity_in(*phase, t); }, velocity, low, high) - low;
    } else if (at_high < velocity) {
      time +=
          high - time_of([&](double t) { return -velocity_in(*phase, t); }, -velocity, low, high);
    }
  }
  return time;
}

double profile_time(std::span<const VelocityStretch> chain, const ProfileRules& rules) {
  const std::vector<double> v = joint_velocities(chain, rules);
  if (has_jerk_limit(chain)) return JerkMotion(chain, v, rules).duration();
  double time = 0;
  for (std::size_t i = 0; i < chain.size(); ++i) {
    time += stretch_time(chain[i], v[i], v[i + 1], rules);
  }
  return time;
}

}  // namespace batten::postproc
