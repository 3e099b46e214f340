// The reports of `batten explore`, for people and for programs; docs/exploring.md has their fields.
#pragma once

#include <string>
#include <vector>

#include "gcode/text/source_text.h"
#include "postproc/stream/explore.h"

namespace batten::postproc {

struct ExploreReport {
  const gcode::SourceText& source;
  const Exploration& found;                      // understood
  const std::string& input;                      // as the user gave it
  const std::vector<std::string>& more_options;  // of `smooth`, beside those that are explored
};

// A table of all settings, one of feeds, and in one sentence what is recommended, with its command.
[[nodiscard]] std::string explore_text(const ExploreReport& report);
[[nodiscard]] std::string explore_json(const ExploreReport& report);

}  // namespace batten::postproc
