#include "postproc/proof/path_part.h"

#include <iterator>
#include <variant>

namespace batten::postproc {
namespace {

using geometry::PathPiece;

// Of two arcs or curves.
bool same_bend(const PathPiece& a, const PathPiece& b) {
  if (a.index() != b.index()) return false;
  if (const auto* arc = std::get_if<geometry::Arc>(&a)) {
    const auto& other = std::get<geometry::Arc>(b);
    return arc->center == other.center && arc->axis == other.axis && arc->sweep == other.sweep;
  }
  const auto& control = std::get<geometry::CubicBezier>(a).control;
  return std::equal(std::begin(control), std::end(control),
                    std::begin(std::get<geometry::CubicBezier>(b).control));
}

bool same_piece(const gcode::MotionPath& a, const gcode::MotionPath& b) {
  if (a.start() != b.start() || a.end() != b.end() || a.is_line() != b.is_line()) return false;
  return a.is_line() || same_bend(a, b);
}

// mm: what the program says for the i-th cut of a side; nothing where it says none.
std::optional<double> stated_at(const SectionSide& side, std::size_t i) {
  const gcode::Interpretation& read = *side.read->interpretation;
  const std::uint32_t block = motion_of(side.cuts[i], *side.read).block;
  return gcode::stated_tolerance_mm(read.states[read.blocks[block].state_after]);
}

}  // namespace

const gcode::Motion& motion_of(const Cut& cut, const ReadProgram& read) {
  return read.interpretation->motions[cut.motion];
}

PathPart all_of(const SectionSide& side) { return {&side, 0, side.cuts.size()}; }

std::vector<PathPart> parts_of_one_feed(const SectionSide& side) {
  std::vector<PathPart> parts;
  for (std::size_t i = 0; i < side.cuts.size(); ++i) {
    if (parts.empty() || !is_one_feed(side.cuts[parts.back().begin], side.cuts[i])) {
      parts.push_back({&side, i, i});
    }
    parts.back().end = i + 1;
  }
  return parts;
}

std::vector<ToleratedPart> parts_of_one_tolerance(const PathPart& whole, double promised) {
  std::vector<ToleratedPart> parts;
  for (std::size_t i = whole.begin; i < whole.end; ++i) {
    const double mm = std::min(promised, stated_at(*whole.side, i).value_or(promised));
    if (parts.empty() || parts.back().tolerance_mm != mm) parts.push_back({{whole.side, i, i}, mm});
    parts.back().part.end = i + 1;
  }
  return parts;
}

double least_tolerance(const PathPart& part, double promised) {
  const gcode::Interpretation& read = *part.side->read->interpretation;
  if (part.size() == 0) {
    return std::min(promised, part.side->stated_tolerance_mm.value_or(promised));
  }
  const std::optional<double> least =
      gcode::least_stated_mm(read, part.block(0), part.block(part.last()));
  return std::min(promised, least.value_or(promised));
}

PathPartPair without_same_ends(const PathPartPair& pair) {
  const std::size_t old_size = pair.before.size();
  const std::size_t new_size = pair.after.size();
  const auto same = [&pair](std::size_t i, std::size_t k) {
    return same_piece(pair.before.piece(i), pair.after.piece(k));
  };
  const std::size_t most = std::min(old_size, new_size);
  std::size_t first = 0;
  while (first < most && same(first, first)) ++first;
  std::size_t last = 0;
  while (last < most - first && same(old_size - 1 - last, new_size - 1 - last)) ++last;
  return {pair.before.without(first, last), pair.after.without(first, last)};
}

}  // namespace batten::postproc
