#include <algorithm>
#include <cmath>

#include "gcode/state/modal_state.h"
#include "geometry/chords/ilca.h"
#include "geometry/chords/linearize.h"
#include "geometry/chords/min_link.h"
#include "postproc/runs/run_path.h"
#include "postproc/smooth/forms/output_plan.h"

namespace batten::postproc {
namespace {

using geometry::BsplineCurve;
using geometry::MarkedPieces;
using Vertices = std::vector<geometry::LinkVertex>;

// How far chords may go in either direction.
struct Fineness {
  double finest = 0;      // mm, chord to curve, wished for
  double coarsest = 0;    // mm, the limit
  double min_length = 0;  // mm; where chords would be shorter, they become coarser
};

// mm, of one block period at this feed.
double length_per_block(double feed, const Machine& machine) {
  return std::min(feed / 60, machine.max_velocity()) * machine.block_period;
}

Fineness fineness_for(double feed, const PlanOptions& options, double height) {
  const double per_block = length_per_block(feed, *options.machine);
  const double highest = std::max(height, kPlans.balanced * options.max_deviation);
  return {height, highest, kPlans.periods * per_block};
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
  std::vector<double> wished =
      geometry::chord_vertices(curve, from, to, {.max_deviation = fineness.finest});
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

// A part of the curve with chords of one height.
struct ChordSection {
  double from = 0;
  double to = 0;
  double height = 0;
};

// Chords may be as high as asked for, but where the curve itself is so far from the edges of the
// run that they would leave the tolerance. Heights go by steps, and an edge's is that of its
// neighbours, too: a chord lies beside several.
std::vector<ChordSection> chord_sections(const geometry::SmoothCurve& fair,
                                         const FeedSection& section, const PlanOptions& options,
                                         double height) {
  const std::vector<double>& off = fair.edge_deviations;
  if (!(options.tolerance > 0) || off.empty()) return {{section.from, section.to, height}};
  const double least = kPlans.least_room * options.max_deviation;
  const auto steps_for = [&](std::size_t edge) {
    const double room = std::max(kPlans.balanced * (options.tolerance - off[edge]), least);
    return room >= height ? 0
                          : static_cast<int>(
                                std::ceil(std::log(room / height) / std::log(kPlans.height_step)));
  };
  std::vector<ChordSection> sections;
  int last = -1;
  for (std::size_t edge = 0; edge < off.size(); ++edge) {
    const double from = std::max(section.from, fair.vertex_parameters[edge]);
    const double to = std::min(section.to, fair.vertex_parameters[edge + 1]);
    if (!(from < to)) continue;
    int steps = steps_for(edge);
    if (edge > 0) steps = std::max(steps, steps_for(edge - 1));
    if (edge + 1 < off.size()) steps = std::max(steps, steps_for(edge + 1));
    if (sections.empty() || steps != last) {
      sections.push_back({from, to, height * std::pow(kPlans.height_step, steps)});
    }
    sections.back().to = to;
    last = steps;
  }
  return sections;
}

// Balanced chords between these parameters. Where bends alternate a chord keeps more of its height
// than the others: beside a vertex of the run that is farther from it than the tolerance it gets a
// vertex of its own.
Vertices chords_beside(const Run& run, const geometry::SmoothCurve& fair,
                       std::vector<double> parameters, double tolerance) {
  const std::vector<double>& at = fair.vertex_parameters;
  for (int round = 0;; ++round) {
    Vertices vertices = geometry::balanced_chords(fair.curve, parameters);
    if (!(tolerance > 0) || round == kPlans.cut_again) return vertices;
    const auto is_near = [&](std::size_t chord, const geometry::Point3& place) {
      return chord + 1 < vertices.size() &&
             geometry::distance_to_segment(place, vertices[chord].place,
                                           vertices[chord + 1].place) <= tolerance;
    };
    std::vector<double> cut;
    auto k = static_cast<std::size_t>(std::ranges::lower_bound(at, parameters[0]) - at.begin());
    for (std::size_t i = 0; i + 1 < parameters.size(); ++i) {
      cut.push_back(parameters[i]);
      const double least = kPlans.cut_beside_ends * (parameters[i + 1] - parameters[i]);
      for (; k < at.size() && at[k] < parameters[i + 1]; ++k) {
        const geometry::Point3& place = run.points[k];
        if (is_near(i, place) || (i > 0 && is_near(i - 1, place)) || is_near(i + 1, place)) {
          continue;
        }
        const double there =
            std::min(std::max(at[k], cut.back() + least), parameters[i + 1] - least);
        if (there >= cut.back() + least) cut.push_back(there);
      }
    }
    cut.push_back(parameters.back());
    if (cut.size() == parameters.size()) return vertices;
    parameters = std::move(cut);
  }
}

// `used_chords` is set where equal steps would have been too many.
Vertices vertices_on(const Run& run, const geometry::SmoothCurve& fair, const MarkedPieces& pieces,
                     const FeedSection& section, const PlanOptions& options, double height,
                     bool& used_chords) {
  const BsplineCurve& curve = fair.curve;
  const double deviation = options.max_deviation;
  switch (options.linearize) {
    case Linearize::kMinLink: {
      geometry::MinLinkOptions links{.tolerance = deviation};
      if (options.counted) links.gates_per_link = kPlans.counted_gates;
      links.balanced = !options.counted;
      return geometry::min_link_vertices(curve, section.from, section.to, links);
    }
    case Linearize::kIlca:
      if (const auto row =
              geometry::ilca(curve, section.from, section.to, {.max_deviation = deviation})) {
        return geometry::on_curve(curve, row->parameters);
      }
      used_chords = true;
      break;
    case Linearize::kBlca:
      return geometry::on_curve(
          curve, geometry::blca(curve, section.from, section.to, deviation).parameters);
    case Linearize::kChord:
      break;
  }
  std::vector<double> parameters = {section.from};
  for (const ChordSection& part : chord_sections(fair, section, options, height)) {
    const std::vector<double> some =
        chords(pieces, part.from, part.to, fineness_for(section.feed, options, part.height));
    parameters.insert(parameters.end(), some.begin() + 1, some.end());
  }
  return chords_beside(run, fair, std::move(parameters), options.tolerance);
}

OutputPlan lines_of(const Run& run, const geometry::SmoothCurve& fair, const MarkedPieces& pieces,
                    const PlanOptions& options, double height) {
  OutputPlan plan;
  plan.form = Form::kLines;
  geometry::Point3 place = run.points.front();
  for (const FeedSection& section : feed_sections(run, fair)) {
    const Vertices vertices =
        vertices_on(run, fair, pieces, section, options, height, plan.chords_for_steps);
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
  // Where the tolerance is known, each section has its own limit (chord_sections).
  const double deviation = std::max(options.max_deviation, options.tolerance);
  const double highest = std::max(kPlans.balanced * deviation, options.chord_height);
  double height = options.chord_height;
  OutputPlan plan = lines_of(run, fair, pieces, options, height);
  if (options.linearize != Linearize::kChord || options.most_moves == 0) return plan;
  // The number of chords goes with the root of their height.
  const auto most = static_cast<double>(options.most_moves);
  while (height < highest && plan.moves.size() > options.most_moves) {
    const double over = static_cast<double>(plan.moves.size()) / most;
    height = std::min(highest, std::max(over * over, kPlans.coarser_again) * height);
    plan = lines_of(run, fair, pieces, options, height);
  }
  return plan;
}

OutputPlan plan_vertices(const Run& run, const geometry::SmoothCurve& fair,
                         const PlanOptions& options) {
  Vertices places = geometry::nearest_chords(fair.curve, fair.vertex_parameters);
  places.front().place = run.points.front();
  places.back().place = run.points.back();
  for (std::size_t i = 1; i + 1 < places.size(); ++i) {
    const geometry::Vector3 way = places[i].place - run.points[i];
    places[i].place = run.points[i] + way / std::max(1.0, way.norm() / options.max_deviation);
  }
  OutputPlan plan;
  plan.form = Form::kLines;
  const std::vector<double> feeds = edge_feeds(run);
  for (std::size_t i = 0; i + 1 < places.size(); ++i) {
    plan.moves.push_back({geometry::Line{places[i].place, places[i + 1].place},
                          feeds[i],
                          {},
                          fair.vertex_parameters[i]});
  }
  place_comments(run, fair, plan);
  return plan;
}

}  // namespace batten::postproc
