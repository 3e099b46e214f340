#include "geometry/chords/ilca.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <stdexcept>
#include <string>
#include <vector>

#include "geometry/chords/chord_proof.h"
#include "geometry/path/curve_pieces.h"

namespace batten::geometry {
namespace {

// Of the steps that the last deviation asks for, so many are tried next: fewer than all, since the
// deviation of the worst chord need not go exactly with the square of the step.
constexpr double kTried = 0.97;

// Equal steps that divide a stretch exactly divide it also after rounding.
constexpr double kWholeSteps = 1e-9;

double step_end(double from, double to, double count, double i) {
  return i >= count ? to : from + (to - from) * i / count;
}

// How much may be looked for and read, on one curve.
class Bounds {
 public:
  explicit Bounds(std::size_t pieces)
      : chords_(std::max(kIlcaLeastBound, kIlcaChordsPerPiece * static_cast<double>(pieces))),
        readings_left_(kIlcaReadings * chords_) {}

  [[nodiscard]] bool allows(double chords) const { return chords <= chords_ && readings_left_ > 0; }
  void count_reading() { --readings_left_; }
  [[nodiscard]] std::size_t readings() const {
    return static_cast<std::size_t>(kIlcaReadings * chords_ - readings_left_);
  }

 private:
  double chords_;
  double readings_left_;
};

// The greatest deviation of so many chords; of the first chord that exceeds the limit, if one does.
double deviation_of(const CurvePieces& pieces, double from, double to, double count, double limit,
                    Bounds& bounds) {
  double greatest = 0;
  for (double i = 0; i < count && greatest <= limit; ++i) {
    const double start = step_end(from, to, count, i);
    const double end = step_end(from, to, count, i + 1);
    greatest = std::max(greatest, chord_deviation(pieces, start, end));
    bounds.count_reading();
  }
  return greatest;
}

}  // namespace

std::optional<ChordRow> ilca(const BsplineCurve& curve, double from, double to,
                             const IlcaOptions& options) {
  if (!(options.max_deviation > 0) || options.first_step < 0) {
    throw std::invalid_argument("ilca: max_deviation " + std::to_string(options.max_deviation) +
                                ", expected > 0; first_step " + std::to_string(options.first_step) +
                                ", expected >= 0");
  }
  const CurvePieces pieces(curve, from, to);
  std::vector<double> ends = pieces.corners();
  ends.push_back(to);
  Bounds bounds(pieces.size());
  ChordRow row{{from}, 0, 0};
  for (const double end : ends) {
    const double start = row.parameters.back();
    double count = 1;
    if (options.first_step > 0) {
      count = std::max(1.0, std::ceil((end - start) / options.first_step * (1 - kWholeSteps)));
    }
    double deviation = 0;
    for (;;) {
      if (!bounds.allows(static_cast<double>(row.parameters.size()) + count)) return std::nullopt;
      deviation = deviation_of(pieces, start, end, count, options.max_deviation, bounds);
      if (deviation <= options.max_deviation) break;
      const double wanted = count * std::sqrt(deviation / options.max_deviation);
      count = std::max(count + 1, std::floor(kTried * wanted));
    }
    for (double i = 1; i <= count; ++i) row.parameters.push_back(step_end(start, end, count, i));
    row.deviation = std::max(row.deviation, deviation);
  }
  row.readings = bounds.readings();
  return row;
}

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
