#include "geometry/chords/min_link.h"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <cstddef>
#include <optional>
#include <span>
#include <stdexcept>
#include <string>
#include <utility>

#include "geometry/chords/chord_proof.h"
#include "geometry/chords/linearize.h"
#include "geometry/chords/min_link_gates.h"
#include "geometry/chords/min_link_space.h"
#include "geometry/path/curve_pieces.h"

namespace batten::geometry {
namespace {

using Vertices = std::vector<LinkVertex>;

// Fewer gates than this are no picture of a link.
constexpr int kLeastGates = 8;

// A curve this near to a plane, as a part of the tolerance, is taken as plane: two places of a
// link and the curve may be apart twice that across the plane, which costs 0.1 % of the tolerance.
constexpr double kFlat = 0.02;

// How often the tolerance is halved in on while looking for the least one that needs as many links.
constexpr int kBalancingRounds = 4;

// A tolerance that is 9/16 of another one needs a third more links.
constexpr double kNarrowest = 9.0 / 16;

// Only so many links at the end are balanced: the cost of the rounds does not grow with the run.
constexpr std::size_t kBalancedLinks = 40;

// A link that is not proved is cut in two, so often.
constexpr int kMostCuts = 12;

// Along a stretch without corners.
class Stretch {
 public:
  // `chords`: vertices of proved chords over the stretch, its ends included.
  Stretch(const CurvePieces& pieces, std::span<const double> chords, const MinLinkOptions& options)
      : pieces_(pieces),
        chords_(chords),
        from_(chords.front()),
        to_(chords.back()),
        options_(options) {
    const double gates = options.gates_per_link;
    gap_ = 2 * options.tolerance / (gates * gates);
    find_plane();
  }

  // Proved links where they are fewer than the chords, otherwise these.
  Vertices links() const {
    Vertices found = continued({{pieces_.point_at(from_), from_}}, options_.tolerance);
    if (options_.balanced && found.size() > 2) balance(found);
    if (prove(found) && found.size() < chords_.size()) return found;
    Vertices on_curve;
    on_curve.reserve(chords_.size());
    for (const double u : chords_) on_curve.push_back({pieces_.point_at(u), u});
    return on_curve;
  }

 private:
  void find_plane() {
    std::vector<Point3> points;
    for (std::size_t i = pieces_.index_of(from_); i < pieces_.size() && pieces_.breaks()[i] < to_;
         ++i) {
      const CubicBezier part = pieces_.part(i, from_, to_);
      points.insert(points.end(), std::begin(part.control), std::end(part.control));
    }
    Point3 middle = Point3::Zero();
    for (const Point3& p : points) middle += p / static_cast<double>(points.size());
    Eigen::Matrix3d spread = Eigen::Matrix3d::Zero();
    for (const Point3& p : points) spread += (p - middle) * (p - middle).transpose();
    const Vector3 normal =
        Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d>(spread).eigenvectors().col(0);
    for (const Point3& p : points) {
      height_ = std::max(height_, std::abs((p - middle).dot(normal)));
    }
    if (height_ <= kFlat * options_.tolerance) normal_ = normal;
  }

  // From the last of `start` to the end of the stretch, with this tolerance.
  [[nodiscard]] Vertices continued(const Vertices& start, double tolerance) const {
    const LinkVertex& last = start.back();
    const GateChain gates(pieces_, last.parameter, to_, gap_);
    std::optional<Vertices> more;
    if (normal_) {
      const double width = std::sqrt(tolerance * tolerance - 4 * height_ * height_);
      more = min_link_in_plane(gates, *normal_, last.place, width);
    }
    if (!more) more = few_links_in_space(gates, last.place, tolerance, chords_);
    Vertices all(start.begin(), start.end() - 1);
    all.insert(all.end(), more->begin(), more->end());
    return all;
  }

  // Narrows the tube over the last links as long as they do not become more.
  void balance(Vertices& vertices) const {
    const std::size_t links = vertices.size() - 1;
    const std::size_t kept = links > kBalancedLinks ? links - kBalancedLinks : 0;
    const Vertices start(vertices.begin(),
                         vertices.begin() + static_cast<std::ptrdiff_t>(kept) + 1);
    double good = 1;
    double bad = kNarrowest;
    for (int round = 0; round < kBalancingRounds; ++round) {
      const double middle = (good + bad) / 2;
      Vertices narrower = continued(start, middle * options_.tolerance);
      if (narrower.size() <= vertices.size()) {
        vertices = std::move(narrower);
        good = middle;
      } else {
        bad = middle;
      }
    }
  }

  // Proves each link; cuts those that are not proved, with new vertices on the curve.
  bool prove(Vertices& vertices) const {
    Vertices proved = {vertices.front()};
    for (std::size_t i = 1; i < vertices.size(); ++i) {
      const bool again = vertices[i].place == proved.back().place && i + 1 < vertices.size();
      if (again) continue;
      if (!is_near_curve(vertices[i])) return false;
      if (!prove_link(vertices[i], kMostCuts, proved)) return false;
    }
    vertices = std::move(proved);
    return true;
  }

  bool prove_link(const LinkVertex& end, int cuts, Vertices& proved) const {
    const LinkVertex start = proved.back();
    if (chord_proved(pieces_, start.parameter, end.parameter,
                     ChordProof(start.place, end.place, options_.tolerance, kSharpProofCuts))) {
      proved.push_back(end);
      return true;
    }
    const double middle = (start.parameter + end.parameter) / 2;
    if (cuts == 0 || !(start.parameter < middle && middle < end.parameter)) return false;
    return prove_link({pieces_.point_at(middle), middle}, cuts - 1, proved) &&
           prove_link(end, cuts - 1, proved);
  }

  [[nodiscard]] bool is_near_curve(const LinkVertex& vertex) const {
    return (vertex.place - pieces_.point_at(vertex.parameter)).norm() <= options_.tolerance;
  }

  const CurvePieces& pieces_;
  std::span<const double> chords_;
  double from_;
  double to_;
  MinLinkOptions options_;
  double gap_;         // mm, curve to chord between two gates
  double height_ = 0;  // mm, greatest distance from the plane
  std::optional<Vector3> normal_;
};

void check(const MinLinkOptions& options) {
  if (!(options.tolerance > 0)) {
    throw std::invalid_argument("min_link_vertices: tolerance " +
                                std::to_string(options.tolerance) + ", expected > 0");
  }
  if (options.gates_per_link < kLeastGates) {
    throw std::invalid_argument("min_link_vertices: gates_per_link " +
                                std::to_string(options.gates_per_link) + ", expected " +
                                std::to_string(kLeastGates) + " or more");
  }
}

}  // namespace

std::vector<LinkVertex> min_link_vertices(const BsplineCurve& curve, double from, double to,
                                          const MinLinkOptions& options) {
  check(options);
  const CurvePieces pieces(curve, from, to);
  const std::vector<double> chords =
      chord_vertices(curve, from, to, {.max_deviation = options.tolerance});
  std::vector<double> ends = pieces.corners();
  ends.push_back(to);
  Vertices vertices = {{pieces.point_at(from), from}};
  auto chord = chords.begin();  // corners are vertices of the chords too
  for (const double end : ends) {
    const auto chord_end = std::lower_bound(chord, chords.end(), end);
    const Vertices links = Stretch(pieces, {chord, chord_end + 1}, options).links();
    vertices.insert(vertices.end(), links.begin() + 1, links.end());
    chord = chord_end;
  }
  vertices.front().place = curve.point_at(from);
  vertices.back().place = curve.point_at(to);
  return vertices;
}

}  // namespace batten::geometry
