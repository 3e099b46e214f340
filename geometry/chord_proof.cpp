#include "geometry/chord_proof.h"

#include <algorithm>
#include <cstddef>

#include "geometry/bezier_halves.h"

namespace batten::geometry {

ChordProof::ChordProof(const Point3& start, const Point3& end, double deviation, int halvings)
    : start_(start),
      along_(Vector3::Zero()),
      length_((end - start).norm()),
      allowed_(deviation * deviation),
      halvings_(halvings) {
  if (length_ > 0) along_ = (end - start) / length_;
}

bool ChordProof::holds(const CubicBezier& piece, int halvings) {
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
  if (halvings == 0 || !near_end(piece.control[0]) || !near_end(piece.control[3])) return false;
  const auto [left, right] = halves(piece);
  return holds(left, halvings - 1) && holds(right, halvings - 1);
}

// A point of the curve itself: too far from the chord, and no halving will help.
bool ChordProof::near_end(const Point3& p) const {
  const double at = std::clamp(along_.dot(p - start_), 0.0, length_);
  return (p - start_ - at * along_).squaredNorm() <= allowed_;
}

bool chord_proved(const CurvePieces& pieces, double from, double to, ChordProof proof) {
  if (!(from < to)) return true;
  for (std::size_t i = pieces.index_of(from); i < pieces.size(); ++i) {
    if (pieces.breaks()[i] >= to) break;
    if (!proof.holds(pieces.part(i, from, to))) return false;
  }
  return true;
}

}  // namespace batten::geometry
