#include "geometry/fitting/fair/fair_problem.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <optional>
#include <utility>

namespace batten::geometry {

namespace {

// A corner is rounded within this many tolerances along its legs: enough for the curve to
// leave the line gently, little enough to keep its deviation local.
constexpr double kReach = 40;

// Knots around a corner start at this part of the limit and double outwards.
constexpr double kFirstKnot = 0.5;

// The first fit has a knot per so many vertices; spans that cannot follow are split.
constexpr std::size_t kVerticesPerSpan = 64;

// Scatter is taken this much greater than the estimated noise: a curve that follows a part of
// the noise is worse than one that is a little too smooth.
constexpr double kNoiseMargin = 1.2;

// Where the curve through the vertices would leave the chords by more than this part of the
// limit, the vertices no longer bind: the curve runs between vertices and chords. Otherwise
// it would have to swing out to each vertex.
constexpr double kTooHigh = 0.7;

// Smooth edges whose chord may leave the curve by this part of the limit are watched between
// their vertices; so are those whose vertices leave the curve as much room.
constexpr double kWatchedSagitta = 0.25;

// A vertex whose chords leave the path by so many times what it may scatter has a knot at once.
// Knots that come one by one, where a span fails, stand elsewhere in the next row of a surface, and
// the curve is off elsewhere.
constexpr double kCoarse = 4;

// Printed places scatter by their rounding, 0.58 of its greatest error (rms of a coordinate), and
// the curve leaves this part of that error: with less it would follow the rounding itself. So near
// a curve is worth its knots only where chords leave the path by more than the rounding does: it
// may leave so many greatest errors squared, over that height, and one of them at the most.
constexpr double kLeftOfRounding = 0.4;
constexpr double kWorthKnots = 1.6;

// Noise that is more than so many of the greatest rounding errors is no rounding: no more of it is
// taken away, for a curve that leaves less follows the noise.
constexpr double kProblemNoise = 2;

// A noisy vertex is drawn towards the place that it was meant to have, by so much of the limit at
// the most; what is left is room for the curve. With more of it the curve is nearer to what was
// meant, and bends harder: with nine tenths it takes 4 % longer, with half it is 3 % further away.
// So much of the limit is the curve expected to pass the drawn vertices at: with less of it edges
// are kept, with more the curve is no smoother.
constexpr double kTowardsMeant = 0.7;
constexpr double kMeantScatter = 0.3;

// The middle of a line edge that stays exactly straight.
struct Straight {
  double from;
  double to;
};

class ProblemMaker {
 public:
  ProblemMaker(std::span<const Point3> points, const PathFeatures& features,
               std::span<const double> loosen, std::span<const EdgeRefinement> care,
               const BandOptions& options)
      : p_(points),
        f_(features),
        loosen_(loosen),
        care_(care),
        options_(options),
        n_(points.size()) {}

  FitProblem make() {
    find_reaches();
    problem_.samples.reserve(n_ + n_ / 4);
    problem_.breakpoints.reserve(n_);
    add(0, n_);
    problem_.breakpoints =
        knots_of(std::move(problem_.breakpoints), std::move(corner_knots_), problem_,
                 {f_.parameters.front(), f_.parameters.back()}, closest_knots(options_));
    return std::move(problem_);
  }

  // Each stretch of them starts at a smooth vertex and goes on to the next one: how edges are
  // watched is told by the last smooth vertex before them.
  void remake(std::span<const std::size_t> changed, std::vector<FitSample>& samples) {
    find_reaches();
    std::vector<FitSample> all;
    all.reserve(samples.size() + samples.size() / 8);
    auto old = samples.cbegin();
    std::size_t done = 0;  // vertices before this one are as they shall be
    for (const std::size_t vertex : changed) {
      if (vertex < done) continue;
      std::size_t begin = vertex;
      while (begin > done && !smooth(begin)) --begin;
      std::size_t end = vertex + 1;
      while (end < n_ && !smooth(end)) ++end;
      while (old != samples.cend() && old->parameter < f_.parameters[begin]) all.push_back(*old++);
      problem_.samples.clear();
      add(begin, end);
      all.insert(all.end(), problem_.samples.begin(), problem_.samples.end());
      while (old != samples.cend() && (end == n_ || old->parameter < f_.parameters[end])) ++old;
      done = end;
    }
    all.insert(all.end(), old, samples.cend());
    samples = std::move(all);
  }

 private:
  // The vertices [begin, end[ and the edges behind them.
  void add(std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) {
      add_vertex(i);
      if (i + 1 == n_) break;
      const std::size_t before = problem_.samples.size();
      add_edge(i);
      put_in_order(before);
    }
  }

  [[nodiscard]] bool smooth(std::size_t i) const { return f_.kinds[i] == VertexKind::kSmooth; }
  [[nodiscard]] double length(std::size_t edge) const {
    return f_.parameters[edge + 1] - f_.parameters[edge];
  }
  [[nodiscard]] Vector3 direction(std::size_t edge) const {
    return (p_[edge + 1] - p_[edge]) / length(edge);
  }
  [[nodiscard]] bool corner(std::size_t i) const { return f_.kinds[i] == VertexKind::kCorner; }
  [[nodiscard]] bool pinned(std::size_t i) const { return f_.kinds[i] == VertexKind::kKeptCorner; }

  // How far each corner's rounding may go along the path: not past the middle of the way to
  // the next corner.
  void find_reaches() {
    reach_before_.assign(n_, 0);
    reach_after_.assign(n_, 0);
    std::optional<std::size_t> last;
    for (std::size_t i = 0; i < n_; ++i) {
      if (!corner(i) && !pinned(i)) continue;
      if (last) {
        const double way = f_.parameters[i] - f_.parameters[*last];
        const double share = corner(i) && corner(*last) ? 0.45 : 0.9;
        const double reach = std::min(kReach * options_.limit, share * way);
        if (corner(*last)) reach_after_[*last] = reach;
        if (corner(i)) reach_before_[i] = reach;
      }
      last = i;
    }
  }

  void add_vertex(std::size_t i) {
    if (pinned(i)) {
      problem_.pins.push_back({f_.parameters[i], p_[i]});
      problem_.breakpoints.push_back(f_.parameters[i]);
      since_break_ = 0;
      return;
    }
    FitSample sample;
    sample.parameter = f_.parameters[i];
    sample.target = p_[i];
    sample.limit = options_.limit * std::min(share(i - 1), share(i));
    if (corner(i)) {
      problem_.samples.push_back(sample);
      add_corner_knots(i);
      return;
    }
    sample.along = (p_[i + 1] - p_[i - 1]).normalized();
    const bool rounded = inside_reach(f_.parameters[i]);
    sample.scatter = rounded ? 0 : scatter(i);
    const bool drawn = noisy(i) && (!rounded || noise_fills_band(i));
    if (drawn) draw_to_meant(i, sample);
    loose_ = !(sample.scatter > 0) || sample.scatter > kWatchedSagitta * options_.limit;
    problem_.samples.push_back(sample);
    // A vertex's own knot does not move those that come by number: what is fitted further on is the
    // same with and without it.
    const bool by_number = ++since_break_ >= kVerticesPerSpan;
    if (by_number) since_break_ = 0;
    // A curve among noise turns at each.
    if (by_number || drawn || has_own_knot(i)) problem_.breakpoints.push_back(f_.parameters[i]);
  }

  [[nodiscard]] bool has_own_knot(std::size_t i) const {
    if (!wants_near(i) || noisy(i)) return false;
    return std::max(f_.bows[i - 1], f_.bows[i]) > kCoarse * expected(i);
  }

  [[nodiscard]] bool noisy(std::size_t i) const {
    return !options_.meant.empty() && options_.meant[i] != p_[i];
  }

  [[nodiscard]] bool noise_fills_band(std::size_t i) const { return f_.noise[i] > options_.limit; }

  // Where noise takes much of the band: towards the place that the vertex was meant to have, as
  // near as the band allows, with some room around it. Where noise fills the band, with all that is
  // left: the neighbours leave little of it.
  void draw_to_meant(std::size_t i, FitSample& sample) const {
    const Vector3 off = options_.meant[i] - p_[i];
    const double room = kTowardsMeant * sample.limit;
    sample.target += std::min(1.0, room / std::max(off.norm(), room)) * off;
    sample.limit -= noise_fills_band(i) ? (sample.target - p_[i]).norm() : room;
    const double loose = looseness(i);
    sample.scatter = std::isinf(loose) ? 0 : kMeantScatter * options_.limit * loose;
  }

  [[nodiscard]] double looseness(std::size_t i) const { return loosen_.empty() ? 1 : loosen_[i]; }

  [[nodiscard]] double share(std::size_t edge) const {
    return care_.empty() ? 1 : care_[edge].share;
  }

  [[nodiscard]] double scatter(std::size_t i) const {
    const double height = std::max(f_.bows[i - 1], f_.bows[i]);
    if (height > kTooHigh * options_.limit) return 0;
    const double loose = looseness(i);
    return std::isinf(loose) ? 0 : expected(i) * loose;
  }

  [[nodiscard]] double expected(std::size_t i) const {
    const double noise = f_.noise[i];
    const double part = left_of_rounding(i);
    const double left = std::max(part * noise, noise - kProblemNoise * options_.rounding);
    return std::max({kNoiseMargin * left, part * options_.rounding, options_.scatter});
  }

  // Whether the curve shall be as near to vertex i as its decimals tell the place: not where its
  // noise is more than rounding, where the feed asks for room, or where a simple curve is wanted.
  [[nodiscard]] bool wants_near(std::size_t i) const {
    if (options_.accurate) return true;
    return options_.near && !(options_.scatter > 0) && looseness(i) == 1 &&
           f_.noise[i] <= options_.rounding;
  }

  // Of what vertex i scatters by, the part that the curve may leave.
  [[nodiscard]] double left_of_rounding(std::size_t i) const {
    if (!wants_near(i)) return 1;
    if (options_.accurate) return kLeftOfRounding;
    const double height = std::min(f_.bows[i - 1], f_.bows[i]);
    const double least = kWorthKnots * options_.rounding;
    return height > least ? std::max(least / height, kLeftOfRounding) : 1;
  }

  // Whether a corner nearby owns this place. Vertices come in order, so the last corner seen
  // and the next one are enough.
  [[nodiscard]] bool inside_reach(double u) {
    while (next_ < n_ && (!corner(next_) || f_.parameters[next_] < u)) {
      if (corner(next_)) before_ = next_;
      ++next_;
    }
    if (before_ && u - f_.parameters[*before_] < reach_after_[*before_]) return true;
    return next_ < n_ && f_.parameters[next_] - u < reach_before_[next_];
  }

  void add_corner_knots(std::size_t i) {
    const double u = f_.parameters[i];
    const double first = kFirstKnot * options_.limit;
    for (double d = first; d < reach_before_[i]; d *= 2) corner_knots_.push_back(u - d);
    for (double d = first; d < reach_after_[i]; d *= 2) corner_knots_.push_back(u + d);
    corner_knots_.push_back(u - std::max(reach_before_[i], first / 2));
    corner_knots_.push_back(u + std::max(reach_after_[i], first / 2));
    since_break_ = 0;
  }

  // The exactly straight middle of a line; nothing when the line has no room for one.
  [[nodiscard]] std::optional<Straight> straight_of(std::size_t edge) const {
    // Between two pins nothing else would hold a curve.
    const bool between_pins = pinned(edge) && pinned(edge + 1);
    if (!f_.lines[edge] && !between_pins) return std::nullopt;
    const double before = end_room(edge, edge, reach_after_[edge]);
    const double after = end_room(edge, edge + 1, reach_before_[edge + 1]);
    if (before + after > 0.6 * length(edge)) return std::nullopt;
    return Straight{f_.parameters[edge] + before, f_.parameters[edge + 1] - after};
  }

  // What a line gives to its neighbour at one end.
  [[nodiscard]] double end_room(std::size_t edge, std::size_t vertex, double reach) const {
    if (pinned(vertex)) return 0;
    if (corner(vertex)) return reach;
    const std::size_t other = vertex == edge ? edge - 1 : edge + 1;
    return std::min(2 * length(other), 0.25 * length(edge));
  }

  void add_edge(std::size_t edge) {
    const double u0 = f_.parameters[edge];
    const double u1 = f_.parameters[edge + 1];
    if (const auto straight = straight_of(edge)) {
      add_watching_samples(edge, u0, straight->from);
      add_watching_samples(edge, straight->to, u1);
      if (!pinned(edge) && !corner(edge)) add_smooth_end(u0, straight->from, edge);
      add_leg_samples(edge, u0, straight->from);
      problem_.breakpoints.push_back(straight->from);
      problem_.breakpoints.push_back(straight->to);
      const Vector3 d = direction(edge);
      problem_.zones.push_back({straight->from, straight->to, p_[edge] + (straight->from - u0) * d,
                                p_[edge] + (straight->to - u0) * d});
      add_leg_samples(edge, straight->to, u1);
      if (!pinned(edge + 1) && !corner(edge + 1)) add_smooth_end(straight->to, u1, edge);
      since_break_ = 0;
      return;
    }
    add_watching_samples(edge, u0, u1);
    const bool leg = corner(edge) || corner(edge + 1);
    const double height = length(edge) * std::max(f_.turns[edge], f_.turns[edge + 1]) / 8;
    if (leg) {
      add_leg_samples(edge, u0, u1);
    } else if (height > kWatchedSagitta * options_.limit) {
      for (const double part : {0.25, 0.5, 0.75}) add_sample_on(edge, u0 + part * (u1 - u0));
    } else if (loose_) {
      add_sample_on(edge, 0.5 * (u0 + u1));
    }
  }

  // A line that leaves a curve smoothly: knots at the joint and half way to its straight part.
  void add_smooth_end(double from, double to, std::size_t) {
    problem_.breakpoints.push_back(from);
    problem_.breakpoints.push_back(0.5 * (from + to));
    problem_.breakpoints.push_back(to);
  }

  // Samples on an edge as dense as the corner knots around: they double away from corners.
  void add_leg_samples(std::size_t edge, double from, double to) {
    const double first = 0.5 * kFirstKnot * options_.limit;
    std::vector<double> places;
    constexpr double kStep = 1.4142135623730951;  // two samples per doubling
    const double u0 = f_.parameters[edge];
    const double u1 = f_.parameters[edge + 1];
    if (corner(edge)) {
      for (double d = first; u0 + d < to && d < 2 * reach_after_[edge]; d *= kStep) {
        if (u0 + d > from) places.push_back(u0 + d);
      }
    }
    if (corner(edge + 1)) {
      for (double d = first; u1 - d > from && d < 2 * reach_before_[edge + 1]; d *= kStep) {
        if (u1 - d < to) places.push_back(u1 - d);
      }
    }
    for (const double part : {0.25, 0.5, 0.75}) places.push_back(from + part * (to - from));
    std::sort(places.begin(), places.end());
    for (const double u : places) {
      if (u > from && u < to) add_sample_on(edge, u);
    }
  }

  // Where the curve has left the edge before. At odd parts, where no other samples are.
  void add_watching_samples(std::size_t edge, double from, double to) {
    constexpr int kPerViolation = 4;
    constexpr int kMost = 8;
    const int count = care_.empty() ? 0 : std::min(kMost, kPerViolation * care_[edge].violations);
    for (int k = 0; k < count && to > from; ++k) {
      add_sample_on(edge, from + (to - from) * (2 * k + 1) / (2 * count));
    }
  }

  void add_sample_on(std::size_t edge, double u) {
    FitSample sample;
    sample.parameter = u;
    sample.along = direction(edge);
    sample.target = p_[edge] + (u - f_.parameters[edge]) * sample.along;
    sample.limit = options_.limit * share(edge);
    problem_.samples.push_back(sample);
  }

  // Samples of one edge, from this one on: those that watch it came first.
  void put_in_order(std::size_t begin) {
    const auto first = problem_.samples.begin() + static_cast<std::ptrdiff_t>(begin);
    const auto earlier = [](const FitSample& a, const FitSample& b) {
      return a.parameter < b.parameter;
    };
    if (!std::is_sorted(first, problem_.samples.end(), earlier)) {
      std::sort(first, problem_.samples.end(), earlier);
    }
  }

  std::span<const Point3> p_;
  const PathFeatures& f_;
  std::span<const double> loosen_;
  std::span<const EdgeRefinement> care_;
  BandOptions options_;
  std::size_t n_;
  FitProblem problem_;
  std::vector<double> reach_before_;
  std::vector<double> reach_after_;
  std::vector<double> corner_knots_;
  std::size_t since_break_ = 0;
  bool loose_ = false;  // the last vertex left the curve room of the size of the limit
  std::optional<std::size_t> before_;
  std::size_t next_ = 0;
};

}  // namespace

double closest_knots(const BandOptions& options) { return 0.25 * kFirstKnot * options.limit; }

FitProblem state_fair_problem(std::span<const Point3> points, const PathFeatures& features,
                              std::span<const double> loosen, std::span<const EdgeRefinement> care,
                              const BandOptions& options) {
  return ProblemMaker(points, features, loosen, care, options).make();
}

void restate_samples(std::span<const Point3> points, const PathFeatures& features,
                     std::span<const double> loosen, std::span<const EdgeRefinement> care,
                     const BandOptions& options, std::span<const std::size_t> changed,
                     FitProblem& problem) {
  ProblemMaker(points, features, loosen, care, options).remake(changed, problem.samples);
}

namespace {

std::vector<double> in_order(std::vector<double> along, std::vector<double> about_corners) {
  if (!std::is_sorted(along.begin(), along.end())) std::sort(along.begin(), along.end());
  std::sort(about_corners.begin(), about_corners.end());
  const auto middle = static_cast<std::ptrdiff_t>(along.size());
  along.insert(along.end(), about_corners.begin(), about_corners.end());
  std::inplace_merge(along.begin(), along.begin() + middle, along.end());
  return along;
}

}  // namespace

std::vector<double> knots_of(std::vector<double> along, std::vector<double> about_corners,
                             const FitProblem& problem, const ParameterRange& path,
                             double closest) {
  const std::vector<double> wished = in_order(std::move(along), std::move(about_corners));
  const std::vector<double> needed = required_breaks(problem);
  const auto is_needed = [&](double u) {
    return std::binary_search(needed.begin(), needed.end(), u);
  };
  std::vector<double> kept;
  kept.reserve(wished.size());
  std::size_t next = 0;
  std::size_t zone = 0;
  for (const double u : wished) {
    while (next < needed.size() && needed[next] < u) ++next;
    const bool must = next < needed.size() && needed[next] == u;
    if (must) {
      while (!kept.empty() && u - kept.back() < closest && !is_needed(kept.back())) {
        kept.pop_back();
      }
      if (kept.empty() || kept.back() != u) kept.push_back(u);
      continue;
    }
    while (zone < problem.zones.size() && problem.zones[zone].to <= u) ++zone;
    const bool inside = zone < problem.zones.size() && u > problem.zones[zone].from;
    const bool outside_path = u <= path.from || u >= path.to;
    if (inside || outside_path || (!kept.empty() && u - kept.back() < closest)) continue;
    kept.push_back(u);
  }
  return kept;
}

}  // namespace batten::geometry
