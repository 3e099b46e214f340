// What the commands' arguments have in common. Each adds to `problems` what is wrong and leaves its
// place as it was.
#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "gcode/control/dialect.h"
#include "gcode/reading/source_kind.h"
#include "gcode/state/modal_state.h"
#include "postproc/cli/cli_given.h"
#include "postproc/cli/cli_values.h"
#include "postproc/options/log_level.h"

namespace batten::postproc {

// Exactly as many as are expected; "-" at most once.
void check_files(const std::vector<std::string>& files,
                 const std::vector<std::string_view>& expected, Problems& problems);

// Nothing where there are fewer.
[[nodiscard]] std::string file_at(const std::vector<std::string>& files, std::size_t index);

// A report must not land on a program.
void check_report(const std::string& file, const std::vector<std::string>& programs,
                  Problems& problems, std::string_view option = "json");

template <typename Value>
void read_into(Value& place, std::optional<Value> value) {
  if (value) place = *value;
}

void read_units_into(gcode::Units& units, const Given& given, Problems& problems);

void read_source_into(gcode::SourceKind& source, const Given& given, Problems& problems);
void read_decimals_into(std::optional<gcode::Decimals>& decimals, const Given& given,
                        Problems& problems);

// --quiet, --log-level
[[nodiscard]] LogLevel read_log_level(const Given& given, Problems& problems);

[[nodiscard]] std::vector<std::string_view> target_names();

// Adds a problem where there is none of that name.
[[nodiscard]] const gcode::Dialect* built_in_target(std::string_view option,
                                                    const std::string& name, Problems& problems);

}  // namespace batten::postproc
