#include "postproc/runs/tolerance_scale.h"

#include <fmt/format.h>

#include <string>
#include <utility>
#include <variant>

#include "gcode/state/motion.h"
#include "geometry/path/path.h"

namespace batten::postproc {
namespace {

constexpr double kLargestPart = 0.01;  // of the part

// An arc reaches beyond its ends. A box of these points is too small by a third at most.
constexpr double kPlaces[] = {0, 0.25, 0.5, 0.75, 1};

}  // namespace

void ToleranceScale::take_point(const geometry::Point3& point) {
  least_ = any_point_ ? geometry::Point3(least_.cwiseMin(point)) : point;
  greatest_ = any_point_ ? geometry::Point3(greatest_.cwiseMax(point)) : point;
  any_point_ = true;
}

void ToleranceScale::add(const gcode::Program& part, const gcode::Interpretation& read,
                         const std::vector<Section>& sections) {
  for (const Section& section : sections) {
    const Run* run = std::get_if<Run>(&section.content);
    if (run != nullptr && !first_run_) first_run_ = part.blocks[section.first_block].span;
    for (std::uint32_t i = section.first_block; i <= section.last_block; ++i) {
      double length = 0;
      for (const gcode::Motion& motion : gcode::motions_of(read, i)) {
        const bool cuts = motion.kind != gcode::MotionKind::kRapid;
        if (!cuts || !motion.start_known || !motion.end_known) continue;
        const bool straight = motion.kind == gcode::MotionKind::kLine;
        if (straight) {
          take_point(motion.piece.start());
          take_point(motion.piece.end());
        } else {
          for (const double t : kPlaces) take_point(geometry::point_at(motion.piece, t));
        }
        if (run == nullptr) continue;
        length += straight ? (motion.piece.end() - motion.piece.start()).norm()
                           : geometry::length_of(motion.piece);
      }
      if (!(length > 0)) continue;
      ++moves_;
      if (length < tolerance_of(*run, tolerance_mm_)) ++shorter_;
    }
  }
}

void ToleranceScale::add(const ToleranceScale& more) {
  if (more.any_point_) {
    take_point(more.least_);
    take_point(more.greatest_);
  }
  moves_ += more.moves_;
  shorter_ += more.shorter_;
  if (!first_run_) first_run_ = more.first_run_;
}

gcode::Diagnostics ToleranceScale::diagnostics() const {
  gcode::Diagnostics found;
  if (!first_run_) return found;
  const geometry::Vector3 box = greatest_ - least_;
  const auto warn = [&](const char* id, std::string message) {
    found.push_back({gcode::Severity::kWarning, id, *first_run_, std::move(message)});
  };
  if (tolerance_mm_ > kLargestPart * box.maxCoeff()) {
    warn("tolerance-large",
         fmt::format("the tolerance of {:g} mm is above a hundredth of the part, whose cutting "
                     "moves span {:.3f} x {:.3f} x {:.3f} mm: its form may be lost; --tolerance is "
                     "in mm, or in inches with `in` behind the number",
                     tolerance_mm_, box.x(), box.y(), box.z()));
  }
  if (2 * shorter_ > moves_) {
    warn("tolerance-above-chords",
         fmt::format("{} of the {} moves in runs are shorter than the tolerance of {:g} mm: what "
                     "is as small as they are may be smoothed away; a smaller --tolerance keeps it",
                     shorter_, moves_, tolerance_mm_));
  }
  return found;
}

}  // namespace batten::postproc
