// Whether a tolerance is small beside what it is applied to: the part, and the moves of its runs.
#pragma once

#include <cstddef>
#include <optional>
#include <vector>

#include "gcode/interpreter/interpreter.h"
#include "gcode/text/diagnostic.h"
#include "gcode/text/program.h"
#include "geometry/basic/point.h"
#include "postproc/runs/section.h"

namespace batten::postproc {

// Adds up the parts of a program, in order.
class ToleranceScale {
 public:
  explicit ToleranceScale(double tolerance_mm) : tolerance_mm_(tolerance_mm) {}

  // The sections of a part, which cover it.
  void add(const gcode::Program& part, const gcode::Interpretation& read,
           const std::vector<Section>& sections);
  // What was added up elsewhere, with the same tolerance.
  void add(const ToleranceScale& more);

  // Warnings at the first run; none where there is no run, or the tolerance is small:
  // - `tolerance-large` where it is above a hundredth of the part: of the longest side of the box
  //   about its cutting moves;
  // - `tolerance-above-chords` where it is above the median length of the moves in runs.
  [[nodiscard]] gcode::Diagnostics diagnostics() const;

 private:
  void take_point(const geometry::Point3& point);

  double tolerance_mm_;
  bool any_point_ = false;
  geometry::Point3 least_ = geometry::Point3::Zero();  // of the box
  geometry::Point3 greatest_ = geometry::Point3::Zero();
  std::size_t moves_ = 0;  // in runs, of some length
  std::size_t shorter_ = 0;
  std::optional<gcode::SourceSpan> first_run_;  // its first block
};

}  // namespace batten::postproc
