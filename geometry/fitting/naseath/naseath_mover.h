// One pass of Naseath's smoother: sizes the moves and makes them. (Naseath 2007,
// chapter 3; docs/algorithms/naseath.md, steps 4 and 5.)
#pragma once

#include <optional>
#include <vector>

#include "geometry/fitting/naseath/naseath_categories.h"
#include "geometry/fitting/naseath/naseath_choice.h"
#include "geometry/fitting/naseath/naseath_setting.h"

namespace batten::geometry {

class NaseathMover {
 public:
  // Measures the first sensitivities with a mock move by the radius. `setting` must outlive it.
  explicit NaseathMover(const NaseathSetting& setting);

  // Moves the points inside the room given. False when none has anywhere to go.
  bool move(ControlPolygon& polygon, const NaseathRoom& room);

 private:
  [[nodiscard]] std::vector<double> sizes_of(const ControlPolygon& polygon,
                                             const NaseathCategories& categories,
                                             const std::vector<Vector3>& directions,
                                             const NaseathRoom& room) const;
  void take_back(ControlPolygon& polygon, const ControlPolygon& before);
  void measure(const std::vector<Vector3>& directions, const std::vector<double>& sizes);

  const NaseathSetting& setting_;
  std::optional<CurvatureGuard> guard_;
  std::vector<double> sensitivities_;
  std::vector<double> parts_;  // of each point's move: halved each time one was taken back
};

}  // namespace batten::geometry
