// A run that is to be smoothed, and what every step of that knows of it.
#pragma once

#include "postproc/options.h"
#include "postproc/runs/section.h"
#include "postproc/smoothing.h"

namespace batten::postproc {

// All must live as long.
struct RunTask {
  const Run& run;
  const RunContext& context;
  const SmoothOptions& options;
  Making making = Making::kToChoose;
};

}  // namespace batten::postproc
