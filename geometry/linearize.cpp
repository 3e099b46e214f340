#include "geometry/linearize.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>
#include <string>
#include <utility>

#include "geometry/chord_proof.h"
#include "geometry/curve_pieces.h"

namespace batten::geometry {
namespace {

// A chord's end is searched to this part of its length: a thousand chords lose one tenth of
// a chord.
constexpr double kEndPrecision = 1e-4;

// A chord this much longer than the greatest length (relative) has that length: rounding of
// evenly divided lines.
constexpr double kLengthNoise = 1e-9;

// How often the limits are narrowed to let the last chord grow to the size of the others.
constexpr int kChordBalancingRounds = 8;

// The last chord is no remainder when it is this part of a full one.
constexpr double kFullChord = 0.98;

// Only so many chords at the end are narrowed: over these a remainder is spread thin, and
// the cost of the rounds does not grow with the run.
constexpr std::size_t kBalancedChords = 50;

struct Limits {
  double deviation;   // mm
  double max_length;  // mm, infinite when there is none
};

Limits scaled(const Limits& limits, double chord_length) {
  // A chord's deviation grows with the square of its length.
  return {limits.deviation * chord_length * chord_length, limits.max_length * chord_length};
}

// The chords from one place of the curve on: which ends hold.
class ChordsFrom {
 public:
  ChordsFrom(const CurvePieces& pieces, double from, const Limits& limits)
      : pieces_(pieces),
        from_(from),
        first_(pieces.index_of(from)),
        start_(pieces.point_at(from)),
        limits_(limits) {}

  [[nodiscard]] const Point3& start() const { return start_; }
  [[nodiscard]] std::size_t first_piece() const { return first_; }

  [[nodiscard]] bool proved(double end) const {
    const Point3 place = pieces_.point_in(piece_at(end, first_), end);
    if ((place - start_).norm() > limits_.max_length * (1 + kLengthNoise)) return false;
    return chord_proved(pieces_, first_, from_, end, ChordProof(start_, place, limits_.deviation));
  }

  // As `proved`, but what lies before an end that held or behind one that did not is not asked
  // again: a longer chord is farther off.
  bool holds(double end) {
    if (end <= held_) return true;
    if (end >= failed_) return false;
    const bool held = proved(end);
    (held ? held_ : failed_) = end;
    return held;
  }

  // As `holds`, for ends that may hold although nearer ones do not: behind a turning point.
  bool holds_beyond(double end) {
    if (end < failed_) return holds(end);
    if (!proved(end)) return false;
    held_ = end;
    failed_ = std::numeric_limits<double>::infinity();
    return true;
  }

  // Whether this end itself was asked for, and held.
  [[nodiscard]] bool held(double end) const { return end == held_; }

  // Makes the doubt small before it is halved: by the height of the chords that begin here, which
  // grows with the square of their length. `guess` is some end behind `from`.
  void narrow(double guess, double limit);

  // Leaves nothing but what is asked.
  void forget() {
    held_ = -std::numeric_limits<double>::infinity();
    failed_ = std::numeric_limits<double>::infinity();
  }

 private:
  // The piece that holds `u`, at or after `piece`.
  [[nodiscard]] std::size_t piece_at(double u, std::size_t piece) const {
    while (piece + 1 < pieces_.size() && pieces_.breaks()[piece + 1] <= u) ++piece;
    return piece;
  }

  [[nodiscard]] double height(double end) const;

  const CurvePieces& pieces_;
  double from_;
  std::size_t first_;
  Point3 start_;
  Limits limits_;
  double held_ = -std::numeric_limits<double>::infinity();
  double failed_ = std::numeric_limits<double>::infinity();
};

// The curve's greatest distance from the chord to `end`, mm: of places between, and of the
// parabola through the farthest and its neighbours.
double ChordsFrom::height(double end) const {
  constexpr int kPlaces = 6;
  const Vector3 chord = pieces_.point_in(piece_at(end, first_), end) - start_;
  const double squared = chord.squaredNorm();
  if (squared == 0) return 0;
  double heights[kPlaces + 1] = {};
  std::size_t piece = first_;
  int farthest = 1;
  for (int k = 1; k < kPlaces; ++k) {
    const double u = from_ + (end - from_) * k / kPlaces;
    piece = piece_at(u, piece);
    const Vector3 off = pieces_.point_in(piece, u) - start_;
    heights[k] = (off - off.dot(chord) / squared * chord).norm();
    if (heights[k] > heights[farthest]) farthest = k;
  }
  const double before = heights[farthest - 1];
  const double after = heights[farthest + 1];
  const double bend = 2 * heights[farthest] - before - after;
  if (!(bend > 0)) return heights[farthest];
  return heights[farthest] + (after - before) * (after - before) / (8 * bend);
}

void ChordsFrom::narrow(double guess, double limit) {
  constexpr int kSteps = 4;
  constexpr double kSettled = 5e-3;  // the error of a step goes with the square of the one before
  constexpr double kWidest = 4;      // a step changes the length by this factor at most
  double length = std::min(guess, limit) - from_;
  const double longest = limit - from_;
  for (int step = 0; step < kSteps; ++step) {
    const double away = height(from_ + length);
    const double wanted = away > 0 ? std::sqrt(limits_.deviation / away) : kWidest;
    const double next = std::min(length * std::clamp(wanted, 1 / kWidest, kWidest), longest);
    const bool settled = std::abs(next - length) < kSettled * length;
    length = next;
    if (settled) break;
  }
  for (double doubt = kEndPrecision; doubt < 1; doubt *= kWidest) {
    if (holds(from_ + length * (1 - doubt))) break;
  }
  for (double doubt = kEndPrecision; doubt < 1; doubt *= kWidest) {
    const double end = from_ + length * (1 + doubt);
    if (end >= limit || !holds(end)) break;
  }
}

// Where the distance from `from` reaches `length`, between `good` (nearer) and `bad`.
double end_at_length(const CurvePieces& pieces, const Point3& start, double good, double bad,
                     double length) {
  for (double middle = (good + bad) / 2; middle > good && middle < bad; middle = (good + bad) / 2) {
    ((pieces.point_at(middle) - start).norm() <= length ? good : bad) = middle;
  }
  return good;
}

// The farthest end of the chords, at most `limit`: doubling the number of pieces under them, then
// halving the doubt.
double farthest_end(const CurvePieces& pieces, double from, double limit, const Limits& limits,
                    ChordsFrom& chords) {
  const auto& breaks = pieces.breaks();
  const std::size_t first = chords.first_piece();
  double good = from;
  double bad = limit;
  for (std::size_t step = 1;; step *= 2) {
    const std::size_t at = std::min(first + step, breaks.size() - 1);
    const double end = std::min(breaks[at], limit);
    if (!chords.holds_beyond(end)) {
      bad = end;
      break;
    }
    good = end;
    if (end >= limit) return limit;
  }
  while (bad - good > kEndPrecision * (bad - from)) {
    const double middle = (good + bad) / 2;
    if (middle <= good || middle >= bad) break;  // the doubles are used up
    (chords.holds(middle) ? good : bad) = middle;
  }
  if (std::isfinite(limits.max_length)) {  // lengths divide evenly: meet them exactly
    const double end = end_at_length(pieces, chords.start(), good, bad, limits.max_length);
    if (end > good && chords.proved(end)) good = end;
  }
  return good > from ? good : bad;  // a chord so short that rounding hides its proof
}

// The same end as without a guess, and proved as it is.
double farthest_end(const CurvePieces& pieces, double from, double limit, const Limits& limits,
                    double guess) {
  ChordsFrom chords(pieces, from, limits);
  chords.narrow(guess, limit);
  const double end = farthest_end(pieces, from, limit, limits, chords);
  if (chords.held(end) || chords.proved(end)) return end;
  chords.forget();
  return farthest_end(pieces, from, limit, limits, chords);
}

// Vertices after `from` up to `to`, greedily: no sequence of such chords gets farther with
// as many, since a chord from farther on reaches farther. Stops after `at_most` chords.
std::vector<double> greedy_ends(const CurvePieces& pieces, double from, double to,
                                const Limits& limits, std::size_t at_most) {
  std::vector<double> ends;
  const std::size_t first = pieces.index_of(from);
  double last_step = pieces.breaks()[first + 1] - pieces.breaks()[first];
  for (double at = from; at < to && ends.size() < at_most;) {
    const double end = farthest_end(pieces, at, to, limits, at + last_step);
    last_step = end - at;
    at = end;
    ends.push_back(at);
  }
  return ends;
}

// How much of a full chord the last one is, 0..1, by its deviation or its length.
double part_of_full_chord(const CurvePieces& pieces, double from, double to, const Limits& limits) {
  constexpr int kSamples = 16;
  const Point3 start = pieces.point_at(from);
  const Vector3 chord = pieces.point_at(to) - start;
  const double length = chord.norm();
  double away = 0;
  for (int i = 1; i < kSamples; ++i) {
    const Vector3 to_curve = pieces.point_at(from + (to - from) * i / kSamples) - start;
    const double along = length > 0 ? to_curve.dot(chord) / length : 0;
    away = std::max(away, to_curve.squaredNorm() - along * along);
  }
  const double by_deviation = std::sqrt(std::sqrt(std::max(away, 0.0)) / limits.deviation);
  return std::min(std::max(by_deviation, length / limits.max_length), 1.0);
}

// As many chords as `ends` has, but with limits narrowed until the last is no remainder.
std::vector<double> balanced(const CurvePieces& pieces, double from, std::vector<double> ends,
                             const Limits& limits) {
  const double to = ends.back();
  const auto count = static_cast<double>(ends.size());
  double good = 1;   // chord lengths relative to the greedy ones
  double small = 0;  // too small: needs more chords
  for (int round = 0; round < kChordBalancingRounds && ends.size() > 1; ++round) {
    const double part = part_of_full_chord(pieces, ends[ends.size() - 2], to, scaled(limits, good));
    if (part >= kFullChord) break;
    const double wanted = good * (count - 1 + part) / count;
    const double next = std::max(wanted, (good + small) / 2);
    std::vector<double> narrower =
        greedy_ends(pieces, from, to, scaled(limits, next), ends.size() + 1);
    if (narrower.size() > ends.size()) {
      small = next;
    } else {
      ends = std::move(narrower);
      good = next;
    }
  }
  return ends;
}

std::vector<double> balanced_ends(const CurvePieces& pieces, double from, double to,
                                  const Limits& limits) {
  std::vector<double> ends =
      greedy_ends(pieces, from, to, limits, std::numeric_limits<std::size_t>::max());
  const std::size_t kept = ends.size() > kBalancedChords ? ends.size() - kBalancedChords : 0;
  const double start = kept > 0 ? ends[kept - 1] : from;
  const auto cut = ends.begin() + static_cast<std::ptrdiff_t>(kept);
  const std::vector<double> tail =
      balanced(pieces, start, std::vector<double>(cut, ends.end()), limits);
  // It may be shorter: where no end could be proved beyond a greedy one, a chord from elsewhere may
  // have gone farther.
  ends.erase(cut, ends.end());
  ends.insert(ends.end(), tail.begin(), tail.end());
  return ends;
}

// Corners, and the ends of straight runs that are about as long as the chords over them:
// shorter ones, such as the spans of a finely cut bend, are left to the chords.
std::vector<double> kept_places(const CurvePieces& pieces, const ChordOptions& options,
                                const Limits& limits) {
  std::vector<double> kept = pieces.corners();
  const std::vector<StraightRun> runs = pieces.straight_runs();
  if (!runs.empty()) {
    const std::vector<double> ends = greedy_ends(pieces, pieces.first(), pieces.last(), limits,
                                                 std::numeric_limits<std::size_t>::max());
    std::size_t chord = 0;
    const auto chord_length = [&](std::size_t i) {
      const double start = i == 0 ? pieces.first() : ends[i - 1];
      return (pieces.point_at(ends[i]) - pieces.point_at(start)).norm();
    };
    for (const StraightRun& run : runs) {
      const double length = (pieces.point_at(run.to) - pieces.point_at(run.from)).norm();
      while (ends[chord] <= run.from) ++chord;
      double longest = chord_length(chord);
      for (std::size_t i = chord + 1; i < ends.size() && ends[i - 1] < run.to; ++i) {
        longest = std::max(longest, chord_length(i));
      }
      if (2 * length < longest || length < options.min_length) continue;
      kept.push_back(run.from);
      kept.push_back(run.to);
    }
  }
  kept.push_back(pieces.last());
  std::sort(kept.begin(), kept.end());
  kept.erase(std::unique(kept.begin(), kept.end()), kept.end());
  return kept;
}

}  // namespace

std::vector<double> chord_vertices(const BsplineCurve& curve, double from, double to,
                                   const ChordOptions& options) {
  if (!(options.max_deviation > 0)) {
    throw std::invalid_argument("chord_vertices: max_deviation " +
                                std::to_string(options.max_deviation) + ", expected > 0");
  }
  const CurvePieces pieces(curve, from, to);
  const Limits limits{options.max_deviation, options.max_length > 0
                                                 ? options.max_length
                                                 : std::numeric_limits<double>::infinity()};
  std::vector<double> vertices = {from};
  for (const double end : kept_places(pieces, options, limits)) {
    if (end <= vertices.back()) continue;
    const std::vector<double> ends = balanced_ends(pieces, vertices.back(), end, limits);
    vertices.insert(vertices.end(), ends.begin(), ends.end());
  }
  vertices.back() = to;
  return vertices;
}

}  // namespace batten::geometry
