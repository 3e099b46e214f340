#include "geometry/fitting/corners/corner_blend.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <numbers>
#include <utility>
#include <variant>
#include <vector>

#include "geometry/basic/require.h"
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
    return greatest([this](double s) { return std::min(from_a(s), from_b(s)); }, places_).value;
  }

  // With its distance from the vertex as a negative value.
  Extremum nearest_to_vertex() const {
    return greatest([this](double s) { return -from_vertex(s).norm(); }, places_);
  }

  double in_order(const Extremum& nearest) const {
    const auto first_after = std::upper_bound(places_.begin(), places_.end(), nearest.at);
    std::vector<double> to_nearest(places_.begin(), first_after);
    to_nearest.push_back(nearest.at);
    std::vector<double> from_nearest = {nearest.at};
    from_nearest.insert(from_nearest.end(), first_after, places_.end());
    const double before = greatest([this](double s) { return from_a(s); }, to_nearest).value;
    const double after = greatest([this](double s) { return from_b(s); }, from_nearest).value;
    return std::max({-nearest.value, before, after});
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
  double from_a(double s) const { return leg_distance(from_vertex(s), frame_.a, frame_.length_a); }
  double from_b(double s) const { return leg_distance(from_vertex(s), frame_.b, frame_.length_b); }

  const CornerFrame& frame_;
  std::vector<CubicPolynomial> pieces_;
  std::vector<double> places_;  // increasing, from 0 to the number of pieces
};

}  // namespace

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
  require(tolerance > 0 && std::isfinite(tolerance), fmt::format("{}: tolerance", caller),
          tolerance, "a positive number of mm");
}

namespace {

// Lines and pieces one after the other, from where it was begun.
class Chain {
 public:
  Chain(const Point3& start, double station) : cursor_(start) { path_.stations = {station}; }

  // Blends that share a leg may overlap by the noise of the search that found them: what takes no
  // way along the polyline is no piece, and the next one starts where this one ended.
  void line_to(const Point3& end, double station) {
    if ((end - cursor_).norm() <= kSamePlace || station <= path_.stations.back()) return;
    path_.pieces.emplace_back(Line{cursor_, end});
    reach(end, station);
  }

  void curve(CubicBezier piece, double from, double to) {
    line_to(piece.control[0], from);
    piece.control[0] = cursor_;
    path_.pieces.emplace_back(piece);
    reach(piece.control[3], to);
  }

  // Ends exactly there, also where the last piece ends beside it by rounding.
  BlendedPath finish(const Point3& end, double station) && {
    line_to(end, station);
    if (path_.pieces.empty()) return {};
    if (auto* line = std::get_if<Line>(&path_.pieces.back())) line->end = end;
    if (auto* bezier = std::get_if<CubicBezier>(&path_.pieces.back())) bezier->control[3] = end;
    path_.stations.back() = station;
    return std::move(path_);
  }

 private:
  void reach(const Point3& end, double station) {
    cursor_ = end;
    path_.stations.push_back(station);
  }

  Point3 cursor_;
  BlendedPath path_;
};

// The middle of a blend's parameters; a knot that is there but for rounding.
double middle_of(const BsplineCurve& blend) {
  // Far above rounding, far below any span that a blend is made of.
  constexpr double kSameMiddle = 1e-9;
  const double middle = 0.5 * (blend.first() + blend.last());
  for (const double u : blend.breakpoints()) {
    if (std::abs(u - middle) <= kSameMiddle * (blend.last() - blend.first())) return u;
  }
  return middle;
}

// One side of a blend, cut at the middle of its parameters. `station`: of the vertex.
void append_half(const BsplineCurve& blend, bool first_half, const Point3& vertex, double station,
                 Chain& chain) {
  const double middle = middle_of(blend);
  const BsplineCurve half =
      first_half ? blend.part(blend.first(), middle) : blend.part(middle, blend.last());
  const std::vector<CubicBezier> pieces = half.bezier_pieces();
  const Point3& on_leg = first_half ? pieces.front().control[0] : pieces.back().control[3];
  const double reach = (on_leg - vertex).norm();
  const std::vector<double> breaks = half.breakpoints();
  // mm along the polyline, negative before the vertex.
  const auto from_vertex = [&](std::size_t i) {
    const double part = (breaks[i] - middle) / (half.last() - half.first());
    return reach * part;
  };
  for (std::size_t i = 0; i < pieces.size(); ++i) {
    chain.curve(pieces[i], station + from_vertex(i), station + from_vertex(i + 1));
  }
}

}  // namespace

DistinctVertices distinct_vertices(std::span<const Point3> points) {
  DistinctVertices kept;
  for (std::size_t i = 0; i < points.size(); ++i) {
    if (!kept.points.empty() && (points[i] - kept.points.back()).norm() <= kSamePlace) continue;
    kept.points.push_back(points[i]);
    kept.indices.push_back(i);
  }
  return kept;
}

bool turns_more(const Corner& corner, double angle) {
  const Vector3 in = corner.vertex - corner.before;
  const Vector3 out = corner.after - corner.vertex;
  return std::atan2(in.cross(out).norm(), in.dot(out)) > angle;
}

namespace {

// Without its shares.
SharedCorner corner_at(std::size_t vertex, const Corner& corner, const CornerPathOptions& options) {
  const bool sharp = turns_more(corner, std::numbers::pi - options.strict_sharper_than);
  SharedCorner found{vertex, corner, NoBlend::kKept, sharp ? ToleranceKind::kPath : options.kind};
  if (!turns_more(corner, options.keep_corner_angle)) found.frame = frame_of(corner);
  return found;
}

bool may_have_blend(const SharedCorner& corner) {
  return std::holds_alternative<CornerFrame>(corner.frame);
}

// The seam without its shares.
std::optional<SharedCorner> rounded_seam(std::span<const Point3> q,
                                         const CornerPathOptions& options) {
  constexpr std::size_t kFewest = 4;  // a triangle
  if (options.seam != Seam::kSmooth || q.size() < kFewest) return std::nullopt;
  if ((q.front() - q.back()).norm() > kSamePlace) return std::nullopt;
  SharedCorner seam = corner_at(0, {q[q.size() - 2], q[0], q[1]}, options);
  if (!may_have_blend(seam)) return std::nullopt;
  return seam;
}

// The part of a segment that the corner at one of its ends may use.
double share_of(const Point3& a, const Point3& b, bool other_blends) {
  return (a - b).norm() / (other_blends ? 2 : 1);
}

}  // namespace

std::vector<SharedCorner> shared_corners(std::span<const Point3> distinct,
                                         const CornerPathOptions& options) {
  const auto& q = distinct;
  std::vector<SharedCorner> corners;
  std::vector<bool> blends(q.size(), false);
  for (std::size_t i = 1; i + 1 < q.size(); ++i) {
    corners.push_back(corner_at(i, {q[i - 1], q[i], q[i + 1]}, options));
    blends[i] = may_have_blend(corners.back());
  }
  if (rounded_seam(q, options)) blends.front() = blends.back() = true;
  for (SharedCorner& corner : corners) {
    const std::size_t i = corner.vertex;
    corner.share_before = share_of(q[i], q[i - 1], blends[i - 1]);
    corner.share_after = share_of(q[i], q[i + 1], blends[i + 1]);
  }
  return corners;
}

std::optional<SharedCorner> shared_seam(std::span<const Point3> distinct,
                                        const CornerPathOptions& options) {
  const auto& q = distinct;
  std::optional<SharedCorner> seam = rounded_seam(q, options);
  if (!seam) return std::nullopt;
  const std::size_t last = q.size() - 2;
  const auto blends = [&](std::size_t i) {
    return may_have_blend(corner_at(i, {q[i - 1], q[i], q[i + 1]}, options));
  };
  seam->share_before = share_of(q[0], q[last], blends(last));
  seam->share_after = share_of(q[0], q[1], blends(1));
  return seam;
}

std::optional<CornerBlend> seam_blend(const SharedCorner& seam, double tolerance) {
  const auto* frame = std::get_if<CornerFrame>(&seam.frame);
  if (frame == nullptr) return std::nullopt;
  // With P2, P3, P4 about the middle knot the curve is at (P2 + 4 P3 + P4) / 6 there, which is the
  // vertex. P1 and P0 are where the parameter is about even.
  const auto curve_of = [&](double spacing) {
    const Point3& q = frame->vertex;
    const Vector3 a = spacing * frame->a;
    const Vector3 b = spacing * frame->b;
    constexpr double kSecond = 5.0 / 3;
    return BsplineCurve(
        BsplineBasis::clamped(3, {0, 1, 2, 3, 4}),
        {q + 2 * a, q + kSecond * a, q + a, q - (a + b) / 4, q + b, q + kSecond * b, q + 2 * b});
  };
  // Its shape is the same for any spacing, so what it deviates goes with it.
  const double share =
      std::min({seam.share_before, seam.share_after, frame->length_a, frame->length_b}) / 2;
  const double deviation = measure_deviation(curve_of(share), *frame, seam.kind);
  const double spacing = deviation > tolerance ? share * tolerance / deviation : share;
  if (!(spacing > kSamePlace)) return std::nullopt;
  BsplineCurve curve = curve_of(spacing);
  const BlendDeviation found = measure_blend(curve, *frame);
  return CornerBlend{std::move(curve), found};
}

AlikeLegs alike_legs(const CornerFrame& frame) {
  const auto steps = [](double x) { return std::llround(x / kCornerTuning.alike); };
  return {steps(frame.a.x()), steps(frame.a.y()), steps(frame.a.z()),
          steps(frame.b.x()), steps(frame.b.y()), steps(frame.b.z())};
}

BlendedPath blended_path(std::span<const Point3> distinct,
                         std::span<const std::optional<BsplineCurve>> blends,
                         const CornerBlend* seam) {
  const auto& q = distinct;
  if (q.size() < 2) return {};
  Chain chain(q[0], 0);
  double station = 0;
  if (seam != nullptr) append_half(seam->curve, false, q[0], station, chain);
  for (std::size_t i = 1; i < q.size(); ++i) {
    station += (q[i] - q[i - 1]).norm();
    if (i + 1 == q.size()) break;
    if (blends[i]) {
      append_half(*blends[i], true, q[i], station, chain);
      append_half(*blends[i], false, q[i], station, chain);
    } else {
      chain.line_to(q[i], station);
    }
  }
  if (seam != nullptr) append_half(seam->curve, true, q.back(), station, chain);
  return std::move(chain).finish(q.back(), station);
}

}  // namespace batten::geometry
