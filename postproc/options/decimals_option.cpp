#include "postproc/options/decimals_option.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <array>

namespace batten::postproc {

namespace {

constexpr std::string_view kImplied = "implied";

// By their decimals.
constexpr std::array<std::string_view, gcode::kMostIncrementDecimals + 1> kSteps = {
    "1", "0.1", "0.01", "0.001", "0.0001", "0.00001"};

}  // namespace

std::optional<gcode::Decimals> read_decimals(std::string_view text,
                                             std::vector<std::string>& problems) {
  using gcode::PointlessNumbers;
  if (text == "auto") return std::nullopt;
  if (text == "explicit") return gcode::Decimals{.pointless = PointlessNumbers::kUnits};
  if (text == kImplied) return gcode::Decimals{.pointless = PointlessNumbers::kIncrements};
  for (std::size_t decimals = 0; decimals < kSteps.size(); ++decimals) {
    if (text == fmt::format("{}:{}", kImplied, kSteps.at(decimals))) {
      return gcode::Decimals{.pointless = PointlessNumbers::kIncrements,
                             .increment_decimals = static_cast<int>(decimals)};
    }
  }
  problems.push_back(fmt::format(
      "--decimals: '{}', expected auto, explicit, implied, or implied: and the least increment of "
      "millimetre programs, one of {}",
      text, fmt::join(kSteps, ", ")));
  return std::nullopt;
}

std::string text_of(const std::optional<gcode::Decimals>& declared) {
  if (!declared) return "auto";
  if (declared->pointless == gcode::PointlessNumbers::kUnits) return "explicit";
  if (declared->increment_decimals == gcode::Decimals{}.increment_decimals)
    return std::string(kImplied);
  return fmt::format("{}:{}", kImplied,
                     kSteps.at(static_cast<std::size_t>(declared->increment_decimals)));
}

std::vector<std::string> problems_of_decimals(const std::optional<gcode::Decimals>& declared,
                                              gcode::SourceKind source,
                                              const gcode::Dialect* target) {
  if (!declared || declared->pointless != gcode::PointlessNumbers::kIncrements) return {};
  const std::string_view why = gcode::why_not_implied(source, target);
  if (why.empty()) return {};
  return {fmt::format("--decimals: {}: {}", text_of(declared), why)};
}

}  // namespace batten::postproc
