#include "postproc/convert/portable_motions.h"

#include <cmath>

#include "gcode/state/modal_state.h"

namespace batten::postproc {
namespace {

using gcode::MotionKind;

// mm: an arc that rises by more is a helix.
constexpr double kLevelArc = 1e-9;

bool rises(const geometry::Arc& arc) {
  return std::abs(arc.axis.dot(arc.end - arc.start)) > kLevelArc;
}

}  // namespace

std::string_view why_no_certain_motion(const gcode::Motion& motion, const gcode::ModalState& state,
                                       gcode::Language language) {
  if (state.distance == gcode::DistanceMode::kIncremental) return "is an increment";
  if (!path_alone_counts(state)) return "moves in a state in which its words are not the path";
  const bool arc = motion.kind == MotionKind::kArc;
  if (!motion.end_known || (arc && !motion.start_known)) {
    return "moves from a place that is not known";
  }
  if (motion.kind == MotionKind::kCurve) return "is a curve";
  if (motion.kind != MotionKind::kRapid && !state.feed) return "moves at a feed that is not known";
  if (arc && language == gcode::Language::kSiemens && rises(*motion.piece.arc())) {
    return "is a helix";
  }
  return {};
}

}  // namespace batten::postproc
