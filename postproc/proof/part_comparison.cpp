#include "postproc/proof/part_comparison.h"

#include <fmt/format.h>

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <string>
#include <utility>

#include "geometry/band/band_region.h"
#include "geometry/band/tolerance_band.h"
#include "geometry/distance/chord_polyline.h"
#include "geometry/distance/joints.h"
#include "geometry/distance/path_distance.h"
#include "geometry/path/path.h"
#include "postproc/proof/target_chords.h"

namespace batten::postproc {
namespace {

using geometry::Path;
using geometry::PathComparison;
using geometry::Verdict;

// mm: how far the curves of a part may be from the pieces by which they are known.
double read_within(const PathPart& part) {
  for (std::size_t i = 0; i < part.size(); ++i) {
    if (motion_of(part.cut(i), *part.side->read).is_near) return gcode::kReadWithin;
  }
  return 0;
}

// Paths of more chords, when arcs and curves are cut into them to be compared, are compared part by
// part, which takes less memory. Each part is so long that what its ends cost is little.
constexpr double kChordsAtOnce = 1024;
constexpr std::size_t kPiecesOfPart = 256;

double count_chords(const PathPart& part, double tolerance) {
  double count = 0;
  for (std::size_t i = 0; i < part.size(); ++i) {
    const gcode::MotionPath& piece = part.piece(i);
    count += piece.is_line()
                 ? 1
                 : geometry::chords_wanted(piece, geometry::kFirstChordShare * tolerance);
  }
  return count;
}

geometry::PassedPlaces passed_places(const PathPart& part) {
  geometry::PassedPlaces places;
  places.lengths.reserve(part.last());
  double length = 0;
  for (std::size_t i = 0; i + 1 < part.size(); ++i) {
    length += geometry::length_of(part.piece(i));
    places.lengths.push_back(length);
  }
  places.place_at = [&part](std::size_t i) -> geometry::Point3 {
    const geometry::Point3& end = part.piece(i).end();
    if (end == part.piece(i + 1).start()) return end;
    return geometry::Point3::Constant(std::numeric_limits<double>::quiet_NaN());
  };
  return places;
}

// Parts that follow each other in both paths, from places that both pass.
std::vector<PathPartPair> parts_between_joints(const PathPartPair& pair, double tolerance) {
  const auto& [before, after] = pair;
  std::vector<PathPartPair> parts;
  std::size_t old_from = before.begin;
  std::size_t new_from = after.begin;
  const auto add_up_to = [&](std::size_t old_end, std::size_t new_end) {
    parts.push_back({{before.side, old_from, old_end}, {after.side, new_from, new_end}});
    old_from = old_end;
    new_from = new_end;
  };
  if (std::max(count_chords(before, tolerance), count_chords(after, tolerance)) > kChordsAtOnce) {
    for (const geometry::Joint& joint :
         geometry::joints_of(passed_places(before), passed_places(after), kPiecesOfPart)) {
      add_up_to(before.begin + joint.a, after.begin + joint.b);
    }
  }
  add_up_to(before.end, after.end);
  return parts;
}

geometry::BandComparison compare_at_once(const PathPartPair& pair, const Promise& promise) {
  const Path before = pair.before.path();
  const Path after = pair.after.path();
  const double within = read_within(pair.before) + read_within(pair.after);
  const double tolerance = std::max(promise.tolerance_mm - within, geometry::kSamePlace);
  auto compared =
      promise.kind == geometry::ToleranceKind::kBand
          ? geometry::compare_in_band(before, after, tolerance)
          : geometry::BandComparison{geometry::compare_paths(before, after, tolerance), 0, 0};
  compared.paths.bounds.at_most += within;
  return compared;
}

ComparedSection section_of(const PathPartPair& pair, double tolerance_mm,
                           geometry::BandComparison compared) {
  const auto& [before, after] = pair;
  ComparedSection section;
  section.old_first_block = before.block(0);
  section.old_last_block = before.block(before.last());
  section.new_first_block = after.block(0);
  section.new_last_block = after.block(after.last());
  section.old_first_line = before.line(0);
  section.old_last_line = before.line(before.last());
  section.new_first_line = after.line(0);
  section.new_last_line = after.line(after.last());
  section.old_worst_line = before.line(compared.paths.worst_piece_a);
  section.new_worst_line = after.line(compared.paths.worst_piece_b);
  section.tolerance_mm = tolerance_mm;
  section.comparison = std::move(compared.paths);
  section.corner_mm = compared.corner_at_most;
  return section;
}

Violation distance_violation(const PathPartPair& pair, const PathComparison& comparison,
                             double tolerance_mm) {
  const std::uint32_t old_line = pair.before.line(comparison.worst_piece_a);
  const std::uint32_t new_line = pair.after.line(comparison.worst_piece_b);
  const auto& [at_least, at_most] = comparison.bounds;
  if (comparison.verdict == Verdict::kBroken) {
    const std::string message =
        fmt::format("the new path is {:.6g} mm or more from the old one, allowed {:.6g} mm",
                    at_least, tolerance_mm);
    return {ViolationKind::kDistance, "distance", old_line, new_line, at_least, message};
  }
  const std::string message = fmt::format(
      "the distance of the paths is between {:.6g} and {:.6g} mm, allowed {:.6g} mm: neither "
      "proved nor broken",
      at_least, at_most, tolerance_mm);
  return {ViolationKind::kNotProved, "not-proved", old_line, new_line, 0, message};
}

// On one side of the old path, as far as the tolerance: within half of it of the path that is half
// of it beside the old one. docs/algorithms/one_side.md
std::optional<Violation> side_violation(const PathPartPair& pair, const TargetChords& chords,
                                        const Promise& promise) {
  if (promise.side == geometry::Side::kBoth) return {};
  const double half = promise.tolerance_mm / 2;
  const double over = kOverSide * promise.tolerance_mm;
  const auto beside = geometry::parallel_path(pair.before.path(), promise.side, half);
  if (!beside) {
    return Violation{
        ViolationKind::kSide,
        "wrong-side",
        pair.before.line(0),
        pair.after.line(0),
        0,
        "the old path has arcs outside the XY plane or curves: no side of it is known"};
  }
  const PathComparison found =
      geometry::compare_paths(*beside, pair.after.path(), half + over, chords.errors);
  if (found.verdict == Verdict::kProved) return {};
  const std::string message = fmt::format(
      "the new path {} on the {} of the old one by {:.6g} mm at most",
      found.verdict == Verdict::kBroken ? "does not stay" : "could not be proved to stay",
      promise.side == geometry::Side::kLeft ? "left" : "right", promise.tolerance_mm);
  const double beyond = std::max(0.0, found.bounds.at_least - half);
  return Violation{ViolationKind::kSide,
                   "wrong-side",
                   pair.before.line_near(found.worst_a),
                   pair.after.line(found.worst_piece_b),
                   beyond,
                   message};
}

// A pair of parts for which one tolerance counts.
class PairComparer {
 public:
  // `promise`: with that tolerance.
  explicit PairComparer(const Promise& promise)
      : promise_(promise), tolerance_(promise.tolerance_mm) {}

  SectionComparison compare_part(const PathPartPair& pair) {
    const PathPartPair middle = without_same_ends(pair);
    if (middle.before.size() == 0 && middle.after.size() == 0) return {};
    geometry::BandComparison comparison = compare_distance(middle, promise_);
    if (comparison.paths.verdict == Verdict::kProved) {
      look_beside_the_distance(pair, middle, comparison.paths);
      result_.sections.push_back(section_of(middle, tolerance_, std::move(comparison)));
      look_twice(middle);
      return std::move(result_);
    }
    // The same ends may be passed otherwise than together: only the whole is a refutation.
    comparison = compare_distance(pair, promise_);
    if (comparison.paths.verdict != Verdict::kProved) {
      result_.violations.push_back(distance_violation(pair, comparison.paths, tolerance_));
      result_.sections.push_back(section_of(pair, tolerance_, std::move(comparison)));
      return std::move(result_);
    }
    look_beside_the_distance(pair, pair, comparison.paths);
    result_.sections.push_back(section_of(pair, tolerance_, std::move(comparison)));
    look_twice(pair);
    return std::move(result_);
  }

 private:
  // Of the section that was added last: both ways in the strict reading; in the band reading a
  // corner of the old path may be farther from the new one.
  void look_twice(const PathPartPair& pair) {
    if (!promise_.twice) return;
    const Path before = pair.before.path();
    const Path after = pair.after.path();
    auto check = geometry::check_in_region(before, after, tolerance_);
    if (!check) return;
    if (check->holds() && promise_.kind == geometry::ToleranceKind::kPath) {
      check = geometry::check_in_region(after, before, tolerance_);
    }
    if (!check || check->holds()) {
      result_.sections.back().in_region = true;
      return;
    }
    const geometry::Point3& place = check->place;
    result_.violations.push_back(
        {ViolationKind::kNotProved, "second-check", pair.before.line_near(place),
         pair.after.line_near(place), 0,
         fmt::format("the distance is proved, but {} at X{:.4f} Y{:.4f} Z{:.4f}: one of the two is "
                     "wrong. Do not run the new program, and send both to who maintains Batten",
                     check->is_inside
                         ? "a hole of the region of the tolerance is passed on the "
                           "other side"
                         : "one path leaves the region of the tolerance about the other",
                     place.x(), place.y(), place.z())});
  }

  // What else a path that keeps the distance may do wrong. `proved`: the part that keeps it.
  void look_beside_the_distance(const PathPartPair& pair, const PathPartPair& proved,
                                const PathComparison& found) {
    const TargetChords chords = chords_of_target(proved, promise_.target);
    for (Violation& violation : chords_violations(proved, chords, found, promise_)) {
      result_.violations.push_back(std::move(violation));
    }
    if (auto violation = side_violation(proved, chords, promise_)) {
      result_.violations.push_back(std::move(*violation));
    }
    // Of the whole, for a new part may also cross one that is the same.
    for (Violation& violation : crossing_violations(pair, proved, tolerance_)) {
      result_.violations.push_back(std::move(violation));
    }
  }

  Promise promise_;
  double tolerance_;  // of the promise
  SectionComparison result_;
};

}  // namespace

// PathPart by part where all of these are proved, else at once.
geometry::BandComparison compare_distance(const PathPartPair& pair, const Promise& promise) {
  const std::vector<PathPartPair> parts = parts_between_joints(pair, promise.tolerance_mm);
  if (parts.size() == 1) return compare_at_once(pair, promise);
  geometry::BandComparison all;
  all.paths.verdict = Verdict::kProved;
  for (const PathPartPair& part : parts) {
    const PathPartPair middle = without_same_ends(part);
    if (middle.before.size() == 0 && middle.after.size() == 0) continue;
    geometry::BandComparison found = compare_at_once(middle, promise);
    if (found.paths.verdict != Verdict::kProved) return compare_at_once(pair, promise);
    all.corner_at_most = std::max(all.corner_at_most, found.corner_at_most);
    all.cut_corners += found.cut_corners;
    const std::size_t size = all.paths.certificate_size + found.paths.certificate_size;
    const double at_least = std::max(all.paths.bounds.at_least, found.paths.bounds.at_least);
    if (found.paths.bounds.at_most >= all.paths.bounds.at_most) {
      found.paths.worst_piece_a += middle.before.begin - pair.before.begin;
      found.paths.worst_piece_b += middle.after.begin - pair.after.begin;
      all.paths = found.paths;
    }
    all.paths.bounds.at_least = at_least;
    all.paths.certificate_size = size;
  }
  return all;
}

SectionComparison compare_part(const PathPartPair& pair, const Promise& promise) {
  return PairComparer(promise).compare_part(pair);
}

std::vector<Violation> crossing_violations(const PathPartPair& pair, const PathPartPair& middle,
                                           double tolerance_mm) {
  std::vector<Violation> violations;
  const auto source = [](const PathPart& part) {
    return geometry::PathSource{part.size(), [&part](std::size_t i) { return part.piece(i); }};
  };
  for (const auto& [first_piece, second_piece, place] :
       geometry::new_crossings(source(pair.before), source(pair.after), tolerance_mm)) {
    Violation violation;
    violation.kind = ViolationKind::kCrossing;
    violation.id = "crosses-itself";
    violation.old_line = middle.before.line_near(place);
    violation.new_line = pair.after.line(first_piece);
    violation.message = fmt::format(
        "the new path meets itself at X{:.4f} Y{:.4f} Z{:.4f} (lines {} and {}), the old one does "
        "not",
        place.x(), place.y(), place.z(), violation.new_line, pair.after.line(second_piece));
    const bool is_known =
        std::ranges::find(violations, violation.old_line, &Violation::old_line) != violations.end();
    if (!is_known) violations.push_back(std::move(violation));
  }
  return violations;
}

}  // namespace batten::postproc
