#include "geometry/fitting/bspline_fit_weights.h"

#include <algorithm>
#include <cmath>

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

}  // namespace batten::geometry
