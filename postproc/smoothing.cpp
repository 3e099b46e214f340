#include "postproc/smoothing.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <optional>
#include <span>
#include <utility>

#include "gcode/reason.h"
#include "geometry/fair.h"
#include "postproc/machine/cycle_time.h"

namespace batten::postproc {

namespace {

constexpr double kMmPerInch = 25.4;

// Where few blocks are wanted, vertices may scatter by this part of the tolerance: fewer arcs
// and chords do for the simpler curve.
constexpr double kSpent = 0.25;

// Of the share of the form, the curve may use this part too: what it leaves of it, and of its
// own share, the form gets back.
constexpr double kLent = 0.6;

// Arcs get no more than this multiple of the form's share, however little the curve used, and
// chords these: long ones are few, fine ones are near to the curve and keep the speed on a
// control that rounds each of their corners.
constexpr double kArcs = 1.5;
constexpr double kFineArcs = 0.25;
constexpr double kLongChords = 1.5;
constexpr double kMiddleChords = 0.6;
constexpr double kFineChords = 0.25;

// The fair curve of scattered vertices is no better known than this part of their scatter: a form
// that is nearer to it than that is not nearer to the path that was meant.
constexpr double kKnown = 0.5;

double step_of(int decimals, gcode::Units units) {
  const double step = std::pow(10.0, -decimals);
  return units == gcode::Units::kInch ? kMmPerInch * step : step;
}

double greatest_feed(const Run& run) {
  double feed = 0;
  for (const FeedFrom& from : run.feeds) feed = std::max(feed, from.feed);
  return feed;
}

// 1/mm, of the circles through three neighbouring vertices.
double greatest_curvature(std::span<const geometry::Point3> p) {
  double most = 0;
  for (std::size_t i = 1; i + 1 < p.size(); ++i) {
    const geometry::Vector3 a = p[i] - p[i - 1];
    const geometry::Vector3 b = p[i + 1] - p[i];
    const double sides = a.norm() * b.norm() * (p[i + 1] - p[i - 1]).norm();
    if (sides > 0) most = std::max(most, 2 * a.cross(b).norm() / sides);
  }
  return most;
}

double greatest_curvature(const geometry::FairPath& fair) {
  constexpr int kParts = 8;
  double most = 0;
  const std::vector<double> knots = fair.curve.breakpoints();
  for (std::size_t i = 0; i + 1 < knots.size(); ++i) {
    for (int k = 0; k < kParts; ++k) {
      const double u = knots[i] + (knots[i + 1] - knots[i]) * k / kParts;
      most = std::max(most, fair.curve.curvature_at(u));
    }
  }
  return std::max(most, fair.curve.curvature_at(fair.curve.last()));
}

std::vector<TimedPiece> timed_pieces(const Run& run) {
  std::vector<TimedPiece> pieces;
  pieces.reserve(run.points.size());
  std::size_t next = 0;
  double feed = 0;
  for (std::size_t i = 0; i + 1 < run.points.size(); ++i) {
    while (next < run.feeds.size() && run.feeds[next].vertex <= i) feed = run.feeds[next++].feed;
    pieces.push_back({geometry::Line{run.points[i], run.points[i + 1]}, feed});
  }
  return pieces;
}

std::vector<TimedPiece> timed_pieces(const OutputPlan& plan) {
  std::vector<TimedPiece> pieces;
  pieces.reserve(plan.moves.size());
  for (const PlannedMove& move : plan.moves) pieces.push_back({move.piece, move.feed});
  return pieces;
}

// How far the chords of the run are from the curve that was meant, as the height of equal
// chords: the rms distance of their middles. Noisy vertices are as far off as they scatter.
double error_of(const Run& run, const geometry::FairPath& fair, double rounding) {
  double squares = 0;
  for (std::size_t i = 0; i + 1 < run.points.size(); ++i) {
    const double u = 0.5 * (fair.vertex_parameters[i] + fair.vertex_parameters[i + 1]);
    const geometry::Point3 middle = 0.5 * (run.points[i] + run.points[i + 1]);
    const geometry::Vector3 off = fair.curve.point_at(u) - middle;
    const geometry::Vector3 along = run.points[i + 1] - run.points[i];
    const double length = along.squaredNorm();
    const double slide = length > 0 ? off.dot(along) / length : 0;
    squares += (off - slide * along).squaredNorm();
  }
  const double chords = std::sqrt(squares / static_cast<double>(run.points.size() - 1));
  return fair.noise > 2 * rounding ? std::max(chords, fair.noise) : chords;
}

class RunSmoother {
 public:
  RunSmoother(const Run& run, const RunContext& context, const SmoothOptions& options)
      : run_(run), context_(context), options_(options), units_(context.before.units) {}

  SmoothedRun smooth() {
    result_.facts.max_curvature = greatest_curvature(run_.points);
    result_.facts.times = times_of(timed_pieces(run_));
    if (options_.method == Method::kNone) return kept(gcode::reason::kMethodNone);

    const ToleranceShares shares = share_tolerance(options_, units_, run_.decimals);
    if (!(shares.smoothing > 0)) return kept(gcode::reason::kNoFit);
    const double rounding = 0.5 * step_of(run_.decimals, units_);
    const auto fair = geometry::fair_path(run_.points, fair_options(shares, rounding));
    if (!fair) return kept(gcode::reason::kNoFit);
    result_.facts.noise = fair->noise;
    result_.facts.error = error_of(run_, *fair, rounding);
    result_.facts.fair_curvature = greatest_curvature(*fair);

    const double left = shares.smoothing + shares.form - fair->deviation;
    if (!(left > 0)) return kept(gcode::reason::kNoFit);
    add_candidates(*fair, shares.form, left);
    if (result_.candidates.empty()) return kept(gcode::reason::kTargetCannot);
    return std::move(result_);
  }

 private:
  [[nodiscard]] geometry::FairOptions fair_options(const ToleranceShares& shares,
                                                   double rounding) const {
    geometry::FairOptions fair;
    fair.tolerance = shares.smoothing + kLent * shares.form;
    fair.rounding = rounding;
    fair.feed = std::clamp(greatest_feed(run_), 1.0, 60 * options_.machine->max_velocity);
    fair.acceleration = options_.machine->max_acceleration;
    if (few_wanted()) fair.scatter = kSpent * fair.tolerance;
    fair.accurate = options_.prefer == Prefer::kAccuracy;
    fair.keep_corner_angle = keep_corner_angle();
    return fair;
  }

  // Whether the whole tolerance may be spent on fewer moves.
  [[nodiscard]] bool few_wanted() const {
    if (options_.prefer == Prefer::kAccuracy) return false;
    return options_.output == Form::kArcs || options_.prefer == Prefer::kSize;
  }

  [[nodiscard]] double keep_corner_angle() const {
    if (!options_.keep_corners_deg) return geometry::FairOptions{}.keep_corner_angle;
    return *options_.keep_corners_deg * std::numbers::pi / 180;
  }

  [[nodiscard]] Times times_of(const std::vector<TimedPiece>& pieces) const {
    const Machine& machine = *options_.machine;
    Machine unmerged = machine;
    unmerged.naive_cam_tolerance = 0;
    Times times;
    times.as_set = cutting_time(pieces, machine, context_.after.path);
    times.without_merging = machine.naive_cam_tolerance > 0
                                ? cutting_time(pieces, unmerged, context_.after.path)
                                : times.as_set;
    std::vector<TimedPiece> unlimited = pieces;
    for (TimedPiece& piece : unlimited) piece.feed = 0;
    times.flat_out = cutting_time(unlimited, machine, context_.after.path);
    times.exact_path = cutting_time(pieces, machine, gcode::PathMode::kExactPath);
    return times;
  }

  // `share` of the tolerance belongs to the form; `left` is what the curve leaves.
  void add_candidates(const geometry::FairPath& fair, double share, double left) {
    const auto plan_with = [&](double multiple) {
      return PlanOptions{options_.target,       options_.machine, units_,
                         context_.before.plane, options_.prefer,  std::min(left, multiple * share),
                         keep_corner_angle()};
    };
    if (options_.output != Form::kLines) {
      for (const double multiple : {kArcs, kFineArcs}) {
        const PlanOptions arcs = plan_with(multiple);
        add(plan_arcs(run_, fair, arcs), arcs.max_deviation);
      }
      if (few_wanted()) {
        PlanOptions whole = plan_with(kArcs);  // the band around the vertices themselves
        whole.max_deviation = left + fair.deviation;
        add(plan_arc_spline(run_, fair, whole), whole.max_deviation);
      }
    }
    if (options_.output == Form::kArcs) return;
    for (const double multiple : {kLongChords, kMiddleChords, kFineChords}) {
      const PlanOptions lines = plan_with(multiple);
      add(plan_lines(run_, fair, lines), lines.max_deviation);
    }
  }

  void add(const std::optional<OutputPlan>& plan, double error) {
    if (!plan) return;
    auto text = write_run(*plan, run_, context_.program, *options_.target, context_.before,
                          context_.after, context_.line_end);
    if (!text) return;
    Candidate candidate;
    candidate.method = "fair";
    candidate.form = plan->form;
    candidate.error = std::max(error, kKnown * result_.facts.noise);
    candidate.times = times_of(timed_pieces(*plan));
    candidate.text = std::move(*text);
    result_.candidates.push_back(std::move(candidate));
  }

  SmoothedRun kept(std::string_view reason) {
    result_.reason = reason;
    return std::move(result_);
  }

  const Run& run_;
  const RunContext& context_;
  const SmoothOptions& options_;
  gcode::Units units_;
  SmoothedRun result_;
};

}  // namespace

SmoothedRun smooth_run(const Run& run, const RunContext& context, const SmoothOptions& options) {
  return RunSmoother(run, context, options).smooth();
}

}  // namespace batten::postproc
