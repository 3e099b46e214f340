// What two programs are compared for between two events: the promise, the sides, and what is found.
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "gcode/control/control.h"
#include "geometry/basic/point.h"
#include "geometry/basic/tolerance_kind.h"
#include "geometry/distance/path_distance.h"
#include "postproc/proof/event_violations.h"
#include "postproc/proof/program_events.h"

namespace batten::postproc {

// What the paths must keep.
struct Promise {
  // > 0. Where the old program says less for a part of itself, the part must keep that.
  double tolerance_mm = 0.01;
  geometry::ToleranceKind kind = geometry::ToleranceKind::kPath;
  // Where the new path may be: on the other side it may be by kOverSide of the tolerance.
  geometry::Side side = geometry::Side::kBoth;
  // That has to take what is new; nullptr: nobody is asked.
  const gcode::Control* target = nullptr;
  bool twice = false;  // a second check of flat paths (geometry/band/band_region)

  // The strict reading, when nothing else is said.
  Promise(double tolerance, geometry::ToleranceKind reading = geometry::ToleranceKind::kPath,
          geometry::Side allowed = geometry::Side::kBoth, const gcode::Control* control = nullptr)
      : tolerance_mm(tolerance), kind(reading), side(allowed), target(control) {}
};

// Printing rounds a place on the path itself to either side of it.
inline constexpr double kOverSide = 0.1;

// One section of cutting moves at one feed that was compared, without the moves at its ends
// that are the same in both programs.
struct ComparedSection {
  std::uint32_t old_first_block = 0, old_last_block = 0;
  std::uint32_t new_first_block = 0, new_last_block = 0;
  // Their lines; where one program has no moves there, that of the event before.
  std::uint32_t old_first_line = 0, old_last_line = 0;
  std::uint32_t new_first_line = 0, new_last_line = 0;
  double tolerance_mm = 0;  // that it had to keep
  geometry::PathComparison comparison;
  double corner_mm = 0;    // band reading: greatest distance of a corner that was cut; 0: none was
  bool in_region = false;  // what Promise::twice asks for: it is flat, and was found there
  std::uint32_t old_worst_line = 0;  // where the greatest distance was met
  std::uint32_t new_worst_line = 0;
};

// The moves of one program between two events.
struct SectionSide {
  const ReadProgram* read = nullptr;
  std::span<const Cut> cuts;
  // Where the tool stands before the first of them; not always known.
  std::optional<geometry::Point3> start;
  std::uint32_t line = 0;  // to name when there are no cuts: of the event before
  // mm, of where it ends: what counts when there are no cuts.
  std::optional<double> stated_tolerance_mm = {};
};

struct SectionComparison {
  std::vector<ComparedSection>
      sections;  // one per feed that was compared; identical ones are left out
  std::vector<Violation> violations;
};

}  // namespace batten::postproc
