#include "postproc/report/time_report.h"
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

}  // namespace batten::postproc
