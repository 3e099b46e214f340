// What the reports of `batten smooth` tell about: the result, what was asked for, and the files.
#pragma once

#include <string>

#include "gcode/text/source_text.h"
#include "postproc/options/options.h"
#include "postproc/stream/smooth_result.h"

namespace batten::postproc {

struct SmoothReport {
  const gcode::SourceText& source;  // its name stands for the input file
  const SmoothOptions& options;
  const SmoothResult& result;
  std::string output_file;  // as the user knows it; empty: nothing is written
  bool strict = false;
};

}  // namespace batten::postproc
