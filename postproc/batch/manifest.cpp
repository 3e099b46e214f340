#include "postproc/batch/manifest.h"

#include <array>
#include <nlohmann/json.hpp>
#include <utility>

#include "postproc/batch/program_tree.h"
#include "postproc/text/json_values.h"

namespace batten::postproc {

namespace {

constexpr std::array<std::pair<ProgramStatus, std::string_view>, 6> kNames = {{
    {ProgramStatus::kSmoothed, "smoothed"},
    {ProgramStatus::kUnchanged, "unchanged"},
    {ProgramStatus::kNotUnderstood, "not understood"},
    {ProgramStatus::kNotProved, "not proved"},
    {ProgramStatus::kFailed, "failed"},
    {ProgramStatus::kNotDone, "not done"},
}};

std::optional<ProgramStatus> status_named(std::string_view name) {
  for (const auto& [status, known] : kNames) {
    if (known == name) return status;
  }
  return std::nullopt;
}

// What a record says besides whose it is and its status.
template <typename Record, typename Take>
void each_field(Record& record, const Take& take) {
  take("exit_code", record.exit_code);
  take("message", record.message);
  take("input_sha256", record.input_sha256);
  take("settings_sha256", record.settings_sha256);
  take("output_sha256", record.output_sha256);
  take("report_sha256", record.report_sha256);
  take("runs_rewritten", record.runs_rewritten);
  take("runs_kept", record.runs_kept);
  each_figure(record, take);
}

}  // namespace

std::string_view name_of(ProgramStatus status) {
  for (const auto& [known, name] : kNames) {
    if (known == status) return name;
  }
  return "";
}

std::string record_text(const ProgramRecord& record) {
  Json json = {{"program", record.program}, {"status", name_of(record.status)}};
  each_field(record, [&](const char* name, const auto& value) { json[name] = value; });
  return json_text(json);
}

std::optional<ProgramRecord> read_record(std::string_view text) {
  try {
    const Json json = Json::parse(text);
    const auto status = status_named(json.at("status").get<std::string>());
    if (!status) return std::nullopt;
    ProgramRecord record;
    record.status = *status;
    json.at("program").get_to(record.program);
    each_field(record, [&](const char* name, auto& place) { json.at(name).get_to(place); });
    return record;
  } catch (const Json::exception&) {
    return std::nullopt;
  }
}

ProgramPlaces places_of(const std::filesystem::path& output_tree, const std::string& program) {
  const std::filesystem::path batch = output_tree / kBatchFolder;
  return {.output = output_tree / program,
          .report = batch / "reports" / (program + ".json"),
          .record = batch / "manifest" / (program + ".json")};
}

}  // namespace batten::postproc
