// The options of `smooth`, which `batch` and in part `verify` have, too.
#pragma once

#include "geometry/basic/tolerance_kind.h"
#include "postproc/cli/cli_given.h"
#include "postproc/cli/cli_values.h"
#include "postproc/commands/commands.h"

namespace batten::postproc {

// Fills the command's options, its machine and its profile.
void read_smooth_options(const Given& given, SmoothCommand& command, Problems& problems);

void read_tolerance_kind_into(geometry::ToleranceKind& kind, const Given& given,
                              Problems& problems);
void read_side_into(geometry::Side& side, const Given& given, Problems& problems);

// What was missing or unreadable has been said; the check of the options would say it again.
void check_options(const SmoothOptions& options, const Given& given, Problems& problems);

}  // namespace batten::postproc
