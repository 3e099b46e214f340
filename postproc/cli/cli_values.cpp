#include "postproc/cli/cli_values.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <array>
#include <charconv>

#include "gcode/state/modal_state.h"

namespace batten::postproc {

namespace {

std::string_view without_blanks_around(std::string_view text) {
  while (!text.empty() && text.front() == ' ') text.remove_prefix(1);
  while (!text.empty() && text.back() == ' ') text.remove_suffix(1);
  return text;
}

bool take_suffix(std::string_view& text, std::string_view suffix) {
  if (!text.ends_with(suffix)) return false;
  text.remove_suffix(suffix.size());
  text = without_blanks_around(text);
  return true;
}

std::optional<double> decimal(std::string_view text) {
  if (text.starts_with('+')) text.remove_prefix(1);  // from_chars takes none
  if (text.starts_with('+') || text.empty()) return std::nullopt;
  double value = 0;
  const auto [end, error] =
      std::from_chars(text.data(), text.data() + text.size(), value, std::chars_format::fixed);
  if (error != std::errc{} || end != text.data() + text.size()) return std::nullopt;
  // from_chars reads "inf" and "nan" too.
  const char last = text.back();
  if (last != '.' && (last < '0' || last > '9')) return std::nullopt;
  return value;
}

}  // namespace

std::optional<Tolerance> read_tolerance(std::string_view text, Problems& problems) {
  std::string_view number = without_blanks_around(text);
  const bool inches = take_suffix(number, "inch") || take_suffix(number, "in");
  if (!inches) take_suffix(number, "mm");
  const auto value = decimal(number);
  if (!value) {
    const bool comma = number.find(',') != std::string_view::npos;
    problems.push_back(
        fmt::format("--tolerance: '{}', expected a length such as 0.01, 0.01mm or 0.0005in{}", text,
                    comma ? " (with a point, not a comma)" : ""));
    return std::nullopt;
  }
  if (!inches) return Tolerance{.mm = *value, .inch = std::nullopt};
  return Tolerance{.mm = *value * gcode::millimetres_per(gcode::Units::kInch), .inch = value};
}

std::optional<double> read_decimal(std::string_view option, std::string_view text,
                                   Problems& problems) {
  const auto value = decimal(text);
  if (!value) problems.push_back(fmt::format("--{}: '{}', expected a number", option, text));
  return value;
}

std::optional<int> read_integer(std::string_view option, std::string_view text,
                                Problems& problems) {
  int value = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (error == std::errc{} && end == text.data() + text.size()) return value;
  problems.push_back(fmt::format("--{}: '{}', expected a whole number", option, text));
  return std::nullopt;
}

std::optional<gcode::Units> read_units(std::string_view text, Problems& problems) {
  static constexpr std::array kUnits = {
      Choice<gcode::Units>{gcode::Units::kMillimetre, "mm", ""},
      Choice<gcode::Units>{gcode::Units::kInch, "inch", ""},
  };
  return read_choice<gcode::Units>("units", text, kUnits, problems);
}

std::string unknown_name(std::string_view option, std::string_view text,
                         std::span<const std::string_view> names) {
  return fmt::format("--{}: there is no '{}'{}; possible: {}", option, text,
                     suggestion(text, names), fmt::join(names, ", "));
}

}  // namespace batten::postproc
