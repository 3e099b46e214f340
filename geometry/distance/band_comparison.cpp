#include "geometry/distance/band_comparison.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <variant>
#include <vector>

#include "geometry/basic/require.h"
#include "geometry/basic/rounding.h"
#include "geometry/basic/tolerance_kind.h"
#include "geometry/distance/chord_polyline.h"
#include "geometry/distance/free_space.h"

namespace batten::geometry {
namespace {

// Legs that turn by less make no corner that could be cut: 1 / sin is 1 to the last digit there.
constexpr double kLeastTurn = 1e-6;

// Chords that show about where the new path passes a corner need not be finer than this part of
// the tolerance.
constexpr double kChordShare = 0.25;

struct Place {  // on a path
  std::size_t piece = 0;
  double t = 0;
};

struct OldCorner {
  std::size_t piece;  // and the next one meet in it
  Point3 vertex;
  double sin_half;  // of the angle between the lines
};

// A corner that the new path leaves by more than the tolerance.
struct Cut {
  Place leaves;     // A, on the old path
  Place returns;    // B, on the old path
  Place passes;     // n, on the new path
  double distance;  // mm, n to the vertex
};

std::vector<OldCorner> corners_of(std::span<const PathPiece> path) {
  std::vector<OldCorner> corners;
  for (std::size_t i = 0; i + 1 < path.size(); ++i) {
    const auto* before = std::get_if<Line>(&path[i]);
    const auto* after = std::get_if<Line>(&path[i + 1]);
    if (before == nullptr || after == nullptr || before->end != after->start) continue;
    const Vector3 in = before->end - before->start;
    const Vector3 out = after->end - after->start;
    if (in.norm() <= kSamePlace || out.norm() <= kSamePlace) continue;
    const double turn = std::atan2(in.cross(out).norm(), in.dot(out));
    if (turn < kLeastTurn || turn > kPi - kSharpestCut) continue;
    corners.push_back({i, before->end, std::cos(turn / 2)});
  }
  return corners;
}

Place nearest_on_line(const Line& line, std::size_t piece, const Point3& to, double from) {
  const Vector3 along = line.end - line.start;
  const double t = (to - line.start).dot(along) / along.squaredNorm();
  return {piece, std::clamp(t, from, 1.0)};
}

// By samples and golden sections; any point of the piece is sound, the nearest one serves best.
Place nearest_on(const PathPiece& piece, std::size_t index, const Point3& to, double from) {
  if (const auto* line = std::get_if<Line>(&piece)) {
    if (line->start == line->end) return {index, from};
    return nearest_on_line(*line, index, to, from);
  }
  constexpr int kSamples = 32;
  constexpr int kSections = 40;
  constexpr double kGolden = 0.6180339887498949;
  const auto distance = [&](double t) { return (point_at(piece, t) - to).norm(); };
  const double step = (1 - from) / kSamples;
  double best = from;
  for (int k = 1; k <= kSamples; ++k) {
    if (distance(from + k * step) < distance(best)) best = from + k * step;
  }
  double low = std::max(from, best - step);
  double high = std::min(1.0, best + step);
  for (int k = 0; k < kSections; ++k) {
    const double left = high - kGolden * (high - low);
    const double right = low + kGolden * (high - low);
    (distance(left) < distance(right) ? high : low) =
        distance(left) < distance(right) ? right : left;
  }
  const double middle = 0.5 * (low + high);
  return {index, distance(middle) < distance(best) ? middle : best};
}

// A path that waits where the two are one.
Path part_between(std::span<const PathPiece> path, const Place& from, const Place& to) {
  Path part;
  for (std::size_t i = from.piece; i <= to.piece; ++i) {
    const double t0 = i == from.piece ? from.t : 0;
    const double t1 = i == to.piece ? to.t : 1;
    if (!(t0 < t1)) continue;
    part.push_back(t0 == 0 && t1 == 1 ? path[i] : sub_piece(path[i], t0, t1));
  }
  if (part.empty()) {
    const Point3 here = point_at(path[from.piece], from.t);
    part.push_back(Line{here, here});
  }
  return part;
}

class BandComparer {
 public:
  BandComparer(std::span<const PathPiece> old_path, std::span<const PathPiece> new_path,
               double tolerance, std::vector<PlacePair>* pairs = nullptr)
      : old_(old_path),
        new_(new_path),
        tolerance_(tolerance),
        corners_(corners_of(old_path)),
        pairs_(pairs) {
    require(tolerance > 2 * kSamePlace && std::isfinite(tolerance), "compare_in_band: tolerance",
            tolerance, "a finite number above 2e-9");
  }

  BandComparison run() {
    find_cuts();
    if (cuts_.empty()) {
      result_.paths = compared(old_, new_, tolerance_, {0, 0}, {0, 0});
    } else {
      compare_parts();
    }
    if (result_.paths.verdict != Verdict::kProved) refute();
    return result_;
  }

 private:
  // --- where the new path passes the corners: nothing of this has to be trusted ---------------

  // The piece of the new path that goes with the end of each piece of `path`, in order.
  [[nodiscard]] std::vector<std::size_t> new_pieces_at_ends(const Path& path) const {
    const double error = kChordShare * tolerance_;
    const ChordPolyline a = cut_into_chords(path, error);
    const ChordPolyline b = cut_into_chords(new_, error);
    std::vector<std::size_t> at(path.size(), 0);
    for (const MatchedPair& pair : match_nearest(a, b)) {
      if (pair.a.t == 1) at[a.pieces[pair.a.edge]] = b.pieces[pair.b.edge];
    }
    for (std::size_t i = 1; i < at.size(); ++i) at[i] = std::max(at[i], at[i - 1]);
    return at;
  }

  // Between the middles of the corner's legs.
  void find_cuts() {
    if (corners_.empty() || new_.empty()) return;
    std::vector<bool> is_leg(old_.size(), false);
    for (const OldCorner& corner : corners_) {
      is_leg[corner.piece] = is_leg[corner.piece + 1] = true;
    }
    Path halved;                                          // the old path with each leg in halves
    std::vector<std::size_t> first_half(old_.size(), 0);  // of each old piece, in it
    for (std::size_t i = 0; i < old_.size(); ++i) {
      first_half[i] = halved.size();
      halved.push_back(is_leg[i] ? sub_piece(old_[i], 0, 0.5) : old_[i]);
      if (is_leg[i]) halved.push_back(sub_piece(old_[i], 0.5, 1));
    }
    const std::vector<std::size_t> new_piece = new_pieces_at_ends(halved);
    for (const OldCorner& corner : corners_) {
      try_to_cut(corner, new_piece[first_half[corner.piece]],
                 new_piece[first_half[corner.piece + 1]]);
    }
  }

  void try_to_cut(const OldCorner& corner, std::size_t first, std::size_t last) {
    const Place passed = cuts_.empty() ? Place{0, 0} : cuts_.back().passes;
    Place nearest;
    double least = std::numeric_limits<double>::infinity();
    for (std::size_t j = std::max(first, passed.piece); j <= last; ++j) {
      const double from = j == passed.piece ? passed.t : 0;
      const Place place = nearest_on(new_[j], j, corner.vertex, from);
      const double distance = (point_at(new_[j], place.t) - corner.vertex).norm();
      if (distance < least) {
        least = distance;
        nearest = place;
      }
    }
    // Beside the tolerance only the exact comparison can tell.
    if (least <= tolerance_ + kSamePlace) return;
    if (least + kSamePlace > tolerance_ / corner.sin_half) return;
    const Point3 n = point_at(new_[nearest.piece], nearest.t);
    const bool leg_was_cut = !cuts_.empty() && cuts_.back().returns.piece == corner.piece;
    const double from = leg_was_cut ? cuts_.back().returns.t : 0;
    const auto& before = std::get<Line>(old_[corner.piece]);
    const auto& after = std::get<Line>(old_[corner.piece + 1]);
    const Place leaves = nearest_on_line(before, corner.piece, n, from);
    const Place returns = nearest_on_line(after, corner.piece + 1, n, 0);
    cuts_.push_back({leaves, returns, nearest, least});
  }

  // --- the proof --------------------------------------------------------------------------------

  // A part's ends are matched with each other, so the proofs of the two parts beside a cut show
  // that A and B are within the tolerance of n.
  void compare_parts() {
    PathComparison all;
    all.verdict = Verdict::kProved;
    Place old_from{0, 0};
    Place new_from{0, 0};
    for (std::size_t k = 0; k <= cuts_.size(); ++k) {
      const bool last = k == cuts_.size();
      const Place old_to = last ? Place{old_.size() - 1, 1} : cuts_[k].leaves;
      const Place new_to = last ? Place{new_.size() - 1, 1} : cuts_[k].passes;
      add_part(compared(part_between(old_, old_from, old_to), part_between(new_, new_from, new_to),
                        tolerance_ - kSamePlace, old_from, new_from),
               old_from, new_from, all);
      if (last) break;
      if (pairs_ != nullptr) {  // round the corner
        pairs_->push_back({old_to.piece, new_to.piece, end_point(old_[old_to.piece]),
                           point_at(new_[new_to.piece], new_to.t)});
      }
      old_from = cuts_[k].returns;
      new_from = cuts_[k].passes;
      result_.corner_at_most = std::max(result_.corner_at_most, cuts_[k].distance + kSamePlace);
    }
    result_.cut_corners = cuts_.size();
    result_.paths = all;
  }

  // compare_paths, with its certificate where one is wanted.
  PathComparison compared(std::span<const PathPiece> old_part, std::span<const PathPiece> new_part,
                          double tolerance, const Place& old_from, const Place& new_from) {
    if (pairs_ == nullptr) return compare_paths(old_part, new_part, tolerance);
    PathMatching part = match_paths(old_part, new_part, tolerance);
    for (PlacePair& pair : part.pairs) {
      pair.piece_a += old_from.piece;
      pair.piece_b += new_from.piece;
      pairs_->push_back(pair);
    }
    return part.comparison;
  }

  static void add_part(const PathComparison& part, const Place& old_from, const Place& new_from,
                       PathComparison& all) {
    all.certificate_size += part.certificate_size;
    if (part.verdict != Verdict::kProved) all.verdict = Verdict::kNotProved;
    const double at_most = part.bounds.at_most + kSamePlace;
    if (at_most <= all.bounds.at_most) return;
    all.bounds.at_most = at_most;
    all.worst_piece_a = old_from.piece + part.worst_piece_a;
    all.worst_piece_b = new_from.piece + part.worst_piece_b;
    all.worst_a = part.worst_a;
    all.worst_b = part.worst_b;
  }

  // No matching of the band reading has a pair further apart than the loosest corner allows, so
  // it is also one in the strict reading at that distance. Without such a one it is broken.
  void refute() {
    double loosest = tolerance_;
    for (const OldCorner& corner : corners_) {
      loosest = std::max(loosest, tolerance_ / corner.sin_half);
    }
    const PathComparison strict = compare_paths(old_, new_, loosest);
    if (strict.verdict == Verdict::kBroken) {
      result_.paths = strict;
    } else {
      result_.paths.verdict = Verdict::kNotProved;
      result_.paths.bounds.at_least = 0;
    }
  }

  std::span<const PathPiece> old_;
  std::span<const PathPiece> new_;
  double tolerance_;
  std::vector<OldCorner> corners_;
  std::vector<PlacePair>* pairs_;  // null: not wanted
  std::vector<Cut> cuts_;
  BandComparison result_;
};

}  // namespace

BandComparison compare_in_band(std::span<const PathPiece> old_path,
                               std::span<const PathPiece> new_path, double tolerance) {
  return BandComparer(old_path, new_path, tolerance).run();
}

PathMatching match_in_band(std::span<const PathPiece> old_path, std::span<const PathPiece> new_path,
                           double tolerance) {
  PathMatching matching;
  matching.comparison = BandComparer(old_path, new_path, tolerance, &matching.pairs).run().paths;
  return matching;
}

}  // namespace batten::geometry
