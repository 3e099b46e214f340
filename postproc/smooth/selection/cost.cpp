#include "postproc/smooth/selection/cost.h"

#include <algorithm>
#include <cmath>

namespace batten::postproc {

Times& Times::add(const Times& other, double multiple) {
  programmed += multiple * other.programmed;
  at_half += multiple * other.at_half;
  at_one_and_half += multiple * other.at_one_and_half;
  return *this;
}

Weights weights_of(Prefer prefer) {
  switch (prefer) {
    case Prefer::kTime:
      return {.time = 1, .size = 0.01, .distance = 0.01, .roughness = 0.003};
    case Prefer::kAccuracy:
      return {.time = 0.1, .size = 0.03, .distance = 1, .roughness = 0.005};
    case Prefer::kSize:
      return {.time = 0.05, .size = 1, .distance = 0.015, .roughness = 0.005};
  }
  return {};
}

namespace {

double size_of(const Figures& figures, const Figures& original) {
  return 0.5 * (figures.blocks / original.blocks + figures.bytes / original.bytes);
}

// Of a part of a longer run the times are differences, which may be nothing or less.
double time_of(const Figures& figures, const CostScale& scale) {
  if (!(scale.alone > 0)) return 1;
  return 1 + (figures.times.programmed - scale.original.times.programmed) / scale.alone;
}

// What is longer than chords inside its bends by as much as the path that was meant is no slower.
// Of what is faster a hundredth less counts alike, however slow the original is.
double counted_time(double ratio) {
  if (ratio > 1) return std::max(1.0, ratio - kCost.longer);
  return 1 + std::log(std::max(ratio, kCost.no_time));
}

// What is more than it was counts more than a gain does, since who loses it has not asked for a
// change; but a run of ten blocks may become one of a hundred, so that it has an end.
double lost(double ratio, double loss = kCost.loss) {
  return ratio > 1 ? loss * (1 - 1 / ratio) : 0;
}

double distance_before(const CostScale& scale) {
  return std::max(scale.original.distance, scale.near);
}

}  // namespace

double cost_of(const Figures& figures, const CostScale& scale, Prefer prefer) {
  const Weights weights = weights_of(prefer);
  const double distance =
      std::max({figures.distance, scale.printed, scale.known}) / distance_before(scale);
  const double roughness = std::max(figures.roughness, kCost.no_kinks) /
                           std::max(scale.original.roughness, kCost.no_kinks);
  const double size = size_of(figures, scale.original);
  const bool is_worse =
      figures.blocks > scale.original.blocks || distance > 1 || roughness > kCost.rougher;
  const double losses = weights.size * lost(size) + weights.distance * lost(distance) +
                        weights.roughness * lost(roughness, 1);
  return weights.time * counted_time(time_of(figures, scale)) + weights.size * std::min(size, 1.0) +
         weights.distance * std::min(distance, 1.0) + weights.roughness * std::min(roughness, 1.0) +
         (is_worse ? std::max(losses, kCost.worse) : losses);
}

bool is_slower(const Times& now, const Times& before, double period) {
  const auto is_above = [&](double a, double b, double part) {
    return a > b + std::max(period, part * b);
  };
  return is_above(now.programmed, before.programmed, kCost.longer) ||
         is_above(now.at_half, before.at_half, kCost.overridden) ||
         is_above(now.at_one_and_half, before.at_one_and_half, kCost.overridden);
}

Objection objection_to(const Figures& figures, const CostScale& scale, Prefer prefer) {
  const Figures& old = scale.original;
  if (is_slower(figures.times, old.times, scale.period)) return Objection::kSlower;
  const bool faster = time_of(figures, scale) <= kCost.clearly_faster;
  const double before = distance_before(scale);
  const bool half_as_far = figures.distance <= kCost.half_as_far * before;
  const bool more_blocks = figures.blocks > old.blocks;
  const bool more_bytes = figures.bytes > old.bytes;
  const bool pays_blocks = faster || (half_as_far && prefer == Prefer::kAccuracy);
  const bool pays_bytes = faster || half_as_far;
  const bool is_size = prefer == Prefer::kSize;
  if (more_blocks && (is_size || !pays_blocks)) return Objection::kLarger;
  if (more_bytes && (is_size || !pays_bytes)) return Objection::kLarger;
  if (figures.distance > before && !faster && !is_size) return Objection::kFarther;
  return is_clearly_better(figures, scale) ? Objection::kNone : Objection::kNoGain;
}

bool is_clearly_better(const Figures& figures, const CostScale& scale) {
  const Figures& old = scale.original;
  const bool faster = time_of(figures, scale) <= kCost.clearly_faster;
  const bool smaller = figures.blocks <= kCost.clearly_smaller * old.blocks ||
                       figures.bytes <= kCost.clearly_smaller * old.bytes;
  const bool nearer = figures.distance <= kCost.clearly_nearer * distance_before(scale);
  const bool smoother =
      std::max(figures.roughness, kCost.no_kinks) <= kCost.clearly_smoother * old.roughness;
  return faster || smaller || nearer || smoother;
}

bool any_gain(const Figures& figures, const CostScale& scale) {
  const Figures& old = scale.original;
  return figures.times.programmed < old.times.programmed - scale.period ||
         figures.blocks < old.blocks || figures.bytes < old.bytes ||
         std::max(figures.distance, scale.near) < old.distance ||
         std::max(figures.roughness, kCost.no_kinks) < old.roughness;
}

}  // namespace batten::postproc
