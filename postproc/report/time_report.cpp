#include "postproc/report/time_report.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <iterator>
#include <nlohmann/json.hpp>
#include <string>

#include "postproc/machine/machine.h"
#include "postproc/text/json_values.h"

namespace batten::postproc {
namespace {

Json parts_json(const TimeParts& s) {
  return {{"time_s", s.sum()},   {"cutting_s", s.cutting},          {"rapid_s", s.rapids},
          {"dwell_s", s.dwells}, {"tool_change_s", s.tool_changes}, {"spindle_s", s.spindle},
          {"rotary_s", s.rotary}};
}

Json tools_json(const std::vector<ToolTime>& tools) {
  Json list = Json::array();
  for (const ToolTime& tool : tools) {
    Json entry = {{"tool", nullptr}};
    if (tool.tool != ProgramStep::kNoTool) entry["tool"] = tool.tool;
    entry.update(parts_json(tool.seconds));
    list.push_back(std::move(entry));
  }
  return list;
}

Json slowest_json(const std::vector<SlowPlace>& places) {
  Json list = Json::array();
  for (const SlowPlace& p : places) {
    list.push_back({{"first_line", p.first_line},
                    {"last_line", p.last_line},
                    {"time_s", p.seconds},
                    {"length_mm", p.length_mm},
                    {"feed_mm_per_min", p.feed},
                    {"lost_s", p.seconds_lost}});
  }
  return list;
}

Json not_timed_json(const std::vector<NotTimed>& entries) {
  Json list = Json::array();
  for (const NotTimed& entry : entries) {
    list.push_back({{"id", entry.id},
                    {"count", entry.count},
                    {"first_line", entry.first_line},
                    {"text", entry.text}});
  }
  return list;
}

}  // namespace

std::string time_json(const TimeReport& report) {
  const ProgramTime& time = report.time;
  Json json = {{"batten", BATTEN_VERSION},
               {"input",
                {{"file", report.program.source.name()},
                 {"bytes", report.program.source.text().size()},
                 {"blocks", report.program.blocks.size()}}},
               {"machine", report.machine.name}};
  json.update(parts_json(time.seconds));
  json["cuts"] = time.counts.cuts;
  json["rapids"] = time.counts.rapids;
  json["dwells"] = time.counts.dwells;
  json["tool_changes"] = time.counts.tool_changes;
  json["spindle_starts"] = time.counts.spindle_starts;
  json["cutting_mm"] = time.cutting_mm;
  json["rapid_mm"] = time.rapid_mm;
  json["cutting_at_feed_s"] = time.cutting_at_feed;
  json["below_half_feed_s"] = time.below_half_feed;
  json["tools"] = tools_json(time.tools);
  json["slowest"] = slowest_json(time.slowest);
  json["not_timed"] = not_timed_json(time.not_timed);
  json["diagnostics"] = diagnostics_json(report.diagnostics, report.program.source);
  return json_text(json);
}

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
