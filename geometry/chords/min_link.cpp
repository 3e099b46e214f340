#include "geometry/chords/min_link.h"

#include <Eigen/Eigenvalues>
#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <limits>
#include <optional>
#include <span>
#include <string>
#include <utility>

#include "geometry/basic/require.h"
#include "geometry/chords/chord_proof.h"
#include "geometry/chords/min_link_gates.h"
#include "geometry/chords/min_link_plane.h"
#include "geometry/path/curve_pieces.h"
#include "geometry/path/plane_curve.h"

namespace batten::geometry {
namespace {

constexpr MinLinkTuning kLink = kMinLinkTuning;

using Vertices = std::vector<LinkVertex>;

// Few links in the tolerance tube of a curve in space, each as long as it can be.

// The corners after the first, which is at (1, 0), and that again.
const std::array<Point2, MinLinkTuning::corners> kCircle = [] {
  std::array<Point2, MinLinkTuning::corners> corners;
  for (int i = 0; i < MinLinkTuning::corners; ++i) {
    corners[static_cast<std::size_t>(i)] = unit_vector(2 * kPi * (i + 1) / MinLinkTuning::corners);
  }
  return corners;
}();

struct Circle {
  Point3 center;
  Vector3 along;
  Vector3 across;  // unit; to where the curve bends
  double radius;
};

Circle circle_of(const Gate& gate, double width) {
  Vector3 across = gate.bend;
  if (across.isZero()) across = gate.along.unitOrthogonal();
  return {gate.center, gate.along, across, width - gate.gap};
}

// The directions of straight ways from one point through circles, one after the other, as a
// convex polygon in the plane at distance 1.
class View {
 public:
  View(const Point3& eye, const Vector3& ahead) : eye_(eye), ahead_(ahead) {
    right_ = ahead.unitOrthogonal();
    up_ = ahead.cross(right_);
    polygon_ = {{-kLink.widest_view, -kLink.widest_view},
                {kLink.widest_view, -kLink.widest_view},
                {kLink.widest_view, kLink.widest_view},
                {-kLink.widest_view, kLink.widest_view}};
  }

  // Only ways through this circle from now on. Nothing is changed when there are none.
  bool pass(const Circle& circle) {
    const double inner = circle.radius * std::cos(kPi / MinLinkTuning::corners);
    const double distance = (circle.center - eye_).dot(circle.along);
    if (distance <= 0) return true;  // beside the eye
    if (std::ranges::all_of(polygon_, [&](const Point2& p) {
          const Vector3 way = direction(p);
          const double onward = way.dot(circle.along);
          if (onward <= 0) return false;
          return (eye_ + distance / onward * way - circle.center).squaredNorm() <= inner * inner;
        })) {
      return true;
    }
    before_ = polygon_;
    const Vector3 side = circle.along.cross(circle.across);
    Vector3 corner = circle.center + circle.radius * circle.across - eye_;
    for (const Point2& unit : kCircle) {
      const Vector3 next =
          circle.center + circle.radius * (unit.x() * circle.across + unit.y() * side) - eye_;
      cut(corner.cross(next));
      if (polygon_.empty()) {
        polygon_ = before_;
        return false;
      }
      corner = next;
    }
    return true;
  }

  // The same of circles one behind the other.
  bool pass_all(std::span<const Circle> circles) {
    const std::vector<Point2> polygon = polygon_;
    for (auto circle = circles.rbegin(); circle != circles.rend(); ++circle) {
      if (pass(*circle)) continue;
      polygon_ = polygon;
      return false;
    }
    return true;
  }

  [[nodiscard]] bool sees(const Point3& p) const {
    const Vector3 way = p - eye_;
    const double onward = way.dot(ahead_);
    if (onward <= 0) return false;
    const Point2 at(way.dot(right_) / onward, way.dot(up_) / onward);
    for (std::size_t i = 0; i < polygon_.size(); ++i) {
      const Point2& a = polygon_[i];
      const Point2& b = polygon_[(i + 1) % polygon_.size()];
      if (cross(b - a, at - a) < 0) return false;
    }
    return true;
  }

  // Where the middle of the view meets the plane of a gate.
  [[nodiscard]] Point3 middle_on(const Gate& gate) const {
    Point2 sum = Point2::Zero();
    for (const Point2& p : polygon_) sum += p;
    const Vector3 way = direction(sum / static_cast<double>(polygon_.size()));
    return eye_ + (gate.center - eye_).dot(gate.along) / way.dot(gate.along) * way;
  }

 private:
  [[nodiscard]] Vector3 direction(const Point2& p) const {
    return ahead_ + p.x() * right_ + p.y() * up_;
  }

  // Keeps the directions on the inner side of a plane through the eye.
  void cut(const Vector3& inward) {
    const double base = inward.dot(ahead_);
    const Point2 rise(inward.dot(right_), inward.dot(up_));
    const auto height = [&](const Point2& p) { return base + rise.dot(p); };
    if (std::ranges::all_of(polygon_, [&](const Point2& p) { return height(p) >= 0; })) return;
    cut_.clear();
    for (std::size_t i = 0; i < polygon_.size(); ++i) {
      const Point2& a = polygon_[i];
      const Point2& b = polygon_[i + 1 < polygon_.size() ? i + 1 : 0];
      const double at_a = height(a);
      const double at_b = height(b);
      if (at_a >= 0) cut_.push_back(a);
      if ((at_a >= 0) != (at_b >= 0)) cut_.push_back(a + at_a / (at_a - at_b) * (b - a));
    }
    polygon_.swap(cut_);
  }

  Point3 eye_;
  Vector3 ahead_;
  Vector3 right_;
  Vector3 up_;
  std::vector<Point2> polygon_;  // counter-clockwise seen from the eye's back
  std::vector<Point2> before_;   // room for the polygon before a circle,
  std::vector<Point2> cut_;      // and for what a plane leaves of it
};

// A vertex, and how far links from it get.
struct Lookout {
  LinkVertex vertex;
  std::size_t next = 1;  // the first gate ahead
  std::size_t last = 0;  // the last gate that links from here pass; next - 1 where none
  LinkVertex farthest;   // between that gate and the next
  bool sees_end = false;

  [[nodiscard]] double reach() const {
    return sees_end ? std::numeric_limits<double>::infinity() : farthest.parameter;
  }
};

// Links from a point near the first gate's centre to the centre of the last one, through all
// gates in order, each inside a polygon in the circle of radius `width` (mm) about the gate's
// centre; a corner points to where the curve bends.
class SpaceWalk {
 public:
  SpaceWalk(const GateChain& gates, double width) : gates_(gates), width_(width) {
    circles_.reserve(gates.size());
    for (std::size_t i = 0; i < gates.size(); ++i) circles_.push_back(circle_of(gates[i], width));
  }

  // Where the curve bends so closely that no link gets on, the way goes over the next of `chords`:
  // parameters of the curve, increasing, between which chords are known to be near it. The last of
  // them is the last gate's.
  Vertices links_from(const Point3& start, std::span<const double> chords) const {
    Vertices vertices;
    Lookout out = look({start, gates_[0].parameter}, 1, gates_[0].along);
    while (!out.sees_end) {
      vertices.push_back(out.vertex);
      if (out.last < out.next) {
        out = on_the_curve(out, chords, vertices);
      } else {
        out = out.last == last_gate() ? before_end(out) : best_after(out);
      }
    }
    vertices.push_back(out.vertex);
    vertices.push_back({gates_.back().center, gates_.back().parameter});
    return vertices;
  }

 private:
  [[nodiscard]] std::size_t last_gate() const { return gates_.size() - 1; }

  [[nodiscard]] Lookout look(const LinkVertex& vertex, std::size_t next,
                             const Vector3& ahead) const {
    Lookout out{vertex, next, next - 1, vertex, next > last_gate()};
    View view(vertex.place, ahead);
    // Some circles at once, the farthest first: most others let all pass that this one does.
    for (std::size_t some = kLink.at_once; some > 0;) {
      some = std::min(some, last_gate() - out.last);
      const auto next_some = std::span(circles_).subspan(out.last + 1, some);
      if (view.pass_all(next_some)) {
        out.last += some;
      } else {
        some /= 2;
      }
    }
    if (out.last < next) return out;
    if (out.last == last_gate()) {
      out.sees_end = view.sees(gates_.back().center);
      out.farthest = {view.middle_on(gates_.back()), gates_.back().parameter};
      return out;
    }
    double good = 0;
    double bad = 1;
    for (int i = 0; i < kLink.end_halvings; ++i) {
      const double middle = (good + bad) / 2;
      const bool passed = view.pass(circle_of(gates_.between(out.last, middle), width_));
      (passed ? good : bad) = middle;
    }
    const Gate gate = gates_.between(out.last, good);
    out.farthest = {view.middle_on(gate), gate.parameter};
    return out;
  }

  // On to the next of `chords`, by way of the curve's own place here.
  [[nodiscard]] Lookout on_the_curve(const Lookout& out, std::span<const double> chords,
                                     Vertices& vertices) const {
    const Gate here = gates_.at(out.vertex.parameter);
    if (out.vertex.place != here.center) vertices.push_back({here.center, here.parameter});
    const auto next = std::upper_bound(chords.begin(), chords.end(), here.parameter);
    if (next == chords.end() || *next >= gates_.back().parameter) return at_end(vertices.back());
    const Gate gate = gates_.at(*next);
    return look({gate.center, gate.parameter}, gates_.index_of(*next) + 1, gate.along);
  }

  // Nothing between this vertex and the end.
  [[nodiscard]] Lookout at_end(const LinkVertex& vertex) const {
    return {vertex, last_gate() + 1, last_gate(), vertex, true};
  }

  // Where the farthest link from `out` passes gate `i`.
  [[nodiscard]] Lookout turned_on(const Lookout& out, std::size_t i) const {
    const Vector3 way = out.farthest.place - out.vertex.place;
    const double part =
        (gates_[i].center - out.vertex.place).dot(gates_[i].along) / way.dot(gates_[i].along);
    return look({out.vertex.place + part * way, gates_[i].parameter}, i + 1, gates_[i].along);
  }

  [[nodiscard]] Lookout best_after(const Lookout& out) const {
    Lookout best = look(out.farthest, out.last + 1, gates_[out.last].along);
    const std::size_t passed = out.last + 1 - out.next;
    if (!bend_changes(out.last, best.last)) return best;
    for (const double part : kLink.earlier_turns) {
      const auto back = static_cast<std::size_t>(part * static_cast<double>(passed));
      if (back == 0 || best.sees_end) continue;
      Lookout other = turned_on(out, out.last - back);
      if (other.reach() > best.reach()) best = std::move(other);
    }
    return best;
  }

  // Does the curve bend anywhere else than at gate `from`, up to gate `to`?
  [[nodiscard]] bool bend_changes(std::size_t from, std::size_t to) const {
    for (std::size_t i = from; i <= to; ++i) {
      if (gates_[i].bend.dot(gates_[from].bend) < kLink.same_bend) return true;
    }
    return false;
  }

  // The farthest link gets to the last gate, but not to its centre. It turns as early as the end
  // can be seen from: at the last gate it always can.
  [[nodiscard]] Lookout before_end(const Lookout& out) const {
    Lookout best = at_end(out.farthest);
    for (std::size_t i = last_gate(); i-- > out.next;) {
      Lookout other = turned_on(out, i);
      if (!other.sees_end) break;
      best = std::move(other);
    }
    return best;
  }

  const GateChain& gates_;
  double width_;
  std::vector<Circle> circles_;
};

// Along a section without corners.
class LinkSection {
 public:
  // `chords`: vertices of proved chords over the section, its ends included, as many as balanced
  // ones.
  LinkSection(const MarkedPieces& curve, std::span<const double> chords,
              const MinLinkOptions& options)
      : curve_(curve),
        pieces_(curve.pieces),
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
    const GateChain gates(pieces_, from_, to_, gap_);
    Vertices found = continued({{pieces_.point_at(from_), from_}}, gates, options_.tolerance);
    if (options_.balanced && found.size() > 2) balance(found, gates);
    if (prove(found) && found.size() < chords_.size()) return found;
    const ChordOptions chords = {.max_deviation = options_.tolerance,
                                 .balanced = options_.balanced};
    Vertices on_curve;
    for (const double u : chord_vertices(curve_, from_, to_, chords)) {
      on_curve.push_back({pieces_.point_at(u), u});
    }
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
    if (height_ <= kLink.flat * options_.tolerance) normal_ = normal;
  }

  // From the last of `start`, at the first gate, to the end of the section, with this tolerance.
  [[nodiscard]] Vertices continued(const Vertices& start, const GateChain& gates,
                                   double tolerance) const {
    const LinkVertex& last = start.back();
    std::optional<Vertices> more;
    if (normal_) {
      const double width = std::sqrt(tolerance * tolerance - 4 * height_ * height_);
      more = min_link_in_plane(gates, *normal_, last.place, width);
    }
    if (!more) more = SpaceWalk(gates, tolerance).links_from(last.place, chords_);
    Vertices all(start.begin(), start.end() - 1);
    all.insert(all.end(), more->begin(), more->end());
    return all;
  }

  // Narrows the tube over the last links as long as they do not become more.
  void balance(Vertices& vertices, const GateChain& all) const {
    const std::size_t links = vertices.size() - 1;
    const std::size_t kept = links > kLink.balanced ? links - kLink.balanced : 0;
    const Vertices start(vertices.begin(),
                         vertices.begin() + static_cast<std::ptrdiff_t>(kept) + 1);
    std::optional<GateChain> rest;
    if (kept > 0) rest.emplace(pieces_, start.back().parameter, to_, gap_);
    const GateChain& gates = rest ? *rest : all;
    const std::vector<double> bent = bent_up_to(gates);
    const auto needed_part = [&](const Vertices& made) {
      const std::size_t last = gates.index_of(made[made.size() - 2].parameter);
      const double of_last = bent.back() - bent[last];
      const auto others = static_cast<double>(made.size() - 2 - kept);
      const double remainder = std::min(1.0, of_last * others / bent[last]);
      const double needed = (others + remainder) / static_cast<double>(links - kept);
      return needed * needed;
    };
    double good = 1;
    double bad = kLink.narrowest;
    double needed = needed_part(vertices);
    for (int round = 0; round < kLink.balancing_rounds; ++round) {
      const double next = std::clamp(needed, bad, good);
      const double part = next + kLink.above_needed * (good - next);
      Vertices narrower = continued(start, gates, part * options_.tolerance);
      needed = part * needed_part(narrower);
      if (narrower.size() <= vertices.size()) {
        vertices = std::move(narrower);
        good = part;
      } else {
        bad = part;
      }
    }
  }

  // For each gate, what links have to follow of the curve up to it: the sum of the roots of its
  // turns by their lengths. On an even bend a link follows as much of it as it is long, by the root
  // of the tolerance.
  static std::vector<double> bent_up_to(const GateChain& gates) {
    std::vector<double> bent = {0};
    for (std::size_t i = 1; i < gates.size(); ++i) {
      const double turn = (gates[i].along - gates[i - 1].along).norm();
      const double length = (gates[i].center - gates[i - 1].center).norm();
      bent.push_back(bent.back() + std::sqrt(turn * length));
    }
    return bent;
  }

  // Proves each link; cuts those that are not proved, with new vertices on the curve.
  bool prove(Vertices& vertices) const {
    Vertices proved = {vertices.front()};
    for (std::size_t i = 1; i < vertices.size(); ++i) {
      const bool again = vertices[i].place == proved.back().place && i + 1 < vertices.size();
      if (again) continue;
      if (!is_near_curve(vertices[i])) return false;
      if (!prove_link(vertices[i], proved)) return false;
    }
    vertices = std::move(proved);
    return true;
  }

  bool prove_link(const LinkVertex& end, Vertices& proved) const {
    const LinkVertex start = proved.back();
    if (chord_proved(pieces_, start.parameter, end.parameter,
                     ChordProof(start.place, end.place, options_.tolerance, kSharpProofCuts))) {
      proved.push_back(end);
      return true;
    }
    const double middle = (start.parameter + end.parameter) / 2;
    if (!(start.parameter < middle && middle < end.parameter)) return false;
    return prove_link({pieces_.point_at(middle), middle}, proved) && prove_link(end, proved);
  }

  [[nodiscard]] bool is_near_curve(const LinkVertex& vertex) const {
    return (vertex.place - pieces_.point_at(vertex.parameter)).norm() <= options_.tolerance;
  }

  const MarkedPieces& curve_;
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
  require(options.tolerance > 0, "min_link_vertices: tolerance", options.tolerance, "> 0");
  require(options.gates_per_link >= kLink.least_gates, "min_link_vertices: gates_per_link",
          options.gates_per_link, std::to_string(kLink.least_gates) + " or more");
}

}  // namespace

std::vector<LinkVertex> min_link_vertices(const BsplineCurve& curve, double from, double to,
                                          const MinLinkOptions& options) {
  check(options);
  const MarkedPieces marked(curve, from, to);
  const std::vector<double> chords =
      chord_vertices(marked, from, to, {.max_deviation = options.tolerance, .balanced = false});
  std::vector<double> ends = marked.corners;
  ends.push_back(to);
  Vertices vertices = {{marked.pieces.point_at(from), from}};
  auto chord = chords.begin();  // corners are vertices of the chords too
  for (const double end : ends) {
    const auto chord_end = std::lower_bound(chord, chords.end(), end);
    const Vertices links = LinkSection(marked, {chord, chord_end + 1}, options).links();
    vertices.insert(vertices.end(), links.begin() + 1, links.end());
    chord = chord_end;
  }
  vertices.front().place = curve.point_at(from);
  vertices.back().place = curve.point_at(to);
  return vertices;
}

}  // namespace batten::geometry
