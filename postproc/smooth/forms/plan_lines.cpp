#include <algorithm>

#include "gcode/state/modal_state.h"
#include "geometry/chords/ilca.h"
#include "geometry/chords/linearize.h"
#include "geometry/chords/min_link.h"
#include "postproc/smooth/forms/output_plan.h"

namespace batten::postproc {
namespace {

using geometry::BsplineCurve;
using geometry::MarkedPieces;
using Vertices = std::vector<geometry::LinkVertex>;

// How far chords may go in either direction.
struct Fineness {
  double finest = 0;        // mm, chord to curve, wished for
  double coarsest = 0;      // mm, the limit
  double min_length = 0;    // mm; where chords would be shorter, they become coarser
  double precision = 5e-4;  // of the chords' ends
};

// Chords that are only wished to be so fine may be a tenth of a percent shorter on the average.
constexpr double kPrecisionOfWishes = 2e-3;

// From one fineness to the next coarser one that is tried: chords twice as long.
constexpr double kCoarser = 4;

// Balanced chords may be so much higher: two thirds of their height are left.
constexpr double kBalanced = 1.5;

// Chords that are still too many become so much coarser at least.
constexpr double kCoarserAgain = 1.05;

// Chords of so many block periods leave the control room to look ahead; with one and a little
// the control just holds the feed.
constexpr double kPeriodsForTime = 2;
constexpr double kPeriodsForAccuracy = 1.1;

// The way of one block period at this feed, mm.
double length_per_block(double feed, const Machine& machine) {
  return std::min(feed / 60, machine.max_velocity()) * machine.block_period;
}

// `finest`: mm, of accurate chords.
Fineness fineness_for(double feed, const PlanOptions& options, double finest) {
  const double limit = options.max_deviation;
  const double per_block = length_per_block(feed, *options.machine);
  switch (options.prefer) {
    case Prefer::kTime:
      return {limit / 2, limit, kPeriodsForTime * per_block, kPrecisionOfWishes};
    case Prefer::kAccuracy:
      return {finest, kBalanced * limit, kPeriodsForAccuracy * per_block};
    case Prefer::kSize:
      break;
  }
  return {limit, limit, 0};
}

Vertices on_the_curve(const BsplineCurve& curve, const std::vector<double>& parameters) {
  Vertices vertices;
  vertices.reserve(parameters.size());
  for (const double u : parameters) vertices.push_back({curve.point_at(u), u});
  return vertices;
}

// `parameters` increase.
Vertices on_the_curve(const geometry::CurvePieces& curve, const std::vector<double>& parameters) {
  Vertices vertices;
  vertices.reserve(parameters.size());
  std::size_t piece = curve.index_of(parameters.front());
  for (const double u : parameters) {
    while (piece + 1 < curve.size() && curve.breaks()[piece + 1] <= u) ++piece;
    vertices.push_back({curve.point_in(piece, u), u});
  }
  return vertices;
}

// Parameters of the vertices between two places, both included: as fine as wished for, and
// coarser on each stretch whose chords come out too short.
std::vector<double> chords(const MarkedPieces& curve, double from, double to,
                           const Fineness& fineness) {
  std::vector<double> wished = geometry::chord_vertices(
      curve, from, to, {.max_deviation = fineness.finest, .precision = fineness.precision});
  if (fineness.finest >= fineness.coarsest) return wished;
  Fineness coarser = fineness;
  coarser.finest = std::min(fineness.finest * kCoarser, fineness.coarsest);

  const Vertices places = on_the_curve(curve.pieces, wished);
  const auto is_short = [&](std::size_t i) {
    return i + 1 < wished.size() &&
           (places[i + 1].place - places[i].place).norm() < fineness.min_length;
  };
  std::vector<double> vertices = {from};
  for (std::size_t i = 0; i + 1 < wished.size();) {
    std::size_t end = i;
    while (is_short(end)) ++end;
    if (end <= i + 1) {
      vertices.push_back(wished[++i]);
      continue;
    }
    const std::vector<double> longer = chords(curve, wished[i], wished[end], coarser);
    vertices.insert(vertices.end(), longer.begin() + 1, longer.end());
    i = end;
  }
  return vertices;
}

// `used_chords` is set where equal steps would have been too many.
Vertices vertices_on(const BsplineCurve& curve, const MarkedPieces& pieces,
                     const FeedStretch& stretch, const PlanOptions& options, double finest,
                     bool& used_chords) {
  const double deviation = options.max_deviation;
  switch (options.linearize) {
    case Linearize::kMinLink:
      return geometry::min_link_vertices(curve, stretch.from, stretch.to, {.tolerance = deviation});
    case Linearize::kIlca:
      if (const auto row =
              geometry::ilca(curve, stretch.from, stretch.to, {.max_deviation = deviation})) {
        return on_the_curve(curve, row->parameters);
      }
      used_chords = true;
      return on_the_curve(pieces.pieces, chords(pieces, stretch.from, stretch.to,
                                                {.finest = deviation, .coarsest = deviation}));
    case Linearize::kBlca:
      return on_the_curve(curve,
                          geometry::blca(curve, stretch.from, stretch.to, deviation).parameters);
    case Linearize::kChord:
      break;
  }
  const std::vector<double> parameters =
      chords(pieces, stretch.from, stretch.to, fineness_for(stretch.feed, options, finest));
  return options.prefer == Prefer::kAccuracy ? geometry::balanced_chords(curve, parameters)
                                             : on_the_curve(pieces.pieces, parameters);
}

OutputPlan lines_of(const Run& run, const geometry::SmoothCurve& fair, const MarkedPieces& pieces,
                    const PlanOptions& options, double finest) {
  OutputPlan plan;
  plan.form = OutputForm::kLines;
  std::vector<double> starts;
  geometry::Point3 place = run.points.front();
  for (const FeedStretch& stretch : feed_stretches(run, fair)) {
    const Vertices vertices =
        vertices_on(fair.curve, pieces, stretch, options, finest, plan.chords_for_steps);
    for (std::size_t i = 0; i + 1 < vertices.size(); ++i) {
      const bool last = i + 2 == vertices.size() && stretch.to >= fair.curve.last();
      const geometry::Point3 next = last ? run.points.back() : vertices[i + 1].place;
      plan.moves.push_back({geometry::Line{place, next}, stretch.feed, {}});
      starts.push_back(vertices[i].parameter);
      place = next;
    }
  }
  place_comments(run, fair, starts, plan);
  return plan;
}

}  // namespace

OutputPlan plan_lines(const Run& run, const geometry::SmoothCurve& fair,
                      const PlanOptions& options) {
  return plan_lines(run, fair, {fair.curve, fair.curve.first(), fair.curve.last()}, options);
}

OutputPlan plan_lines(const Run& run, const geometry::SmoothCurve& fair, const MarkedPieces& pieces,
                      const PlanOptions& options) {
  const bool accurate =
      options.prefer == Prefer::kAccuracy && options.linearize == Linearize::kChord;
  if (!accurate) return lines_of(run, fair, pieces, options, 0);
  const double step =
      gcode::printed_step(place_format(*options.target, options.units), options.units);
  const double tenth_of_rounding = step / 2 / 10;
  double finest = std::min(tenth_of_rounding, kBalanced * options.max_deviation);
  OutputPlan plan = lines_of(run, fair, pieces, options, finest);
  // The number of chords goes with the root of their height.
  while (options.most_moves > 0 && plan.moves.size() > options.most_moves &&
         finest < kBalanced * options.max_deviation) {
    const double over =
        static_cast<double>(plan.moves.size()) / static_cast<double>(options.most_moves);
    finest =
        std::min(kBalanced * options.max_deviation, std::max(over * over, kCoarserAgain) * finest);
    plan = lines_of(run, fair, pieces, options, finest);
  }
  plan.error = geometry::kBalancedError / geometry::kChordError * finest;
  return plan;
}

}  // namespace batten::postproc
