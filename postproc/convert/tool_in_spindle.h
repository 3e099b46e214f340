// The tool in the spindle while a program is read, and whether its length counts.
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <string_view>

#include "gcode/state/motion.h"
#include "gcode/text/program.h"

namespace batten::postproc {

enum class LengthSaid : std::uint8_t { kNot, kCounts, kCountsNot };

struct FetchedTool {
  double number = 0;
  gcode::SourceSpan where;
};

struct ToolInSpindle {
  std::optional<double> number;
  std::optional<FetchedTool> fetched;  // T without its M6 yet
  LengthSaid length = LengthSaid::kNot;
  std::optional<gcode::SourceSpan> without_length;  // G49, D0, and nothing moved since
  bool moved_along = false;                         // along Z, since the tool was put in

  // A whole number from 1 on.
  [[nodiscard]] static bool is_number(double number);

  // `tool` is in the spindle from here on.
  void put_in(double tool);

  // The length does not count from here on.
  void leave_length(gcode::SourceSpan where);

  // The length counts from here on. Whether it did not before.
  bool count_length();

  // Why G43, or a D word, is not just the length of the tool; empty where it is. `words`: of the
  // block. A control counts the length from where the tool is put in: that is the same as long as
  // nothing has moved along Z meanwhile.
  [[nodiscard]] std::string_view why_not_length(std::span<const gcode::Word> words) const;
  [[nodiscard]] std::string_view why_not_edge(const gcode::Word& d,
                                              std::span<const gcode::Word> words) const;

 private:
  [[nodiscard]] std::optional<double> behind(std::span<const gcode::Word> words) const;
  [[nodiscard]] std::string_view why_too_late(std::span<const gcode::Word> words) const;
};

}  // namespace batten::postproc
