#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <iterator>
#include <string>

#include "postproc/machine/unit_sizes.h"
#include "postproc/report/time_report.h"

namespace batten::postproc {
namespace {

// Places beyond these are small ones; the JSON report has more.
constexpr std::size_t kMostPlaces = 8;

std::string seconds_text(double time) {
  if (time < 10) return fmt::format("{:.3f} s", time);
  if (time < 120) return fmt::format("{:.2f} s", time);
  const auto whole = std::llround(time);
  if (whole < 3600) return fmt::format("{} min {:02} s", whole / 60, whole % 60);
  return fmt::format("{} h {:02} min {:02} s", whole / 3600, whole % 3600 / 60, whole % 60);
}

std::string length_text(double mm) {
  return mm < 10000 ? fmt::format("{:.1f} mm", mm) : fmt::format("{:.2f} m", mm / 1000);
}

std::string counted(std::size_t count, std::string_view noun) {
  return fmt::format("{} {}{}", count, noun, count == 1 ? "" : "s");
}

std::string tool_name(std::int32_t tool) {
  return tool == ProgramStep::kNoTool ? "before a tool" : fmt::format("tool T{}", tool);
}

class TimeLines {
 public:
  explicit TimeLines(double whole) : whole_(whole) {}

  void add_part(std::string_view title, double time, const std::string& text) {
    const double share = whole_ > 0 ? 100 * time / whole_ : 0;
    fmt::format_to(std::back_inserter(text_), "  {:<14}{:>14} {:>5.1f} %{}{}\n", title,
                   seconds_text(time), share, text.empty() ? "" : "  ", text);
  }
  void add(std::string_view title, const std::string& text) {
    fmt::format_to(std::back_inserter(text_), "  {:<14}{}\n", title, text);
  }
  [[nodiscard]] const std::string& text() const { return text_; }

 private:
  double whole_;
  std::string text_;
};

void add_parts(const ProgramTime& time, TimeLines& lines) {
  const TimeParts& s = time.seconds;
  lines.add_part(
      "cutting", s.cutting,
      fmt::format("{} in {}; {} at the programmed feeds", length_text(time.cutting_mm),
                  counted(time.counts.cuts, "move"), seconds_text(time.cutting_at_feed)));
  if (time.counts.rapids > 0) {
    lines.add_part(
        "rapids", s.rapids,
        fmt::format("{} in {}", length_text(time.rapid_mm), counted(time.counts.rapids, "move")));
  }
  if (time.counts.dwells > 0)
    lines.add_part("dwells", s.dwells, counted(time.counts.dwells, "dwell"));
  if (time.counts.tool_changes > 0) {
    lines.add_part("tool changes", s.tool_changes, counted(time.counts.tool_changes, "change"));
  }
  if (time.counts.spindle_starts > 0) {
    lines.add_part("spindle", s.spindle, counted(time.counts.spindle_starts, "start"));
  }
  if (s.rotary > 0) lines.add_part("rotary axes", s.rotary, "turning alone");
}

void add_tools(const ProgramTime& time, TimeLines& lines) {
  if (time.tools.size() < 2) return;
  for (const ToolTime& tool : time.tools) {
    if (tool.seconds.sum() <= 0) continue;
    lines.add_part(tool_name(tool.tool), tool.seconds.sum(),
                   "cutting " + seconds_text(tool.seconds.cutting));
  }
}

void add_slow_places(const ProgramTime& time, TimeLines& lines) {
  if (time.seconds.cutting <= 0) return;
  lines.add("slow", fmt::format("{:.1f} % of the cutting time is below half of the programmed feed",
                                100 * time.below_half_feed / time.seconds.cutting));
  for (std::size_t i = 0; i < std::min(time.slowest.size(), kMostPlaces); ++i) {
    const SlowPlace& p = time.slowest[i];
    const std::string where = p.first_line == p.last_line
                                  ? fmt::format("line {}", p.first_line)
                                  : fmt::format("lines {}-{}", p.first_line, p.last_line);
    lines.add("",
              fmt::format("{}: {} for {}, {:.0f} of {:.0f} mm/min, {} lost", where,
                          seconds_text(p.seconds), length_text(p.length_mm),
                          p.length_mm / p.seconds * kMinute, p.feed, seconds_text(p.seconds_lost)));
  }
  if (time.slowest.size() > kMostPlaces) {
    lines.add("", fmt::format("{} more, see --json", time.slowest.size() - kMostPlaces));
  }
}

void add_not_timed(const ProgramTime& time, TimeLines& lines) {
  std::string_view title = "not certain";
  for (const NotTimed& entry : time.not_timed) {
    lines.add(title, fmt::format("{}, first in line {} ({}): {}", counted(entry.count, "block"),
                                 entry.first_line, entry.id, entry.text));
    title = "";
  }
}

}  // namespace

std::string time_text(const TimeReport& report) {
  TimeLines lines(report.time.seconds.sum());
  add_parts(report.time, lines);
  add_tools(report.time, lines);
  add_slow_places(report.time, lines);
  add_not_timed(report.time, lines);
  return fmt::format("{} on {}: {}\n", report.program.source.name(), report.machine.name,
                     seconds_text(report.time.seconds.sum())) +
         lines.text();
}

}  // namespace batten::postproc
