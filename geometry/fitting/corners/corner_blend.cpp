#include "geometry/fitting/corners/corner_blend.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <stdexcept>
#include <string>
#include <vector>

#include "geometry/basic/rounding.h"
#include "geometry/numeric/extrema.h"
#include "geometry/path/cubic_polynomial.h"

namespace batten::geometry {
namespace {

// Distance from the leg of that unit direction and length that starts at the vertex; `from` is
// measured from the vertex.
double leg_distance(const Vector3& from, const Vector3& direction, double length) {
  const double foot = std::clamp(from.dot(direction), 0.0, length);
  return (from - foot * direction).norm();
}

// The pieces of a blend as one function of s in [0, pieces].
class PiecewiseCurve {
 public:
  PiecewiseCurve(const BsplineCurve& curve, const CornerFrame& frame) : frame_(frame) {
    for (const CubicBezier& piece : curve.bezier_pieces()) {
      pieces_.emplace_back(piece, frame.vertex);
    }
    places_ = with_even_places(kinks(), 0, static_cast<double>(pieces_.size()),
                               kPlacesPerSpan * static_cast<int>(pieces_.size()));
  }

  // Greatest distance from the nearer leg.
  double off_legs() const {
    const auto away = [this](double s) {
      const Vector3 from = from_vertex(s);
      return std::min(from_a(from), from_b(from));
    };
    return greatest(away, places_).value;
  }

  // With its distance from the vertex as a negative value.
  Extremum nearest_to_vertex() const {
    return greatest([this](double s) { return -from_vertex(s).norm(); }, places_);
  }

  double in_order(const Extremum& nearest) const {
    const auto before = [this](double s) { return from_a(from_vertex(s)); };
    const auto after = [this](double s) { return from_b(from_vertex(s)); };
    const auto first_after = std::upper_bound(places_.begin(), places_.end(), nearest.at);
    std::vector<double> to_nearest(places_.begin(), first_after);
    to_nearest.push_back(nearest.at);
    std::vector<double> from_nearest = {nearest.at};
    from_nearest.insert(from_nearest.end(), first_after, places_.end());
    return std::max(
        {-nearest.value, greatest(before, to_nearest).value, greatest(after, from_nearest).value});
  }

 private:
  // Where a distance from the legs has a kink: beside the vertex, or as near to the one leg as to
  // the other. Kinks can be too narrow for even places, and a search for the best curve would
  // find those.
  std::vector<double> kinks() const {
    std::vector<double> places;
    for (std::size_t i = 0; i < pieces_.size(); ++i) {
      const auto offset = static_cast<double>(i);
      pieces_[i].append_crossings(frame_.a, offset, places);
      pieces_[i].append_crossings(frame_.b, offset, places);
      pieces_[i].append_crossings(frame_.a - frame_.b, offset, places);
    }
    return places;
  }

  Vector3 from_vertex(double s) const {
    const std::size_t i = std::min(static_cast<std::size_t>(s), pieces_.size() - 1);
    return pieces_[i].value(s - static_cast<double>(i));
  }
  double from_a(const Vector3& from) const { return leg_distance(from, frame_.a, frame_.length_a); }
  double from_b(const Vector3& from) const { return leg_distance(from, frame_.b, frame_.length_b); }

  const CornerFrame& frame_;
  std::vector<CubicPolynomial> pieces_;
  std::vector<double> places_;  // increasing, from 0 to the number of pieces
};

}  // namespace

std::string_view name_of(NoBlend reason) {
  switch (reason) {
    case NoBlend::kNoLeg:
      return "no-leg";
    case NoBlend::kStraight:
      return "straight";
    case NoBlend::kReversal:
      return "reversal";
    case NoBlend::kNoRoom:
      return "no-room";
    case NoBlend::kKept:
      return "kept";
  }
  return "";
}

Vector3 CornerFrame::outward_a() const { return -(b - b.dot(a) * a).normalized(); }
Vector3 CornerFrame::outward_b() const { return -(a - a.dot(b) * b).normalized(); }

std::variant<CornerFrame, NoBlend> frame_of(const Corner& corner) {
  const Vector3 to_before = corner.before - corner.vertex;
  const Vector3 to_after = corner.after - corner.vertex;
  const double length_a = to_before.norm();
  const double length_b = to_after.norm();
  if (!(length_a > kSamePlace && length_b > kSamePlace)) return NoBlend::kNoLeg;
  const Vector3 a = to_before / length_a;
  const Vector3 b = to_after / length_b;
  // |a - b| and |a + b| are twice sine and cosine of half the angle, accurate at both ends.
  const double sin_half = (a - b).norm() / 2;
  const double cos_half = (a + b).norm() / 2;
  if (!(sin_half >= kSameDirection)) return NoBlend::kReversal;
  if (!(cos_half >= kSameDirection)) return NoBlend::kStraight;
  return CornerFrame{corner.vertex, a, b, length_a, length_b, sin_half, cos_half};
}

CornerFrame reversed(const CornerFrame& frame) {
  return {frame.vertex,   frame.b,        frame.a,       frame.length_b,
          frame.length_a, frame.sin_half, frame.cos_half};
}

double deviation_of(const BlendDeviation& deviation, ToleranceKind kind) {
  return kind == ToleranceKind::kBand ? deviation.legs : deviation.in_order;
}

BlendDeviation measure_blend(const BsplineCurve& curve, const CornerFrame& frame) {
  const PiecewiseCurve blend(curve, frame);
  const Extremum nearest = blend.nearest_to_vertex();
  return {blend.off_legs(), -nearest.value, blend.in_order(nearest)};
}

double measure_deviation(const BsplineCurve& curve, const CornerFrame& frame, ToleranceKind kind) {
  const PiecewiseCurve blend(curve, frame);
  if (kind == ToleranceKind::kBand) return blend.off_legs();
  return blend.in_order(blend.nearest_to_vertex());
}

void require_positive_tolerance(double tolerance, std::string_view caller) {
  if (tolerance > 0 && std::isfinite(tolerance)) return;
  throw std::invalid_argument(std::string(caller) + ": tolerance " + std::to_string(tolerance) +
                              " mm, expected a positive number");
}

}  // namespace batten::geometry
