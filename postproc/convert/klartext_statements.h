// Statements of Klartext that are no words of a motion, and what a translation left in comments.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

#include "gcode/text/program.h"

namespace batten::postproc {

// `TOOL CALL 5 Z S3000`, `TOOL CALL Z S4000`.
struct CalledTool {
  std::optional<double> number;  // none: the tool stays
  std::optional<double> speed;
};

// Nothing where the statement has more than number, Z, S and F, or where Z is missing: other tool
// axes, names, oversizes. F is not told: motions at the feed that a tool brings are not known.
[[nodiscard]] std::optional<CalledTool> called_tool(std::string_view statement);

// `BLK FORM 0.1 Z X+0 Y+0 Z-20`: the blank, which only the control's simulation shows.
[[nodiscard]] bool defines_stock(std::string_view statement);

// `PLANE RESET STAY`: nothing moves, and no plane is tilted behind it.
[[nodiscard]] bool ends_tilting(std::string_view statement);

// Milliseconds, where the block is the first of two that say a dwell: `CYCL DEF 9.0 DWELL TIME` and
// `CYCL DEF 9.1 DWELL 1.5`, in seconds, with these or the words of another dialog language.
[[nodiscard]] std::optional<std::int32_t> dwell_begun_in(const gcode::Program& program,
                                                         std::uint32_t block);

// A block's statement, without number and comment; empty where other lines continue it.
[[nodiscard]] std::string_view statement_of(const gcode::Program& program,
                                            const gcode::Block& block);

// --- remarks that a translation leaves -----------------------------------------------------------

// What Klartext says in place of a work offset, so that the proof finds it and the operator sees
// it: "G54: its datum is active".
[[nodiscard]] std::string datum_remark(int work_offset);

// The same for motions behind G49.
inline constexpr std::string_view kLengthRemark = "G49: the length of the tool counts";

// For motions along Z after a tool change without G43.
inline constexpr std::string_view kUnsaidLengthRemark = "no G43: the length of the tool counts";

// What other languages say before their M30, where Klartext ends by its END PGM alone.
inline constexpr std::string_view kEndRemark = "END PGM";

// 54 of "G54: its datum is active".
[[nodiscard]] std::optional<int> datum_of_remark(std::string_view comment);

}  // namespace batten::postproc
