// Values of options: text to numbers and names, with a message for what cannot be read.
#pragma once

#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "gcode/state/modal_state.h"
#include "postproc/options/options.h"
#include "postproc/text/nearest_name.h"

namespace batten::postproc {

// Messages for the user, one per problem.
using Problems = std::vector<std::string>;

struct Tolerance {
  double mm = 0;
  std::optional<double> inch;  // as given, where it was given in inches
};

// "0.01" and "0.01mm" are millimetres, "0.0005in" (or inch) inches. A blank may stand before the
// unit. Whether the size makes sense is not asked here.
[[nodiscard]] std::optional<Tolerance> read_tolerance(std::string_view text, Problems& problems);

// A plain decimal: no exponent, no unit, no blanks.
[[nodiscard]] std::optional<double> read_decimal(std::string_view option, std::string_view text,
                                                 Problems& problems);
[[nodiscard]] std::optional<int> read_integer(std::string_view option, std::string_view text,
                                              Problems& problems);

[[nodiscard]] std::optional<gcode::Units> read_units(std::string_view text, Problems& problems);

// "--output: there is no 'arc'; did you mean arcs? Possible: auto, arcs, lines"
[[nodiscard]] std::string unknown_name(std::string_view option, std::string_view text,
                                       std::span<const std::string_view> names);

template <typename Value>
[[nodiscard]] std::optional<Value> read_choice(std::string_view option, std::string_view text,
                                               std::span<const Choice<Value>> choices,
                                               Problems& problems) {
  std::vector<std::string_view> names;
  for (const auto& choice : choices) {
    if (choice.name == text) return choice.value;
    names.push_back(choice.name);
  }
  problems.push_back(unknown_name(option, text, names));
  return std::nullopt;
}

}  // namespace batten::postproc
