#include "postproc/batch/manifest.h"

#include <array>
#include <utility>

#include "postproc/batch/program_tree.h"
#include "postproc/report/json_values.h"

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

}  // namespace

std::string_view name_of(ProgramStatus status) {
  for (const auto& [known, name] : kNames) {
    if (known == status) return name;
  }
  return "";
}

std::string record_text(const ProgramRecord& record) {
  return json_text({{"program", record.program},
                    {"status", name_of(record.status)},
                    {"exit_code", record.exit_code},
                    {"message", record.message},
                    {"input_sha256", record.input_sha256},
                    {"settings_sha256", record.settings_sha256},
                    {"output_sha256", record.output_sha256},
                    {"report_sha256", record.report_sha256},
                    {"bytes_in", record.bytes_in},
                    {"bytes_out", record.bytes_out},
                    {"blocks_in", record.blocks_in},
                    {"blocks_out", record.blocks_out},
                    {"runs_rewritten", record.runs_rewritten},
                    {"runs_kept", record.runs_kept},
                    {"time_before_s", record.time_before_s},
                    {"time_after_s", record.time_after_s},
                    {"deviation_mm", record.deviation_mm}});
}

std::optional<ProgramRecord> read_record(std::string_view text) {
  try {
    const Json json = Json::parse(text);
    const auto status = status_named(json.at("status").get<std::string>());
    if (!status) return std::nullopt;
    ProgramRecord record;
    record.status = *status;
    const auto read = [&](const char* name, auto& place) { json.at(name).get_to(place); };
    read("program", record.program);
    read("exit_code", record.exit_code);
    read("message", record.message);
    read("input_sha256", record.input_sha256);
    read("settings_sha256", record.settings_sha256);
    read("output_sha256", record.output_sha256);
    read("report_sha256", record.report_sha256);
    read("bytes_in", record.bytes_in);
    read("bytes_out", record.bytes_out);
    read("blocks_in", record.blocks_in);
    read("blocks_out", record.blocks_out);
    read("runs_rewritten", record.runs_rewritten);
    read("runs_kept", record.runs_kept);
    read("time_before_s", record.time_before_s);
    read("time_after_s", record.time_after_s);
    read("deviation_mm", record.deviation_mm);
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
