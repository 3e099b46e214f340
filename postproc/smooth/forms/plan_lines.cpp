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

// mm, of one block period at this feed.
double length_per_block(double feed, const Machine& machine) {
  return std::min(feed / 60, machine.max_velocity()) * machine.block_period;
}

// `finest`: mm, of accurate chords.
Fineness fineness_for(double feed, const PlanOptions& options, double finest) {
  const double limit = options.max_deviation;
  const double per_block = length_per_block(feed, *options.machine);
  switch (options.prefer) {
    case Prefer::kTime:
      return {limit / 2, limit, kPlans.periods_for_time * per_block, kPlans.precision_of_wishes};
    case Prefer::kAccuracy:
      return {finest, kPlans.balanced * limit, kPlans.periods_for_accuracy * per_block};
    case Prefer::kSize:
      break;
  }
  return {limit, limit, 0};
}

Vertices on_the_curve(const BsplineCurve& curve, const std::vector<double>& parameters) {
  Vertices vertices;
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

// Parameters of the vertices from the one to the other: as fine as wished for, and coarser on each
// section whose chords come out too short.
std::vector<double> chords(const MarkedPieces& curve, double from, double to,
                           const Fineness& fineness) {
  std::vector<double> wished = geometry::chord_vertices(
      curve, from, to, {.max_deviation = fineness.finest, .precision = fineness.precision});
  if (fineness.finest >= fineness.coarsest) return wished;
  Fineness coarser = fineness;
  coarser.finest = std::min(fineness.finest * kPlans.coarser, fineness.coarsest);

  const Vertices places = on_the_curve(curve.pieces, wished);
  const auto is_short = [&](std::size_t i) {
    return i + 1 < wished.size() &&
           (places[i + 1].place - places[i].place).norm() < fineness.min_length;
  };
  std::vector<double> vertices = {from};
  std::size_t end = 0;
  for (std::size_t i = 0; i + 1 < wished.size(); i = end) {
    end = i;
    while (is_short(end)) ++end;
    if (end <= i + 1) {
      end = i + 1;
      vertices.push_back(wished[end]);
      continue;
    }
    const std::vector<double> longer = chords(curve, wished[i], wished[end], coarser);
    vertices.insert(vertices.end(), longer.begin() + 1, longer.end());
  }
  return vertices;
}

// `used_chords` is set where equal steps would have been too many.
Vertices vertices_on(const BsplineCurve& curve, const MarkedPieces& pieces,
                     const FeedSection& section, const PlanOptions& options, double finest,
                     bool& used_chords) {
  const double deviation = options.max_deviation;
  switch (options.linearize) {
    case Linearize::kMinLink:
      return geometry::min_link_vertices(curve, section.from, section.to, {.tolerance = deviation});
    case Linearize::kIlca:
      if (const auto row =
              geometry::ilca(curve, section.from, section.to, {.max_deviation = deviation})) {
        return on_the_curve(curve, row->parameters);
      }
      used_chords = true;
      return on_the_curve(pieces.pieces, chords(pieces, section.from, section.to,
                                                {.finest = deviation, .coarsest = deviation}));
    case Linearize::kBlca:
      return on_the_curve(curve,
                          geometry::blca(curve, section.from, section.to, deviation).parameters);
    case Linearize::kChord:
      break;
  }
  const std::vector<double> parameters =
      chords(pieces, section.from, section.to, fineness_for(section.feed, options, finest));
  return options.prefer == Prefer::kAccuracy ? geometry::balanced_chords(curve, parameters)
                                             : on_the_curve(pieces.pieces, parameters);
}

OutputPlan lines_of(const Run& run, const geometry::SmoothCurve& fair, const MarkedPieces& pieces,
                    const PlanOptions& options, double finest) {
  OutputPlan plan;
  plan.form = Form::kLines;
  geometry::Point3 place = run.points.front();
  for (const FeedSection& section : feed_sections(run, fair)) {
    const Vertices vertices =
        vertices_on(fair.curve, pieces, section, options, finest, plan.chords_for_steps);
    for (std::size_t i = 0; i + 1 < vertices.size(); ++i) {
      const bool last = i + 2 == vertices.size() && section.to >= fair.curve.last();
      const geometry::Point3 next = last ? run.points.back() : vertices[i + 1].place;
      plan.moves.push_back({geometry::Line{place, next}, section.feed, {}, vertices[i].parameter});
      place = next;
    }
  }
  place_comments(run, fair, plan);
  return plan;
}

}  // namespace

OutputPlan plan_lines(const Run& run, const geometry::SmoothCurve& fair, const MarkedPieces& pieces,
                      const PlanOptions& options) {
  const bool accurate =
      options.prefer == Prefer::kAccuracy && options.linearize == Linearize::kChord;
  if (!accurate) return lines_of(run, fair, pieces, options, 0);
  const double step =
      gcode::printed_step(place_format(*options.target, options.units), options.units);
  const double tenth_of_rounding = step / 2 / 10;
  double finest = std::min(tenth_of_rounding, kPlans.balanced * options.max_deviation);
  OutputPlan plan = lines_of(run, fair, pieces, options, finest);
  // The number of chords goes with the root of their height.
  while (options.most_moves > 0 && plan.moves.size() > options.most_moves &&
         finest < kPlans.balanced * options.max_deviation) {
    const double over =
        static_cast<double>(plan.moves.size()) / static_cast<double>(options.most_moves);
    finest = std::min(kPlans.balanced * options.max_deviation,
                      std::max(over * over, kPlans.coarser_again) * finest);
    plan = lines_of(run, fair, pieces, options, finest);
  }
  plan.error = geometry::kBalancedError / geometry::kChordError * finest;
  return plan;
}

}  // namespace batten::postproc
