// The control that a command line names.
#pragma once

#include <memory>
#include <string>

#include "postproc/cli/cli_given.h"
#include "postproc/cli/cli_values.h"
#include "postproc/profile/target_profile.h"

namespace batten::postproc {

// By --target NAME, --target FILE.toml, --profile FILE.toml, or --target NAME with --profile
// FILE.toml.
struct GivenTarget {
  const gcode::Dialect* built_in = nullptr;      // of --target NAME
  std::shared_ptr<const TargetProfile> profile;  // of the file
  bool is_wrong = false;                         // and that has been said
};

[[nodiscard]] GivenTarget target_given(const Given& given, Problems& problems);

}  // namespace batten::postproc
