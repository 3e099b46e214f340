#include <fmt/format.h>

#include <algorithm>
#include <map>
#include <nlohmann/json.hpp>

#include "gcode/interpreter/interpreter.h"
#include "gcode/reading/parser.h"
#include "gcode/reading/source_kind.h"
#include "gcode/state/reason.h"
#include "postproc/commands/commands.h"
#include "postproc/commands/files.h"
#include "postproc/report/html_report.h"
#include "postproc/report/kept_report.h"
#include "postproc/report/own_words_report.h"
#include "postproc/runs/run_grouping.h"
#include "postproc/stream/inspect.h"
#include "postproc/stream/part_reader.h"
#include "postproc/system/exit_code.h"
#include "postproc/system/interrupt.h"
#include "postproc/text/json_values.h"
#include "postproc/text/words.h"

namespace batten::postproc {

namespace {

// Rows that still are a readable table; --json has all of them.
constexpr std::size_t kMostRows = 60;

struct KeptTotal {
  std::size_t sections = 0;
  std::size_t blocks = 0;
  std::size_t cutting_moves = 0;
};

std::string_view text_of(std::string_view reason) {
  for (const auto& explanation : gcode::reason::explanations()) {
    if (explanation.id == reason) return explanation.text;
  }
  return "";
}

std::string runs_table(const std::vector<InspectedSection>& sections) {
  std::string text =
      "     lines          moves   shortest   median  longest mm  greatest turn     feed mm/min\n";
  std::size_t rows = 0;
  std::size_t runs = 0;
  for (const InspectedSection& section : sections) {
    if (!section.reason.empty()) continue;
    ++runs;
    if (++rows > kMostRows) continue;
    const SegmentStatistics& segments = section.segments;
    const std::string feed =
        section.least_feed == section.greatest_feed
            ? fmt::format("{:g}", section.greatest_feed)
            : fmt::format("{:g}-{:g}", section.least_feed, section.greatest_feed);
    text += fmt::format("{:>8}-{:<8} {:>8} {:>10.4f} {:>8.4f} {:>10.4f}  {:>6.1f} deg{:<12} {}{}\n",
                        section.first_line, section.last_line, segments.count, segments.shortest,
                        segments.median, segments.longest, segments.greatest_turn_deg,
                        segments.turn_line > 0 ? fmt::format(" (line {})", segments.turn_line) : "",
                        feed, section.closed ? "  closed" : "");
  }
  if (runs == 0) return "no run that may be rewritten\n";
  if (runs > kMostRows) text += fmt::format("     {} more runs, see --json\n", runs - kMostRows);
  return fmt::format("{} that may be rewritten:\n", plural(runs, "run")) + text;
}

std::map<std::string_view, KeptTotal> kept_totals(const std::vector<InspectedSection>& sections) {
  std::map<std::string_view, KeptTotal> totals;
  for (const InspectedSection& section : sections) {
    if (section.reason.empty()) continue;
    KeptTotal& total = totals[section.reason];
    ++total.sections;
    total.blocks += section.blocks;
    total.cutting_moves += section.cutting_moves;
  }
  return totals;
}

std::string kept_table(const InspectedProgram& inspected) {
  std::string text = "kept as it is:\n";
  for (const auto& [reason, total] : kept_totals(inspected.sections)) {
    const auto& causes = inspected.kept.causes;
    const auto cause = std::ranges::find(causes, reason, &KeptCause::reason);
    text += fmt::format("{:>8} {:<6} {:>6} cutting moves  {}: {}\n", total.blocks,
                        total.blocks == 1 ? "block" : "blocks", total.cutting_moves, reason,
                        text_of(reason));
    if (cause == causes.end()) continue;
    text += fmt::format("{:>40}{}\n", "", cause_text(inspected.kept, *cause));
  }
  return text;
}

Json json_of(const InspectedSection& section) {
  Json json = {{"first_line", section.first_line},
               {"last_line", section.last_line},
               {"blocks", section.blocks},
               {"cutting_moves", section.cutting_moves},
               {"status", section.reason.empty() ? "run" : "kept"},
               {"reason", section.reason}};
  if (!section.reason.empty()) return json;
  const SegmentStatistics& segments = section.segments;
  json["closed"] = section.closed;
  json["decimals"] = section.decimals;
  json["least_feed_mm_per_min"] = section.least_feed;
  json["greatest_feed_mm_per_min"] = section.greatest_feed;
  json["segments"] = {{"count", segments.count},
                      {"shortest_mm", segments.shortest},
                      {"median_mm", segments.median},
                      {"longest_mm", segments.longest},
                      {"length_mm", segments.length},
                      {"greatest_turn_deg", segments.greatest_turn_deg},
                      {"greatest_turn_line", segments.turn_line}};
  return json;
}

Json json_of(const InspectedProgram& inspected, const InspectCommand& command,
             const CalledFiles& called, const gcode::SourceText& source) {
  const auto section = [](const InspectedSection& each) { return json_of(each); };
  const auto kept = [](const auto& each) -> Json {
    const auto& [reason, total] = each;
    return {{"id", reason},
            {"sections", total.sections},
            {"blocks", total.blocks},
            {"cutting_moves", total.cutting_moves},
            {"text", text_of(reason)}};
  };
  Json json = as_report(
      "inspect",
      {{"input",
        {{"file", source.name()}, {"bytes", source.text().size()}, {"blocks", inspected.blocks}}},
       {"words", own_words_json(command.own_words)},
       {"sections", json_list(inspected.sections, section)},
       {"kept", json_list(kept_totals(inspected.sections), kept)},
       {"cutting", kept_json(inspected.kept)},
       {"diagnostics", diagnostics_json(inspected.found, source)}});
  if (!called.files.empty()) json["called"] = called_json(called.files);
  return json;
}

int write_inspect_page(const InspectCommand& command, const gcode::SourceText& source,
                       const PartReading& reading, const InspectedProgram& inspected,
                       const Json& json) {
  if (!command.page.is_wanted()) return 0;
  std::vector<PageLines> rows;
  for (const InspectedSection& section : inspected.sections) {
    if (!section.reason.empty() && section.cutting_moves == 0) continue;
    rows.push_back({section.first_line, section.last_line});
  }
  gcode::Diagnostics said_before;
  const auto [program, meaning] = read_whole(source, reading, said_before);
  const PageOf page{"inspect", json, source.name(), command.command_line, rows};
  return write_page(command.page, command.force, command.input,
                    html_report(page, {&program, &meaning}, nullptr));
}

}  // namespace

int run(const InspectCommand& command) {
  if (!may_write_reports(command)) return static_cast<int>(ExitCode::kFileError);
  const WatchedFile watched(command.input);
  const auto source = read_program(command.input);
  if (interrupted()) return end_interrupted();
  if (!source) return static_cast<int>(ExitCode::kFileError);

  PartReading reading = reading_of(*source, command, command.source, std::nullopt);
  if (gcode::has_error(reading.of_language)) {
    print(reading.of_language, *source, command.log_level);
    return static_cast<int>(ExitCode::kNotUnderstood);
  }
  read_as(command.runs_it, command.source, reading.options);
  const CalledFiles called = read_called_files(*source, command.input, reading.text);
  reading.options.subprograms = called.programs;
  GroupingOptions grouping;
  grouping.allowed.assign(command.allowed.begin(), command.allowed.end());
  InspectedProgram result = inspect(*source, reading, grouping, {}, command.runs_it);
  if (changed_while_read(watched) || changed_while_read(called)) {
    return static_cast<int>(ExitCode::kFileError);
  }
  print(result.found, *source, command.log_level, command.command_line);
  if (command.json_file != "-" && command.page.file != "-") {
    const std::string nothing =
        result.kept.any_run ? "" : fmt::format(": {}", why_nothing(result.kept));
    const std::string text =
        fmt::format("{}: {} blocks{}\n", source->name(), result.blocks, nothing) +
        runs_table(result.sections) + kept_table(result) + text_of(called.files) +
        own_words_text(command.own_words);
    if (const int code = write_result("-", text, false); code != 0) return code;
  }
  if (!command.json_file.empty() || command.page.is_wanted()) {
    const Json json = json_of(result, command, called, *source);
    write_report(command.json_file, command.force, [&] { return json_text(json); });
    const int code = write_inspect_page(command, *source, reading, result, json);
    if (code != 0) return code;
  }
  if (!result.unit_word_seen && !gcode::has_error(result.found)) {
    say(source->name() +
        ": no G20 or G21 says whether its numbers are inches or millimetres; say --units mm or "
        "--units inch");
    return static_cast<int>(ExitCode::kNotUnderstood);
  }
  return static_cast<int>(gcode::has_error(result.found) ? ExitCode::kNotUnderstood
                                                         : ExitCode::kDone);
}

}  // namespace batten::postproc
