// What a fit (bspline_fit.h) is asked for: samples to keep near, straight zones and pins to keep
// exactly, and where spans start. Its cubic spline while it is made: knots, what is known of the
// control points, the energy, and the basis values at the samples. And the normal equations for a
// range of the control points, all others held where they are.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "geometry/basic/point.h"
#include "geometry/numeric/banded_cholesky.h"

namespace batten::geometry {

struct FitSample {
  double parameter = 0;
  Point3 target = Point3::Zero();
  Vector3 along = Vector3::Zero();  // unit direction of free sliding; zero: all of it counts
  double limit = 0;                 // mm, > 0: no distance is greater
  double scatter = 0;               // mm, rms distance expected here; 0: only the limit counts
};

// The curve is exactly the straight line from `start` to `end` over [from, to], run at even
// speed, and so are its first two derivatives at both ends.
struct StraightZone {
  double from = 0;
  double to = 0;
  Point3 start = Point3::Zero();
  Point3 end = Point3::Zero();
};

// The curve passes here exactly, and may have a corner.
struct Pin {
  double parameter = 0;
  Point3 place = Point3::Zero();
};

struct FitProblem {
  std::vector<FitSample> samples;   // parameters increase
  std::vector<StraightZone> zones;  // do not overlap, in order
  std::vector<Pin> pins;            // in order; first and last are the ends of the curve
  std::vector<double> breakpoints;  // where spans start at first, strictly increasing, with the
                                    // ends, every pin and every end of a zone; none inside a zone
};

// Every pin and both ends of every zone, increasing, each once.
[[nodiscard]] std::vector<double> required_breaks(const FitProblem& problem);

// Parts of the parameter; single parameters have from == to.
struct ParameterRange {
  double from = 0;
  double to = 0;
};

// Indices [begin, end[.
struct IndexRange {
  std::size_t begin = 0;
  std::size_t end = 0;
};

struct FitTuning {
  // [..]: what fails at half and double (docs/ARCHITECTURE.md).
  int max_refinements = 10;  // rounds of splitting the spans that cannot hold their samples
  int passes = 4;            // solutions per round that tell which spans those are
  int last_passes = 16;      // solutions, when weights have settled, to bring all inside

  // Weights stay above this part of the stiffness of the curve, so that a section whose samples all
  // have room is still held somewhere and the system stays regular; and below this multiple of it:
  // heavier weights no longer move the curve where its knots cannot follow.
  double weight_floor = 1e-8;
  double weight_cap = 1e4;
  double tight_start = 30;  // stiffnesses, where weights start: close to the least-squares curve
  // From one control point to the next the stiffness changes by this factor at the most: samples
  // that weigh much less than their neighbours are left to the swing of these.
  double stiffness_step = 4;
  double least_share = 1e-3;  // of its samples in a control point, for its stiffness
  // In one step a weight grows by this factor at the most. Falling is quicker: distances grow no
  // faster than weights fall, so a weight that falls by the ratio does not fall too far.
  double growth = 8;
  double fall = 1.0 / 32;
  // What is left of the base weight of a sample without scatter after each step. While knots are
  // decided: enough for the curve to stay close to all samples, so that a span that cannot follow
  // them shows. While weights settle: so little that it vanishes within half of the solutions, and
  // the weights of limits have the others to follow.
  double fade = 0.25;
  double let_go = 1.0 / 32;
  // Scatter is judged over this many neighbours on either side: enough for a standard error of a
  // fifth, few enough to follow a change of noise along the path.
  std::size_t scatter_window = 10;
  // A distance that went less than this part of the way hardly follows its falling weight.
  double numb = 0.5;
  // The distance that weights of limits aim at, in limits: they approach their values from both
  // sides, and a curve that is a little outside is of no use.
  double aim_inside = 0.995;
  double press = 0.5;  // the part of Newton's step that the weight of a limit takes; all at the end

  // Sliding along is drawn back by this part in every solution, so that the parameter stays near
  // the one it was made for and the curve cannot fold.
  double slide_pull = 0.05;
  double slide_room = 2;  // limits that a sample slides at most: the path turns from its direction

  // A sample this far above its limit asks for another knot; so does a span whose samples scatter
  // this much more than expected (a tight fit leaves about half of the scatter).
  double too_far = 1.05;
  double too_scattered = 1.5;
  double hopeless = 2.5;        // heavier weights would leave distances smaller by this at most
  double nearly_inside = 1.05;  // what is left after the last solution is no reason for a knot

  // A control point that is new or wakes is solved for so many times, whatever comes of it: a
  // number that is the same for all does not depend on rounding, and weights have settled by then.
  int solutions = 10;
  // A solution in which it moves by less than this part of its limit counts as several: what the
  // solutions that are left would still move it by is a hundredth of the limit at the most.
  double still = 1e-3;
  int still_counts = 4;
  // One that rests wakes when it is moved by this part of its limit.
  double moved = 0.02;
  // Control points on either side that are solved for with those that are awake: the influence of a
  // sample dies out over some of them. Where more of them move, these wake in turn.
  std::size_t reach = 6;
};
inline constexpr FitTuning kFitTuning;

inline constexpr std::size_t kSplineDegree = 3;
inline constexpr std::size_t kNoPoint = static_cast<std::size_t>(-1);

// The four basis functions that are not zero at a sample.
struct FitRow {
  std::size_t first = kNoPoint;  // the first of four control points
  std::array<double, 4> value{};

  // The curve at the sample.
  [[nodiscard, gnu::always_inline]] Point3 on(std::span<const Point3> points) const {
    const Point3* p = &points[first];
    return value[0] * p[0] + value[1] * p[1] + value[2] * p[2] + value[3] * p[3];
  }
};

// What the fit knows of a sample from one solution to the next.
struct SampleState {
  FitRow row;
  bool tight = true;               // its weights are still those of a start on new knots
  Point3 target = Point3::Zero();  // slid along the path
  double stiffness = 0;            // of the curve there: what weights are compared with
  double base = 0;                 // weight that makes the distances scatter as expected
  double push = 0;                 // weight of the limit, on top of it
  double distance = 0;             // mm, in the last solution
  double rms = 0;                  // of the distances around over their scatter, one step before
};

struct FitSpline {
  std::vector<double> breaks;       // distinct knots, increasing
  std::vector<double> knots;        // fourfold at the ends, threefold at inner pins
  std::vector<Point3> points;       // control points
  std::vector<std::uint8_t> fixed;  // per control point: it is known, by a pin or a zone

  // Integrals of the products of third derivatives: energy[i][k] belongs to i and i - k.
  std::vector<std::array<double, 4>> energy;

  [[nodiscard]] std::size_t size() const { return points.size(); }
};

// The spline on these breakpoints, among them every pin; control points that are not fixed are at
// the origin. Throws std::invalid_argument when a straight zone is no span.
[[nodiscard]] FitSpline spline_on(std::vector<double> breaks, std::span<const Pin> pins,
                                  std::span<const StraightZone> zones);

// The row at u, on the last span from `span` on that does not start after it; `span` moves there.
[[nodiscard]] FitRow row_at(const FitSpline& spline, double u, std::size_t& span);

// The normal equations. Memory is kept from one solution to the next, but not by copies, of which
// none is asked for what the other has solved.
class FitSystem {
 public:
  FitSystem() = default;
  FitSystem(const FitSystem& /*other*/) {}
  FitSystem(FitSystem&&) = default;
  FitSystem& operator=(const FitSystem& /*other*/) { return *this = FitSystem(); }
  FitSystem& operator=(FitSystem&&) = default;
  ~FitSystem() = default;

  // Minimises energy + sum of weight * |curve - target|^2 over the control points `free`.
  // `samples` are those whose rows touch them. Returns false when the system is singular.
  [[nodiscard]] bool solve(const FitSpline& spline, std::span<const SampleState> states,
                           IndexRange samples, IndexRange free);

  // After solve(): the new position of a control point of `free`.
  [[nodiscard]] const Point3& place(std::size_t point) const { return right_[point - offset_]; }

  // After solve(): the inverse, as far as leverage() needs it for rows that start at `first_point`
  // or after it.
  void invert(const FitSpline& spline, std::size_t first_point);

  // After invert(): the compliance of the curve at a sample, how far a unit force moves it.
  [[nodiscard]] double leverage(const FitRow& row) const;

 private:
  void add_sample(const SampleState& state);
  void add_samples(std::span<const SampleState> states);
  [[nodiscard]] bool is_held(const FitSpline& spline, std::size_t point) const {
    return point < free_.begin || point >= free_.end || spline.fixed[point] != 0;
  }

  BandedMatrix matrix_{0};
  BandedMatrix inverse_{0};
  std::vector<Point3> right_;
  std::size_t offset_ = 0;  // control point of the first row
  IndexRange free_;
};

}  // namespace batten::geometry
