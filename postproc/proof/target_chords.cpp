#include "postproc/proof/target_chords.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
#include <set>
#include <utility>
#include <variant>

#include "gcode/controls/arc_rules.h"
#include "geometry/band/tolerance_band.h"
#include "geometry/distance/band_comparison.h"
#include "geometry/path/path.h"

namespace batten::postproc {
namespace {

using geometry::Path;
using geometry::PathComparison;
using geometry::PathPiece;
using geometry::Verdict;

using ArcNumbers = std::array<double, 10>;

// Of two arcs that are read from the same text, but from starts that differ by rounding, the same.
ArcNumbers numbers_of(const geometry::Arc& arc) {
  constexpr double kPerMm = 1e8;
  ArcNumbers numbers{};
  auto next = numbers.begin();
  for (const geometry::Point3& place : {arc.start, arc.end, arc.center}) {
    for (const double mm : place) *next++ = std::round(kPerMm * mm);
  }
  *next = std::round(kPerMm * arc.sweep);
  return numbers;
}

// The path that the target runs: chords where it makes them of new arcs, and their number is
// certain.
struct RunPath {
  Path pieces;
  std::vector<double> beside;         // mm, for each: how far what is run may be from it
  std::vector<std::size_t> piece_of;  // of the new part
};

RunPath run_path(const PathPart& after, const TargetChords& chords, const gcode::Control& target) {
  RunPath run;
  const auto add = [&run](PathPiece piece, double beside, std::size_t of) {
    run.pieces.push_back(std::move(piece));
    run.beside.push_back(beside);
    run.piece_of.push_back(of);
  };
  const Path pieces = after.path();
  for (std::size_t i = 0; i < pieces.size(); ++i) {
    const auto* arc = std::get_if<geometry::Arc>(&pieces[i]);
    const bool is_cut = arc != nullptr && chords.is_cut(i);
    const auto certain = is_cut ? gcode::certain_chords(target.chords, *arc) : std::nullopt;
    if (!certain || certain->count == 0) {
      add(pieces[i], is_cut ? chords.errors[i] : 0, i);
      continue;
    }
    geometry::Point3 from = arc->start;
    for (int k = 1; k <= certain->count; ++k) {
      const geometry::Point3 to =
          k == certain->count ? arc->end
                              : geometry::point_at(*arc, static_cast<double>(k) / certain->count);
      add(geometry::Line{from, to}, certain->off, i);
      from = to;
    }
  }
  return run;
}

}  // namespace

TargetChords chords_of_target(const PathPartPair& pair, const gcode::Control* target) {
  TargetChords found;
  if (target == nullptr || !target->chords.any()) return found;
  // What is said in another language has the arcs of the program, but in other parts.
  const auto language = [](const PathPart& part) { return part.side->read->program->language; };
  if (language(pair.before) != language(pair.after)) return found;
  std::set<ArcNumbers> old_arcs;
  for (std::size_t i = 0; i < pair.before.size(); ++i) {
    if (const geometry::Arc* arc = pair.before.piece(i).arc()) old_arcs.insert(numbers_of(*arc));
  }
  std::vector<double> errors(pair.after.size(), 0);
  for (std::size_t i = 0; i < pair.after.size(); ++i) {
    const geometry::Arc* arc = pair.after.piece(i).arc();
    if (arc == nullptr || old_arcs.contains(numbers_of(*arc))) continue;
    errors[i] = gcode::chord_error(target->chords, *arc);
    if (errors[i] <= found.greatest) continue;
    found.greatest = errors[i];
    found.worst = i;
  }
  if (found.greatest > 0) found.errors = std::move(errors);
  return found;
}

std::vector<Violation> chords_violations(const PathPartPair& pair, const TargetChords& chords,
                                         const PathComparison& proved, const Promise& promise) {
  const double tolerance = promise.tolerance_mm;
  if (proved.bounds.at_most + chords.greatest <= tolerance) return {};
  std::vector<std::size_t> to_blame;
  for (std::size_t i = 0; i < chords.errors.size(); ++i) {
    if (chords.errors[i] >= tolerance) to_blame.push_back(i);
  }
  if (to_blame.empty()) {
    const Path before = pair.before.path();
    std::size_t worst = 0;
    if (promise.kind == geometry::ToleranceKind::kBand) {
      const Path after = pair.after.path();
      const auto found = geometry::compare_in_band(before, after, tolerance - chords.greatest);
      if (found.paths.verdict == Verdict::kProved) return {};
      worst = found.paths.worst_piece_b;
    } else {
      const RunPath run = run_path(pair.after, chords, *promise.target);
      const PathComparison found =
          geometry::compare_paths(before, run.pieces, tolerance, run.beside);
      if (found.verdict == Verdict::kProved) return {};
      worst = run.piece_of[found.worst_piece_b];
    }
    to_blame = {chords.is_cut(worst) ? worst : chords.worst};
  }
  std::vector<Violation> violations;
  violations.reserve(to_blame.size());
  for (const std::size_t piece : to_blame) {
    violations.push_back(
        {ViolationKind::kTarget, "arc-chords", pair.before.line(0), pair.after.line(piece), 0,
         fmt::format("{} cuts this arc into chords that leave it by up to {:.6g} mm: with them the "
                     "new path is not proved to be within {:.6g} mm of the old one",
                     promise.target->name, chords.errors[piece], tolerance)});
  }
  return violations;
}

}  // namespace batten::postproc
