#include "geometry/distance/path_distance.h"

#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>
#include <CGAL/Exact_rational.h>
#include <CGAL/Simple_cartesian.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <utility>

#include "geometry/basic/require.h"
#include "geometry/distance/chord_polyline.h"
#include "geometry/distance/free_space.h"

namespace batten::geometry {
namespace {

// --- what must not be wrong by a rounding step: in rounded numbers where these decide, else exact
// ---

using Exact = CGAL::Simple_cartesian<CGAL::Exact_rational>;
using ExactNumber = Exact::FT;
using Filtered = CGAL::Exact_predicates_inexact_constructions_kernel;

// Steps of the decimals that coordinates are printed with, per mm: six decimals of an inch are 1e-6
// * 25.4 = 2.54e-5 mm, a multiple of 1e-7 mm; mm carry up to nine decimals.
constexpr double kGridPerMm = 1e9;

// A double made from a printed decimal is off by half a rounding step; inches by three half steps
// (the decimal, 25.4, their product); one more for the product with kGridPerMm. Sixteen leave room
// for increments that were added up.
constexpr double kDecimalNoise = 16 * std::numeric_limits<double>::epsilon();

// The same where the sum of increments comes back to zero, in steps of the grid: 1e-13 mm.
constexpr double kDecimalFloor = 1e-4;

// Beyond it neighbouring doubles are too far apart to tell the decimal: 9e6 mm.
constexpr double kGreatestGrid = 9007199254740992.0;  // 2^53

// The whole number of grid steps that the double stands for.
std::optional<double> grid_steps(double mm) {
  const double scaled = mm * kGridPerMm;
  const double steps = std::round(scaled);
  if (std::abs(scaled) > kGreatestGrid) return {};
  const double noise = std::max(kDecimalFloor, kDecimalNoise * std::abs(scaled));
  if (std::abs(scaled - steps) > noise) return {};
  return steps;
}

ExactNumber exact_number(double mm) {
  const std::optional<double> steps = grid_steps(mm);
  return steps ? ExactNumber(*steps) / ExactNumber(kGridPerMm) : ExactNumber(mm);
}

Exact::Point_3 exact_point(const Point3& p) {
  return {exact_number(p.x()), exact_number(p.y()), exact_number(p.z())};
}

// In grid steps, as doubles that are whole numbers; nothing where they are none.
std::optional<Filtered::Point_3> grid_point(const Point3& p) {
  const auto x = grid_steps(p.x());
  const auto y = grid_steps(p.y());
  const auto z = grid_steps(p.z());
  if (!x || !y || !z) return {};
  return Filtered::Point_3(*x, *y, *z);
}

// One of a pair: as given, or the foot of the perpendicular from a vertex of the other polyline.
struct ReadPlace {
  PlaceOnChord place;
  std::optional<Point3> foot_of = {};
};

bool is_vertex(const PlaceOnChord& place) { return place.t == 0 || place.t == 1; }

Exact::Point_3 exact_place(const ChordPolyline& polyline, const PlaceOnChord& place) {
  Exact::Point_3 from = exact_point(polyline.points[place.edge]);
  if (place.t == 0) return from;
  Exact::Point_3 to = exact_point(polyline.points[place.edge + 1]);
  if (place.t == 1) return to;
  return from + ExactNumber(place.t) * (to - from);
}

// The parameter of the foot of the perpendicular on the line through the edge.
ExactNumber exact_foot(const ChordPolyline& polyline, std::size_t edge, const Point3& vertex) {
  const Exact::Point_3 from = exact_point(polyline.points[edge]);
  const Exact::Vector_3 along = exact_point(polyline.points[edge + 1]) - from;
  if (along.squared_length() == 0) return 0;
  return (exact_point(vertex) - from) * along / along.squared_length();
}

ExactNumber exact_parameter(const ChordPolyline& polyline, const ReadPlace& read) {
  if (!read.foot_of) return read.place.t;
  return exact_foot(polyline, read.place.edge, *read.foot_of);
}

// Neighbours on one polyline, one of them read as a foot: still in order?
bool in_order(const ChordPolyline& polyline, const ReadPlace& before, const ReadPlace& after) {
  if (!before.foot_of && !after.foot_of) return true;
  const ExactNumber t = exact_parameter(polyline, after);
  if (before.place.edge == after.place.edge) return exact_parameter(polyline, before) <= t;
  return t >= 0;  // a foot is never read for a vertex, so `before` is the end of its edge
}

// mm, a bound for the rounding of a distance between these polylines, computed in doubles.
double distance_noise(const ChordPolyline& a, const ChordPolyline& b) {
  // A coordinate off its decimal by kDecimalNoise of itself on both sides, a difference, a position
  // between two vertices and a norm: below 64 steps of the greatest coordinate. The rest is the
  // kDecimalFloor of both.
  const double size = std::max(greatest_coordinate(a), greatest_coordinate(b));
  return 128 * std::numeric_limits<double>::epsilon() * size + 4 * kDecimalFloor / kGridPerMm;
}

class Checker {
 public:
  Checker(const ChordPolyline& a, const ChordPolyline& b, double tolerance)
      : a_(a), b_(b), tolerance_(tolerance), noise_(distance_noise(a, b)) {}

  // Pairs must come in the order of the matching.
  bool accept(const MatchedPair& pair, double error) {
    ReadPlace on_a{pair.a};
    ReadPlace on_b{pair.b};
    const double apart = (point_at(a_, pair.a) - point_at(b_, pair.b)).norm();
    const double allowed = tolerance_ - error;
    if (apart > allowed + noise_) return false;
    if (apart > allowed - noise_ && !exactly_within(pair, error) &&
        !foot_within(pair, error, on_a, on_b)) {
      return false;
    }
    if (!first_ && (!in_order(a_, last_a_, on_a) || !in_order(b_, last_b_, on_b))) return false;
    first_ = false;
    last_a_ = on_a;
    last_b_ = on_b;
    return true;
  }

 private:
  [[nodiscard]] ExactNumber exactly_allowed(double error) const {
    return exact_number(tolerance_) - ExactNumber(error);
  }

  [[nodiscard]] bool exactly_within(const MatchedPair& pair, double error) const {
    if (error == 0 && is_vertex(pair.a) && is_vertex(pair.b)) {
      if (const std::optional<bool> answer = vertices_within(pair)) return *answer;
    }
    const ExactNumber allowed = exactly_allowed(error);
    if (allowed < 0) return false;
    return CGAL::compare_squared_distance(exact_place(a_, pair.a), exact_place(b_, pair.b),
                                          allowed * allowed) != CGAL::LARGER;
  }

  // Printed numbers against a printed tolerance, all whole numbers of grid steps: CGAL's filtered
  // predicate compares two distances without leaving doubles unless it must.
  [[nodiscard]] std::optional<bool> vertices_within(const MatchedPair& pair) const {
    const auto p = grid_point(point_at(a_, pair.a));
    const auto q = grid_point(point_at(b_, pair.b));
    const auto steps = grid_steps(tolerance_);
    if (!p || !q || !steps) return {};
    return Filtered().compare_distance_3_object()(*p, *q, Filtered::Point_3(0, 0, 0),
                                                  Filtered::Point_3(*steps, 0, 0)) != CGAL::LARGER;
  }

  [[nodiscard]] bool foot_within(const MatchedPair& pair, double error, ReadPlace& on_a,
                                 ReadPlace& on_b) const {
    if (is_vertex(pair.a) && !is_vertex(pair.b)) {
      return foot_on(b_, pair.b, point_at(a_, pair.a), error, on_b);
    }
    if (is_vertex(pair.b) && !is_vertex(pair.a)) {
      return foot_on(a_, pair.a, point_at(b_, pair.b), error, on_a);
    }
    return false;
  }

  [[nodiscard]] bool foot_on(const ChordPolyline& polyline, const PlaceOnChord& place,
                             const Point3& vertex, double error, ReadPlace& read) const {
    const ExactNumber t = exact_foot(polyline, place.edge, vertex);
    const ExactNumber allowed = exactly_allowed(error);
    if (t < 0 || t > 1 || allowed < 0) return false;
    const Exact::Point_3 from = exact_point(polyline.points[place.edge]);
    const Exact::Point_3 to = exact_point(polyline.points[place.edge + 1]);
    if (CGAL::compare_squared_distance(exact_point(vertex), Exact::Point_3(from + t * (to - from)),
                                       allowed * allowed) == CGAL::LARGER) {
      return false;
    }
    read.foot_of = vertex;
    return true;
  }

  const ChordPolyline& a_;
  const ChordPolyline& b_;
  double tolerance_;
  double noise_;
  bool first_ = true;
  ReadPlace last_a_;
  ReadPlace last_b_;
};

// Is every pair of the matching within `tolerance` minus the chord errors beside it? Exactly: a
// distance that equals the tolerance is within, one that is longer by any amount is not.
//
// A coordinate is taken as the decimal of nine digits after the point (mm) that the double stands
// for, where there is one: coordinates come from printed millimetres, or from printed inches of up
// to eight decimals times 25.4, and both are such decimals. So is the tolerance. Other coordinates
// are taken as the number that the double is.
//
// A pair of a vertex and a point inside an edge may be read as the vertex and the foot of the
// perpendicular from it, where the foot lies in order: the foot is exact, the double is not.
//
// Requires: the matching goes forward (goes_forward).
bool within_tolerance(const Matching& matching, const ChordPolyline& a, const ChordPolyline& b,
                      double tolerance) {
  Checker checker(a, b, tolerance);
  for (std::size_t k = 0; k < matching.size(); ++k) {
    if (!checker.accept(matching[k], pair_error(matching, k, a, b))) return false;
  }
  return true;
}

// --- the search
// ------------------------------------------------------------------------------------

// Chord error of either path, as a share of the tolerance. When the answer is within these errors
// of the tolerance, chords of a fourth of the length (a sixteenth of the error) are asked next;
// after the last one the answer is left open.
constexpr double kChordShares[] = {kFirstChordShare, kFirstChordShare / 16, kFirstChordShare / 256};

// at_most may be this share of the tolerance above the truth, and twice the chord errors: with arcs
// on one side that makes the two percent that compare_paths promises.
constexpr double kTightness = 0.01;

// Cells of one decision. Paths that run beside each other need some ten per vertex; the first
// number (24 MB) lets short paths be folded as they like.
constexpr std::size_t kCellsAtLeast = 1'000'000;
constexpr std::size_t kCellsPerVertex = 24;

// To make a known bound tighter is worth less than to find one.
constexpr std::size_t kTighterCellsAtLeast = 20'000;
constexpr std::size_t kTighterCellsPerVertex = 12;

double greatest_error(const ChordPolyline& polyline) {
  return *std::max_element(polyline.errors.begin(), polyline.errors.end());
}

// One pair of paths, cut into chords of one fineness.
class Comparison {
 public:
  Comparison(std::span<const PathPiece> a, std::span<const PathPiece> b, double tolerance,
             double max_error, std::span<const double> beside_b)
      : a_(cut_into_chords(a, max_error)),
        b_(cut_into_chords(b, max_error)),
        tolerance_(tolerance),
        noise_(distance_noise(a_, b_)),
        vertices_(a_.points.size() + b_.points.size()),
        cut_error_(greatest_error(a_) + greatest_error(b_)) {
    if (beside_b.empty()) return;
    for (std::size_t i = 0; i < b_.edge_count(); ++i) b_.errors[i] += beside_b[b_.pieces[i]];
  }

  PathComparison run() {
    raise_floor((a_.points.front() - b_.points.front()).norm());
    raise_floor((a_.points.back() - b_.points.back()).norm());
    keep_if_better(match_nearest(a_, b_));
    if (!proved_) search_proof();
    if (proved_) {
      tighten();
    } else {
      refute();
    }
    return result();
  }

  // Finer chords change nothing when no chord has an error, and when there are too many already.
  [[nodiscard]] bool finer_is_useless() const { return too_wide_ || cut_error_ == 0; }

  // The best matching that was found: the certificate where it is proved.
  [[nodiscard]] std::vector<PlacePair> pairs() const {
    std::vector<PlacePair> places;
    places.reserve(best_.size());
    for (const MatchedPair& pair : best_) places.push_back(places_of(pair));
    return places;
  }

 private:
  // The ends of the paths are passed together, so they are never nearer than the paths are.
  void raise_floor(double distance) { at_least_ = std::max(at_least_, distance - noise_); }

  // Takes over a matching that proves more than the one before.
  void keep_if_better(Matching matching) {
    if (!goes_forward(matching, a_, b_)) return;
    const MeasuredMatching found = measure(matching, a_, b_, noise_);
    const bool proves = (!proved_ || found.at_most < measured_.at_most) &&
                        found.at_most <= tolerance_ + 2 * noise_ &&
                        within_tolerance(matching, a_, b_, tolerance_);
    if (!proves && (proved_ || found.at_most >= measured_.at_most)) return;
    best_ = std::move(matching);
    measured_ = found;
    proved_ = proves;
  }

  [[nodiscard]] PlacePair places_of(const MatchedPair& pair) const {
    return {a_.pieces[pair.a.edge], b_.pieces[pair.b.edge],      point_at(a_, pair.a),
            point_at(b_, pair.b),   piece_parameter(a_, pair.a), piece_parameter(b_, pair.b)};
  }

  // A way through the free space at the tolerance. Rounding may close a passage that is as narrow
  // as the tolerance is exact, or lead a wider one over it: both sides are tried.
  void search_proof() {
    for (const double distance : {tolerance_ + noise_, tolerance_ - 2 * noise_}) {
      FreeSpaceAnswer answer =
          find_passage(a_, b_, distance, ChordErrors::kSubtracted, most_cells());
      too_wide_ = answer.passage == Passage::kTooWide;
      if (answer.passage != Passage::kFound) return;
      keep_if_better(std::move(answer.way));
      if (proved_) return;
    }
  }

  // Asks for a way at smaller distances, until none is left or the bound is tight.
  void tighten() {
    const double gap =
        kTightness * tolerance_ + 2 * (greatest_error(a_) + greatest_error(b_)) + 4 * noise_;
    // The nearest places in order are mostly the best matching: ask just below it first.
    double distance = measured_.at_most - gap;
    while (measured_.at_most - at_least_ > gap) {
      distance = std::max(distance, at_least_);
      const Passage none = refuted_at(distance);
      if (none == Passage::kTooWide) return;
      if (none == Passage::kNone) {
        at_least_ = std::max(at_least_, distance);
      } else if (!proved_at(distance)) {
        return;  // the chords are too coarse to say
      }
      distance = (at_least_ + measured_.at_most) / 2;
    }
  }

  [[nodiscard]] Passage refuted_at(double distance) const {
    return find_passage(a_, b_, distance + noise_, ChordErrors::kAdded, tighter_cells()).passage;
  }

  bool proved_at(double distance) {
    const double before = measured_.at_most;
    FreeSpaceAnswer answer =
        find_passage(a_, b_, distance, ChordErrors::kSubtracted, tighter_cells());
    if (answer.passage == Passage::kFound) keep_if_better(std::move(answer.way));
    // Less than a quarter of the way down is no progress: the errors of the chords stop it.
    return measured_.at_most <= before - (before - distance) / 4;
  }

  // No way even at the tolerance plus all errors: the tolerance is broken. By how much, to
  // within a few percent of what is known from above, is worth some more questions.
  void refute() {
    if (too_wide_) return;  // a larger distance leaves more cells free, not fewer
    FreeSpaceAnswer answer =
        find_passage(a_, b_, tolerance_ + 2 * noise_, ChordErrors::kAdded, most_cells());
    if (answer.passage != Passage::kNone) return;
    violation_ = answer.furthest;
    at_least_ = std::max(at_least_, tolerance_ + noise_);
    constexpr int kQuestions = 6;
    for (int i = 0; i < kQuestions && measured_.at_most > 1.05 * at_least_; ++i) {
      const double distance = (at_least_ + measured_.at_most) / 2;
      const Passage passage = refuted_at(distance);
      if (passage == Passage::kTooWide) return;
      if (passage == Passage::kNone) {
        at_least_ = distance;
      } else if (!proved_at(distance)) {
        return;
      }
    }
  }

  [[nodiscard]] std::size_t most_cells() const {
    return kCellsAtLeast + kCellsPerVertex * vertices_;
  }
  [[nodiscard]] std::size_t tighter_cells() const {
    return kTighterCellsAtLeast + kTighterCellsPerVertex * vertices_;
  }

  [[nodiscard]] PathComparison result() const {
    PathComparison found;
    found.bounds.at_most = proved_ ? std::min(measured_.at_most, tolerance_) : measured_.at_most;
    found.bounds.at_least = std::min(std::max(at_least_, 0.0), found.bounds.at_most);
    if (proved_) {
      found.verdict = Verdict::kProved;
      found.certificate_size = best_.size();
    } else if (at_least_ > tolerance_) {
      found.verdict = Verdict::kBroken;
    }
    const PlacePair worst = places_of(violation_ ? *violation_ : best_[measured_.worst]);
    found.worst_piece_a = worst.piece_a;
    found.worst_piece_b = worst.piece_b;
    found.worst_a = worst.a;
    found.worst_b = worst.b;
    return found;
  }

  ChordPolyline a_;
  ChordPolyline b_;
  double tolerance_;
  double noise_;
  std::size_t vertices_;
  double cut_error_;  // of the chords themselves
  double at_least_ = 0;
  bool proved_ = false;
  bool too_wide_ = false;
  Matching best_;  // always set: the nearest in order are a matching
  MeasuredMatching measured_{std::numeric_limits<double>::infinity(), 0};  // of it
  std::optional<MatchedPair> violation_;
};

// `pairs`: where the certificate is wanted, else null.
PathComparison compare(std::span<const PathPiece> a, std::span<const PathPiece> b, double tolerance,
                       std::span<const double> beside_b, std::vector<PlacePair>* pairs) {
  require(tolerance > 0 && std::isfinite(tolerance), "compare_paths: tolerance", tolerance,
          "a finite number above 0");
  require(beside_b.empty() || beside_b.size() == b.size(), "compare_paths: beside_b",
          static_cast<double>(beside_b.size()), "a number for each piece");
  PathComparison found;
  if (a.empty() && b.empty()) {
    found.verdict = Verdict::kProved;
    return found;
  }
  // A path that is not there is one that waits where the other one starts.
  const Point3 start = start_point(a.empty() ? b.front() : a.front());
  const Path waiting = {Line{start, start}};
  if (a.empty()) a = waiting;
  if (b.empty()) b = waiting;
  for (const double share : kChordShares) {
    Comparison comparison(a, b, tolerance, share * tolerance, beside_b);
    found = comparison.run();
    if (pairs != nullptr) *pairs = comparison.pairs();
    if (found.verdict != Verdict::kNotProved || comparison.finer_is_useless()) break;
  }
  return found;
}

}  // namespace

PathComparison compare_paths(std::span<const PathPiece> a, std::span<const PathPiece> b,
                             double tolerance, std::span<const double> beside_b) {
  return compare(a, b, tolerance, beside_b, nullptr);
}

PathMatching match_paths(std::span<const PathPiece> a, std::span<const PathPiece> b,
                         double tolerance) {
  PathMatching matching;
  matching.comparison = compare(a, b, tolerance, {}, &matching.pairs);
  return matching;
}

}  // namespace batten::geometry
