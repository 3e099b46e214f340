// The path that was meant, as far as it is known, and how far moves are from it.
// Method: docs/algorithms/choice.md.
#pragma once

#include <span>
#include <utility>
#include <vector>

#include "geometry/fitting/fair/fair.h"
#include "postproc/runs/section.h"
#include "postproc/smooth/forms/output_plan.h"

namespace batten::postproc {

// How many moves are looked at of a run that has more, and where on each.
struct MeantPathTuning {
  std::size_t moves = 3000;
  int steps = 3;  // of Newton's method from about the right parameter
};
inline constexpr MeantPathTuning kMeantPath;

class MeantPath {
 public:
  using Moves = std::vector<PlannedMove>;

  // The fair curve of a run passes the vertices as near as their decimals and their noise tell.
  // `shape`: moves that are known to be what was meant (line_arcs.h), along all of the curve.
  explicit MeantPath(const geometry::SmoothCurve& fair, Moves shape = {})
      : fair_(fair), shape_(std::move(shape)) {}

  [[nodiscard]] const geometry::SmoothCurve& fair() const { return fair_; }

  // mm, rms along the path, of the run's chords and of moves that were planned along a curve
  // of the same run. Deterministic, linear in the moves up to a number of them.
  [[nodiscard]] double distance_of(const Run& run) const;
  [[nodiscard]] double distance_of(std::span<const PlannedMove> moves,
                                   const geometry::SmoothCurve& along) const;

 private:
  template <typename Visit>
  [[nodiscard]] double rms_of(Visit visit) const;

  const geometry::SmoothCurve& fair_;
  Moves shape_;
};

// rad/sqrt(mm), see Figures; 0 for moves of no length.
[[nodiscard]] double roughness_of(std::span<const TimedPiece> moves);

}  // namespace batten::postproc
