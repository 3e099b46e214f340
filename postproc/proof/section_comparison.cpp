#include "postproc/proof/section_comparison.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <iterator>
#include <limits>
#include <set>
#include <string>
#include <utility>

#include "gcode/controls/arc_rules.h"
#include "geometry/band/band_region.h"
#include "geometry/band/tolerance_band.h"
#include "geometry/distance/band_comparison.h"
#include "geometry/distance/joints.h"
#include "geometry/path/path.h"

namespace batten::postproc {
namespace {

using geometry::Path;
using geometry::PathComparison;
using geometry::PathPiece;
using geometry::Verdict;

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

const gcode::Motion& motion_of(const Cut& cut, const ReadProgram& read) {
  return read.interpretation->motions[cut.motion];
}

std::string feed_text(const Cut& cut) {
  return cut.feed ? fmt::format("{:.6g} mm/min{}", *cut.feed,
                                cut.feed_without_point ? " without a decimal point" : "")
                  : std::string("none known");
}

// Some of the cuts of one side, as a path.
struct Part {
  const StretchSide* side = nullptr;
  std::size_t begin = 0;
  std::size_t end = 0;  // after the last

  [[nodiscard]] std::size_t size() const { return end - begin; }
  [[nodiscard]] const Cut& cut(std::size_t i) const { return side->cuts[begin + i]; }
  [[nodiscard]] const gcode::MotionPath& piece(std::size_t i) const {
    return motion_of(cut(i), *side->read).piece;
  }
  [[nodiscard]] Part without(std::size_t first, std::size_t last) const {
    return {side, begin + first, end - last};
  }
  // Where the path stands before its first piece.
  [[nodiscard]] std::optional<geometry::Point3> start() const {
    if (size() > 0) return piece(0).start();
    if (begin > 0) return motion_of(side->cuts[begin - 1], *side->read).piece.end();
    return side->start;
  }
  [[nodiscard]] Path path() const {
    Path result;
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

// mm: what the program says for the i-th cut of a side; nothing where it says none.
std::optional<double> stated_at(const StretchSide& side, std::size_t i) {
  const gcode::Interpretation& read = *side.read->interpretation;
  const std::uint32_t block = motion_of(side.cuts[i], *side.read).block;
  return gcode::stated_tolerance_mm(read.states[read.blocks[block].state_after]);
}

// mm: the least that the old program allows in the part.
double least_tolerance(const Part& part, double promised) {
  const gcode::Interpretation& read = *part.side->read->interpretation;
  if (part.size() == 0) {
    return std::min(promised, part.side->stated_tolerance_mm.value_or(promised));
  }
  const std::optional<double> least =
      gcode::least_stated_mm(read, part.block(0), part.block(part.last()));
  return std::min(promised, least.value_or(promised));
}

Part all_of(const StretchSide& side) { return {&side, 0, side.cuts.size()}; }

// The longest parts that have one feed, in order.
std::vector<Part> parts_of_one_feed(const StretchSide& side) {
  std::vector<Part> parts;
  for (std::size_t i = 0; i < side.cuts.size(); ++i) {
    if (parts.empty() || !is_one_feed(side.cuts[parts.back().begin], side.cuts[i])) {
      parts.push_back({&side, i, i});
    }
    parts.back().end = i + 1;
  }
  return parts;
}

// A part in which other tolerances hold than in those beside it, of those that are less than the
// promised one.
struct ToleratedPart {
  Part part;
  double tolerance_mm = 0;
};

std::vector<ToleratedPart> parts_of_one_tolerance(const Part& whole, double promised) {
  std::vector<ToleratedPart> parts;
  for (std::size_t i = whole.begin; i < whole.end; ++i) {
    const double mm = std::min(promised, stated_at(*whole.side, i).value_or(promised));
    if (parts.empty() || parts.back().tolerance_mm != mm) parts.push_back({{whole.side, i, i}, mm});
    parts.back().part.end = i + 1;
  }
  return parts;
}

struct PartPair {
  Part before;
  Part after;
};

// A proof for the middle is a proof for the whole: the same pieces are passed together.
PartPair without_same_ends(const PartPair& pair) {
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

// mm: how far the curves of a part may be from the pieces by which they are known.
double read_within(const Part& part) {
  for (std::size_t i = 0; i < part.size(); ++i) {
    if (motion_of(part.cut(i), *part.side->read).is_near) return gcode::kReadWithin;
  }
  return 0;
}

// Paths of more pieces are compared part by part, which takes less memory. Each part is so long
// that what its ends cost is little.
constexpr std::size_t kPiecesAtOnce = 4096;
constexpr std::size_t kPiecesOfPart = 256;

std::vector<geometry::PassedPlace> passed_places(const Part& part) {
  constexpr double kNowhere = std::numeric_limits<double>::quiet_NaN();
  std::vector<geometry::PassedPlace> places;
  places.reserve(part.last());
  double length = 0;
  for (std::size_t i = 0; i + 1 < part.size(); ++i) {
    length += geometry::length_of(part.piece(i));
    const geometry::Point3 end = part.piece(i).end();
    const bool meets = end == part.piece(i + 1).start();
    places.push_back({meets ? end : geometry::Point3::Constant(kNowhere), length});
  }
  return places;
}

// Parts that follow each other in both paths, from places that both pass.
std::vector<PartPair> parts_between_joints(const PartPair& pair) {
  const auto& [before, after] = pair;
  std::vector<PartPair> parts;
  std::size_t old_from = before.begin;
  std::size_t new_from = after.begin;
  const auto add_up_to = [&](std::size_t old_end, std::size_t new_end) {
    parts.push_back({{before.side, old_from, old_end}, {after.side, new_from, new_end}});
    old_from = old_end;
    new_from = new_end;
  };
  if (std::max(before.size(), after.size()) > kPiecesAtOnce) {
    for (const geometry::Joint& joint :
         geometry::joints_of(passed_places(before), passed_places(after), kPiecesOfPart)) {
      add_up_to(before.begin + joint.a, after.begin + joint.b);
    }
  }
  add_up_to(before.end, after.end);
  return parts;
}

geometry::BandComparison compare_at_once(const PartPair& pair, const Promise& promise) {
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

// Part by part where all of these are proved, else at once.
geometry::BandComparison compare(const PartPair& pair, const Promise& promise) {
  const std::vector<PartPair> parts = parts_between_joints(pair);
  if (parts.size() == 1) return compare_at_once(pair, promise);
  geometry::BandComparison all;
  all.paths.verdict = Verdict::kProved;
  for (const PartPair& part : parts) {
    const PartPair middle = without_same_ends(part);
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

Stretch stretch_of(const PartPair& pair, double tolerance_mm, geometry::BandComparison compared) {
  const auto& [before, after] = pair;
  Stretch stretch;
  stretch.old_first_block = before.block(0);
  stretch.old_last_block = before.block(before.last());
  stretch.new_first_block = after.block(0);
  stretch.new_last_block = after.block(after.last());
  stretch.old_first_line = before.line(0);
  stretch.old_last_line = before.line(before.last());
  stretch.new_first_line = after.line(0);
  stretch.new_last_line = after.line(after.last());
  stretch.old_worst_line = before.line(compared.paths.worst_piece_a);
  stretch.new_worst_line = after.line(compared.paths.worst_piece_b);
  stretch.tolerance_mm = tolerance_mm;
  stretch.comparison = std::move(compared.paths);
  stretch.corner_mm = compared.corner_at_most;
  return stretch;
}

Violation distance_violation(const PartPair& pair, const PathComparison& comparison,
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

// `middle`: without the pieces that are the same, which cannot be to blame. One for each old line.
std::vector<Violation> crossing_violations(const PartPair& pair, const PartPair& middle,
                                           double tolerance_mm) {
  std::vector<Violation> violations;
  const auto source = [](const Part& part) {
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

// What the target makes of new arcs: mm, for each piece of the new part, by how much the chords
// that it cuts it into leave it. 0 for lines, and for arcs that the old program has, too.
struct TargetChords {
  std::vector<double> errors;  // none where no arc is cut
  double greatest = 0;
  std::size_t worst = 0;  // piece

  [[nodiscard]] bool is_cut(std::size_t piece) const {
    return !errors.empty() && errors[piece] > 0;
  }
};

// The path that the target runs: chords where it makes them of new arcs, and their number is
// certain.
struct RunPath {
  Path pieces;
  std::vector<double> beside;         // mm, for each: how far what is run may be from it
  std::vector<std::size_t> piece_of;  // of the new part
};

RunPath run_path(const Part& after, const TargetChords& chords, const gcode::Control& target) {
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

TargetChords chords_of_target(const PartPair& pair, const gcode::Control* target) {
  TargetChords found;
  if (target == nullptr || !target->chords.any()) return found;
  // What is said in another language has the arcs of the program, but in other parts.
  const auto language = [](const Part& part) { return part.side->read->program->language; };
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

// The path that keeps the tolerance by itself keeps it as the target runs it, too: else the arcs to
// blame, all that alone are too coarse or the worst one.
std::vector<Violation> chords_violations(const PartPair& pair, const TargetChords& chords,
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

// On one side of the old path, as far as the tolerance: within half of it of the path that is half
// of it beside the old one. docs/algorithms/one_side.md
std::optional<Violation> side_violation(const PartPair& pair, const TargetChords& chords,
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

  StretchResult compare_part(const PartPair& pair) {
    const PartPair middle = without_same_ends(pair);
    if (middle.before.size() == 0 && middle.after.size() == 0) return {};
    geometry::BandComparison comparison = compare(middle, promise_);
    if (comparison.paths.verdict == Verdict::kProved) {
      look_beside_the_distance(pair, middle, comparison.paths);
      result_.stretches.push_back(stretch_of(middle, tolerance_, std::move(comparison)));
      look_twice(middle);
      return std::move(result_);
    }
    // The same ends may be passed otherwise than together: only the whole is a refutation.
    comparison = compare(pair, promise_);
    if (comparison.paths.verdict != Verdict::kProved) {
      result_.violations.push_back(distance_violation(pair, comparison.paths, tolerance_));
      result_.stretches.push_back(stretch_of(pair, tolerance_, std::move(comparison)));
      return std::move(result_);
    }
    look_beside_the_distance(pair, pair, comparison.paths);
    result_.stretches.push_back(stretch_of(pair, tolerance_, std::move(comparison)));
    look_twice(pair);
    return std::move(result_);
  }

 private:
  // Of the stretch that was added last: both ways in the strict reading; in the band reading a
  // corner of the old path may be farther from the new one.
  void look_twice(const PartPair& pair) {
    if (!promise_.twice) return;
    const Path before = pair.before.path();
    const Path after = pair.after.path();
    auto check = geometry::check_in_region(before, after, tolerance_);
    if (!check) return;
    if (check->holds() && promise_.kind == geometry::ToleranceKind::kPath) {
      check = geometry::check_in_region(after, before, tolerance_);
    }
    if (!check || check->holds()) {
      result_.stretches.back().in_region = true;
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
  void look_beside_the_distance(const PartPair& pair, const PartPair& proved,
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
  StretchResult result_;
};

class StretchComparer {
 public:
  StretchComparer(const StretchSide& before, const StretchSide& after, const Promise& promise)
      : before_(before), after_(after), promise_(promise) {}

  StretchResult run() {
    const std::vector<Part> old_parts = parts_of_one_feed(before_);
    const std::vector<Part> new_parts = parts_of_one_feed(after_);
    const bool one_side_only = old_parts.empty() || new_parts.empty();
    if (one_side_only || !same_feeds(old_parts, new_parts)) {
      compare_part({all_of(before_), all_of(after_)});
      return std::move(result_);
    }
    for (std::size_t i = 0; i < old_parts.size(); ++i) compare_part({old_parts[i], new_parts[i]});
    if (old_parts.size() > 1 && std::ranges::any_of(result_.violations, is_of_distance)) {
      look_for_moved_feed();
    }
    return std::move(result_);
  }

 private:
  static bool is_of_distance(const Violation& violation) {
    return violation.kind == ViolationKind::kDistance ||
           violation.kind == ViolationKind::kNotProved;
  }

  bool same_feeds(const std::vector<Part>& old_parts, const std::vector<Part>& new_parts) {
    const std::size_t both = std::min(old_parts.size(), new_parts.size());
    const auto violate = [this](std::uint32_t old_line, std::uint32_t new_line,
                                const std::string& message) {
      result_.violations.push_back(
          {ViolationKind::kFeed, "feed-changed", old_line, new_line, 0, message});
      return false;
    };
    for (std::size_t i = 0; i < both; ++i) {
      const Cut& old_feed = old_parts[i].cut(0);
      const Cut& new_feed = new_parts[i].cut(0);
      if (same_feed(old_feed, new_feed)) continue;
      return violate(old_parts[i].line(0), new_parts[i].line(0),
                     fmt::format("feed {}, expected {}", feed_text(new_feed), feed_text(old_feed)));
    }
    const auto end_line = [](const Part& part) { return part.line(part.size()); };
    if (old_parts.size() > both) {
      const Part& lost = old_parts[both];
      return violate(lost.line(0), end_line(new_parts.back()),
                     fmt::format("feed {} is missing", feed_text(lost.cut(0))));
    }
    if (new_parts.size() > both) {
      const Part& added = new_parts[both];
      return violate(end_line(old_parts.back()), added.line(0),
                     fmt::format("feed {} was not there", feed_text(added.cut(0))));
    }
    return true;
  }

  void compare_part(const PartPair& pair) {
    StretchResult found = compared_in_parts(pair);
    std::ranges::move(found.stretches, std::back_inserter(result_.stretches));
    std::ranges::move(found.violations, std::back_inserter(result_.violations));
  }

  // A path that keeps the least tolerance of its parts keeps that of each.
  [[nodiscard]] StretchResult compared_in_parts(const PartPair& pair) const {
    const double promised = promise_.tolerance_mm;
    const double least = least_tolerance(pair.before, promised);
    // Of a side the corner where a path is cut would be in none of its parts.
    const bool any_change = !before_.read->interpretation->stated.empty();
    if (!any_change || promise_.side != geometry::Side::kBoth) return compared_within(least, pair);
    const auto old_parts = parts_of_one_tolerance(pair.before, promised);
    if (old_parts.size() < 2) return compared_within(least, pair);
    const auto new_parts = parts_of_one_tolerance(pair.after, promised);
    const bool says_the_same = std::ranges::equal(
        old_parts, new_parts, {}, &ToleratedPart::tolerance_mm, &ToleratedPart::tolerance_mm);
    if (!says_the_same) return compared_within(least, pair);
    StretchResult all = compared_apart(old_parts, new_parts);
    // The new path of one part may cross that of another.
    if (all.violations.empty()) {
      all.violations = crossing_violations(pair, without_same_ends(pair), promised);
    }
    if (all.violations.empty()) return all;
    StretchResult whole = compared_within(least, pair);
    // Where the new program says it elsewhere on the path its parts are no help to who reads this.
    const double of_whole = greatest_deviation(whole.violations);
    const bool is_nearer = of_whole > 0 && of_whole < greatest_deviation(all.violations);
    return whole.violations.empty() || is_nearer ? whole : all;
  }

  // mm; 0 where nothing is known to break the tolerance.
  static double greatest_deviation(const std::vector<Violation>& violations) {
    double greatest = 0;
    for (const Violation& each : violations) greatest = std::max(greatest, each.deviation_mm);
    return greatest;
  }

  [[nodiscard]] StretchResult compared_apart(const std::vector<ToleratedPart>& old_parts,
                                             const std::vector<ToleratedPart>& new_parts) const {
    StretchResult all;
    for (std::size_t i = 0; i < old_parts.size(); ++i) {
      StretchResult part =
          compared_within(old_parts[i].tolerance_mm, {old_parts[i].part, new_parts[i].part});
      std::ranges::move(part.stretches, std::back_inserter(all.stretches));
      std::ranges::move(part.violations, std::back_inserter(all.violations));
    }
    return all;
  }

  [[nodiscard]] StretchResult compared_within(double tolerance_mm, const PartPair& pair) const {
    Promise promise = promise_;
    promise.tolerance_mm = tolerance_mm;
    return PairComparer(promise).compare_part(pair);
  }

  // Parts that break the tolerance of a path that keeps it: a feed begins at another place.
  void look_for_moved_feed() {
    const PathComparison whole = compare_whole_path(before_, after_, promise_);
    if (whole.verdict != Verdict::kProved) return;
    const double least = least_tolerance(all_of(before_), promise_.tolerance_mm);
    for (Violation& violation : result_.violations) {
      if (!is_of_distance(violation)) continue;
      violation.kind = ViolationKind::kFeed;
      violation.id = "feed-moved";
      violation.message = fmt::format(
          "the path is the same within {:.6g} mm, but a feed begins or ends at another position",
          least);
    }
  }

  const StretchSide& before_;
  const StretchSide& after_;
  const Promise& promise_;
  StretchResult result_;
};

}  // namespace

StretchResult compare_stretch(const StretchSide& before, const StretchSide& after,
                              const Promise& promise) {
  return StretchComparer(before, after, promise).run();
}

geometry::PathComparison compare_whole_path(const StretchSide& before, const StretchSide& after,
                                            const Promise& promise) {
  Promise least = promise;
  least.tolerance_mm = least_tolerance(all_of(before), promise.tolerance_mm);
  return compare({all_of(before), all_of(after)}, least).paths;
}

std::optional<std::vector<MatchedPart>> match_stretch(const StretchSide& before,
                                                      const StretchSide& after,
                                                      double tolerance_mm) {
  std::vector<Part> old_parts = parts_of_one_feed(before);
  std::vector<Part> new_parts = parts_of_one_feed(after);
  if (old_parts.empty() && new_parts.empty()) return std::vector<MatchedPart>{};
  if (old_parts.empty()) old_parts.push_back(all_of(before));
  if (new_parts.empty()) new_parts.push_back(all_of(after));
  if (old_parts.size() != new_parts.size()) return {};
  std::vector<MatchedPart> matched;
  for (std::size_t i = 0; i < old_parts.size(); ++i) {
    const Part& old_part = old_parts[i];
    const Part& new_part = new_parts[i];
    const bool both = old_part.size() > 0 && new_part.size() > 0;
    if (both && !same_feed(old_part.cut(0), new_part.cut(0))) return {};
    MatchedPart part{old_part.path(), new_part.path(), {}};
    part.matching = geometry::match_paths(part.before, part.after, tolerance_mm);
    if (part.matching.comparison.verdict != Verdict::kProved) return {};
    matched.push_back(std::move(part));
  }
  return matched;
}

}  // namespace batten::postproc
