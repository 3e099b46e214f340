#include "postproc/report/json_report.h"

#include "postproc/options/options.h"
#include "postproc/report/summary_text.h"
#include "postproc/text/json_values.h"

namespace batten::postproc {

namespace {

std::string_view name_of_form(OutputForm form) {
  switch (form) {
    case OutputForm::kCurves:
      return "curves";
    case OutputForm::kArcs:
      return "arcs";
    case OutputForm::kLines:
      break;
  }
  return "lines";
}

Json json_of(const SmoothOptions& options, bool strict) {
  Json json = {{"target", options.target->name},
               {"machine", options.machine->name},
               {"tolerance_mm", options.tolerance_mm}};
  if (options.tolerance_inch) json["tolerance_inch"] = *options.tolerance_inch;
  json["tolerance_kind"] = name_of(options.tolerance_kind);
  json["side"] = name_of(options.side);
  json["method"] = name_of(options.method);
  json["output"] = name_of(options.output);
  json["prefer"] = name_of(options.prefer);
  json["linearize"] = name_of(linearize_of(options));
  json["units"] = name_of(options.units);
  json["decimals"] = text_of(options.decimals);
  json["keep_corners_deg"] =
      options.keep_corners_deg ? Json(*options.keep_corners_deg) : Json(nullptr);
  json["allow"] = options.allowed;
  json["strict"] = strict;
  return json;
}

Json json_of(const RunReport& run) {
  const bool rewritten = run.status == RunStatus::kRewritten;
  Json methods = Json::array();
  for (const MethodTime& each : run.methods) {
    methods.push_back({{"method", each.method}, {"time_s", each.time_s}});
  }
  return {{"first_line", run.first_line},
          {"last_line", run.last_line},
          {"points", run.points},
          {"status", rewritten ? "rewritten" : "kept"},
          {"reason", run.reason},
          {"method", run.method},
          {"methods", std::move(methods)},
          {"form", rewritten ? name_of_form(run.form) : ""},
          {"blocks_in", run.blocks_in},
          {"blocks_out", run.blocks_out},
          {"deviation_mm", run.deviation_mm},
          {"proved", run.proved},
          {"noise_mm", run.noise_mm},
          {"max_curvature_before", run.max_curvature_before},
          {"max_curvature_after", run.max_curvature_after},
          {"time_before_s", run.time_before_s},
          {"time_after_s", run.time_after_s}};
}

Json json_of(const ReasonCount& reason) {
  return {{"id", reason.id},         {"runs", reason.runs},
          {"blocks", reason.blocks}, {"text", reason.text},
          {"advice", reason.advice}, {"can_be_allowed", reason.can_be_allowed}};
}

Json profile_json(const SmoothReport& report) {
  const ProfileWords& words = report.options.words;
  return {{"file", report.options.profile}, {"lines_added", report.result.added_lines},
          {"header", words.header},         {"footer", words.footer},
          {"before_run", words.before_run}, {"after_run", words.after_run}};
}

}  // namespace

Json smooth_json(const SmoothReport& report) {
  const SmoothResult& result = report.result;
  Json runs = Json::array();
  for (const RunReport& run : result.runs) runs.push_back(json_of(run));
  Json reasons = Json::array();
  for (const ReasonCount& reason : count_reasons(result.runs)) reasons.push_back(json_of(reason));

  Json json = {{"batten", BATTEN_VERSION},
               {"options", json_of(report.options, report.strict)},
               {"input",
                {{"file", report.source.name()},
                 {"bytes", report.source.text().size()},
                 {"blocks", result.blocks_in},
                 {"units", name_of(result.units)}}},
               {"output",
                {{"file", report.output_file},
                 {"bytes", result.bytes_out()},
                 {"blocks", result.blocks_out},
                 {"target", report.options.target->name}}},
               {"machine",
                {{"name", report.options.machine->name},
                 {"model", name_of(report.options.machine->model)},
                 {"description", report.options.machine->description}}},
               {"runs", std::move(runs)},
               {"reasons", std::move(reasons)},
               {"deviation_mm", result.deviation_mm},
               {"deviation_line", result.deviation_line},
               {"corner_mm", result.corner_mm},
               {"time_before_s", result.time_before_s},
               {"time_after_s", result.time_after_s},
               {"proved", result.proved},
               {"understood", result.understood},
               {"diagnostics", diagnostics_json(result.diagnostics, report.source)}};
  if (!report.options.profile.empty()) json["profile"] = profile_json(report);
  return json;
}

std::string json_report(const SmoothReport& report) { return json_text(smooth_json(report)); }

}  // namespace batten::postproc
