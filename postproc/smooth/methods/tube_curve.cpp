#include "postproc/smooth/methods/tube_curve.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <iterator>
#include <limits>
#include <numeric>
#include <utility>
#include <vector>

#include "geometry/basic/rounding.h"
#include "geometry/fitting/naseath/naseath.h"
#include "geometry/path/curve_pieces.h"
#include "geometry/path/joined_curve.h"
#include "geometry/path/path.h"
#include "postproc/machine/planner/feed_plan.h"
#include "postproc/machine/planner/s_curve.h"

namespace batten::postproc {

using geometry::BsplineCurve;
using geometry::Point3;
using geometry::SmoothCurve;

namespace {

// A part of the fit between two cuts.
struct TubeSection {
  double from;
  double to;
  bool straight;        // a line of the program: it stays
  bool meets_smoothly;  // its neighbours go on with its tangent and curvature
};

// Inner knots at which the curve may have a corner.
std::vector<double> corners_of(const BsplineCurve& curve) {
  std::vector<double> corners;
  const auto& t = curve.basis().knots();
  for (std::size_t i = 4; i + 5 < t.size(); ++i) {
    if (t[i] == t[i + 1] && t[i] > curve.first() && t[i] < curve.last()) corners.push_back(t[i]);
  }
  corners.erase(std::unique(corners.begin(), corners.end()), corners.end());
  return corners;
}

std::vector<TubeSection> sections_of(const BsplineCurve& curve, bool closed) {
  const auto lines = geometry::CurvePieces(curve, curve.first(), curve.last()).straight_runs();
  const std::vector<double> corners = corners_of(curve);
  std::vector<double> cuts = {curve.first(), curve.last()};
  cuts.insert(cuts.end(), corners.begin(), corners.end());
  for (const geometry::StraightRun& line : lines) {
    cuts.push_back(line.from);
    cuts.push_back(line.to);
  }
  std::sort(cuts.begin(), cuts.end());
  cuts.erase(std::unique(cuts.begin(), cuts.end()), cuts.end());
  const auto is_smooth = [&](double u) {
    if (u == curve.first() || u == curve.last()) return closed;
    return !std::binary_search(corners.begin(), corners.end(), u);
  };
  std::vector<TubeSection> sections;
  std::size_t line = 0;
  for (std::size_t i = 0; i + 1 < cuts.size(); ++i) {
    while (line < lines.size() && lines[line].to <= cuts[i]) ++line;
    const bool straight = line < lines.size() && lines[line].from <= cuts[i];
    sections.push_back(
        {cuts[i], cuts[i + 1], straight, is_smooth(cuts[i]) || is_smooth(cuts[i + 1])});
  }
  return sections;
}

// What the measured deviation of a spline fitted to the run leaves is the radius of the tube. Lines
// and kept corners of the fit stay; the parts between them are smoothed, each with the tangent and
// curvature that it has where it meets a line.
struct TubeFit {
  SmoothCurve path;
  double radius = 0;  // mm
  std::vector<TubeSection> sections;

  [[nodiscard]] BsplineCurve part(const TubeSection& section) const {
    return path.curve.part(section.from, section.to);
  }
  [[nodiscard]] static int held_points(const TubeSection& section) {
    return section.meets_smoothly ? kTube.hold_curvature : kTube.hold_position;
  }
  // `moved`: mm, the greatest displacement of the parts.
  [[nodiscard]] SmoothCurve with(const std::vector<BsplineCurve>& parts, double moved) const {
    SmoothCurve smoothed = path;
    smoothed.curve = geometry::joined(parts);
    smoothed.deviation += moved;
    smoothed.noise = 0;
    smoothed.rounds = 0;
    smoothed.edge_deviations.clear();
    return smoothed;
  }
};

std::optional<TubeFit> tube_fit(std::span<const Point3> run, const CurveRequest& request) {
  CurveRequest fit = request;
  fit.tolerance = kTube.fit_part * request.tolerance;
  fit.scatter = 0;
  fit.accurate = true;
  std::optional<SmoothCurve> path = fair_curve(run, fit);
  if (!path || !(path->deviation < request.tolerance)) return std::nullopt;
  const bool closed = (run.front() - run.back()).norm() <= geometry::kSamePlace;
  TubeFit tube{std::move(*path), 0, {}};
  tube.radius = request.tolerance - tube.path.deviation;
  tube.sections = sections_of(tube.path.curve, closed);
  return tube;
}

// The curves in a tube, one for each of geometry::kFewMethods, and the fastest of them.
class TubeWays {
 public:
  TubeWays(const TubeFit& fit, const CurveRequest& request)
      : fit_(fit), limits_(plan_limits(request)), rival_(request.rival), few_(fit.sections.size()) {
    options_.radius = fit.radius;
    options_.feed = limits_.feed;
    options_.acceleration = limits_.acceleration.minCoeff();
    const SCurveLimits along{limits_.feed, options_.acceleration, limits_.jerk.minCoeff()};
    longest_line_ = limits_.feed * s_curve_change(limits_.feed, along);
    find_nodes();
    find_samples();
  }

  [[nodiscard]] std::optional<TubeCurve> fastest() {
    const std::span methods(geometry::kFewMethods);
    solve_samples(methods.first(1));
    const double of_first = sampled_time(0);
    const bool as_a_whole = samples_.size() == 1;
    if (as_a_whole && of_first > kTube.behind * rival_) return std::nullopt;
    solve_samples(methods.subspan(1));
    std::optional<std::size_t> best;
    double least = std::numeric_limits<double>::infinity();
    for (std::size_t k = 0; k < methods.size(); ++k) {
      const double time = k == 0 ? of_first : sampled_time(k);
      if (!(time < least)) continue;
      least = time;
      best = k;
    }
    if (!best) return std::nullopt;
    double moved = 0;
    std::vector<BsplineCurve> parts;
    for (std::size_t i = 0; i < fit_.sections.size(); ++i) {
      if (fit_.sections[i].straight) {
        parts.push_back(fit_.part(fit_.sections[i]));
        continue;
      }
      const geometry::TubeCandidate found =
          few_[i].empty() ? solved(i, methods.subspan(*best, 1)).front() : few_[i][*best];
      parts.push_back(found.curve);
      moved = std::max(moved, found.displacement);
    }
    return TubeCurve{fit_.with(parts, moved), geometry::kFewMethods[*best], visits_, planned_};
  }

 private:
  // In nodes of a plan of the fit from its start.
  struct Sample {
    double from;
    double to;  // infinity: the end
  };

  void find_nodes() {
    geometry::Path path;
    for (const TubeSection& section : fit_.sections) {
      firsts_.push_back(path.size());
      const geometry::Path pieces =
          section.straight ? ends_of(section) : geometry::beziers_of(fit_.part(section));
      path.insert(path.end(), pieces.begin(), pieces.end());
    }
    firsts_.push_back(path.size());
    for (const double nodes : plan_nodes(path, limits_, kTube.density)) {
      starts_.push_back(starts_.back() + nodes);
    }
  }

  void find_samples() {
    const double all = starts_.back();
    const double each = kTube.planned / kTube.samples;
    if (all <= kTube.planned) {
      samples_ = {{0, kEnd}};
    } else {
      for (double k = 0; k < kTube.samples; ++k) {
        const double from = k / (kTube.samples - 1) * (all - each);
        samples_.push_back({from, k + 1 < kTube.samples ? from + each : kEnd});
      }
    }
  }

  // In each section that a sample is of, once; those of a second call stand behind the first.
  void solve_samples(std::span<const geometry::TubeMethod> methods) {
    std::vector<bool> is_solved(fit_.sections.size());
    for (const Sample& sample : samples_) {
      for (std::size_t i = section_at(sample.from); holds(sample, i); ++i) {
        if (fit_.sections[i].straight || is_solved[i]) continue;
        is_solved[i] = true;
        std::ranges::move(solved(i, methods), std::back_inserter(few_[i]));
      }
    }
  }

  // Of a line the ways from rest to the feed and back: what lies between them takes as long
  // whatever the curves beside it are.
  [[nodiscard]] geometry::Path ends_of(const TubeSection& line) const {
    const Point3 begin = fit_.path.curve.point_at(line.from);
    const geometry::Vector3 along = fit_.path.curve.point_at(line.to) - begin;
    return {geometry::Line{begin, begin + std::min(1.0, longest_line_ / along.norm()) * along}};
  }

  [[nodiscard]] std::size_t section_at(double node) const {
    const auto after = std::ranges::upper_bound(firsts_, node, {},
                                                [&](std::size_t first) { return starts_[first]; });
    return static_cast<std::size_t>(after - firsts_.begin()) - 1;
  }

  // Of a section that does not end before the sample.
  [[nodiscard]] bool holds(const Sample& sample, std::size_t section) const {
    return section < fit_.sections.size() && starts_[firsts_[section]] < sample.to;
  }

  [[nodiscard]] std::vector<geometry::TubeCandidate> solved(
      std::size_t section, std::span<const geometry::TubeMethod> methods) {
    options_.held_points = TubeFit::held_points(fit_.sections[section]);
    static_assert(geometry::kFewMethods.front() == geometry::TubeMethod::kThirdDerivative);
    std::optional<BsplineCurve> third;
    if (!few_[section].empty()) third = few_[section].front().curve;
    geometry::FewInTube found =
        geometry::few_in_tube(fit_.part(fit_.sections[section]), options_, methods, third);
    visits_ += found.visits;
    return std::move(found.candidates);
  }

  [[nodiscard]] double sampled_time(std::size_t way) {
    double time = 0;
    for (const Sample& sample : samples_) time += planned_time(sample, way);
    return time;
  }

  // s, about: of a sample within the run as if the machine came to it and left it at the feed.
  [[nodiscard]] double planned_time(const Sample& sample, std::size_t way) {
    geometry::Path path;
    for (std::size_t i = section_at(sample.from); holds(sample, i); ++i) {
      const TubeSection& section = fit_.sections[i];
      const geometry::Path pieces =
          section.straight ? ends_of(section) : geometry::beziers_of(few_[i][way].curve);
      for (std::size_t k = 0; k < pieces.size(); ++k) {
        const double start = starts_[firsts_[i] + k];
        const double nodes = starts_[firsts_[i] + k + 1] - start;
        const double from = start < sample.from ? (sample.from - start) / nodes : 0;
        const double to = start + nodes > sample.to ? (sample.to - start) / nodes : 1;
        if (from == 0 && to == 1) {
          path.push_back(pieces[k]);
        } else if (from < 1 && from < to) {
          path.push_back(geometry::sub_piece(pieces[k], from, to));
        }
      }
    }
    const double before = sample.from > 0 ? limits_.feed : 0;
    const double after = sample.to < kEnd ? limits_.feed : 0;
    const FeedPlan plan = plan_feed(path, limits_, {before, after}, kTube.density);
    planned_ += plan.nodes.size();
    return plan.time;
  }

  static constexpr double kEnd = std::numeric_limits<double>::infinity();

  const TubeFit& fit_;
  KinematicPathLimits limits_;
  double rival_;  // s
  geometry::TubeOptions options_;
  double longest_line_;               // mm
  std::vector<std::size_t> firsts_;   // piece of the fit that each section begins with, and the end
  std::vector<double> starts_ = {0};  // of each piece, as Sample, and the end
  std::vector<Sample> samples_;
  std::vector<std::vector<geometry::TubeCandidate>> few_;  // of each section in a sample
  std::size_t visits_ = 0;
  std::size_t planned_ = 0;
};

}  // namespace

std::optional<SmoothCurve> naseath_curve(std::span<const Point3> run, const CurveRequest& request,
                                         bool literal) {
  const auto tube = tube_fit(run, request);
  if (!tube) return std::nullopt;
  geometry::NaseathOptions options;
  options.radius = tube->radius;
  options.max_passes = kTube.passes;
  if (literal) options.repairs = geometry::NaseathRepairs::none();
  double moved = 0;
  std::vector<BsplineCurve> parts;
  for (const TubeSection& section : tube->sections) {
    parts.push_back(tube->part(section));
    if (section.straight) continue;
    options.held_points = TubeFit::held_points(section);
    geometry::NaseathResult smoothed = geometry::smooth_naseath(parts.back(), options);
    moved = std::max(moved, smoothed.displacement);
    parts.back() = std::move(smoothed.curve);
  }
  return tube->with(parts, moved);
}

std::optional<TubeCurve> tube_curve(std::span<const Point3> run, const CurveRequest& request) {
  if (!can_race(request.limits)) return std::nullopt;
  const auto tube = tube_fit(run, request);
  if (!tube) return std::nullopt;
  if (std::ranges::all_of(tube->sections, &TubeSection::straight)) return TubeCurve{tube->path};
  return TubeWays(*tube, request).fastest();
}

double tube_operations(const BsplineCurve& fair, const CurveRequest& request) {
  const std::vector<double> nodes =
      plan_nodes(geometry::beziers_of(fair), plan_limits(request), kTube.density);
  return kTube.operations * std::min(std::reduce(nodes.begin(), nodes.end()), kTube.planned);
}

}  // namespace batten::postproc
