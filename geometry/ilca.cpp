#include "geometry/ilca.h"

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <string>

#include "geometry/chord_deviation.h"
#include "geometry/chord_proof.h"
#include "geometry/curve_pieces.h"

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

// The greatest deviation of so many chords; of the first chord that exceeds the limit, if one does.
double deviation_of(const CurvePieces& pieces, double from, double to, double count, double limit) {
  double greatest = 0;
  for (double i = 0; i < count && greatest <= limit; ++i) {
    const double start = step_end(from, to, count, i);
    const double end = step_end(from, to, count, i + 1);
    greatest = std::max(greatest, chord_deviation(pieces, start, end));
  }
  return greatest;
}

}  // namespace

ChordRow ilca(const BsplineCurve& curve, double from, double to, const IlcaOptions& options) {
  if (!(options.max_deviation > 0) || options.first_step < 0) {
    throw std::invalid_argument("ilca: max_deviation " + std::to_string(options.max_deviation) +
                                ", expected > 0; first_step " + std::to_string(options.first_step) +
                                ", expected >= 0");
  }
  const CurvePieces pieces(curve, from, to);
  std::vector<double> ends = pieces.corners();
  ends.push_back(to);
  ChordRow row{{from}, 0};
  for (const double end : ends) {
    const double start = row.parameters.back();
    double count = 1;
    if (options.first_step > 0) {
      count = std::max(1.0, std::ceil((end - start) / options.first_step * (1 - kWholeSteps)));
    }
    double deviation = 0;
    for (;;) {
      deviation = deviation_of(pieces, start, end, count, options.max_deviation);
      if (deviation <= options.max_deviation) break;
      const double wanted = count * std::sqrt(deviation / options.max_deviation);
      count = std::max(count + 1, std::floor(kTried * wanted));
    }
    for (double i = 1; i <= count; ++i) row.parameters.push_back(step_end(start, end, count, i));
    row.deviation = std::max(row.deviation, deviation);
  }
  return row;
}

}  // namespace batten::geometry
