// A small picture of a tool path, some kilobytes whatever the program: for a table of many.
#pragma once

#include <string>

#include "postproc/report/smooth_report.h"

namespace batten::postproc {

// Of a picture kWidth wide and kHeight high, each the text of an SVG path's `d`; empty where there
// is nothing of the kind.
struct PathPicture {
  static constexpr int kWidth = 320;
  static constexpr int kHeight = 240;

  std::string rewritten;
  std::string kept;
};

// The cutting moves of the old program, seen along the axis in which it is smallest. The same
// program and result give the same text.
[[nodiscard]] PathPicture path_picture(const SmoothReport& report);

}  // namespace batten::postproc
