#include "geometry/chords/linearize.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <span>
#include <stdexcept>
#include <string>
#include <utility>

#include "geometry/chords/chord_proof.h"
#include "geometry/path/curve_pieces.h"

namespace batten::geometry {
namespace {

// A chord this much longer than the greatest length (relative) has that length: rounding of
// evenly divided lines.
constexpr double kLengthNoise = 1e-9;

// How often the limits are narrowed to let the last chord grow to the size of the others.
constexpr int kChordBalancingRounds = 8;

// The last chord is no remainder when it is this part of a full one. The limits are narrowed for
// one that is a little longer, for with a whole one there is often another behind it; but where
// lengths divide evenly there is none.
constexpr double kFullChord = 0.98;
constexpr double kWantedChord = 0.99;

// Only so many chords at the end are narrowed: over these a remainder is spread thin, and
// the cost of the rounds does not grow with the run.
constexpr std::size_t kBalancedChords = 50;

struct Limits {
  double deviation;   // mm
  double max_length;  // mm, infinite when there is none
  double precision;   // of a chord's end, relative to its length
};

Limits scaled(const Limits& limits, double chord_length) {
  // A chord's deviation grows with the square of its length.
  return {limits.deviation * chord_length * chord_length, limits.max_length * chord_length,
          limits.precision};
}

// The longest chord from one place of the curve.
class LongestChord {
 public:
  // `piece`: that holds `from`.
  LongestChord(const CurvePieces& pieces, std::size_t piece, double from, const Limits& limits)
      : pieces_(pieces), chords_(pieces, piece, from), limits_(limits) {}

  // Where it ends, at most `limit`; `guess` is some end behind the start.
  double end(double guess, double limit) {
    good_ = chords_.from();
    bad_ = std::numeric_limits<double>::infinity();
    approach(std::min(guess, limit), limit);
    go_beyond(limit);
    if (std::isfinite(limits_.max_length) && good_ < limit) {  // lengths divide evenly: meet them
      const double end = end_at_length();
      if (end > good_ && holds(end)) good_ = end;
    }
    return good_ > chords_.from() ? good_ : bad_;  // so short that rounding hides its proof
  }

 private:
  // What one chord says of the best end.
  struct Trial {
    double end;
    double bow;  // the root of the height, which goes about with the length
    bool holds;
  };

  [[nodiscard]] Trial try_end(double end) const {
    const ChordHeight chord = chords_.to(end);
    const bool fits = chord.height <= limits_.deviation && !is_too_long(chord.chord);
    return {end, std::sqrt(chord.height), fits && (chord.in_order || proved(end))};
  }

  [[nodiscard]] bool holds(double end) const { return try_end(end).holds; }

  [[nodiscard]] bool is_too_long(double length) const {
    return length > limits_.max_length * (1 + kLengthNoise);
  }

  // Where the curve goes back and forth along its chord.
  [[nodiscard]] bool proved(double end) const {
    const Point3 place = pieces_.point_at(end);
    return chord_proved(pieces_, chords_.first_piece(), chords_.from(), end,
                        ChordProof(chords_.start(), place, limits_.deviation));
  }

  [[nodiscard]] bool is_settled() const {
    return std::isfinite(bad_) && bad_ - good_ <= limits_.precision * (bad_ - chords_.from());
  }

  // Narrows the doubt between an end that holds and one that does not, by the secants of the bow.
  void approach(double end, double limit) {
    constexpr int kSecants = 12;
    constexpr double kWidest = 4;                 // the length changes by this factor at most
    const double nearly = 1 - limits_.precision;  // of the deviation: half of it, of the length
    const double from = chords_.from();
    const double full = std::sqrt(limits_.deviation);
    const double aim = std::sqrt(0.5 * (1 + nearly)) * full;
    Trial before{from, 0, true};
    for (int i = 0;; ++i) {
      const Trial trial = try_end(end);
      (trial.holds ? good_ : bad_) = end;
      if (trial.holds && (end >= limit || trial.bow * trial.bow >= nearly * limits_.deviation)) {
        return;
      }
      if (is_settled()) return;
      const double slope = (trial.bow - before.bow) / (trial.end - before.end);
      const double length = end - from;
      double next = slope > 0 ? end + (aim - trial.bow) / slope : from + kWidest * length;
      next = std::clamp(next, from + length / kWidest, from + kWidest * length);
      next = std::min(next, limit);
      if (i >= kSecants || !(good_ < next && next < bad_)) {
        if (!std::isfinite(bad_)) {
          next = std::min(from + 2 * length, limit);
        } else {
          next = (good_ + bad_) / 2;
          if (next <= good_ || next >= bad_) return;  // the doubles are used up
        }
      }
      before = trial;
      end = next;
    }
  }

  // A chord may hold although shorter ones do not, behind a turning point: the number of pieces
  // under it is doubled as long as that helps.
  void go_beyond(double limit) {
    const auto& breaks = pieces_.breaks();
    bool farther = false;
    for (std::size_t step = 1; good_ < limit; step *= 2) {
      const std::size_t at = std::min(chords_.first_piece() + step, breaks.size() - 1);
      const double end = std::min(breaks[at], limit);
      if (end <= good_) continue;
      if (chords_.leaves(end, limits_.deviation) || !holds(end)) {
        bad_ = farther ? end : std::min(end, bad_);
        break;
      }
      good_ = end;
      farther = true;
    }
    while (farther && good_ < limit && !is_settled()) {
      const double middle = (good_ + bad_) / 2;
      if (middle <= good_ || middle >= bad_) return;  // the doubles are used up
      (holds(middle) ? good_ : bad_) = middle;
    }
  }

  // Where the distance from the start reaches the greatest length, between good and bad.
  [[nodiscard]] double end_at_length() const {
    double good = good_;
    double bad = bad_;
    for (double middle = (good + bad) / 2; middle > good && middle < bad;
         middle = (good + bad) / 2) {
      const double length = (pieces_.point_at(middle) - chords_.start()).norm();
      (length <= limits_.max_length ? good : bad) = middle;
    }
    return good;
  }

  const CurvePieces& pieces_;
  ChordsFrom chords_;
  Limits limits_;
  double good_ = 0;
  double bad_ = 0;
};

// Vertices after `from` up to `to`, greedily: no sequence of such chords gets farther with
// as many, since a chord from farther on reaches farther. Stops after `at_most` chords.
std::vector<double> greedy_ends(const CurvePieces& pieces, double from, double to,
                                const Limits& limits, std::size_t at_most) {
  std::vector<double> ends;
  std::size_t piece = pieces.index_of(from);
  // A chord is about as long as the one before, and as much longer than that as that was.
  double last_step = pieces.breaks()[piece + 1] - pieces.breaks()[piece];
  double growth = 1;
  constexpr double kMostGrowth = 1.5;
  for (double at = from; at < to && ends.size() < at_most;) {
    const double guess = at + std::clamp(growth, 1 / kMostGrowth, kMostGrowth) * last_step;
    while (piece + 1 < pieces.size() && pieces.breaks()[piece + 1] <= at) ++piece;
    const double end = LongestChord(pieces, piece, at, limits).end(guess, to);
    growth = ends.empty() ? 1 : (end - at) / last_step;
    last_step = end - at;
    at = end;
    ends.push_back(at);
  }
  return ends;
}

// How much of a full chord the last one is, 0..1, by its deviation or its length.
double part_of_full_chord(const CurvePieces& pieces, double from, double to, const Limits& limits) {
  const ChordHeight last = ChordsFrom(pieces, from).to(to);
  const double by_deviation = std::sqrt(last.height / limits.deviation);
  return std::min(std::max(by_deviation, last.chord / limits.max_length), 1.0);
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
    const double last = std::isfinite(limits.max_length) ? 1 : kWantedChord;
    const double wanted = good * (count - 1 + part) / (count - 1 + last);
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

std::vector<double> all_ends(const CurvePieces& pieces, double from, double to,
                             const Limits& limits) {
  return greedy_ends(pieces, from, to, limits, std::numeric_limits<std::size_t>::max());
}

// The last of greedy chords balanced.
std::vector<double> balanced_tail(const CurvePieces& pieces, double from, std::vector<double> ends,
                                  const Limits& limits) {
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

// The chords between two corners.
class Section {
 public:
  Section(const CurvePieces& pieces, double from, double to, const ChordOptions& options,
          const Limits& limits)
      : pieces_(pieces),
        from_(from),
        to_(to),
        min_length_(options.min_length),
        limits_(limits),
        ends_(all_ends(pieces, from, to, limits)) {}

  // Appends the places behind the section's start. `runs`: the straight ones that are in it.
  void append(std::span<const StraightRun> runs, std::vector<double>& vertices) {
    const std::vector<double> kept = kept_ends(runs);
    if (kept.empty()) {
      append_balanced(from_, std::move(ends_), vertices);
      return;
    }
    double at = from_;
    for (const double end : kept) {
      append_balanced(at, all_ends(pieces_, at, end, limits_), vertices);
      at = end;
    }
  }

 private:
  void append_balanced(double from, std::vector<double> ends, std::vector<double>& vertices) const {
    const std::vector<double> all = balanced_tail(pieces_, from, std::move(ends), limits_);
    vertices.insert(vertices.end(), all.begin(), all.end());
  }

  // Ends of straight runs that are about as long as the chords over them, and the section's end:
  // shorter ones, such as the spans of a finely cut bend, are left to the chords.
  [[nodiscard]] std::vector<double> kept_ends(std::span<const StraightRun> runs) const {
    std::vector<double> kept;
    std::size_t chord = 0;
    const auto keep = [&](double end) {
      if (end > (kept.empty() ? from_ : kept.back())) kept.push_back(end);
    };
    for (const StraightRun& run : runs) {
      if (run.from <= from_ && run.to >= to_) continue;  // its ends are kept anyway
      const double length = (pieces_.point_at(run.to) - pieces_.point_at(run.from)).norm();
      while (ends_[chord] <= run.from) ++chord;
      double longest = chord_length(chord);
      for (std::size_t i = chord + 1; i < ends_.size() && ends_[i - 1] < run.to; ++i) {
        longest = std::max(longest, chord_length(i));
      }
      if (2 * length < longest || length < min_length_) continue;
      keep(run.from);
      keep(run.to);
    }
    if (!kept.empty()) keep(to_);
    return kept;
  }

  [[nodiscard]] double chord_length(std::size_t i) const {
    const double start = i == 0 ? from_ : ends_[i - 1];
    return (pieces_.point_at(ends_[i]) - pieces_.point_at(start)).norm();
  }

  const CurvePieces& pieces_;
  double from_;
  double to_;
  double min_length_;
  Limits limits_;
  std::vector<double> ends_;  // greedy ones
};

// What of the straight runs lies between two places, from the run `next` on, which is moved to the
// last of them.
std::vector<StraightRun> runs_between(const std::vector<StraightRun>& runs, double from, double to,
                                      std::size_t& next) {
  std::vector<StraightRun> found;
  while (next < runs.size() && runs[next].to <= from) ++next;
  for (std::size_t i = next; i < runs.size() && runs[i].from < to; ++i) {
    found.push_back({std::max(runs[i].from, from), std::min(runs[i].to, to)});
  }
  return found;
}

}  // namespace

std::vector<double> chord_vertices(const MarkedPieces& curve, double from, double to,
                                   const ChordOptions& options) {
  if (!(options.max_deviation > 0)) {
    throw std::invalid_argument("chord_vertices: max_deviation " +
                                std::to_string(options.max_deviation) + ", expected > 0");
  }
  const Limits limits{
      options.max_deviation,
      options.max_length > 0 ? options.max_length : std::numeric_limits<double>::infinity(),
      options.precision};
  std::vector<double> vertices = {from};
  auto corner = std::upper_bound(curve.corners.begin(), curve.corners.end(), from);
  std::size_t run = 0;
  for (double at = from; at < to;) {
    const double end = corner != curve.corners.end() && *corner < to ? *corner++ : to;
    Section(curve.pieces, at, end, options, limits)
        .append(runs_between(curve.straight_runs, at, end, run), vertices);
    at = end;
  }
  vertices.back() = to;
  return vertices;
}

std::vector<double> chord_vertices(const BsplineCurve& curve, double from, double to,
                                   const ChordOptions& options) {
  return chord_vertices(MarkedPieces(curve, from, to), from, to, options);
}

}  // namespace batten::geometry
