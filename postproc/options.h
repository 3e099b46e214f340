// What the user asks for, checked, with units.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "gcode/dialect.h"
#include "gcode/modal_state.h"
#include "postproc/machine/machine.h"

namespace batten::postproc {

enum class Form { kAuto, kArcs, kLines };
enum class Method { kBest, kFair, kNone };
enum class Prefer { kTime, kAccuracy, kSize };

// Decisions of `smooth`, without files and messages.
struct SmoothOptions {
  const gcode::Dialect* target = nullptr;       // required
  const Machine* machine = nullptr;             // required; never null after options are checked
  double tolerance_mm = 0.01;                   // the full distance allowed, both ways, in order
  std::optional<double> tolerance_inch;         // as given, where it was given in inches
  gcode::Units units = gcode::Units::kUnknown;  // --units
  Method method = Method::kBest;
  Form output = Form::kAuto;
  Prefer prefer = Prefer::kTime;
  std::optional<double> keep_corners_deg;  // turns above this stay corners
  std::vector<std::string> allowed;        // --allow
  std::size_t min_motions = 3;
  int threads = 0;  // 0: all cores
};

// Every problem of the options at once, as sentences; empty when they are fine.
[[nodiscard]] std::vector<std::string> problems_of(const SmoothOptions& options);

// How the user's tolerance is shared. smoothing + form + rounding <= tolerance.
struct ToleranceShares {
  double smoothing = 0;  // mm, fair curve to old path
  double form = 0;       // mm, arcs or chords to fair curve
  double rounding = 0;   // mm, printed places to computed ones, in space
};
[[nodiscard]] ToleranceShares share_tolerance(const SmoothOptions& options, gcode::Units units);

}  // namespace batten::postproc
