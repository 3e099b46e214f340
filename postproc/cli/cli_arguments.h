// What the commands' arguments have in common. Each adds to `problems` what is wrong and leaves its
// place as it was.
#pragma once

#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "gcode/control/control.h"
#include "gcode/reading/source_kind.h"
#include "gcode/state/modal_state.h"
#include "postproc/cli/cli_given.h"
#include "postproc/cli/cli_values.h"
#include "postproc/machine/machine.h"
#include "postproc/options/options.h"
#include "postproc/profile/target_profile.h"

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
[[nodiscard]] const gcode::Control* built_in_target(std::string_view option,
                                                    const std::string& name, Problems& problems);

// The machine that the options of a command name; the same options for every command.

// --machine, or the built-in machine `otherwise` (may be empty) when that is not given, with what
// --grbl-settings says. Null when there is none, and when something was wrong, which `problems`
// tell then.
[[nodiscard]] std::shared_ptr<const Machine> machine_given(const Given& given,
                                                           std::string_view otherwise,
                                                           Problems& problems);

// The control that a command line names.

// By --target NAME, --target FILE.toml, --profile FILE.toml, or --target NAME with --profile
// FILE.toml.
struct GivenTarget {
  const gcode::Control* built_in = nullptr;      // of --target NAME
  std::shared_ptr<const TargetProfile> profile;  // of the file
  bool is_wrong = false;                         // and that has been said
};

[[nodiscard]] GivenTarget target_given(const Given& given, Problems& problems);

}  // namespace batten::postproc
