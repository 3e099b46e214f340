#include "geometry/distance/path_distance.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <stdexcept>
#include <utility>

#include "geometry/distance/chord_polyline.h"
#include "geometry/distance/free_space.h"
#include "geometry/distance/path_distance_predicates.h"

namespace batten::geometry {
namespace {

// Chord error of either path, as a share of the tolerance. When the answer is within these
// errors of the tolerance, chords of a fourth of the length (a sixteenth of the error) are
// asked next. Finer than the last one the answer is left open.
constexpr double kChordShares[] = {5e-3, 5e-3 / 16, 5e-3 / 256};

// at_most may be this share of the tolerance above the truth, and twice the chord errors:
// with arcs on one side that makes the two percent that compare_paths promises.
constexpr double kTightness = 0.01;

// Cells of one decision. Paths that run beside each other need some ten per vertex; the
// first number (24 MB) lets short paths be folded as they like.
constexpr std::size_t kCellsAtLeast = 1'000'000;
constexpr std::size_t kCellsPerVertex = 24;

// CandidateScope a known bound tighter is worth less than finding one.
constexpr std::size_t kTighterCellsAtLeast = 20'000;
constexpr std::size_t kTighterCellsPerVertex = 12;

struct Certificate {
  Matching matching;
  double at_most = std::numeric_limits<double>::infinity();
  std::size_t worst = 0;
};

double greatest_error(const ChordPolyline& polyline) {
  return *std::max_element(polyline.errors.begin(), polyline.errors.end());
}

// One pair of paths, cut into chords of one fineness.
class Comparison {
 public:
  Comparison(std::span<const PathPiece> a, std::span<const PathPiece> b, double tolerance,
             double max_error)
      : a_(cut_into_chords(a, max_error)),
        b_(cut_into_chords(b, max_error)),
        tolerance_(tolerance),
        noise_(distance_noise(a_, b_)),
        vertices_(a_.points.size() + b_.points.size()) {}

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

  // Would finer chords change nothing? So it is when no chord stands for anything else, and
  // when there are too many already.
  [[nodiscard]] bool finer_is_useless() const {
    return too_wide_ || greatest_error(a_) + greatest_error(b_) == 0;
  }

  // The best matching that was found: the certificate where it is proved.
  [[nodiscard]] std::vector<PlacePair> pairs() const {
    std::vector<PlacePair> places;
    places.reserve(best_.matching.size());
    for (const MatchedPair& pair : best_.matching) {
      places.push_back({a_.pieces[pair.a.edge], b_.pieces[pair.b.edge], point_at(a_, pair.a),
                        point_at(b_, pair.b)});
    }
    return places;
  }

 private:
  // The ends of the paths are passed together, so they are never nearer than the paths are.
  void raise_floor(double distance) { at_least_ = std::max(at_least_, distance - noise_); }

  // Takes over a matching that proves more than the one before.
  void keep_if_better(Matching matching) {
    if (!goes_forward(matching, a_, b_)) return;
    const MeasuredMatching found = measure(matching, a_, b_, noise_);
    const bool proves = (!proved_ || found.at_most < best_.at_most) &&
                        found.at_most <= tolerance_ + 2 * noise_ &&
                        within_tolerance(matching, a_, b_, tolerance_);
    if (!proves && (proved_ || found.at_most >= best_.at_most)) return;
    best_ = {std::move(matching), found.at_most, found.worst};
    proved_ = proves;
  }

  // A way through the free space at the tolerance. Rounding may close a passage that is as
  // narrow as the tolerance is exact, or lead a wider one over it: both sides are tried.
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
    double distance = best_.at_most - gap;
    while (best_.at_most - at_least_ > gap) {
      distance = std::max(distance, at_least_);
      const Passage none = refuted_at(distance);
      if (none == Passage::kTooWide) return;
      if (none == Passage::kNone) {
        at_least_ = std::max(at_least_, distance);
      } else if (!proved_at(distance)) {
        return;  // the chords are too coarse to say
      }
      distance = (at_least_ + best_.at_most) / 2;
    }
  }

  [[nodiscard]] Passage refuted_at(double distance) const {
    return find_passage(a_, b_, distance + noise_, ChordErrors::kAdded, tighter_cells()).passage;
  }

  bool proved_at(double distance) {
    const double before = best_.at_most;
    FreeSpaceAnswer answer =
        find_passage(a_, b_, distance, ChordErrors::kSubtracted, tighter_cells());
    if (answer.passage == Passage::kFound) keep_if_better(std::move(answer.way));
    // Less than a quarter of the way down is no progress: the errors of the chords stop it.
    return best_.at_most <= before - (before - distance) / 4;
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
    for (int i = 0; i < kQuestions && best_.at_most > 1.05 * at_least_; ++i) {
      const double distance = (at_least_ + best_.at_most) / 2;
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
    found.bounds.at_most = proved_ ? std::min(best_.at_most, tolerance_) : best_.at_most;
    found.bounds.at_least = std::min(std::max(at_least_, 0.0), found.bounds.at_most);
    if (proved_) {
      found.verdict = Verdict::kProved;
      found.certificate_size = best_.matching.size();
    } else if (at_least_ > tolerance_) {
      found.verdict = Verdict::kBroken;
    }
    const MatchedPair worst = violation_ ? *violation_ : best_.matching[best_.worst];
    found.worst_piece_a = a_.pieces[worst.a.edge];
    found.worst_piece_b = b_.pieces[worst.b.edge];
    found.worst_a = point_at(a_, worst.a);
    found.worst_b = point_at(b_, worst.b);
    return found;
  }

  ChordPolyline a_;
  ChordPolyline b_;
  double tolerance_;
  double noise_;
  std::size_t vertices_;
  double at_least_ = 0;
  bool proved_ = false;
  bool too_wide_ = false;
  Certificate best_;  // always set: the nearest places in order are a matching
  std::optional<MatchedPair> violation_;
};

PathComparison both_empty() {
  PathComparison found;
  found.verdict = Verdict::kProved;
  return found;
}

// A path that is not there is one that waits where the other one starts.
Path waiting_at_start_of(std::span<const PathPiece> path) {
  const Point3 start = start_point(path.front());
  return {Line{start, start}};
}

// `pairs`: where the certificate is wanted, else null. Neither path is empty.
PathComparison compare_some(std::span<const PathPiece> a, std::span<const PathPiece> b,
                            double tolerance, std::vector<PlacePair>* pairs) {
  PathComparison found;
  for (const double share : kChordShares) {
    Comparison comparison(a, b, tolerance, share * tolerance);
    found = comparison.run();
    if (pairs != nullptr) *pairs = comparison.pairs();
    if (found.verdict != Verdict::kNotProved || comparison.finer_is_useless()) break;
  }
  return found;
}

PathComparison compare_any(std::span<const PathPiece> a, std::span<const PathPiece> b,
                           double tolerance, std::vector<PlacePair>* pairs) {
  if (!(tolerance > 0) || !std::isfinite(tolerance)) {
    throw std::invalid_argument(
        fmt::format("compare_paths: tolerance {} mm, expected a finite number above 0", tolerance));
  }
  if (a.empty() && b.empty()) return both_empty();
  if (a.empty()) return compare_some(waiting_at_start_of(b), b, tolerance, pairs);
  if (b.empty()) return compare_some(a, waiting_at_start_of(a), tolerance, pairs);
  return compare_some(a, b, tolerance, pairs);
}

}  // namespace

PathComparison compare_paths(std::span<const PathPiece> a, std::span<const PathPiece> b,
                             double tolerance) {
  return compare_any(a, b, tolerance, nullptr);
}

PathMatching match_paths(std::span<const PathPiece> a, std::span<const PathPiece> b,
                         double tolerance) {
  PathMatching matching;
  matching.comparison = compare_any(a, b, tolerance, &matching.pairs);
  return matching;
}

}  // namespace batten::geometry
