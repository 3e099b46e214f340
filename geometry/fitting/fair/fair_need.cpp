#include "geometry/fitting/fair/fair_need.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <utility>
#include <vector>

namespace batten::geometry {

namespace {

// Rounds of widening for the machine's need, what one widens by, and the least part of a
// stretch's time that a round must win there to be kept.
constexpr int kRounds = 3;
constexpr double kWiden = 4;
constexpr double kWorthIt = 0.002;

// A stretch reaches so many vertices beyond those that were widened: the curve moves there too.
constexpr std::size_t kBeside = 16;

// The vertices beside which the curve is too tight for the feed, and three on either side of them.
std::vector<bool> tight_vertices(const BandFit& fit) {
  const std::size_t n = fit.points().size();
  std::vector<bool> tight(n, false);
  for (std::size_t i = 1; i + 1 < n; ++i) {
    if (fit.features().kinds[i] != VertexKind::kSmooth || !fit.is_tight(i)) continue;
    constexpr std::size_t kAround = 3;
    const std::size_t last = std::min(i + kAround, n - 1);
    for (std::size_t j = i < kAround ? 0 : i - kAround; j <= last; ++j) tight[j] = true;
  }
  return tight;
}

// More scatter for vertices where the curve is too tight for the feed, beyond what was tried
// before; nothing when there are none that could still be given more.
std::optional<std::vector<double>> widened(const BandFit& fit, const FairOptions& options,
                                           std::vector<double>& tried) {
  const std::vector<bool> tight = tight_vertices(fit);
  std::vector<double> loosen = fit.loosened();
  bool any = false;
  for (std::size_t i = 0; i < tight.size(); ++i) {
    if (!tight[i] || std::isinf(tried[i])) continue;
    tried[i] *= kWiden;
    const double scatter = std::max(fit.features().noise[i], options.rounding) * tried[i];
    if (scatter > 0.5 * options.tolerance) tried[i] = std::numeric_limits<double>::infinity();
    loosen[i] = tried[i];
    any = true;
  }
  if (!any) return std::nullopt;
  return loosen;
}

// Stretches of vertices in which one fit was told something else than the other, and some
// vertices around.
std::vector<IndexRange> stretches_apart(const BandFit& before, const BandFit& after) {
  const std::size_t n = before.points().size();
  std::vector<IndexRange> stretches;
  for (std::size_t i = 0; i < n; ++i) {
    if (before.loosened()[i] == after.loosened()[i] &&
        before.features().kinds[i] == after.features().kinds[i]) {
      continue;
    }
    const IndexRange around{i < kBeside ? 0 : i - kBeside, std::min(i + kBeside + 1, n)};
    if (!stretches.empty() && around.begin <= stretches.back().end) {
      stretches.back().end = around.end;
    } else {
      stretches.push_back(around);
    }
  }
  return stretches;
}

// A curve that had to keep edges as they were is not smoother, whatever its time says.
bool is_worth_it(const BandFit& before, const BandFit& after, IndexRange stretch,
                 double tolerance) {
  for (std::size_t i = stretch.begin; i < stretch.end; ++i) {
    if (before.features().kinds[i] != after.features().kinds[i]) return false;
    if (i + 1 == stretch.end) break;
    if (after.deviations()[i] > tolerance) return false;
  }
  return after.time_beside(stretch) <= (1 - kWorthIt) * before.time_beside(stretch);
}

bool is_inside(const BandFit& fit, double tolerance) {
  return std::ranges::all_of(fit.deviations(), [&](double off) { return off <= tolerance; });
}

}  // namespace

int widen_for_feed(BandFit& fit, const FairOptions& options) {
  std::vector<double> tried(fit.points().size(), 1);
  int rounds = 0;
  for (int round = 0; round < kRounds; ++round) {
    auto loosen = widened(fit, options, tried);
    if (!loosen) break;
    BandFit next = fit;
    next.loosen(std::move(*loosen));
    const std::vector<IndexRange> stretches = stretches_apart(fit, next);
    std::vector<IndexRange> in_vain;
    for (const IndexRange& stretch : stretches) {
      if (!is_worth_it(fit, next, stretch, options.tolerance)) in_vain.push_back(stretch);
    }
    if (in_vain.size() == stretches.size()) continue;
    if (!in_vain.empty()) next.take_back(fit, in_vain);
    if (!is_inside(next, options.tolerance)) break;
    fit = std::move(next);
    ++rounds;
  }
  return rounds;
}

}  // namespace batten::geometry
