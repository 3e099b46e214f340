#include "geometry/fitting/naseath/naseath.h"

#include <algorithm>
#include <optional>

#include "geometry/fitting/naseath/naseath_pass.h"
#include "geometry/fitting/naseath/naseath_setting.h"

namespace batten::geometry {

namespace {

bool has_room(const NaseathSetting& setting, const NaseathRoom& room) {
  return *std::max_element(room.per_point.begin(), room.per_point.end()) >= setting.at_tube();
}

bool is_stalled(const NaseathSetting& setting, const std::optional<BestPass>& best, int passes) {
  const int patience = setting.options.repairs.stall_passes;
  return best && patience > 0 && passes - best->last_progress() >= patience;
}

}  // namespace

NaseathResult smooth_naseath(const BsplineCurve& curve, const NaseathOptions& options) {
  const NaseathSetting setting = naseath_setting(curve, options);
  ControlPolygon polygon = setting.original;
  NaseathMover mover(setting);
  std::optional<BestPass> best;
  if (options.repairs.keep_best) best.emplace(setting);
  NaseathResult result{curve, {}, 0, 0, NaseathStop::kTouchesTube, 0};

  while (true) {
    const NaseathRoom room = naseath_room(setting, polygon);
    result.remaining.push_back(room.least);
    if (!has_room(setting, room)) break;
    if (result.passes == options.max_passes) {
      result.stop = NaseathStop::kPassLimit;
      break;
    }
    if (is_stalled(setting, best, result.passes)) {
      result.stop = NaseathStop::kStalled;
      break;
    }
    if (!mover.move(polygon, room)) {
      result.stop = NaseathStop::kNothingToMove;
      break;
    }
    ++result.passes;
    if (best) best->offer(polygon, result.passes);
  }

  result.kept_pass = result.passes;
  if (best) {
    best->confirm();
    polygon = best->polygon();
    result.kept_pass = best->pass();
  }
  result.displacement = naseath_displacement(setting, polygon);
  if (result.kept_pass > 0) result.curve = setting.curve_of(polygon);
  return result;
}

}  // namespace batten::geometry
