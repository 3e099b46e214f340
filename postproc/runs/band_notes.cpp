#include "postproc/runs/band_notes.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string_view>
#include <utility>
#include <variant>
#include <vector>

#include "geometry/band/tolerance_band.h"
#include "geometry/basic/rounding.h"
#include "postproc/runs/run_grouping.h"

namespace batten::postproc {

namespace {

using geometry::BandCusp;
using geometry::BandOverlap;
using geometry::Point2;
using geometry::Point3;

// The axis across which all points lie at one height.
std::optional<int> flat_across(std::span<const Point3> points) {
  for (int axis = 2; axis >= 0; --axis) {
    const double height = points.front()[axis];
    const bool flat = std::ranges::all_of(points, [&](const Point3& p) {
      return std::abs(p[axis] - height) <= geometry::kSamePlace;
    });
    if (flat) return axis;
  }
  return std::nullopt;
}

std::vector<Point2> seen_along(int axis, std::span<const Point3> points) {
  std::vector<Point2> flat;
  flat.reserve(points.size());
  for (const Point3& p : points) flat.emplace_back(p[(axis + 1) % 3], p[(axis + 2) % 3]);
  return flat;
}

// For every edge of the run the block whose motion it belongs to.
std::vector<std::uint32_t> blocks_of_edges(const gcode::Program& program,
                                           const gcode::Interpretation& meaning,
                                           const Section& section, const Run& run) {
  const RunBlocks blocks(program, meaning);
  std::vector<std::uint32_t> of_edges;
  of_edges.reserve(run.points.size());
  auto arc = run.arcs.begin();
  for (std::uint32_t block = section.first_block; block <= section.last_block; ++block) {
    if (meaning.blocks[block].motion < 0 || !blocks.moves(block)) continue;
    const bool is_arc = arc != run.arcs.end() && arc->first == of_edges.size();
    of_edges.insert(of_edges.end(), is_arc ? arc->last - arc->first : 1, block);
    if (is_arc) ++arc;
  }
  return of_edges;
}

std::string_view places(std::size_t count) { return count == 1 ? "place" : "places"; }

class Notes {
 public:
  Notes(const gcode::Program& program, std::vector<std::uint32_t> of_edges, double tolerance)
      : program_(program), of_edges_(std::move(of_edges)), tolerance_(tolerance) {}

  void tell_overlaps(const std::vector<BandOverlap>& overlaps) {
    if (overlaps.empty()) return;
    const auto nearest = std::ranges::min_element(overlaps, {}, &BandOverlap::distance);
    const std::string_view how = nearest->meets_itself ? "which meet" : "which do not meet";
    found_.push_back(
        {gcode::Severity::kNote, "band-overlap", program_.blocks[of_edges_[nearest->edge]].span,
         fmt::format("lines {}-{} and {}-{} are {:.4f} mm apart, {}, less than twice the tolerance "
                     "of {:g} mm: {} {} like that in this run; the new path may not cross itself "
                     "there",
                     line(nearest->first_from), line(nearest->first_to), line(nearest->second_from),
                     line(nearest->second_to), nearest->distance, how, tolerance_, overlaps.size(),
                     places(overlaps.size()))});
  }

  void tell_cusps(const std::vector<BandCusp>& cusps) {
    if (cusps.empty()) return;
    const BandCusp& first = cusps.front();
    found_.push_back(
        {gcode::Severity::kNote, "band-cusp", program_.blocks[of_edges_[first.edge]].span,
         fmt::format("the path bends to the {} with a radius below the tolerance of {:g} mm: {} {} "
                     "like that in this run",
                     first.left ? "left" : "right", tolerance_, cusps.size(),
                     places(cusps.size()))});
  }

  gcode::Diagnostics take() && { return std::move(found_); }

 private:
  [[nodiscard]] std::uint32_t line(std::size_t edge) const {
    return program_.blocks[of_edges_[edge]].line;
  }

  const gcode::Program& program_;
  std::vector<std::uint32_t> of_edges_;
  double tolerance_;
  gcode::Diagnostics found_;
};

}  // namespace

gcode::Diagnostics band_notes(const gcode::Program& program, const gcode::Interpretation& meaning,
                              const Section& section, double tolerance_mm) {
  const auto* run = std::get_if<Run>(&section.content);
  if (run == nullptr) return {};
  const auto axis = flat_across(run->points);
  if (!axis) return {};
  const auto structure = geometry::band_structure(seen_along(*axis, run->points), tolerance_mm);
  if (!structure) return {};
  Notes notes(program, blocks_of_edges(program, meaning, section, *run), tolerance_mm);
  notes.tell_overlaps(structure->overlaps);
  notes.tell_cusps(structure->cusps);
  return std::move(notes).take();
}

void BandNoteTally::add(std::span<const gcode::Diagnostics> of_runs, gcode::Diagnostics& found) {
  for (const gcode::Diagnostics& notes : of_runs) {
    for (const gcode::Diagnostic& note : notes) {
      if (told_ < kMostBandNotes) {
        ++told_;
        found.push_back(note);
      } else if (++left_out_ == 1) {
        first_untold_ = note.where;
      }
    }
  }
}

void BandNoteTally::tell_rest(gcode::Diagnostics& found) const {
  if (left_out_ == 0) return;
  found.push_back({gcode::Severity::kNote, "band-overlap", first_untold_,
                   fmt::format("{} more notes on bands that overlap or have cusps", left_out_)});
}

void append_band_notes(std::span<const gcode::Diagnostics> of_runs, gcode::Diagnostics& found) {
  BandNoteTally tally;
  tally.add(of_runs, found);
  tally.tell_rest(found);
}

}  // namespace batten::postproc
