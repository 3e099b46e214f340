#include "postproc/machine/planner/feed_plan.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <span>
#include <utility>

#include "postproc/machine/planner/feed_plan_straight.h"
#include "postproc/machine/planner/feed_search.h"
#include "postproc/machine/planner/feed_sections.h"

namespace batten::postproc {
namespace {

using geometry::PathPiece;
using geometry::Vector3;

// The first interval from rest has constant jerk, so it must be short: a third of the first jerk
// phase by time is a 27th by way; at the end of that phase, at half the speed, the potential is
// 0.35 of its greatest.
constexpr GridRule grid_of(double density) {
  return {.density = density, .nodes_per_bend = 2, .rest_share = 0.35 / 27};
}

// A straight move is not refined, so it has more nodes from the start.
constexpr double kStraightDensity = 2;

// The search ends where no limit is exceeded by more than this part: a fiftieth of what is allowed
// between the nodes.
constexpr double kEnoughKept = 1e-4;

// Paths whose allowed speed changes a hundredfold within a millimetre take up to 120 steps. While
// the duals do not yet explain the gradient of the time, the search keeps `per_unexplained` of it
// as distance from the limits: with less, it would creep along them.
constexpr SearchRule kFirst = {.first_gap = 0.5,
                               .enough_gap = 1e-3,  // only says where nodes are missing
                               .enough_kept = kEnoughKept,
                               .least_slack = 0.2,
                               .least_gap_part = 0.08,
                               .per_unexplained = 0.1,
                               .most_steps = 150};

// The next start from it, near to what they find.
constexpr SearchRule kNext = {.first_gap = 0.02,
                              .enough_gap = 2e-5,
                              .enough_kept = kEnoughKept,
                              .least_slack = 0.02,
                              .least_gap_part = 0.08,
                              .per_unexplained = 0.1,
                              .most_steps = 150};

struct RefineRule {
  double excess;     // an interval is cut where it exceeds a limit by this part of it,
  double switching;  // or where the jerk (without jerk limit the acceleration) along the path
                     // changes by this part of its limit; above 2: never
};

// Intervals are cut where the jerk switches, once, and where a limit is exceeded between the
// positions that were asked, until it is so by less than half a percent; three times are rarely
// needed.
constexpr std::array<RefineRule, 4> kRefinements = {RefineRule{0.002, 0.5}, RefineRule{0.004, 2},
                                                    RefineRule{0.004, 2}, RefineRule{0.004, 2}};

// Of a plan for its time alone. Without any it would be half a percent too slow.
constexpr std::size_t kQuickRefinements = 1;

// Parameters this close are the same: rounding of sums.
constexpr double kSameParameter = 1e-12;

// q = (ds/dt)^2 and its first two derivatives by the distance s.
struct PlanState {
  double q = 0;
  double p = 0;
  double r = 0;

  [[nodiscard]] Vector3 acceleration(const LengthDerivatives& x) const {
    return x.second * q + x.first * (p / 2);
  }
  [[nodiscard]] Vector3 jerk(const LengthDerivatives& x) const {
    return (x.third * q + x.second * (1.5 * p) + x.first * (0.5 * r)) * std::sqrt(q);
  }
};

// `s` mm after the start of an interval with q and p at both ends: w = {q0, p0, q1, p1}.
PlanState state_in(const double* w, double length, double s) {
  const double rise = (w[2] - w[0]) / length;
  const double r0 = (6 * rise - 4 * w[1] - 2 * w[3]) / length;
  const double third = 6 * (w[1] + w[3] - 2 * rise) / (length * length);
  return {w[0] + s * (w[1] + s * (r0 / 2 + s * third / 6)), w[1] + s * (r0 + s * third / 2),
          r0 + s * third};
}

// Simpson's rule on 1 / sqrt(q).
double interval_seconds(double length, const double* w) {
  const double middle = state_in(w, length, 0.5 * length).q;
  return length / 6 * (1 / std::sqrt(w[0]) + 4 / std::sqrt(middle) + 1 / std::sqrt(w[2]));
}

// By length.
double middle_of(const PathPiece& piece, const FeedInterval& at) {
  return parameter_after(piece, at.t0, at.t1, at.length, 0.5 * at.length);
}

double greatest_part(const Vector3& value, const Vector3& limit) {
  return value.cwiseAbs().cwiseQuotient(limit).maxCoeff();
}

// The greatest part of any limit that a state uses.
double use_of_limits(const LengthDerivatives& x, const PlanState& at,
                     const KinematicPathLimits& limits) {
  const double v = std::sqrt(at.q);
  return std::max({v / limits.feed, greatest_part(x.first * v, limits.speed),
                   x.second.norm() * at.q / limits.normal_acceleration,
                   greatest_part(at.acceleration(x), limits.acceleration),
                   greatest_part(at.jerk(x), limits.jerk),
                   0.5 * std::abs(at.p) / limits.tangential_acceleration,
                   0.5 * std::abs(at.r) * v / limits.tangential_jerk});
}

// How much of its limit the jerk along the path changes by, or the acceleration where the
// jerk has no limit.
double change_along(const LengthDerivatives& x, const PlanState& from, const PlanState& to,
                    const KinematicPathLimits& limits) {
  const LimitsAlong along = limits_along(x.first, limits);
  if (std::isinf(along.jerk)) return 0.5 * std::abs(to.p - from.p) / along.acceleration;
  return 0.5 * std::abs(to.r * std::sqrt(to.q) - from.r * std::sqrt(from.q)) / along.jerk;
}

// A section as a problem of the search: the unknowns are q and p = dq/ds of the nodes in turn, q is
// a cubic on each interval, so speed and acceleration are continuous and the jerk may jump at
// nodes. Limits are asked for at both ends and in the middle of each interval.
class BentSection {
 public:
  BentSection(std::span<const PathPiece> path, const PlannedSection& section, LimitsOfPieces limits,
              double density)
      : path_(path),
        section_(section),
        limits_(limits),
        refinements_(density <= kQuickPlanDensity ? std::span(kRefinements).first(kQuickRefinements)
                                                  : std::span(kRefinements)) {
    intervals = intervals_of(section, path, limits, grid_of(density));
    if (section.start.is_rest()) {
      first = intervals.front();
      start = rest_motion(path[first.piece], first, limits_of(limits, first.piece));
      intervals.erase(intervals.begin());
    }
    if (section.end.is_rest()) {
      last = intervals.back();
      end = rest_motion(path[last.piece], last, limits_of(limits, last.piece));
      intervals.pop_back();
    }
  }

  void solve();

  std::vector<FeedInterval> intervals;  // between those from and to rest
  std::vector<double> x;                // the unknowns
  FeedInterval first;                   // from rest, where it is
  FeedInterval last;
  RestMotion start;
  RestMotion end;

 private:
  [[nodiscard]] SearchProblem problem() const;
  void add_interval(std::size_t number, SearchProblem& problem) const;
  [[nodiscard]] std::vector<double> rough_start(const SearchProblem& problem) const;
  [[nodiscard]] double monotone_slope(std::size_t node) const;
  bool raise_above_zero();
  [[nodiscard]] bool is_too_long(std::size_t number, const RefineRule& rule) const;
  std::size_t refine(const RefineRule& rule);

  std::span<const PathPiece> path_;
  const PlannedSection& section_;
  LimitsOfPieces limits_;
  std::span<const RefineRule> refinements_;
};

void BentSection::add_interval(std::size_t number, SearchProblem& problem) const {
  const FeedInterval& at = intervals[number];
  const KinematicPathLimits& limits = limits_of(limits_, at.piece);
  const double h = at.length;
  const double k = 6 / (h * h);
  // q, p and r at the start, in the middle and at the end, by the unknowns; Simpson's rule.
  std::array<Eigen::Matrix<double, 3, 4>, 3> sums;
  sums[0] << 1, 0, 0, 0, 0, 1, 0, 0, -k, -4 / h, k, -2 / h;
  sums[1] << 0.5, h / 8, 0.5, -h / 8, -1.5 / h, -0.25, 1.5 / h, -0.25, 0, -1 / h, 0, 1 / h;
  sums[2] << 0, 0, 1, 0, 0, 0, 0, 1, k, 2 / h, -k, 4 / h;
  const std::array<double, 3> t = {at.t0, middle_of(path_[at.piece], at), at.t1};
  for (std::size_t which = 0; which < 3; ++which) {
    SearchPlace place{.sums = sums[which], .first = 2 * number};
    place.time = which == 1 ? 4 * h / 6 : h / 6;
    const LengthDerivatives here = derivatives_by_length(path_[at.piece], t[which]);
    problem.add_jerk_rows(here, limits, place);
    // Speed and acceleration run on from the end of the interval before, unless the bend jumps.
    if (which > 0 || number == 0 || intervals[number - 1].piece != at.piece) {
      problem.add_other_limits(here, limits, place);
    }
    if (which == 2) place.lower_speed(at.end_bound);
    problem.places.push_back(place);
  }
}

SearchProblem BentSection::problem() const {
  SearchProblem problem;
  problem.unknowns = 2 * intervals.size() + 2;
  for (std::size_t k = 0; k < intervals.size(); ++k) add_interval(k, problem);
  const std::size_t q = problem.unknowns - 2;
  set_end(section_.start, start, 0, start.slope(), problem.places.front(), problem);
  set_end(section_.end, end, q, -end.slope(), problem.places.back(), problem);
  return problem;
}

// The slope at a node between two intervals that keeps a cubic monotone where the values are:
// their harmonic mean, or 0 at an extremum.
double BentSection::monotone_slope(std::size_t node) const {
  const auto rise = [&](std::size_t i) { return (x[2 * i + 2] - x[2 * i]) / intervals[i].length; };
  const double before = rise(node - 1);
  const double after = rise(node);
  return before * after > 0 ? 2 * before * after / (before + after) : 0;
}

// The envelope, rounded off. It exceeds limits.
std::vector<double> BentSection::rough_start(const SearchProblem& problem) const {
  const double first_speed = start.is_there() ? first.end_speed : section_.start.speed;
  std::vector<double> q = {std::min(first_speed * first_speed, problem.places.front().most)};
  for (std::size_t i = 0; i < intervals.size(); ++i) {
    const double v = intervals[i].end_speed;
    q.push_back(std::min(v * v, problem.places[3 * i + 2].most));
  }
  constexpr int kPasses = 12;  // about two changes of the speed, at the usual density
  smooth(q, kPasses);
  BentSection rough = *this;
  rough.x.assign(problem.unknowns, 0);
  for (std::size_t i = 0; i < q.size(); ++i) rough.x[2 * i] = q[i];
  for (std::size_t i = 1; i + 1 < q.size(); ++i) rough.x[2 * i + 1] = rough.monotone_slope(i);
  problem.tie(rough.x);
  return std::move(rough.x);
}

// The search asks of its start that speed^2 is above 0 everywhere. A cubic between nodes that were
// added may not be: there the slopes at its ends become those of a monotone one. False where that
// does not help.
bool BentSection::raise_above_zero() {
  const std::size_t n = intervals.size();
  const auto is_above = [&](std::size_t i) {
    const double* w = x.data() + 2 * i;
    return w[0] > 0 && w[2] > 0 &&
           state_in(w, intervals[i].length, 0.5 * intervals[i].length).q > 0;
  };
  // Flatter slopes may take the neighbours below 0, which are flattened in the next pass.
  constexpr int kPasses = 4;
  for (int pass = 0; pass < kPasses; ++pass) {
    bool above = true;
    for (std::size_t i = 0; i < n; ++i) {
      if (is_above(i)) continue;
      above = false;
      for (const std::size_t node : {i, i + 1}) {
        if (node > 0 && node < n) x[2 * node + 1] = monotone_slope(node);
      }
    }
    if (above) return true;
  }
  return false;
}

bool BentSection::is_too_long(std::size_t number, const RefineRule& rule) const {
  const FeedInterval& at = intervals[number];
  const PathPiece& piece = path_[at.piece];
  const KinematicPathLimits& limits = limits_of(limits_, at.piece);
  const double* window = x.data() + 2 * number;
  const auto state_at = [&](double s) { return state_in(window, at.length, s); };
  const LengthDerivatives middle = derivatives_by_length(piece, 0.5 * (at.t0 + at.t1));
  if (change_along(middle, state_at(0), state_at(at.length), limits) > rule.switching) return true;
  // The limits are kept at both ends and in the middle: look between those.
  return std::ranges::any_of(std::array{0.125, 0.25, 0.375, 0.625, 0.75, 0.875}, [&](double part) {
    const double t = at.t0 + part * (at.t1 - at.t0);
    const PlanState state = state_at(length_between(piece, at.t0, t));
    return use_of_limits(derivatives_by_length(piece, t), state, limits) > 1 + rule.excess;
  });
}

// Cuts intervals in two; the speeds stay. Returns how many were cut.
std::size_t BentSection::refine(const RefineRule& rule) {
  std::vector<FeedInterval> finer;
  std::vector<double> finer_x = {x[0], x[1]};
  for (std::size_t k = 0; k < intervals.size(); ++k) {
    FeedInterval half = intervals[k];
    const double* window = x.data() + 2 * k;
    if (is_too_long(k, rule)) {
      const PathPiece& piece = path_[half.piece];
      half.t1 = middle_of(piece, half);
      half.length = length_between(piece, half.t0, half.t1);
      half.end_bound = KinematicPathLimits::kNone;
      const PlanState middle = state_in(window, intervals[k].length, half.length);
      half.end_speed = std::sqrt(middle.q);
      finer.push_back(half);
      finer_x.insert(finer_x.end(), {middle.q, middle.p});
      half = intervals[k];
      half.t0 = finer.back().t1;
      half.length -= finer.back().length;
    }
    finer.push_back(half);
    finer_x.insert(finer_x.end(), {window[2], window[3]});
  }
  const std::size_t cut = finer.size() - intervals.size();
  intervals = std::move(finer);
  x = std::move(finer_x);
  return cut;
}

SearchResult searched(const SearchProblem& problem, std::vector<double> start,
                      const SearchRule& rule) {
  SearchResult result = fastest(problem, std::move(start), rule);
  if (result.excess > kEnoughKept) slow_down(problem, result.unknowns);
  return result;
}

void BentSection::solve() {
  const SearchProblem rough = problem();
  std::vector<double> begin = rough_start(rough);
  SearchResult first_found = searched(rough, begin, kFirst);
  // It may lose itself, too, at a cusp: then all goes as slowly as that has to be passed.
  if (!std::isfinite(first_found.seconds)) {
    slow_down(rough, begin);
    x = std::move(begin);
    return;
  }
  x = std::move(first_found.unknowns);
  for (const RefineRule& rule : refinements_) {
    BentSection finer = *this;
    if (finer.refine(rule) == 0 && &rule != &refinements_.front()) return;
    const SearchProblem stated = finer.problem();
    SearchResult found = finer.raise_above_zero()
                             ? searched(stated, finer.x, kNext)
                             : searched(stated, finer.rough_start(stated), kFirst);
    // The search may lose itself where the speed is next to nothing within the path.
    if (!std::isfinite(found.seconds)) return;
    intervals = std::move(finer.intervals);
    x = std::move(found.unknowns);
  }
}

// --- the plan -----------------------------------------------------------------------------------

class Planner {
 public:
  Planner(std::span<const PathPiece> path, LimitsOfPieces limits, double density)
      : path_(path), limits_(limits), density_(density) {}

  FeedPlan run(const PlanEnds& ends) {
    const PassedJoints joints =
        for_each_section(path_, limits_, ends, [this](const PlannedSection& section) {
          section.is_straight() ? plan_straight(section) : plan_bent(section);
        });
    plan_.stops = joints.stops;
    plan_.passed_jumps = joints.jumps;
    return std::move(plan_);
  }

 private:
  void plan_straight(const PlannedSection& section) {
    const StraightRun run = straight_run(section, path_, limits_);
    // From rest the acceleration is there at once where the jerk has no limit.
    start_nodes(section, run.from, run.from > 0 ? 0 : run.state_at(0).acceleration);
    std::vector<double> ends;
    double sum = 0;
    for (const FeedPart& part : section.parts) ends.push_back(sum += part.length);
    std::size_t part = 0;
    StraightState last;
    double last_time = 0;
    for (const double time :
         node_times(run, std::span(ends).first(ends.size() - 1), kStraightDensity * density_)) {
      const StraightState state = run.state_at(time);
      const double length = section.parts[part].length;
      double t = 1 - (ends[part] - state.distance) / length;
      if (t > 1 - kSameParameter && part + 1 < ends.size()) {
        ++part;
        t = 0;
      }
      add_node(section.parts[part].piece, std::clamp(t, 0.0, 1.0), state.distance - last.distance,
               time - last_time, state.speed, state.acceleration);
      last = state;
      last_time = time;
    }
  }

  void plan_bent(const PlannedSection& section) {
    BentSection bent(path_, section, limits_, density_);
    bent.solve();
    const std::vector<double>& x = bent.x;
    const auto& intervals = bent.intervals;
    const std::size_t n = intervals.size();
    // Interval k ends where the next one starts.
    const auto add = [&](double length, std::size_t next, double seconds, double q, double p) {
      const FeedInterval& last = bent.end.is_there() ? bent.last : intervals.back();
      const bool is_end = next > n || (next == n && !bent.end.is_there());
      const FeedInterval& at = next < n ? intervals[next] : last;
      add_node(at.piece, is_end ? at.t1 : at.t0, length, seconds, std::sqrt(q), p / 2);
    };
    if (bent.start.is_there()) {
      start_nodes(section, 0, bent.start.acceleration_at_rest(x[0]));
      add(bent.start.length, 0, bent.start.time() / std::sqrt(x[0]), x[0], x[1]);
    } else {
      start_nodes(section, std::sqrt(x[0]), x[1] / 2);
    }
    for (std::size_t i = 0; i < n; ++i) {
      const double length = intervals[i].length;
      add(length, i + 1, interval_seconds(length, x.data() + 2 * i), x[2 * i + 2], x[2 * i + 3]);
    }
    if (bent.end.is_there()) {
      const double q = x[2 * n];
      add(bent.end.length, n + 1, bent.end.time() / std::sqrt(q), 0,
          -2 * bent.end.acceleration_at_rest(q));
    }
  }

  void start_nodes(const PlannedSection& section, double speed, double acceleration) {
    if (plan_.nodes.empty()) plan_.nodes.emplace_back();
    FeedPlanNode& node = plan_.nodes.back();
    node.speed = speed;
    node.acceleration = acceleration;
    node.piece = section.parts.front().piece;
    node.t = 0;
  }

  // A node `length` mm and some seconds after the last one.
  void add_node(std::size_t piece, double t, double length, double seconds, double speed,
                double acceleration) {
    plan_.time += seconds;
    plan_.nodes.push_back(
        {plan_.nodes.back().distance + length, speed, acceleration, plan_.time, piece, t});
  }

  std::span<const PathPiece> path_;
  LimitsOfPieces limits_;
  double density_;
  FeedPlan plan_;
};

}  // namespace

FeedPlan plan_feed(std::span<const PathPiece> path, const KinematicPathLimits& limits,
                   const PlanEnds& ends, double density) {
  return plan_feed(path, LimitsOfPieces(&limits, 1), ends, density);
}

FeedPlan plan_feed(std::span<const PathPiece> path, LimitsOfPieces limits, const PlanEnds& ends,
                   double density) {
  return Planner(path, limits, density).run(ends);
}

std::vector<double> plan_nodes(std::span<const PathPiece> path, const KinematicPathLimits& limits,
                               double density) {
  std::vector<double> nodes(path.size(), 0);
  const LimitsOfPieces same(&limits, 1);
  for_each_section(path, same, {}, [&](const PlannedSection& section) {
    if (section.is_straight()) {
      ++nodes[section.parts.front().piece];
      return;
    }
    for (const FeedInterval& at : intervals_of(section, path, same, grid_of(density))) {
      ++nodes[at.piece];
    }
  });
  return nodes;
}

}  // namespace batten::postproc
