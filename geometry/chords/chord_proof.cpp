#include "geometry/chords/chord_proof.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <utility>

#include "geometry/path/bezier_halves.h"

namespace batten::geometry {

namespace {

// A bend and a second one the other way have their tops; what is left after these cuts is due to
// the twist of a curve in space, and there halves do better.
constexpr int kCutsAtTheTop = 2;

}  // namespace

ChordProof::ChordProof(const Point3& start, const Point3& end, double deviation, int cuts)
    : start_(start),
      along_(Vector3::Zero()),
      length_((end - start).norm()),
      allowed_(deviation * deviation),
      cuts_(cuts) {
  if (length_ > 0) along_ = (end - start) / length_;
}

bool ChordProof::holds(const CubicBezier& piece, int cuts) {
  double at = reached_;
  bool near = true;
  for (const Point3& control : piece.control) {
    at = std::max(at, std::clamp(along_.dot(control - start_), 0.0, length_));
    if ((control - start_ - at * along_).squaredNorm() > allowed_) {
      near = false;
      break;
    }
  }
  if (near) {
    reached_ = at;
    return true;
  }
  if (cuts == 0 || !near_end(piece.control[0]) || !near_end(piece.control[3])) return false;
  const bool early = cuts + kCutsAtTheTop > cuts_;
  const auto [left, right] = early ? parts_at(piece, farthest(piece)) : halves(piece);
  return holds(left, cuts - 1) && holds(right, cuts - 1);
}

Vector3 ChordProof::off_chord(const Point3& p) const {
  return p - start_ - along_.dot(p - start_) * along_;
}

// Where the piece runs along the chord at its greatest height, seen in the direction of its bow.
// The middle where there is no such place well inside.
double ChordProof::farthest(const CubicBezier& piece) const {
  constexpr double kMiddle = 0.5;
  constexpr double kInside = 0.02;
  const Vector3 off[] = {off_chord(piece.control[0]), off_chord(piece.control[1]),
                         off_chord(piece.control[2]), off_chord(piece.control[3])};
  const Vector3 bow = off[1] + off[2] - off[0] - off[3];
  const double heights[] = {bow.dot(off[0]), bow.dot(off[1]), bow.dot(off[2]), bow.dot(off[3])};
  // The slope is a (1-t)^2 + 2 b t (1-t) + c t^2; of its two zeros the bow's top is where it falls.
  const double a = heights[1] - heights[0];
  const double b = heights[2] - heights[1];
  const double c = heights[3] - heights[2];
  const double square = b * b - a * c;
  if (!(square > 0)) return kMiddle;
  const double t = a / (a - b + std::sqrt(square));
  return t > kInside && t < 1 - kInside ? t : kMiddle;
}

// A point of the curve itself: too far from the chord, and no cut will help.
bool ChordProof::near_end(const Point3& p) const {
  const double at = std::clamp(along_.dot(p - start_), 0.0, length_);
  return (p - start_ - at * along_).squaredNorm() <= allowed_;
}

bool chord_proved(const CurvePieces& pieces, double from, double to, ChordProof proof) {
  return chord_proved(pieces, pieces.index_of(from), from, to, std::move(proof));
}

bool chord_proved(const CurvePieces& pieces, std::size_t first, double from, double to,
                  ChordProof proof) {
  if (!(from < to)) return true;
  for (std::size_t i = first; i < pieces.size(); ++i) {
    if (pieces.breaks()[i] >= to) break;
    if (!proof.holds(pieces.part(i, from, to))) return false;
  }
  return true;
}

}  // namespace batten::geometry
