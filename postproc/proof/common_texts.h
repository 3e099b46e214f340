// Texts of Klartext programs, and of what was made of them, that stand for events: the proof's own
// view of them.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

namespace batten::postproc {

// `TOOL CALL 5 Z S3000`, with what a program of plain words can say.
struct ToolCall {
  std::optional<double> tool;
  std::optional<double> speed;
};

// Nothing where there is more.
[[nodiscard]] std::optional<ToolCall> tool_call_in(std::string_view content);

// `CYCL DEF 9.0 DWELL TIME`, in any dialog language: the next block says how long.
[[nodiscard]] bool is_dwell_begin(std::string_view content);

// Milliseconds of `CYCL DEF 9.1 DWELL 1.5`; nothing where it is no time of whole milliseconds up to
// an hour.
[[nodiscard]] std::optional<std::int32_t> dwell_time_in(std::string_view content);

// In tenths: G54 to G59.
[[nodiscard]] bool is_work_offset(int code);

// 54 of "; G54: its datum is active".
[[nodiscard]] std::optional<int> datum_in_remark(std::string_view comment);

// What a Klartext program says where its source moves behind G49, or along Z behind a tool change
// without G43.
inline constexpr std::string_view kCountsAlways = "; G49: the length of the tool counts";
inline constexpr std::string_view kCountsUnsaid = "; no G43: the length of the tool counts";

// Without (), ; and the blanks at both ends; capitals alone.
[[nodiscard]] std::string capitals_of_comment(std::string_view comment);

// Of a statement, or of the comment that it became; in capitals.
[[nodiscard]] bool is_blank_form(std::string_view capitals);

}  // namespace batten::postproc
