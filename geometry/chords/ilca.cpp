#include "geometry/chords/ilca.h"

#include <algorithm>
#include <cmath>

#include "geometry/basic/require.h"
#include "geometry/basic/rounding.h"
#include "geometry/chords/chord_proof.h"
#include "geometry/path/curve_pieces.h"

namespace batten::geometry {
namespace {

// Of the steps that the last deviation asks for, so many are tried next: fewer than all, since the
// deviation of the worst chord need not go exactly with the square of the step.
constexpr double kTried = 0.97;

// Equal steps that divide a section exactly divide it also after rounding.
constexpr double kWholeSteps = 1e-9;

std::vector<double> section_ends(const CurvePieces& pieces, double to) {
  std::vector<double> ends = pieces.corners();
  ends.push_back(to);
  return ends;
}

}  // namespace

std::optional<ChordRow> ilca(const BsplineCurve& curve, double from, double to,
                             const IlcaOptions& options) {
  require(options.max_deviation > 0, "ilca: max_deviation", options.max_deviation, "> 0");
  require(options.first_step >= 0, "ilca: first_step", options.first_step, ">= 0");
  const CurvePieces pieces(curve, from, to);
  const double most =
      std::max(kIlcaLeastBound, kIlcaChordsPerPiece * static_cast<double>(pieces.size()));
  ChordRow row{{from}, 0, 0};
  for (const double end : section_ends(pieces, to)) {
    const double start = row.parameters.back();
    double count = 1;
    if (options.first_step > 0) {
      count = std::max(1.0, std::ceil((end - start) / options.first_step * (1 - kWholeSteps)));
    }
    const auto vertex = [&](double i) {
      return i >= count ? end : start + (end - start) * i / count;
    };
    double deviation = 0;
    for (;;) {
      if (static_cast<double>(row.parameters.size()) + count > most ||
          static_cast<double>(row.readings) >= kIlcaReadings * most) {
        return std::nullopt;
      }
      // Of the first chord that exceeds the limit, if one does.
      deviation = 0;
      for (double i = 0; i < count && deviation <= options.max_deviation; ++i) {
        deviation = std::max(deviation, chord_deviation(pieces, vertex(i), vertex(i + 1)));
        ++row.readings;
      }
      if (deviation <= options.max_deviation) break;
      const double wanted = count * std::sqrt(deviation / options.max_deviation);
      count = std::max(count + 1, std::floor(kTried * wanted));
    }
    for (double i = 1; i <= count; ++i) row.parameters.push_back(vertex(i));
    row.deviation = std::max(row.deviation, deviation);
  }
  return row;
}

ChordRow blca(const BsplineCurve& curve, double from, double to, double tolerance) {
  require(tolerance > 0, "blca: tolerance", tolerance, "> 0");
  const CurvePieces pieces(curve, from, to);
  const auto holds = [&](double start, double end) {
    return chord_proved(pieces, start, end,
                        ChordProof(pieces.point_at(start), pieces.point_at(end), tolerance));
  };
  ChordRow row{{from}, 0, 0};
  for (const double limit : section_ends(pieces, to)) {
    while (row.parameters.back() < limit) {
      const double start = row.parameters.back();
      double end = leaves_tangent_at(pieces, start, limit, tolerance);
      while (!holds(start, end)) {
        const double shorter = (start + end) / 2;
        if (!(start < shorter && shorter < end)) break;  // the doubles are used up
        end = shorter;
      }
      row.deviation = std::max(row.deviation, chord_deviation(pieces, start, end));
      row.parameters.push_back(end);
    }
  }
  return row;
}

TangentLines tangent_lines(const BsplineCurve& curve, std::span<const double> parameters,
                           double moved) {
  const CurvePieces pieces(curve, parameters.front(), parameters.back());
  TangentLines lines;
  Point3 at = pieces.point_at(parameters.front());
  for (std::size_t i = 0; i + 1 < parameters.size(); ++i) {
    const Point3 start = pieces.point_at(parameters[i]);
    const Vector3 way = pieces.point_at(parameters[i + 1]) - start;
    const Vector3 tangent = pieces.leaving(parameters[i]);
    const double along = way.dot(tangent);
    const Vector3 across = way - along * tangent;
    const Point3 begin = start + moved * across.stableNormalized();
    if ((begin - at).norm() > kSamePlace) {
      lines.path.emplace_back(Line{at, begin});
      lines.jumped += (begin - at).norm();
      ++lines.jumps;
    }
    const Line line{begin, begin + along * tangent};
    const BesideCurve beside = line_beside(pieces, parameters[i], parameters[i + 1], line);
    lines.beside.left = std::max(lines.beside.left, beside.left);
    lines.beside.right = std::max(lines.beside.right, beside.right);
    lines.path.emplace_back(line);
    at = line.end;
  }
  return lines;
}

}  // namespace batten::geometry
