#include "geometry/fitting/bspline_fit_system.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <stdexcept>
#include <utility>

namespace batten::geometry {

namespace {

// A sample's weight starts at this many times the stiffness of its span: close to the
// least-squares curve.
constexpr double kTightStart = 30;

// Scatter is judged over this many neighbours on either side: enough for a standard error of
// a fifth, few enough to follow a change of noise along the path.
constexpr std::size_t kScatterWindow = 10;

// A sample this far above its limit asks for another knot; so does a span whose samples
// scatter this much more than expected (a tight fit leaves about half of the scatter).
constexpr double kTooFar = 1.05;
constexpr double kTooScattered = 1.5;

// Tight weights leave distances that are at most this much greater than heavier ones would.
constexpr double kHopeless = 2.5;

// Whether a distance, over what is wanted, hardly follows its falling weight: the last step went
// less than half of the way.
bool is_numb(double now, double before) { return now < 1 && 1 - now > 0.5 * (1 - before); }

}  // namespace

void start_tight(SampleState& state) {
  state.base = kTightStart * state.stiffness;
  state.push = kWeightFloor * state.stiffness;
  state.rms = 0;
}

void reweight_scatter(std::span<const FitSample> samples, std::span<SampleState> states,
                      std::size_t begin, std::size_t end, ScatterStep step) {
  const double least = step == ScatterStep::kGrow ? 1 : kFall;
  // Squared distances over scatter, in turn, of those that the window of the next sample may hold
  // or lose; none where no scatter is expected.
  constexpr std::size_t kRing = 32;
  static_assert(kRing > 2 * kScatterWindow + 1);
  double squares[kRing];
  const std::size_t offset = begin < kScatterWindow ? 0 : begin - kScatterWindow;
  double sum = 0;  // of those in [first, last[
  int count = 0;
  std::size_t first = offset;
  std::size_t last = first;
  for (std::size_t i = begin; i < end; ++i) {
    for (; last < samples.size() && last <= i + kScatterWindow; ++last) {
      const double scatter = samples[last].scatter;
      if (!(scatter > 0)) continue;
      const double ratio = states[last].distance / scatter;
      squares[last % kRing] = ratio * ratio;
      sum += squares[last % kRing];
      ++count;
    }
    for (; first + kScatterWindow < i; ++first) {
      if (samples[first].scatter > 0) sum -= squares[first % kRing], --count;
    }
    if (!(samples[i].scatter > 0) || count == 0) continue;
    const double rms = std::sqrt(std::max(sum, 0.0) / count);
    SampleState& state = states[i];
    const double factor = is_numb(rms, state.rms) ? rms * rms * rms : rms;
    state.rms = rms;
    const double change = std::clamp(factor, least, kGrowth);
    state.base = bounded_weight(state.base * change, state.stiffness);
    // What a limit needed beside the heavier weight it will be told again if need be.
    if (states[i].distance < samples[i].limit) {
      state.push = bounded_weight(state.push * std::min(change, 1.0), state.stiffness);
    }
  }
}

void press_limit(double ratio, double leverage, double part, SampleState& state) {
  if (!(leverage > 0)) return;
  const double excess = std::min(ratio / kAimInside, kGrowth) - 1;
  state.push = bounded_weight(state.push + part * excess / leverage, state.stiffness);
}

void forget_limit(SampleState& state) { state.push = kWeightFloor * state.stiffness; }

SpanNeed need_of(std::span<const FitSample> samples, std::span<const SampleState> states) {
  double squares = 0;
  double count = 0;
  double worst = 0;
  for (std::size_t i = 0; i < samples.size(); ++i) {
    worst = std::max(worst, states[i].distance / samples[i].limit);
    if (!(samples[i].scatter > 0)) continue;
    const double ratio = states[i].distance / samples[i].scatter;
    squares += ratio * ratio;
    ++count;
  }
  const double scattered = kTooScattered * kTooScattered * count;
  // Samples that have a limit only may be holding the others back, for the moment.
  const bool alike = count == static_cast<double>(samples.size());
  return {worst, worst > kTooFar || squares > scattered,
          worst > kHopeless || (alike && squares > kHopeless * kHopeless * scattered)};
}

namespace {

constexpr std::size_t kSplineDegree = 3;

// Knots, and the control point at each pin: the one whose Greville abscissa is the pin.
std::vector<std::size_t> make_knots(FitSpline& spline, std::span<const Pin> pins) {
  std::vector<std::size_t> points;
  std::vector<double>& knots = spline.knots;
  knots.reserve(spline.breaks.size() + 2 * pins.size() + 2);
  for (const double u : spline.breaks) {
    std::size_t copies = 1;
    const std::size_t pin = points.size();
    if (pin < pins.size() && u == pins[pin].parameter) {
      const bool end = pin == 0 || pin + 1 == pins.size();
      copies = end ? kSplineDegree + 1 : kSplineDegree;
      points.push_back(knots.empty() ? 0 : knots.size() - 1);
    }
    knots.insert(knots.end(), copies, u);
  }
  if (points.size() != pins.size()) {
    throw std::invalid_argument("fit_bspline: a pin is no breakpoint");
  }
  return points;
}

// A cubic span whose four control points lie on a line at their Greville abscissas is that line.
void fix_zones(FitSpline& spline, std::span<const StraightZone> zones) {
  const std::vector<double>& t = spline.knots;
  for (const StraightZone& zone : zones) {
    const auto after = std::upper_bound(t.begin(), t.end(), zone.from);
    const auto span = static_cast<std::size_t>(after - t.begin()) - 1;
    if (after == t.begin() || after == t.end() || t[span] != zone.from || *after != zone.to) {
      throw std::invalid_argument("fit_bspline: a straight zone is no span");
    }
    const Vector3 per_unit = (zone.end - zone.start) / (zone.to - zone.from);
    for (std::size_t i = span - kSplineDegree; i <= span; ++i) {
      const double greville = (t[i + 1] + t[i + 2] + t[i + 3]) / 3;
      spline.points[i] = zone.start + (greville - zone.from) * per_unit;
      spline.fixed[i] = 1;
    }
  }
}

// The third derivative is constant on a span: differences of differences of the control points.
std::array<double, 4> third_derivatives(const double* t) {
  // t points to the last knot of the span's start.
  const double last = 1 / (t[1] - t[0]);
  const double b0 = 2 / (t[1] - t[-1]);
  const double b1 = 2 / (t[2] - t[0]);
  const double d0 = last * b0 * 3 / (t[1] - t[-2]);
  const double d1 = -last * (b0 + b1) * 3 / (t[2] - t[-1]);
  const double d2 = last * b1 * 3 / (t[3] - t[0]);
  return {-d0, d0 - d1, d1 - d2, d2};
}

void make_energy(FitSpline& spline) {
  const std::vector<double>& t = spline.knots;
  spline.energy.assign(spline.size(), {});
  for (std::size_t span = kSplineDegree; span < spline.size(); ++span) {
    const double width = t[span + 1] - t[span];
    if (!(width > 0)) continue;
    const std::array<double, 4> third = third_derivatives(&t[span]);
    for (std::size_t j = 0; j < 4; ++j) {
      std::array<double, 4>& row = spline.energy[span - kSplineDegree + j];
      for (std::size_t k = 0; k <= j; ++k) row[j - k] += width * third[j] * third[k];
    }
  }
}

constexpr std::size_t kBands = BandedMatrix::kBands;

// What the samples of one span add to the equations of its four control points.
struct SpanSums {
  double product[4][4];  // column, row; the lower half and the diagonal
  double force[3][4];    // axis, row
};

// Two numbers that processors add and multiply at a time.
using Pair = double __attribute__((vector_size(16)));

Pair pair_at(const double* at) { return Pair{at[0], at[1]}; }

void put(const Pair& pair, double* to) { std::memcpy(to, &pair, sizeof pair); }

Pair twice(double value) { return Pair{value, value}; }

SpanSums sums_of(std::span<const FitRow> rows, std::span<const SampleState> states) {
  const Pair zero = twice(0);
  // Columns of the products, each of rows 0 and 1 and of rows 2 and 3.
  Pair p0low = zero, p0high = zero, p1low = zero, p1high = zero, p2high = zero, p3high = zero;
  Pair xlow = zero, xhigh = zero, ylow = zero, yhigh = zero, zlow = zero, zhigh = zero;
  for (std::size_t i = 0; i < rows.size(); ++i) {
    const Pair weight = twice(states[i].base + states[i].push);
    const Pair low = pair_at(&rows[i].value[0]);
    const Pair high = pair_at(&rows[i].value[2]);
    const Pair wlow = weight * low;
    const Pair whigh = weight * high;
    p0low += twice(wlow[0]) * low;
    p0high += twice(wlow[0]) * high;
    p1low += twice(wlow[1]) * low;
    p1high += twice(wlow[1]) * high;
    p2high += twice(whigh[0]) * high;
    p3high += twice(whigh[1]) * high;
    const Point3& target = states[i].target;
    xlow += wlow * twice(target.x());
    xhigh += whigh * twice(target.x());
    ylow += wlow * twice(target.y());
    yhigh += whigh * twice(target.y());
    zlow += wlow * twice(target.z());
    zhigh += whigh * twice(target.z());
  }
  SpanSums sums;
  put(p0low, &sums.product[0][0]);
  put(p0high, &sums.product[0][2]);
  put(p1low, &sums.product[1][0]);
  put(p1high, &sums.product[1][2]);
  put(p2high, &sums.product[2][2]);
  put(p3high, &sums.product[3][2]);
  put(xlow, &sums.force[0][0]);
  put(xhigh, &sums.force[0][2]);
  put(ylow, &sums.force[1][0]);
  put(yhigh, &sums.force[1][2]);
  put(zlow, &sums.force[2][0]);
  put(zhigh, &sums.force[2][2]);
  return sums;
}

// The two numbers the other way round.
Pair swapped(const Pair& pair) { return Pair{pair[1], pair[0]}; }

void add_to(double* at, const Pair& pair) { put(pair_at(at) + pair, at); }

}  // namespace

FitSpline spline_on(std::vector<double> breaks, std::span<const Pin> pins,
                    std::span<const StraightZone> zones) {
  FitSpline spline;
  spline.breaks = std::move(breaks);
  const std::vector<std::size_t> pinned = make_knots(spline, pins);
  const std::size_t size = spline.knots.size() - kSplineDegree - 1;
  spline.points.assign(size, Point3::Zero());
  spline.fixed.assign(size, 0);
  fix_zones(spline, zones);
  for (std::size_t i = 0; i < pins.size(); ++i) {
    spline.points[pinned[i]] = pins[i].place;
    spline.fixed[pinned[i]] = 1;
  }
  make_energy(spline);
  return spline;
}

std::vector<std::size_t> carry_points(const FitSpline& before, FitSpline& after) {
  constexpr std::ptrdiff_t kSupport = kSplineDegree + 2;  // knots of one control point
  std::vector<std::size_t> now_at(before.size(), kNotCarried);
  std::size_t j = 0;
  for (std::size_t i = 0; i < before.size() && j < after.size(); ++i) {
    const auto old_knots = before.knots.begin() + static_cast<std::ptrdiff_t>(i);
    const auto new_knots = [&] { return after.knots.begin() + static_cast<std::ptrdiff_t>(j); };
    while (j < after.size() && std::lexicographical_compare(new_knots(), new_knots() + kSupport,
                                                            old_knots, old_knots + kSupport)) {
      ++j;
    }
    if (j == after.size()) break;
    if (!std::equal(old_knots, old_knots + kSupport, new_knots())) continue;
    if (before.fixed[i] != after.fixed[j]) continue;
    if (after.fixed[j] != 0 && before.points[i] != after.points[j]) continue;
    after.points[j] = before.points[i];
    now_at[i] = j;
  }
  return now_at;
}

FitRow row_at(const FitSpline& spline, double u, std::size_t& span) {
  const std::vector<double>& knots = spline.knots;
  while (span + 1 < spline.size() && knots[span + 1] <= u) ++span;
  FitRow row;
  row.first = span - kSplineDegree;
  // Piegl and Tiller, The NURBS Book, algorithm A2.2, written out for degree 3.
  const double* t = &knots[span];
  const double left1 = u - t[0];
  const double left2 = u - t[-1];
  const double left3 = u - t[-2];
  const double right1 = t[1] - u;
  const double right2 = t[2] - u;
  const double right3 = t[3] - u;
  const double one = 1 / (right1 + left1);
  const double a0 = right1 * one;
  const double a1 = left1 * one;
  const double part0 = a0 / (right1 + left2);
  const double part1 = a1 / (right2 + left1);
  const double b0 = right1 * part0;
  const double b1 = left2 * part0 + right2 * part1;
  const double b2 = left1 * part1;
  const double third0 = b0 / (right1 + left3);
  const double third1 = b1 / (right2 + left2);
  const double third2 = b2 / (right3 + left1);
  row.value = {right1 * third0, left3 * third0 + right2 * third1, left2 * third1 + right3 * third2,
               left1 * third2};
  return row;
}

bool FitSystem::solve(const FitSpline& spline, std::span<const FitRow> rows,
                      std::span<const SampleState> states, IndexRange samples, IndexRange free) {
  free_ = free;
  offset_ = free.begin < kBands ? 0 : free.begin - kBands;
  const std::size_t end = std::min(free.end + kBands, spline.size());
  matrix_.set_rows({&spline.energy[offset_], end - offset_});
  right_.assign(end - offset_, Point3::Zero());
  add_samples(rows, states, samples);
  for (std::size_t i = offset_; i < end; ++i) {
    if (is_held(spline, i)) matrix_.fix(i - offset_, spline.points[i], right_);
  }
  return matrix_.solve(right_);
}

// Samples of one span share their control points: they are summed up before they are added.
void FitSystem::add_samples(std::span<const FitRow> rows, std::span<const SampleState> states,
                            IndexRange samples) {
  for (std::size_t i = samples.begin; i < samples.end;) {
    const std::size_t first = rows[i].first;
    const std::size_t begin = i;
    while (i < samples.end && rows[i].first == first) ++i;
    if (i == begin + 1) {
      add_sample(rows[begin], states[begin]);
      continue;
    }
    const SpanSums sums = sums_of(rows.subspan(begin, i - begin), states.subspan(begin, i - begin));
    const std::size_t row = first - offset_;
#pragma GCC unroll 4
    for (std::size_t j = 0; j < 4; ++j) {
#pragma GCC unroll 4
      for (std::size_t k = 0; k <= j; ++k) {
        matrix_.at(row + j, static_cast<int>(j - k)) += sums.product[k][j];
      }
      Point3& force = right_[row + j];
      force.x() += sums.force[0][j];
      force.y() += sums.force[1][j];
      force.z() += sums.force[2][j];
    }
  }
}

// The same numbers as those of a span with one sample, without the sums: where every vertex has its
// own knot, most are.
void FitSystem::add_sample(const FitRow& row, const SampleState& state) {
  const std::size_t first = row.first - offset_;
  const Pair weight = twice(state.base + state.push);
  const Pair low = weight * pair_at(&row.value[0]);
  const Pair high = weight * pair_at(&row.value[2]);
  double* const band = &matrix_.at(first, 0);
  const auto row_of = [band](std::size_t j) { return band + j * (BandedMatrix::kBands + 1); };
  row_of(0)[0] += low[0] * row.value[0];
  add_to(row_of(1), swapped(low) * twice(row.value[1]));
  add_to(row_of(2), Pair{high[0], low[1]} * twice(row.value[2]));
  row_of(2)[2] += low[0] * row.value[2];
  add_to(row_of(3), swapped(high) * twice(row.value[3]));
  add_to(row_of(3) + 2, swapped(low) * twice(row.value[3]));
  const Pair target = pair_at(state.target.data());
  const double height = state.target.z();
  const auto pull = [&](std::size_t j, double weighted) {
    double* const force = right_[first + j].data();
    add_to(force, twice(weighted) * target);
    force[2] += weighted * height;
  };
  pull(0, low[0]);
  pull(1, low[1]);
  pull(2, high[0]);
  pull(3, high[1]);
}

void FitSystem::invert(const FitSpline& spline, std::size_t first_point) {
  const std::size_t first = std::max(first_point, offset_) - offset_;
  matrix_.inverse_band(inverse_, first);
  // Held control points do not move: their unit rows stand for no compliance.
  for (std::size_t i = first; i < inverse_.size(); ++i) {
    if (is_held(spline, offset_ + i)) inverse_.at(i, 0) = 0;
  }
}

double FitSystem::leverage(const FitRow& row) const {
  const std::size_t first = row.first - offset_;
  double sum = 0;
  for (std::size_t j = 0; j < 4; ++j) {
    sum += row.value[j] * row.value[j] * inverse_.at(first + j, 0);
    for (std::size_t k = 0; k < j; ++k) {
      sum += 2 * row.value[j] * row.value[k] * inverse_.at(first + j, static_cast<int>(j - k));
    }
  }
  return sum;
}

}  // namespace batten::geometry
