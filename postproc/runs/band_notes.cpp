#include "postproc/runs/band_notes.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <optional>
#include <string_view>
#include <variant>
#include <vector>

#include "geometry/band/tolerance_band.h"
#include "geometry/basic/rounding.h"
#include "postproc/runs/run_grouping.h"

namespace batten::postproc {

namespace {

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

std::string_view places(std::size_t count) { return count == 1 ? "place" : "places"; }

}  // namespace

gcode::Diagnostics band_notes(const gcode::Program& program, const gcode::Interpretation& meaning,
                              const Section& section, double tolerance_mm) {
  const auto* run = std::get_if<Run>(&section.content);
  if (run == nullptr) return {};
  const auto axis = flat_across(run->points);
  if (!axis) return {};
  const auto structure = geometry::band_structure(seen_along(*axis, run->points), tolerance_mm);
  if (!structure) return {};
  const std::vector<std::uint32_t> of_edges = blocks_of_edges(section, meaning);
  const auto block = [&](std::size_t edge) -> const gcode::Block& {
    return program.blocks[of_edges[edge]];
  };
  gcode::Diagnostics found;
  const auto& overlaps = structure->overlaps;
  if (!overlaps.empty()) {
    const auto nearest = std::ranges::min_element(overlaps, {}, &geometry::BandOverlap::distance);
    found.push_back(
        {gcode::Severity::kNote, "band-overlap", block(nearest->edge).span,
         fmt::format("lines {}-{} and {}-{} are {:.4f} mm apart, {}, less than twice the tolerance "
                     "of {:g} mm: {} {} like that in this run; the new path may not cross itself "
                     "there",
                     block(nearest->first_from).line, block(nearest->first_to).line,
                     block(nearest->second_from).line, block(nearest->second_to).line,
                     nearest->distance, nearest->meets_itself ? "which meet" : "which do not meet",
                     tolerance_mm, overlaps.size(), places(overlaps.size()))});
  }
  const auto& cusps = structure->cusps;
  if (!cusps.empty()) {
    found.push_back(
        {gcode::Severity::kNote, "band-cusp", block(cusps.front().edge).span,
         fmt::format("the path bends to the {} with a radius below the tolerance of {:g} mm: {} {} "
                     "like that in this run",
                     cusps.front().left ? "left" : "right", tolerance_mm, cusps.size(),
                     places(cusps.size()))});
  }
  return found;
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

}  // namespace batten::postproc
