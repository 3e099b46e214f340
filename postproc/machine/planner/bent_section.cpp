#include "postproc/machine/planner/bent_section.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include "postproc/machine/planner/speed_cubic.h"

namespace batten::postproc {

using geometry::PathPiece;
using geometry::Vector3;

namespace {

// The first interval from rest has constant jerk, so it must be short: a third of the first jerk
// phase by time is a 27th by way; at the end of that phase, at half the speed, the potential is
// 0.35 of its greatest.
constexpr double kRestShare = 0.35 / 27;

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

}  // namespace

struct RefineRule {
  double excess;     // an interval is cut where it exceeds a limit by this part of it,
  double switching;  // or where the jerk (without jerk limit the acceleration) along the path
                     // changes by this part of its limit; above 2: never
};

namespace {

// Intervals are cut where the jerk switches, once, and where a limit is exceeded between the
// positions that were asked, until it is so by less than half a percent; three times are rarely
// needed.
constexpr std::array<RefineRule, 4> kRefinements = {RefineRule{0.002, 0.5}, RefineRule{0.004, 2},
                                                    RefineRule{0.004, 2}, RefineRule{0.004, 2}};

// Of a plan for its time alone. Without any it would be half a percent too slow.
constexpr std::size_t kQuickRefinements = 1;

// By length.
double middle_of(const PathPiece& piece, const FeedInterval& at) {
  return parameter_after(piece, at.t0, at.t1, at.length, 0.5 * at.length);
}

double greatest_part(const Vector3& value, const Vector3& limit) {
  return value.cwiseAbs().cwiseQuotient(limit).maxCoeff();
}

// The greatest part of any limit that a state uses.
double use_of_limits(const LengthDerivatives& x, const PlannedState& at,
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
double change_along(const LengthDerivatives& x, const PlannedState& from, const PlannedState& to,
                    const KinematicPathLimits& limits) {
  const LimitsAlong along = limits_along(x.first, limits);
  if (std::isinf(along.jerk)) return 0.5 * std::abs(to.p - from.p) / along.acceleration;
  return 0.5 * std::abs(to.r * std::sqrt(to.q) - from.r * std::sqrt(from.q)) / along.jerk;
}

// Of the unknowns of a node.
std::ptrdiff_t index_of(std::size_t node) { return static_cast<std::ptrdiff_t>(2 * node); }

// Of the nodes `from` to `to`, the last included.
std::size_t slowest(const std::vector<double>& x, std::size_t from, std::size_t to) {
  std::size_t found = to;
  for (std::size_t node = from; node < to; ++node) {
    if (x[2 * node] < x[2 * found]) found = node;
  }
  return found;
}

// The slope at a node between two intervals that keeps a cubic monotone where the values are:
// their harmonic mean, or 0 at an extremum.
double monotone_slope(std::span<const FeedInterval> intervals, const std::vector<double>& x,
                      std::size_t node) {
  const auto rise = [&](std::size_t i) { return (x[2 * i + 2] - x[2 * i]) / intervals[i].length; };
  const double before = rise(node - 1);
  const double after = rise(node);
  return before * after > 0 ? 2 * before * after / (before + after) : 0;
}

// The search asks of its start that speed^2 is above 0 everywhere. A cubic between nodes that were
// added may not be: there the slopes at its ends become those of a monotone one. False where that
// does not help.
bool raise_above_zero(std::span<const FeedInterval> intervals, std::vector<double>& x) {
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
        if (node > 0 && node < n) x[2 * node + 1] = monotone_slope(intervals, x, node);
      }
    }
    if (above) return true;
  }
  return false;
}

}  // namespace

GridRule grid_of(double density) {
  return {.density = density, .nodes_per_bend = 2, .rest_share = kRestShare};
}

BentSection::BentSection(std::span<const PathPiece> path, const PlannedSection& section,
                         LimitsOfPieces limits, double density, const SectionWindows& windows)
    : path_(path),
      section_(section),
      limits_(limits),
      refinements_(density <= kQuickPlanDensity ? std::span(kRefinements).first(kQuickRefinements)
                                                : std::span(kRefinements)),
      windows_(windows) {
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

// Limits are asked for at both ends and in the middle of the interval.
void BentSection::add_interval(std::size_t number, std::size_t from, SearchProblem& problem) const {
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
    SearchPlace place{.sums = sums[which], .first = 2 * (number - from)};
    place.time = which == 1 ? 4 * h / 6 : h / 6;
    const LengthDerivatives here = derivatives_by_length(path_[at.piece], t[which]);
    problem.add_jerk_rows(here, limits, place);
    // Speed and acceleration run on from the end of the interval before, unless the bend jumps;
    // where a window begins they are given.
    if (which > 0 || number == 0 || (number > from && intervals[number - 1].piece != at.piece)) {
      problem.add_other_limits(here, limits, place);
    }
    if (which == 2) place.lower_speed(at.end_bound);
    problem.places.push_back(place);
  }
}

// `found`: the unknowns of the whole section, up to where the window begins.
SearchProblem BentSection::problem(const Window& window, const std::vector<double>& found) const {
  const auto& [from, to] = window;
  SearchProblem problem;
  problem.unknowns = 2 * (to - from) + 2;
  for (std::size_t k = from; k < to; ++k) add_interval(k, from, problem);
  if (from == 0) {
    set_end(section_.start, start, 0, start.slope(), problem.places.front(), problem);
  } else {
    problem.ties.push_back({.tied = 0, .free = 1, .factor = 0, .offset = found[2 * from]});
    problem.ties.push_back({.tied = 1, .free = 0, .factor = 0, .offset = found[2 * from + 1]});
  }
  if (to == intervals.size()) {
    const std::size_t q = problem.unknowns - 2;
    set_end(section_.end, end, q, -end.slope(), problem.places.back(), problem);
  }
  return problem;
}

// What there is, where that may be gone on from; else empty.
std::vector<double> BentSection::next_start(const Window& window,
                                            const SearchProblem& problem) const {
  if (x.empty()) return {};
  const std::size_t size = window.to - window.from;
  std::vector<double> start(x.begin() + index_of(window.from), x.begin() + index_of(window.to + 1));
  problem.tie(start);
  if (!raise_above_zero(std::span(intervals).subspan(window.from, size), start)) return {};
  return start;
}

// The envelope, rounded off, behind what the window before found. It exceeds limits.
std::vector<double> BentSection::rough_start(const Window& window, const SearchProblem& problem,
                                             const std::vector<double>& found) const {
  const auto& [from, to] = window;
  const std::span within = std::span(intervals).subspan(from, to - from);
  const double v0 = start.is_there() ? first.end_speed : section_.start.speed;
  std::vector<double> q = {from > 0 ? found[2 * from]
                                    : std::min(v0 * v0, problem.places.front().most)};
  for (std::size_t i = 0; i < within.size(); ++i) {
    const double v = within[i].end_speed;
    q.push_back(std::min(v * v, problem.places[3 * i + 2].most));
  }
  constexpr int kPasses = 12;  // about two changes of the speed, at the usual density
  smooth(q, kPasses);
  std::vector<double> rough(problem.unknowns);
  for (std::size_t i = 0; i < q.size(); ++i) rough[2 * i] = q[i];
  for (std::size_t i = 1; i + 1 < q.size(); ++i) {
    rough[2 * i + 1] = monotone_slope(within, rough, i);
  }
  problem.tie(rough);
  return rough;
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
    const PlannedState state = state_at(length_between(piece, at.t0, t));
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
      const PlannedState middle = state_in(window, intervals[k].length, half.length);
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

// From the unknowns that there are, or a rough start. False where a search loses itself, and where
// one of several windows does not keep the limits: a slower state there would not be that of its
// neighbours.
bool BentSection::search_in(const SectionWindows& size) {
  const std::size_t n = intervals.size();
  std::vector<double> found(2 * n + 2);
  windows = 0;
  Window window;
  while (true) {
    ++windows;
    const std::size_t after = window.from + size.kept;
    window.to = n > after + 2 * size.ahead ? after + size.ahead : n;
    const SearchProblem stated = problem(window, found);
    std::vector<double> begin = next_start(window, stated);
    const bool is_rough = begin.empty();
    if (is_rough) begin = rough_start(window, stated, found);
    SearchResult result = fastest(stated, std::move(begin), is_rough ? kFirst : kNext);
    if (!std::isfinite(result.seconds)) return false;
    const bool is_whole = window.from == 0 && window.to == n;
    if (result.excess > kEnoughKept) {
      if (!is_whole) return false;
      slow_down(stated, result.unknowns);
    }
    std::ranges::copy(result.unknowns, found.begin() + index_of(window.from));
    if (window.to == n) break;
    window.from = slowest(found, window.from + size.kept / 2, after);
  }
  x = std::move(found);
  return true;
}

bool BentSection::search() {
  const std::size_t n = intervals.size();
  const bool is_long = n > windows_.kept + 2 * windows_.ahead;
  return (is_long && search_in(windows_)) || search_in({.kept = n, .ahead = 0});
}

void BentSection::solve() {
  if (!search()) {
    const Window whole{.to = intervals.size()};
    const SearchProblem rough = problem(whole, {});
    x = rough_start(whole, rough, {});
    slow_down(rough, x);
    return;
  }
  for (const RefineRule& rule : refinements_) {
    BentSection finer = *this;
    if (finer.refine(rule) == 0 && &rule != &refinements_.front()) return;
    // It may lose itself where the speed is next to nothing within the path.
    if (!finer.search()) return;
    windows = finer.windows;
    intervals = std::move(finer.intervals);
    x = std::move(finer.x);
  }
}

}  // namespace batten::postproc
