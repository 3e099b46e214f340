// What a run takes in one form or another: four figures, and the one cost that decides between
// forms. The blocks as they are have figures and a cost like any candidate.
// Method: docs/algorithms/choice.md.
#pragma once

#include "postproc/options/options.h"

namespace batten::postproc {

// Seconds, at three settings of the control's feed override.
struct Times {
  double programmed = 0;  // at 100 %
  double at_half = 0;
  double at_one_and_half = 0;

  Times& operator+=(const Times& other) { return add(other, 1); }
  Times& add(const Times& other, double multiple);
};

struct Figures {
  Times times;
  double blocks = 0;
  double bytes = 0;
  double distance = 0;   // mm, rms, from the path that was meant
  double roughness = 0;  // rad/sqrt(mm): root of the sum of the squared turns at joints by length
};

// Parts of what the original has, but where units are given.
struct CostTuning {
  // A distance below this part of the tolerance counts as this one in what is asked of candidates:
  // it is less than what a machine repeats.
  double near = 0.03;
  double no_kinks = 1e-3;  // rad/sqrt(mm): less is as smooth
  double loss = 3;  // a little more size or distance counts so many times what as much less does
  // Where any figure is more than it was, the roughness by so much, losses cost this at least.
  double worse = 0.02;
  double rougher = 1.05;
  // Never slower. The path that was meant is longer than chords inside its bends, by about this.
  double longer = 1e-3;
  double mended = 5e-4;      // of a form with the run where it alone would be slower, at most
  double no_time = 0.01;     // of the original's: a part of a run may take less than nothing of it
  double overridden = 0.02;  // slower at other settings of the override, at most
  // What a gain is, and what makes up for being larger or farther off.
  double clearly_faster = 0.99;
  double clearly_smaller = 0.9;
  double clearly_nearer = 0.7;
  double clearly_smoother = 0.5;
  double half_as_far = 0.5;
};
inline constexpr CostTuning kCost;

// Of the ratios to the original's figures.
struct Weights {
  double time = 0;
  double size = 0;  // blocks and bytes, by halves
  double distance = 0;
  double roughness = 0;
};
[[nodiscard]] Weights weights_of(Prefer prefer);

// The scale by which the forms of one run are measured.
struct CostScale {
  Figures original;
  double alone = 0;    // s, the run from rest to rest, as programmed
  double printed = 0;  // mm, rms, of the rounding of the numbers that are written
  double known = 0;    // mm, rms: the path that was meant is no better known
  double near = 0;     // mm: see CostTuning
  double period = 0;   // s, of the control: what nobody measures
};

// The sum of the weighted ratios, in which losses have a least price. The smaller the better;
// total and transitive as numbers are.
[[nodiscard]] double cost_of(const Figures& figures, const CostScale& scale, Prefer prefer);

// Whether the times are more than a control's period, and what the longer path takes, above those
// before; or too much at another setting of the override.
[[nodiscard]] bool is_slower(const Times& now, const Times& before, double period);

// What speaks against writing a form in place of the original, whatever its cost.
enum class Objection {
  kNone,
  kSlower,
  kLarger,   // without being faster or, for who prefers accuracy, half as far off
  kFarther,  // from the path that was meant, without being faster
  kNoGain,   // no figure is clearly better
};
[[nodiscard]] Objection objection_to(const Figures& figures, const CostScale& scale, Prefer prefer);

// Whether one of the figures is: a gain.
[[nodiscard]] bool is_clearly_better(const Figures& figures, const CostScale& scale);

// Whether any figure is less than the original's.
[[nodiscard]] bool any_gain(const Figures& figures, const CostScale& scale);

}  // namespace batten::postproc
