// Some of the cuts between two events of one program, as a path, and which of them are compared
// with which of the other program.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <vector>

#include "gcode/state/motion.h"
#include "geometry/basic/point.h"
#include "geometry/path/path.h"
#include "postproc/proof/compared_section.h"
#include "postproc/proof/program_events.h"

namespace batten::postproc {

[[nodiscard]] const gcode::Motion& motion_of(const Cut& cut, const ReadProgram& read);

// Some of the cuts of one side, as a path.
struct PathPart {
  const SectionSide* side = nullptr;
  std::size_t begin = 0;
  std::size_t end = 0;  // after the last

  [[nodiscard]] std::size_t size() const { return end - begin; }
  [[nodiscard]] const Cut& cut(std::size_t i) const { return side->cuts[begin + i]; }
  [[nodiscard]] const gcode::MotionPath& piece(std::size_t i) const {
    return motion_of(cut(i), *side->read).piece;
  }
  [[nodiscard]] PathPart without(std::size_t first, std::size_t last) const {
    return {side, begin + first, end - last};
  }
  // Where the path stands before its first piece.
  [[nodiscard]] std::optional<geometry::Point3> start() const {
    if (size() > 0) return piece(0).start();
    if (begin > 0) return motion_of(side->cuts[begin - 1], *side->read).piece.end();
    return side->start;
  }
  [[nodiscard]] geometry::Path path() const {
    geometry::Path result;
    result.reserve(size());
    for (std::size_t i = 0; i < size(); ++i) result.push_back(piece(i));
    if (const auto here = start(); result.empty() && here) {
      result.push_back(geometry::Line{*here, *here});
    }
    return result;
  }
  // Block of the i-th cut, of the nearest one where there are fewer; 0 where there are none.
  [[nodiscard]] std::uint32_t block(std::size_t i) const {
    if (side->cuts.empty()) return 0;
    const std::size_t index = std::min(begin + i, side->cuts.size() - 1);
    return motion_of(side->cuts[index], *side->read).block;
  }
  // Its line.
  [[nodiscard]] std::uint32_t line(std::size_t i) const {
    return side->cuts.empty() ? side->line : side->read->program->blocks[block(i)].line;
  }
  [[nodiscard]] std::size_t last() const { return std::max<std::size_t>(size(), 1) - 1; }
  // Line of the cut with an end nearest to the point.
  [[nodiscard]] std::uint32_t line_near(const geometry::Point3& point) const {
    std::size_t nearest = 0;
    const auto distance = [&](std::size_t i) {
      return std::min((piece(i).start() - point).norm(), (piece(i).end() - point).norm());
    };
    for (std::size_t i = 1; i < size(); ++i) {
      if (distance(i) < distance(nearest)) nearest = i;
    }
    return line(nearest);
  }
};

struct PathPartPair {
  PathPart before;
  PathPart after;
};

[[nodiscard]] PathPart all_of(const SectionSide& side);

// The longest parts that have one feed, in order.
[[nodiscard]] std::vector<PathPart> parts_of_one_feed(const SectionSide& side);

// A part in which other tolerances hold than in those beside it, of those that are less than the
// promised one.
struct ToleratedPart {
  PathPart part;
  double tolerance_mm = 0;
};

[[nodiscard]] std::vector<ToleratedPart> parts_of_one_tolerance(const PathPart& whole,
                                                                double promised);

// mm: the least that the old program allows in the part.
[[nodiscard]] double least_tolerance(const PathPart& part, double promised);

// A proof for the middle is a proof for the whole: the same segments are passed together.
[[nodiscard]] PathPartPair without_same_ends(const PathPartPair& pair);

}  // namespace batten::postproc
