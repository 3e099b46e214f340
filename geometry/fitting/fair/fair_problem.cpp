#include "geometry/fitting/fair/fair_problem.h"

#include <cstddef>
#include <optional>
#include <utility>

namespace batten::geometry {

namespace {

// The middle of a line edge that stays exactly straight.
struct Straight {
  double from;
  double to;
};

class ProblemMaker {
 public:
  ProblemMaker(std::span<const Point3> points, const PathFeatures& features, const FairCare& care,
               const FairOptions& options)
      : p_(points),
        f_(features),
        care_(care),
        options_(options),
        limit_(aimed_limit(options)),
        rounding_(counted_rounding(options)),
        n_(points.size()) {}

  FitProblem make() {
    find_reaches();
    problem_.samples.reserve(2 * n_);  // what is not used takes no memory
    problem_.breakpoints.reserve(n_);
    for (std::size_t i = 0; i < n_; ++i) {
      add_vertex(i);
      if (i + 1 == n_) break;
      const auto before = static_cast<std::ptrdiff_t>(problem_.samples.size());
      add_edge(i);
      // Samples that watch the edge came first.
      const auto added = problem_.samples.begin() + before;
      if (!std::ranges::is_sorted(added, problem_.samples.end(), {}, &FitSample::parameter)) {
        std::ranges::sort(added, problem_.samples.end(), {}, &FitSample::parameter);
      }
    }
    sort_knots();
    return std::move(problem_);
  }

 private:
  [[nodiscard]] double length(std::size_t edge) const {
    return f_.parameters[edge + 1] - f_.parameters[edge];
  }
  // Where vertex i is of an edge: on its line among noise where the edge was meant as one.
  [[nodiscard]] const Point3& end_of(std::size_t edge, std::size_t i) const {
    return f_.lines[edge] && noisy(i) && !pinned(i) ? care_.denoised[i] : p_[i];
  }
  [[nodiscard]] Vector3 direction(std::size_t edge) const {
    return (end_of(edge, edge + 1) - end_of(edge, edge)) / length(edge);
  }
  [[nodiscard]] bool corner(std::size_t i) const { return f_.kinds[i] == VertexKind::kCorner; }
  [[nodiscard]] bool pinned(std::size_t i) const { return f_.kinds[i] == VertexKind::kKeptCorner; }

  // How far each corner's rounding may go along the path: not past the middle of the path to
  // the next corner.
  void find_reaches() {
    reach_before_.assign(n_, 0);
    reach_after_.assign(n_, 0);
    std::optional<std::size_t> last;
    for (std::size_t i = 0; i < n_; ++i) {
      if (!corner(i) && !pinned(i)) continue;
      if (last) {
        const double length = f_.parameters[i] - f_.parameters[*last];
        const bool both = corner(i) && corner(*last);
        const double share = both ? kFairTuning.reach_between : kFairTuning.reach_to_kept;
        const double reach = std::min(kFairTuning.reach * limit_, share * length);
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
    sample.limit = limit_ * std::min(share(i - 1), share(i));
    if (corner(i)) {
      problem_.samples.push_back(sample);
      add_corner_knots(i);
      return;
    }
    sample.along = (p_[i + 1] - p_[i - 1]).normalized();
    const bool rounded = inside_reach(f_.parameters[i]);
    sample.scatter = rounded ? 0 : scatter(i);
    const bool drawn = noisy(i) && (!rounded || noise_fills_band(i));
    if (drawn) draw_to_denoised(i, sample);
    loose_ = !(sample.scatter > 0) || sample.scatter > kFairTuning.watched_sagitta * limit_;
    problem_.samples.push_back(sample);
    // A vertex's own knot does not move those that come by number: what is fitted further on is the
    // same with and without it.
    const bool by_number = ++since_break_ >= kFairTuning.vertices_per_span;
    if (by_number) since_break_ = 0;
    // A curve among noise turns at each.
    if (by_number || drawn || has_own_knot(i)) problem_.breakpoints.push_back(f_.parameters[i]);
  }

  [[nodiscard]] bool has_own_knot(std::size_t i) const {
    if (!wants_near(i) || noisy(i)) return false;
    return std::max(f_.sagittas[i - 1], f_.sagittas[i]) > kFairTuning.coarse * expected(i);
  }

  [[nodiscard]] bool noisy(std::size_t i) const {
    return !care_.denoised.empty() && care_.denoised[i] != p_[i];
  }

  [[nodiscard]] bool noise_fills_band(std::size_t i) const { return f_.noise[i] > limit_; }

  // Where noise takes much of the band: towards the denoised position of the vertex, as near
  // as the band allows, with some room around it. Where noise fills the band, with all that is
  // left: the neighbours leave little of it.
  void draw_to_denoised(std::size_t i, FitSample& sample) const {
    const Vector3 off = care_.denoised[i] - p_[i];
    const double room = kFairTuning.towards_denoised * sample.limit;
    sample.target += std::min(1.0, room / std::max(off.norm(), room)) * off;
    sample.limit -= noise_fills_band(i) ? (sample.target - p_[i]).norm() : room;
    const double loose = care_.loosen[i];
    const double widest = kFairTuning.denoised_scatter * limit_;
    const double noise = f_.noise[i];
    const double near = noise < widest ? kFairTuning.denoised_part * noise : widest;
    sample.scatter = std::isinf(loose) ? 0 : near * loose;
  }

  [[nodiscard]] double share(std::size_t edge) const { return care_.edges[edge].share; }

  [[nodiscard]] double scatter(std::size_t i) const {
    const double height = std::max(f_.sagittas[i - 1], f_.sagittas[i]);
    if (height > kFairTuning.too_high * limit_) return 0;
    const double loose = care_.loosen[i];
    return std::isinf(loose) ? 0 : expected(i) * loose;
  }

  [[nodiscard]] double expected(std::size_t i) const {
    const double noise = f_.noise[i];
    const double part = left_of_rounding(i);
    const double left = std::max(part * noise, noise - kFairTuning.rounding_noise * rounding_);
    return std::max({kFairTuning.noise_margin * left, part * rounding_, options_.scatter});
  }

  // Whether the curve shall be as near to vertex i as its decimals tell the place: not where its
  // noise is more than rounding, where the feed asks for room, or where a simple curve is wanted.
  [[nodiscard]] bool wants_near(std::size_t i) const {
    if (options_.accurate) return true;
    return options_.near && !(options_.scatter > 0) && care_.loosen[i] == 1 &&
           f_.noise[i] <= rounding_;
  }

  // Of what vertex i scatters by, the part that the curve may leave.
  [[nodiscard]] double left_of_rounding(std::size_t i) const {
    if (!wants_near(i)) return 1;
    if (options_.accurate) return kFairTuning.left_of_rounding;
    const double height = std::min(f_.sagittas[i - 1], f_.sagittas[i]);
    const double least = kFairTuning.worth_knots * rounding_;
    return height > least ? std::max(least / height, kFairTuning.left_of_rounding) : 1;
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
    const double first = kFairTuning.first_knot * limit_;
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
    if (before + after > kFairTuning.line_ends * length(edge)) return std::nullopt;
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
      if (!pinned(edge) && !corner(edge)) add_smooth_end(u0, straight->from);
      add_leg_samples(edge, u0, straight->from);
      problem_.breakpoints.push_back(straight->from);
      problem_.breakpoints.push_back(straight->to);
      const Vector3 d = direction(edge);
      const Point3& start = end_of(edge, edge);
      problem_.zones.push_back({straight->from, straight->to, start + (straight->from - u0) * d,
                                start + (straight->to - u0) * d});
      add_leg_samples(edge, straight->to, u1);
      if (!pinned(edge + 1) && !corner(edge + 1)) add_smooth_end(straight->to, u1);
      since_break_ = 0;
      return;
    }
    add_watching_samples(edge, u0, u1);
    const bool leg = corner(edge) || corner(edge + 1);
    const double height = length(edge) * std::max(f_.turns[edge], f_.turns[edge + 1]) / 8;
    if (leg) {
      add_leg_samples(edge, u0, u1);
    } else if (height > kFairTuning.watched_sagitta * limit_) {
      for (const double part : {0.25, 0.5, 0.75}) add_sample_on(edge, u0 + part * (u1 - u0));
    } else if (loose_) {
      add_sample_on(edge, 0.5 * (u0 + u1));
    }
  }

  // A line that leaves a curve smoothly: knots at the joint and half way to its straight part.
  void add_smooth_end(double from, double to) {
    problem_.breakpoints.push_back(from);
    problem_.breakpoints.push_back(0.5 * (from + to));
    problem_.breakpoints.push_back(to);
  }

  // Samples on an edge as dense as the corner knots around: they double away from corners.
  void add_leg_samples(std::size_t edge, double from, double to) {
    const double first = 0.5 * kFairTuning.first_knot * limit_;
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
    const int count = std::min(kFairTuning.most_violation_samples,
                               kFairTuning.samples_per_violation * care_.edges[edge].violations);
    for (int k = 0; k < count && to > from; ++k) {
      add_sample_on(edge, from + (to - from) * (2 * k + 1) / (2 * count));
    }
  }

  void add_sample_on(std::size_t edge, double u) {
    FitSample sample;
    sample.parameter = u;
    sample.along = direction(edge);
    sample.target = end_of(edge, edge) + (u - f_.parameters[edge]) * sample.along;
    sample.limit = limit_ * share(edge);
    problem_.samples.push_back(sample);
  }

  // The knots wished for along the path, in order but for some, and about its corners: in order,
  // none inside a zone, outside the path or nearer than `closest` (mm) to the one before. Pins and
  // ends of zones stay, and replace knots nearer than that.
  void sort_knots() {
    const double closest = kFairTuning.closest_knots * limit_;
    std::vector<double>& wished = problem_.breakpoints;
    if (!std::ranges::is_sorted(wished)) std::ranges::sort(wished);
    std::ranges::sort(corner_knots_);
    const auto added = wished.insert(wished.end(), corner_knots_.begin(), corner_knots_.end());
    std::inplace_merge(wished.begin(), added, wished.end());
    const std::vector<double> needed = required_breaks(problem_);
    std::vector<double> kept;
    kept.reserve(wished.size());
    std::size_t zone = 0;
    for (const double u : wished) {
      const bool near_last = !kept.empty() && u - kept.back() < closest;
      if (std::ranges::binary_search(needed, u)) {
        while (!kept.empty() && u - kept.back() < closest &&
               !std::ranges::binary_search(needed, kept.back())) {
          kept.pop_back();
        }
        if (kept.empty() || kept.back() != u) kept.push_back(u);
        continue;
      }
      while (zone < problem_.zones.size() && problem_.zones[zone].to <= u) ++zone;
      const bool inside = zone < problem_.zones.size() && u > problem_.zones[zone].from;
      const bool outside = u <= f_.parameters.front() || u >= f_.parameters.back();
      if (!inside && !outside && !near_last) kept.push_back(u);
    }
    wished = std::move(kept);
  }

  std::span<const Point3> p_;
  const PathFeatures& f_;
  const FairCare& care_;
  const FairOptions& options_;
  double limit_;     // mm
  double rounding_;  // mm
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

FitProblem state_fair_problem(std::span<const Point3> points, const PathFeatures& features,
                              const FairCare& care, const FairOptions& options) {
  return ProblemMaker(points, features, care, options).make();
}

}  // namespace batten::geometry
