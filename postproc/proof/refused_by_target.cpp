#include "postproc/proof/refused_by_target.h"

#include <fmt/format.h>

#include <algorithm>
#include <map>
#include <span>
#include <string>
#include <string_view>
#include <utility>

#include "gcode/controls/arc_rules.h"
#include "geometry/basic/rounding.h"

namespace batten::postproc {
namespace {

using gcode::Motion;

std::span<const Motion> motions_in(const ReadProgram& read, std::uint32_t first,
                                   std::uint32_t last) {
  const auto& motions = read.interpretation->motions;
  const auto begin = std::ranges::lower_bound(motions, first, {}, &Motion::block);
  const auto end = std::ranges::upper_bound(motions, last, {}, &Motion::block);
  return {begin, end};
}

bool is_same(const geometry::Arc& a, const geometry::Arc& b) {
  const auto same = [](const geometry::Point3& p, const geometry::Point3& q) {
    return (p - q).norm() <= geometry::kSamePlace;
  };
  return same(a.start, b.start) && same(a.end, b.end) && same(a.center, b.center) &&
         a.sweep * b.sweep > 0;
}

Violation refused(std::string_view id, std::uint32_t old_line, std::uint32_t new_line,
                  std::string message) {
  Violation violation;
  violation.kind = ViolationKind::kTarget;
  violation.id = id;
  violation.old_line = old_line;
  violation.new_line = new_line;
  violation.message = std::move(message);
  return violation;
}

void add_refused_arcs(const ReadProgram& before, const ReadProgram& after, const Stretch& stretch,
                      const gcode::Control& target, std::vector<Violation>& violations) {
  const auto is_old = [&](const geometry::Arc& arc) {
    return std::ranges::any_of(
        motions_in(before, stretch.old_first_block, stretch.old_last_block),
        [&](const Motion& m) { return m.piece.arc() != nullptr && is_same(*m.piece.arc(), arc); });
  };
  for (const Motion& m : motions_in(after, stretch.new_first_block, stretch.new_last_block)) {
    const geometry::Arc* arc = m.piece.arc();
    if (arc == nullptr) continue;
    const auto& meaning = after.interpretation->blocks[m.block];
    const gcode::Units units = after.interpretation->states[meaning.state_after].units;
    const std::string_view why = gcode::arc_refusal(target, *arc, units);
    if (why.empty() || is_old(*arc)) continue;
    violations.push_back(refused(
        "arc-refused", stretch.old_first_line, after.program->blocks[m.block].line,
        fmt::format("{} refuses this arc: {}; expected one that it runs", target.name, why)));
  }
}

// The blocks whose lines are too long, with their text.
std::map<std::string_view, const gcode::Block*> long_lines(const ReadProgram& read,
                                                           const gcode::Control& target) {
  std::map<std::string_view, const gcode::Block*> found;
  for (const gcode::Block& block : read.program->blocks) {
    if (block.span.size() <= target.max_line_length) continue;
    const std::string_view line = read.program->source.text(block.span);
    if (line_length(target, line) > target.max_line_length) found.try_emplace(line, &block);
  }
  return found;
}

void add_long_lines(const ReadProgram& before, const ReadProgram& after,
                    const gcode::Control& target, std::vector<Violation>& violations) {
  const auto written = long_lines(after, target);
  if (written.empty()) return;
  const auto old = long_lines(before, target);
  for (const auto& [line, block] : written) {
    if (old.contains(line)) continue;
    violations.push_back(
        refused("line-refused", 0, block->line,
                fmt::format("{} bytes in this line, {} reads {} at the most",
                            line_length(target, line), target.name, target.max_line_length)));
  }
}

}  // namespace

std::vector<Violation> refused_by_target(const ReadProgram& before, const ReadProgram& after,
                                         const std::vector<Stretch>& stretches,
                                         const gcode::Control& target) {
  std::vector<Violation> violations;
  for (const Stretch& stretch : stretches) {
    add_refused_arcs(before, after, stretch, target, violations);
  }
  add_long_lines(before, after, target, violations);
  return violations;
}

}  // namespace batten::postproc
