#include "postproc/proof/refused_arcs.h"

#include <fmt/format.h>

#include <algorithm>
#include <span>
#include <string_view>

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

}  // namespace

std::vector<Violation> refused_arcs(const ReadProgram& before, const ReadProgram& after,
                                    const std::vector<Stretch>& stretches,
                                    const gcode::Dialect& target, const OldLine& old_line) {
  std::vector<Violation> violations;
  for (const Stretch& stretch : stretches) {
    const auto is_old = [&](const geometry::Arc& arc) {
      return std::ranges::any_of(
          motions_in(before, stretch.old_first_block, stretch.old_last_block),
          [&](const Motion& m) {
            return m.piece.arc() != nullptr && is_same(*m.piece.arc(), arc);
          });
    };
    for (const Motion& m : motions_in(after, stretch.new_first_block, stretch.new_last_block)) {
      const geometry::Arc* arc = m.piece.arc();
      if (arc == nullptr) continue;
      const auto& meaning = after.interpretation->blocks[m.block];
      const gcode::Units units = after.interpretation->states[meaning.state_after].units;
      const std::string_view why = gcode::arc_refusal(target, *arc, units);
      if (why.empty() || is_old(*arc)) continue;
      Violation violation;
      violation.kind = ViolationKind::kTarget;
      violation.id = "arc-refused";
      violation.old_line = old_line(m.block, stretch);
      violation.new_line = after.program->blocks[m.block].line;
      violation.message =
          fmt::format("{} refuses this arc: {}; expected one that it runs", target.name(), why);
      violations.push_back(std::move(violation));
    }
  }
  return violations;
}

}  // namespace batten::postproc
