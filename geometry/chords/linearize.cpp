#include "geometry/chords/linearize.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>
#include <numeric>
#include <utility>

#include "geometry/basic/require.h"
#include "geometry/chords/chord_proof.h"

namespace batten::geometry {
namespace {

constexpr ChordTuning kChords = kChordTuning;

// The longest chord from one point of the curve.
class LongestChord {
 public:
  // `piece`: that holds `from`.
  LongestChord(const CurvePieces& pieces, std::size_t piece, double from,
               const ChordOptions& options)
      : pieces_(pieces), chords_(pieces, piece, from), options_(options) {}

  // Where it ends, at most `limit`; `guess` is some end after the start.
  double end(double guess, double limit) {
    good_ = chords_.from();
    bad_ = std::numeric_limits<double>::infinity();
    approach(std::min(guess, limit), limit);
    go_beyond(limit);
    return good_ > chords_.from() ? good_ : bad_;  // so short that rounding hides its proof
  }

  // What one chord says of the best end.
  struct Trial {
    double end;
    double bow;  // the root of the height, which goes about with the length
    bool holds;
  };

  [[nodiscard]] Trial try_end(double end) const {
    const ChordHeight chord = chords_.to(end);
    const bool fits = chord.height <= options_.max_deviation;
    return {end, std::sqrt(chord.height), fits && (chord.in_order || proved(end))};
  }

 private:
  [[nodiscard]] bool holds(double end) const { return try_end(end).holds; }

  // Where the curve goes back and forth along its chord.
  [[nodiscard]] bool proved(double end) const {
    return chord_proved(pieces_, chords_.from(), end,
                        ChordProof(chords_.start(), pieces_.point_at(end), options_.max_deviation));
  }

  [[nodiscard]] bool is_settled() const {
    return std::isfinite(bad_) && bad_ - good_ <= options_.precision * (bad_ - chords_.from());
  }

  // Narrows the doubt between an end that holds and one that does not, by the secants of the bow.
  void approach(double end, double limit) {
    const double nearly = 1 - options_.precision;  // of the deviation: half of it, of the length
    const double from = chords_.from();
    const double full = std::sqrt(options_.max_deviation);
    const double aim = std::sqrt(0.5 * (1 + nearly)) * full;
    Trial before{from, 0, true};
    for (int i = 0;; ++i) {
      const Trial trial = try_end(end);
      (trial.holds ? good_ : bad_) = end;
      if (trial.holds &&
          (end >= limit || trial.bow * trial.bow >= nearly * options_.max_deviation)) {
        return;
      }
      if (is_settled()) return;
      const double slope = (trial.bow - before.bow) / (trial.end - before.end);
      const double length = end - from;
      double next = slope > 0 ? end + (aim - trial.bow) / slope : from + kChords.widest * length;
      next = std::clamp(next, from + length / kChords.widest, from + kChords.widest * length);
      next = std::min(next, limit);
      if (i >= kChords.secants || !(good_ < next && next < bad_)) {
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

  // A chord may hold although shorter ones do not, after a turning point: the number of pieces
  // under it is doubled as long as that helps.
  void go_beyond(double limit) {
    const auto& breaks = pieces_.breaks();
    bool farther = false;
    for (std::size_t step = 1; good_ < limit; step *= 2) {
      const std::size_t at = std::min(chords_.first_piece() + step, breaks.size() - 1);
      const double end = std::min(breaks[at], limit);
      if (end <= good_) continue;
      if (chords_.leaves(end, options_.max_deviation) || !holds(end)) {
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

  const CurvePieces& pieces_;
  ChordsFrom chords_;
  ChordOptions options_;
  double good_ = 0;
  double bad_ = 0;
};

// Vertices after `from` up to `to`, greedily: no sequence of such chords gets farther with
// as many, since a chord from farther on reaches farther.
std::vector<double> greedy_ends(const CurvePieces& pieces, double from, double to,
                                const ChordOptions& options) {
  std::vector<double> ends;
  std::size_t piece = pieces.index_of(from);
  // A chord is about as long as the one before, and as much longer than that as that was.
  double last_step = pieces.breaks()[piece + 1] - pieces.breaks()[piece];
  double growth = 1;
  for (double at = from; at < to;) {
    const double guess = at + std::clamp(growth, 1 / kChords.growth, kChords.growth) * last_step;
    while (piece + 1 < pieces.size() && pieces.breaks()[piece + 1] <= at) ++piece;
    const double end = LongestChord(pieces, piece, at, options).end(guess, to);
    growth = ends.empty() ? 1 : (end - at) / last_step;
    last_step = end - at;
    at = end;
    ends.push_back(at);
  }
  return ends;
}

// As many vertices, between which the chords have equal parts of `bows`, those of the chords there.
std::vector<double> evened(const std::vector<double>& vertices, const std::vector<double>& bows) {
  const std::size_t chords = bows.size();
  const double part = std::reduce(bows.begin(), bows.end()) / static_cast<double>(chords);
  std::vector<double> even = vertices;
  double passed = 0;  // of the bows, before chord i
  std::size_t i = 0;
  for (std::size_t k = 1; k < chords; ++k) {
    const double at = static_cast<double>(k) * part;
    while (i + 1 < chords && passed + bows[i] < at) passed += bows[i++];
    const double on = bows[i] > 0 ? std::clamp((at - passed) / bows[i], 0.0, 1.0) : 0;
    even[k] = vertices[i] + on * (vertices[i + 1] - vertices[i]);
  }
  return even;
}

// As many chords as there are between greedy vertices, all of about one height: the last is no
// short remainder. As they are where no others are found that hold.
std::vector<double> spread(const CurvePieces& pieces, const std::vector<double>& greedy,
                           const ChordOptions& options) {
  const std::size_t chords = greedy.size() - 1;
  const auto tried = [&](std::size_t piece, double from, double to) {
    return LongestChord(pieces, piece, from, options).try_end(to);
  };
  const double full = std::sqrt(options.max_deviation);
  std::vector<double> bows(chords, full);
  bows.back() = tried(pieces.index_of(greedy[chords - 1]), greedy[chords - 1], greedy[chords]).bow;
  if (chords == 1 || bows.back() >= kChords.full * full) return greedy;
  std::vector<double> found = greedy;
  std::vector<double> vertices = greedy;
  for (int round = 0; round < kChords.spreading_rounds; ++round) {
    vertices = evened(vertices, bows);
    bool hold = true;
    std::size_t piece = pieces.index_of(vertices.front());
    for (std::size_t i = 0; i < chords; ++i) {
      while (pieces.breaks()[piece + 1] <= vertices[i]) ++piece;
      const auto trial = tried(piece, vertices[i], vertices[i + 1]);
      bows[i] = trial.bow;
      hold = hold && trial.holds;
    }
    if (!hold) continue;
    found = vertices;
    const auto [least, greatest] = std::ranges::minmax(bows);
    if (least >= kChords.even * greatest) break;
  }
  return found;
}

// Appends greedy chords, the last of them balanced.
void append_balanced(const CurvePieces& pieces, double from, const std::vector<double>& ends,
                     const ChordOptions& options, std::vector<double>& vertices) {
  if (!options.balanced) {
    vertices.insert(vertices.end(), ends.begin(), ends.end());
    return;
  }
  const std::size_t kept = ends.size() > kChords.balanced ? ends.size() - kChords.balanced : 0;
  const auto cut = ends.begin() + static_cast<std::ptrdiff_t>(kept);
  vertices.insert(vertices.end(), ends.begin(), cut);
  std::vector<double> tail = {kept > 0 ? ends[kept - 1] : from};
  tail.insert(tail.end(), cut, ends.end());
  tail = spread(pieces, std::move(tail), options);
  vertices.insert(vertices.end(), tail.begin() + 1, tail.end());
}

// Where chords have to end: the ends of straight runs that are about as long as the chords over
// them, and then the section's end. Shorter runs, such as the spans of a finely cut bend, are left
// to the chords. `ends`: of greedy chords. `run`: the first run that may be in the section, moved
// on to the last that is.
std::vector<double> ends_of_runs(const MarkedPieces& curve, double from, double to,
                                 const std::vector<double>& ends, std::size_t& run) {
  const auto length = [&](double a, double b) {
    return (curve.pieces.point_at(b) - curve.pieces.point_at(a)).norm();
  };
  const auto chord_length = [&](std::size_t i) {
    return length(i == 0 ? from : ends[i - 1], ends[i]);
  };
  const std::vector<StraightRun>& runs = curve.straight_runs;
  std::vector<double> kept;
  const auto keep = [&](double end) {
    if (end > (kept.empty() ? from : kept.back())) kept.push_back(end);
  };
  std::size_t chord = 0;
  while (run < runs.size() && runs[run].to <= from) ++run;
  for (std::size_t i = run; i < runs.size() && runs[i].from < to; ++i) {
    const double first = std::max(runs[i].from, from);
    const double last = std::min(runs[i].to, to);
    if (first <= from && last >= to) continue;  // its ends are kept anyway
    while (ends[chord] <= first) ++chord;
    double longest = chord_length(chord);
    for (std::size_t k = chord + 1; k < ends.size() && ends[k - 1] < last; ++k) {
      longest = std::max(longest, chord_length(k));
    }
    if (2 * length(first, last) < longest) continue;
    keep(first);
    keep(last);
  }
  if (!kept.empty()) keep(to);
  return kept;
}

}  // namespace

std::vector<double> chord_vertices(const MarkedPieces& curve, double from, double to,
                                   const ChordOptions& options) {
  require(options.max_deviation > 0, "chord_vertices: max_deviation", options.max_deviation, "> 0");
  const CurvePieces& pieces = curve.pieces;
  std::vector<double> vertices = {from};
  auto corner = std::upper_bound(curve.corners.begin(), curve.corners.end(), from);
  std::size_t run = 0;
  for (double at = from; at < to;) {  // from corner to corner
    const double end = corner != curve.corners.end() && *corner < to ? *corner++ : to;
    const std::vector<double> greedy = greedy_ends(pieces, at, end, options);
    const std::vector<double> kept = ends_of_runs(curve, at, end, greedy, run);
    if (kept.empty()) append_balanced(pieces, at, greedy, options, vertices);
    for (const double next : kept) {
      append_balanced(pieces, at, greedy_ends(pieces, at, next, options), options, vertices);
      at = next;
    }
    at = end;
  }
  vertices.back() = to;
  return vertices;
}

std::vector<double> chord_vertices(const BsplineCurve& curve, double from, double to,
                                   const ChordOptions& options) {
  return chord_vertices(MarkedPieces(curve, from, to), from, to, options);
}

namespace {

bool is_corner(const BsplineCurve& curve, double u) {
  const auto& knots = curve.basis().knots();
  const auto [first, end] = std::equal_range(knots.begin(), knots.end(), u);
  return end - first >= curve.basis().degree();
}

// From the chord between two points of the curve to its middle point, across the chord: the height
// of a bend, nothing where the curve crosses its chord.
Vector3 bow(const BsplineCurve& curve, double from, double to) {
  const Point3 start = curve.point_at(from);
  const Vector3 chord = curve.point_at(to) - start;
  const Vector3 off = curve.point_at(0.5 * (from + to)) - start;
  const double squared = chord.squaredNorm();
  if (squared == 0) return Vector3::Zero();
  return off - off.dot(chord) / squared * chord;
}

}  // namespace

std::vector<LinkVertex> on_curve(const BsplineCurve& curve, std::span<const double> parameters) {
  std::vector<LinkVertex> vertices;
  vertices.reserve(parameters.size());
  for (const double u : parameters) vertices.push_back({curve.point_at(u), u});
  return vertices;
}

std::vector<LinkVertex> balanced_chords(const BsplineCurve& curve,
                                        std::span<const double> parameters) {
  std::vector<LinkVertex> vertices = on_curve(curve, parameters);
  Vector3 before = Vector3::Zero();
  for (std::size_t i = 0; i + 1 < vertices.size(); ++i) {
    const double u = vertices[i].parameter;
    const Vector3 after = bow(curve, u, vertices[i + 1].parameter);
    if (i > 0 && !is_corner(curve, u)) vertices[i].place += 2.0 / 3 * 0.5 * (before + after);
    before = after;
  }
  return vertices;
}

namespace {

// Which vertices stay: both ends and corners, and what is next to these across a chord of less than
// half of the next one's length, which would be turned by more than the bend itself.
std::vector<bool> staying(const BsplineCurve& curve, std::span<const LinkVertex> vertices) {
  const std::size_t last = vertices.size() - 1;
  std::vector<bool> fixed(vertices.size());
  for (std::size_t i = 0; i <= last; ++i) {
    fixed[i] = i == 0 || i == last || is_corner(curve, vertices[i].parameter);
  }
  const auto length = [&](std::size_t a, std::size_t b) {
    return (vertices[b].place - vertices[a].place).norm();
  };
  std::vector<bool> stays = fixed;
  for (std::size_t i = 1; i < last; ++i) {
    const double before = length(i - 1, i);
    const double after = length(i, i + 1);
    if ((fixed[i - 1] && 2 * before < after) || (fixed[i + 1] && 2 * after < before)) {
      stays[i] = true;
    }
  }
  return stays;
}

}  // namespace

// With vertices moved by d, a chord of length l whose bend is b high is off the curve at its part x
// by 4 x (1 - x) b - (1 - x) d0 - x d1. Where the sum of its squares is least, at each vertex
//   l0 (d- + 2 d) + l1 (2 d + d+) = 2 (l0 b0 + l1 b1),
// of the chords that meet there: solved from one vertex that stays to the next by elimination.
std::vector<LinkVertex> nearest_chords(const BsplineCurve& curve,
                                       std::span<const double> parameters) {
  std::vector<LinkVertex> vertices = on_curve(curve, parameters);
  const std::vector<bool> stays = staying(curve, vertices);
  std::vector<double> ratios(vertices.size());  // what of d+ is taken from d
  std::vector<Vector3> moves(vertices.size(), Vector3::Zero());
  Vector3 before = Vector3::Zero();  // the last chord's bend by its length
  double length_before = 0;
  for (std::size_t i = 0; i + 1 < vertices.size(); ++i) {
    const double length = (vertices[i + 1].place - vertices[i].place).norm();
    const Vector3 bend = length * bow(curve, parameters[i], parameters[i + 1]);
    if (!stays[i] && length_before + length > 0) {
      const double own = 2 * (length_before + length) - length_before * ratios[i - 1];
      ratios[i] = length / own;
      moves[i] = (2 * (before + bend) - length_before * moves[i - 1]) / own;
    }
    before = bend;
    length_before = length;
  }
  for (std::size_t i = vertices.size() - 1; i-- > 1;) {
    moves[i] -= ratios[i] * moves[i + 1];
    vertices[i].place += moves[i];
  }
  return vertices;
}

}  // namespace batten::geometry
