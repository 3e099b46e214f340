#include "geometry/chords/blca.h"

#include <algorithm>
#include <cstddef>
#include <stdexcept>
#include <string>
#include <vector>

#include "geometry/chords/chord_deviation.h"
#include "geometry/chords/chord_proof.h"
#include "geometry/path/curve_pieces.h"

namespace batten::geometry {
namespace {

bool chord_is_near(const CurvePieces& pieces, double from, double to, double tolerance) {
  const ChordProof proof(pieces.point_at(from), pieces.point_at(to), tolerance);
  return chord_proved(pieces, from, to, proof);
}

double step_end(const CurvePieces& pieces, double from, double limit, double tolerance) {
  double end = leaves_tangent_at(pieces, from, limit, tolerance);
  while (!chord_is_near(pieces, from, end, tolerance)) {
    const double shorter = (from + end) / 2;
    if (!(from < shorter && shorter < end)) break;  // the doubles are used up
    end = shorter;
  }
  return end;
}

}  // namespace

ChordRow blca(const BsplineCurve& curve, double from, double to, double tolerance) {
  if (!(tolerance > 0)) {
    throw std::invalid_argument("blca: tolerance " + std::to_string(tolerance) + ", expected > 0");
  }
  const CurvePieces pieces(curve, from, to);
  std::vector<double> ends = pieces.corners();
  ends.push_back(to);
  ChordRow row{{from}, 0, 0};
  for (const double limit : ends) {
    while (row.parameters.back() < limit) {
      const double start = row.parameters.back();
      const double end = step_end(pieces, start, limit, tolerance);
      row.deviation = std::max(row.deviation, chord_deviation(pieces, start, end));
      row.parameters.push_back(end);
    }
  }
  return row;
}

}  // namespace batten::geometry
