#include "postproc/report/time_report.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>

#include "postproc/report/own_words_report.h"
#include "postproc/text/words.h"

namespace batten::postproc {
namespace {

Json parts_json(const TimeParts& s) {
  return {{"time_s", s.sum()},   {"cutting_s", s.cutting},          {"rapid_s", s.rapids},
          {"dwell_s", s.dwells}, {"tool_change_s", s.tool_changes}, {"spindle_s", s.spindle},
          {"rotary_s", s.rotary}};
}

Json json_of(const ToolTime& tool) {
  Json entry = {{"tool", nullptr}};
  if (tool.tool != ProgramStep::kNoTool) entry["tool"] = tool.tool;
  entry.update(parts_json(tool.seconds));
  return entry;
}

Json json_of(const SlowPlace& p) {
  return {{"first_line", p.first_line}, {"last_line", p.last_line},  {"time_s", p.seconds},
          {"length_mm", p.length_mm},   {"feed_mm_per_min", p.feed}, {"lost_s", p.seconds_lost}};
}

Json json_of(const NotTimed& entry) {
  return {{"id", entry.id},
          {"count", entry.count},
          {"first_line", entry.first_line},
          {"text", entry.text}};
}

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

std::string tool_name(std::int32_t tool) {
  return tool == ProgramStep::kNoTool ? "before a tool" : fmt::format("tool T{}", tool);
}

void add_part(std::string_view title, double time, double whole, const std::string& text,
              std::string& lines) {
  lines += titled(title,
                  fmt::format("{:>14} {:>5.1f} %{}{}", seconds_text(time),
                              whole > 0 ? 100 * time / whole : 0, text.empty() ? "" : "  ", text));
}

void add_parts(const ProgramTime& time, std::string& lines) {
  const TimeParts& s = time.seconds;
  const auto add = [&](bool has_any, std::string_view title, double seconds,
                       const std::string& text) {
    if (has_any) add_part(title, seconds, s.sum(), text, lines);
  };
  add(true, "cutting", s.cutting,
      fmt::format("{} in {}; {} at the programmed feeds", length_text(time.cutting_mm),
                  plural(time.counts.cuts, "move"), seconds_text(time.cutting_at_feed)));
  add(time.counts.rapids > 0, "rapids", s.rapids,
      fmt::format("{} in {}", length_text(time.rapid_mm), plural(time.counts.rapids, "move")));
  add(time.counts.dwells > 0, "dwells", s.dwells, plural(time.counts.dwells, "dwell"));
  add(time.counts.tool_changes > 0, "tool changes", s.tool_changes,
      plural(time.counts.tool_changes, "change"));
  add(time.counts.spindle_starts > 0, "spindle", s.spindle,
      plural(time.counts.spindle_starts, "start"));
  add(s.rotary > 0, "rotary axes", s.rotary, "turning alone");
}

void add_tools(const ProgramTime& time, std::string& lines) {
  if (time.tools.size() < 2) return;
  for (const ToolTime& tool : time.tools) {
    if (tool.seconds.sum() <= 0) continue;
    add_part(tool_name(tool.tool), tool.seconds.sum(), time.seconds.sum(),
             "cutting " + seconds_text(tool.seconds.cutting), lines);
  }
}

void add_slow_places(const ProgramTime& time, std::string& lines) {
  if (time.seconds.cutting <= 0) return;
  lines += titled("slow",
                  fmt::format("{:.1f} % of the cutting time is below half of the programmed feed",
                              100 * time.below_half_feed / time.seconds.cutting));
  for (std::size_t i = 0; i < std::min(time.slowest.size(), kMostPlaces); ++i) {
    const SlowPlace& p = time.slowest[i];
    const std::string where = p.first_line == p.last_line
                                  ? fmt::format("line {}", p.first_line)
                                  : fmt::format("lines {}-{}", p.first_line, p.last_line);
    lines += titled(
        "", fmt::format("{}: {} for {}, {:.0f} of {:.0f} mm/min, {} lost", where,
                        seconds_text(p.seconds), length_text(p.length_mm),
                        p.length_mm / p.seconds * kMinute, p.feed, seconds_text(p.seconds_lost)));
  }
  if (time.slowest.size() > kMostPlaces) {
    lines += titled("", fmt::format("{} more, see --json", time.slowest.size() - kMostPlaces));
  }
}

Json json_of(const BoundedTime& seconds) {
  return {{"time_s", seconds.time},
          {"least_on_path_s", seconds.least_on_path},
          {"least_within_s", seconds.least_within ? Json(*seconds.least_within) : Json()}};
}

Json json_of(const RunBound& run) {
  Json entry = {{"first_line", run.first_line}, {"last_line", run.last_line}};
  entry.update(json_of(run.seconds));
  return entry;
}

Json json_of(const TimeBounds& bounds) {
  Json entry = {{"tolerance_mm", bounds.tolerance_mm ? Json(*bounds.tolerance_mm) : Json()}};
  entry.update(json_of(bounds.seconds));
  entry["exact_stop_moves"] = bounds.exact_stop.cut.moves;
  entry["runs"] = json_list(bounds.runs, [](const RunBound& run) { return json_of(run); });
  return entry;
}

std::string left_text(const BoundedTime& seconds) {
  const double left = seconds.time - seconds.least();
  return fmt::format("at most {} of {} ({:.1f} %)", seconds_text(left), seconds_text(seconds.time),
                     seconds.time > 0 ? 100 * left / seconds.time : 0);
}

void add_runs(const TimeBounds& bounds, std::string& lines) {
  if (bounds.runs.empty()) {
    lines += titled("to win", "no run that may be rewritten");
    return;
  }
  const BoundedTime& all = bounds.seconds;
  lines +=
      titled("to win", fmt::format("{} in {}", left_text(all), plural(bounds.runs.size(), "run")));
  std::string least =
      fmt::format("no feed plan takes less than {} on this path", seconds_text(all.least_on_path));
  if (bounds.tolerance_mm) {
    least += fmt::format(", and none on a path within {:g} mm less than {}", *bounds.tolerance_mm,
                         seconds_text(all.least()));
  }
  lines += titled("", least);
  for (std::size_t i = 0; i < std::min(bounds.runs.size(), kMostPlaces); ++i) {
    const RunBound& run = bounds.runs[i];
    lines += titled(
        "", fmt::format("lines {}-{}: {}", run.first_line, run.last_line, left_text(run.seconds)));
  }
  if (bounds.runs.size() > kMostPlaces) {
    lines += titled("", fmt::format("{} more, see --json", bounds.runs.size() - kMostPlaces));
  }
}

void add_bounds(const TimeBounds& bounds, std::string& lines) {
  add_runs(bounds, lines);
  const KeptCause& kept = bounds.exact_stop;
  if (kept.cut.moves == 0) return;
  lines += titled("", fmt::format("not in it: {} from line {} on, kept for exact stop (batten "
                                  "explain {})",
                                  plural(kept.cut.moves, "move"), kept.first_line, kept.reason));
}

void add_not_timed(const ProgramTime& time, std::string& lines) {
  std::string_view title = "not certain";
  for (const NotTimed& entry : time.not_timed) {
    lines +=
        titled(title, fmt::format("{}, first in line {} ({}): {}", plural(entry.count, "block"),
                                  entry.first_line, entry.id, entry.text));
    title = "";
  }
}

}  // namespace

Json time_json(const TimeReport& report) {
  const ProgramTime& time = report.time;
  Json json = {{"input",
                {{"file", report.program.source.name()},
                 {"bytes", report.program.source.text().size()},
                 {"blocks", report.program.blocks.size()}}},
               {"machine", report.machine.name},
               {"planner", name_of(report.planner)},
               {"feed_override", report.feed_override}};
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
  const auto item = [](const auto& each) { return json_of(each); };
  json["tools"] = json_list(time.tools, item);
  json["slowest"] = json_list(time.slowest, item);
  if (report.bounds) json["bounds"] = json_of(*report.bounds);
  json["not_timed"] = json_list(time.not_timed, item);
  json["words"] = own_words_json(report.own_words);
  if (!report.called.empty()) json["called"] = called_json(report.called);
  json["diagnostics"] = diagnostics_json(report.diagnostics, report.program.source);
  return as_report("time", json);
}

std::string time_text(const TimeReport& report) {
  const bool planned = report.planner != FeedPlanner::kControl;
  const bool overridden = report.feed_override != 1;
  std::string lines =
      fmt::format("{} on {}{}{}: {}\n", report.program.source.name(), report.machine.name,
                  planned ? fmt::format(", planner {}", name_of(report.planner)) : "",
                  overridden ? fmt::format(", feeds at {:g} %", 100 * report.feed_override) : "",
                  seconds_text(report.time.seconds.sum()));
  add_parts(report.time, lines);
  add_tools(report.time, lines);
  add_slow_places(report.time, lines);
  if (report.bounds) add_bounds(*report.bounds, lines);
  add_not_timed(report.time, lines);
  lines += text_of(report.called);
  if (!report.called.empty()) lines += titled("", "the time of what is called is not in it");
  return lines + own_words_text(report.own_words);
}

}  // namespace batten::postproc
