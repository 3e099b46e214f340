#include "postproc/batch/batch_summary.h"

#include <fmt/format.h>

#include <algorithm>
#include <iterator>
#include <nlohmann/json.hpp>

#include "postproc/system/terminal_colour.h"
#include "postproc/text/json_values.h"

namespace batten::postproc {

namespace {

bool is_written(const ProgramRecord& record) {
  return record.status == ProgramStatus::kSmoothed || record.status == ProgramStatus::kUnchanged;
}

std::size_t& count_of(ProgramStatus status, BatchTotals& totals) {
  switch (status) {
    case ProgramStatus::kSmoothed:
      return totals.smoothed;
    case ProgramStatus::kUnchanged:
      return totals.unchanged;
    case ProgramStatus::kNotUnderstood:
      return totals.not_understood;
    case ProgramStatus::kNotProved:
      return totals.not_proved;
    case ProgramStatus::kFailed:
      return totals.failed;
    case ProgramStatus::kNotDone:
      break;
  }
  return totals.not_done;
}

std::string arrow(std::size_t before, std::size_t after) {
  return fmt::format("{} -> {}", before, after);
}

std::string counts_line(const BatchTotals& totals) {
  std::string text =
      fmt::format("{} program{}: {} smoothed, {} unchanged", totals.programs,
                  totals.programs == 1 ? "" : "s", totals.smoothed, totals.unchanged);
  const auto add = [&](std::size_t count, std::string_view what) {
    if (count > 0) text += fmt::format(", {} {}", count, what);
  };
  add(totals.not_understood, "not understood");
  add(totals.not_proved, "not proved");
  add(totals.failed, "failed");
  add(totals.not_done, "not done");
  return text + "\n";
}

// A field of RFC 4180.
std::string csv_field(std::string_view text) {
  if (text.find_first_of("\",\r\n") == std::string_view::npos) return std::string(text);
  std::string field = "\"";
  for (const char c : text) field += c == '"' ? std::string("\"\"") : std::string(1, c);
  return field + "\"";
}

Json json_of(const BatchTotals& totals) {
  Json json = {{"programs", totals.programs},     {"smoothed", totals.smoothed},
               {"unchanged", totals.unchanged},   {"not_understood", totals.not_understood},
               {"not_proved", totals.not_proved}, {"failed", totals.failed},
               {"not_done", totals.not_done}};
  each_figure(totals, [&](const char* name, const auto& value) { json[name] = value; });
  json["exit_code"] = totals.exit_code;
  return json;
}

}  // namespace

BatchTotals totals_of(std::span<const ProgramRecord> records) {
  BatchTotals totals;
  totals.programs = records.size();
  for (const ProgramRecord& record : records) {
    ++count_of(record.status, totals);
    totals.exit_code = std::max(totals.exit_code, record.exit_code);
    if (!is_written(record)) continue;
    totals.bytes_in += record.bytes_in;
    totals.bytes_out += record.bytes_out;
    totals.blocks_in += record.blocks_in;
    totals.blocks_out += record.blocks_out;
    totals.time_before_s += record.time_before_s;
    totals.time_after_s += record.time_after_s;
    totals.deviation_mm = std::max(totals.deviation_mm, record.deviation_mm);
  }
  return totals;
}

std::string summary_table(std::span<const ProgramRecord> records) {
  std::size_t width = std::string_view("program").size();
  for (const ProgramRecord& record : records) width = std::max(width, record.program.size());
  std::string text = fmt::format("{:<{}}  {:<14}  {:>18}  {:>22}  {:>22}  {:>9}\n", "program",
                                 width, "status", "blocks", "bytes", "cutting time s", "within mm");
  const auto add_row = [&](std::string_view name, std::string_view status,
                           const ProgramFigures& row) {
    fmt::format_to(
        std::back_inserter(text), "{:<{}}  {:<14}  {:>18}  {:>22}  {:>22}  {:>9.4f}\n", name, width,
        status, arrow(row.blocks_in, row.blocks_out), arrow(row.bytes_in, row.bytes_out),
        fmt::format("{:.2f} -> {:.2f}", row.time_before_s, row.time_after_s), row.deviation_mm);
  };
  for (const ProgramRecord& record : records) {
    if (is_written(record)) {
      add_row(record.program, name_of(record.status), record);
    } else {
      fmt::format_to(std::back_inserter(text), "{:<{}}  {:<14}  {}\n", record.program, width,
                     name_of(record.status), record.message);
    }
  }
  const BatchTotals totals = totals_of(records);
  add_row("all", "", totals);
  return text + counts_line(totals);
}

std::string summary_csv(std::span<const ProgramRecord> records) {
  std::string text =
      "program,status,exit_code,blocks_in,blocks_out,bytes_in,bytes_out,runs_rewritten,runs_kept,"
      "time_before_s,time_after_s,deviation_mm,input_sha256,output_sha256,message\n";
  for (const ProgramRecord& r : records) {
    fmt::format_to(std::back_inserter(text), "{},{},{},{},{},{},{},{},{},{},{},{},{},{},{}\n",
                   csv_field(r.program), name_of(r.status), r.exit_code, r.blocks_in, r.blocks_out,
                   r.bytes_in, r.bytes_out, r.runs_rewritten, r.runs_kept, r.time_before_s,
                   r.time_after_s, r.deviation_mm, r.input_sha256, r.output_sha256,
                   csv_field(r.message));
  }
  return text;
}

std::string summary_json(std::span<const ProgramRecord> records) {
  Json programs = Json::array();
  for (const ProgramRecord& record : records) programs.push_back(Json::parse(record_text(record)));
  return json_text({{"batten", BATTEN_VERSION},
                    {"totals", json_of(totals_of(records))},
                    {"programs", std::move(programs)}});
}

namespace {

constexpr std::size_t kBarWidth = 20;  // characters, so that the line fits into 80

std::string bar_of(std::size_t part, std::size_t whole) {
  const std::size_t full = whole > 0 ? kBarWidth * part / whole : kBarWidth;
  return "[" + std::string(full, '#') + std::string(kBarWidth - full, '-') + "]";
}

}  // namespace

std::string progress_line(const BatchCount& count) {
  std::string line =
      fmt::format("{}  {} of {} programs", bar_of(count.programs_over, count.programs),
                  count.programs_over, count.programs);
  if (count.bytes_over == 0 || !(count.seconds > 0)) return line;
  const double rate = static_cast<double>(count.bytes_over) / count.seconds;
  line += "  " + rate_text(rate);
  if (count.bytes > count.bytes_over) {
    line += fmt::format("  about {} left",
                        rough_time(static_cast<double>(count.bytes - count.bytes_over) / rate));
  }
  return line;
}

}  // namespace batten::postproc
