#include "geometry/distance/sparse_matching.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <variant>

#include "geometry/distance/chord_polyline.h"
#include "geometry/distance/free_space.h"

namespace batten::geometry {
namespace {

constexpr double kBillion = 1e9;

// Of the tolerance: errors of the chords of arcs and curves, as tools/check_certificate.py tries
// them (CHORD_SHARES), and how far rounding may move a place along its piece.
constexpr double kSparseShares[] = {1.0 / 300, 1.0 / 5000, 1.0 / 50000};
constexpr double kRoundingShare = 1e-2;

// mm: the checker counts in billionths, and a step may be as much longer or shorter there.
constexpr double kCheckerRounding = 1e-8;

// Left free below the tolerance, as a share of it: the checker's bounds on the chords of arcs are
// greater than these by a fiftieth of their error.
constexpr double kMargin = 1e-4;

PathPlace rounded(std::size_t piece, double t, double step) {
  double billionths = std::round(t / step) * step * kBillion;
  billionths = std::clamp(std::round(billionths), 0.0, kBillion);
  if (billionths >= kBillion) return {piece + 1, 0};
  return {piece, static_cast<std::uint32_t>(billionths)};
}

// Into how many chords tools/check_certificate.py cuts the piece (arc_chords, cubic_chords there).
std::size_t checked_count(const PathPiece& piece, double max_error) {
  constexpr double kGreatestStep = 0.3;  // radians
  double count = 1;
  if (const auto* arc = std::get_if<Arc>(&piece)) {
    const auto radius_at = [arc](const Point3& p) {
      const Vector3 from = p - arc->center;
      return (from - from.dot(arc->axis) * arc->axis).norm();
    };
    const double radius = std::max(radius_at(arc->start), radius_at(arc->end));
    const double step = std::min(kGreatestStep, std::sqrt(8 * max_error / radius));
    count = std::ceil(std::abs(arc->sweep) / step);
  } else if (const auto* cubic = std::get_if<CubicBezier>(&piece)) {
    const auto& c = cubic->control;
    const double bend = std::max((c[0] - 2 * c[1] + c[2]).norm(), (c[1] - 2 * c[2] + c[3]).norm());
    count = std::ceil(std::sqrt(0.75 * bend / max_error));
  }
  return static_cast<std::size_t>(std::max(1.0, count));
}

// The path on the checker's chords, each with its error.
ChordPolyline checked_chords(std::span<const PathPiece> path, double max_error) {
  ChordPolyline chords;
  chords.points.push_back(start_point(path.front()));
  for (std::size_t i = 0; i < path.size(); ++i) {
    const PathPiece& piece = path[i];
    const std::size_t count = checked_count(piece, max_error);
    const double error =
        second_derivative_bound(piece) / (8.0 * static_cast<double>(count * count));
    for (std::size_t k = 1; k <= count; ++k) {
      const double t = static_cast<double>(k) / static_cast<double>(count);
      chords.points.push_back(k == count ? end_point(piece) : geometry::point_at(piece, t));
      chords.errors.push_back(error);
      chords.pieces.push_back(i);
    }
  }
  return chords;
}

class Thinning {
 public:
  Thinning(std::span<const PathPiece> a, std::span<const PathPiece> b, double tolerance,
           double chord_share)
      : old_(a),
        new_(b),
        a_(checked_chords(a, chord_share * tolerance)),
        b_(checked_chords(b, chord_share * tolerance)),
        tolerance_(tolerance) {}

  std::optional<std::vector<SparsePair>> run(const std::vector<PlacePair>& pairs) {
    std::size_t done = 0;  // pairs up to here are passed
    for (std::size_t k = 0; k + 1 < pairs.size(); ++k) {
      const bool piece_ends = pairs[k].t_b >= 1 && pairs[k].piece_b + 1 < new_.size() &&
                              pairs[k + 1].piece_b != pairs[k].piece_b;
      if (!piece_ends) continue;
      if (!pass(pairs, done, k)) return {};
      done = k;
    }
    if (!pass_to_end(pairs, done)) return {};
    return std::move(thin_);
  }

 private:
  [[nodiscard]] MatchedPair on_chords(const SparsePair& pair) const {
    return {place_of(a_, old_, pair.a), place_of(b_, new_, pair.b)};
  }
  static PlaceOnChord place_of(const ChordPolyline& polyline, std::span<const PathPiece> path,
                               const PathPlace& place) {
    if (place.piece >= path.size()) return {polyline.edge_count() - 1, 1};
    return place_on_piece(polyline, place.piece, place.billionths / kBillion);
  }

  [[nodiscard]] bool keeps(const SparsePair& from, const SparsePair& to) const {
    return std::ranges::all_of(std::array{1.0, -1.0}, [&](double either) {
      const double tie = either * kCheckerRounding * tolerance_;
      const Matching matching = match_nearest(a_, b_, on_chords(from), on_chords(to), tie);
      return measure(matching, a_, b_, 0).at_most <= tolerance_ * (1 - kMargin);
    });
  }

  [[nodiscard]] SparsePair sparse(const PlacePair& pair, bool coarse) const {
    constexpr double kFinest = 1 / kBillion;
    const auto step = [&](const PathPiece& piece) {
      const double share = kRoundingShare * tolerance_ / std::max(length_of(piece), kFinest);
      const double digits = std::clamp(std::ceil(-std::log10(share)), 1.0, 9.0);
      return coarse ? std::pow(10.0, -digits) : kFinest;
    };
    SparsePair result{rounded(pair.piece_a, pair.t_a, step(old_[pair.piece_a])),
                      rounded(pair.piece_b, pair.t_b, step(new_[pair.piece_b]))};
    result.a = std::max(result.a, last_.a);
    result.b = std::max(result.b, last_.b);
    return result;
  }

  bool add_if_kept(const SparsePair& pair) {
    if (!keeps(last_, pair)) return false;
    thin_.push_back(pair);
    last_ = pair;
    return true;
  }

  // From the pair `done` to pair `k`; by the pairs between them where the rule is not enough.
  bool pass(const std::vector<PlacePair>& pairs, std::size_t done, std::size_t k) {
    if (add_if_kept(sparse(pairs[k], true)) || add_if_kept(sparse(pairs[k], false))) return true;
    for (std::size_t i = done + 1; i <= k; ++i) {
      if (!add_if_kept(sparse(pairs[i], false))) return false;
    }
    return true;
  }

  bool pass_to_end(const std::vector<PlacePair>& pairs, std::size_t done) {
    const SparsePair end{{old_.size(), 0}, {new_.size(), 0}};
    if (keeps(last_, end)) return true;
    for (std::size_t i = done + 1; i + 1 < pairs.size(); ++i) {
      if (!add_if_kept(sparse(pairs[i], false))) return false;
    }
    return keeps(last_, end);
  }

  std::span<const PathPiece> old_;
  std::span<const PathPiece> new_;
  ChordPolyline a_;
  ChordPolyline b_;
  double tolerance_;
  SparsePair last_;
  std::vector<SparsePair> thin_;
};

}  // namespace

std::optional<std::vector<SparsePair>> thin_matching(std::span<const PathPiece> a,
                                                     std::span<const PathPiece> b,
                                                     const PathMatching& matching,
                                                     double tolerance) {
  if (a.empty() || b.empty()) return std::vector<SparsePair>{};
  for (const double share : kSparseShares) {
    if (auto pairs = Thinning(a, b, tolerance, share).run(matching.pairs)) return pairs;
  }
  return {};
}

}  // namespace batten::geometry
