#include "postproc/report/explore_report.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>

#include "gcode/curves/curve_format.h"
#include "postproc/report/smooth_report.h"
#include "postproc/text/json_values.h"
#include "postproc/text/words.h"

namespace batten::postproc {

namespace {

// Less than any digit that is shown.
constexpr double kNothing = 1e-6;

// A figure in a column, and how it was changed.
std::string changed(const std::string& figure, double before, double after) {
  const double change = before > kNothing ? 100 * (after / before - 1) : 0;
  const bool same = std::abs(change) < 0.5;
  return fmt::format(" {:>10} {:>7}", figure, same ? "" : fmt::format("{:+.0f} %", change));
}

std::string row_text(std::string_view title, const ExploredFigures& old,
                     const ExploredFigures& now) {
  const PathFigures& path = now.path;
  return fmt::format(
      "  {:<26}{}{}{}{}\n", title,
      changed(fmt::format("{:.2f} s", now.time_s), old.time_s, now.time_s),
      changed(fmt::format("{:.0f}", now.blocks), old.blocks, now.blocks),
      changed(fmt::format("{:.4f}", path.distance_mm), old.path.distance_mm, path.distance_mm),
      changed(fmt::format("{:.3f}", path.roughness), old.path.roughness, path.roughness));
}

std::string feeds_text(std::string_view title, const ExploredFigures& old,
                       const ExploredFigures& now) {
  std::string text = fmt::format("  {:<26}", title);
  for (std::size_t i = 0; i < now.at_feeds.size(); ++i) {
    text += changed(fmt::format("{:.2f} s", now.at_feeds[i]), old.at_feeds[i], now.at_feeds[i]);
  }
  return text + "\n";
}

std::string sentence_of(const Exploration& found) {
  if (!found.recommended) {
    const bool any = !found.rows.empty() && found.rows.front().before.path.length_mm > 0;
    return any ? "Leave the program as it is: no setting takes 1 % less time, 10 % fewer blocks or "
                 "comes 30 % nearer to the path that was meant, and is no worse otherwise."
               : "There is no run that may be rewritten: batten smooth --dry-run tells why.";
  }
  const ExploredRow& row = found.rows[*found.recommended];
  const SmoothOptions& options = row.options;
  return fmt::format("Recommended is a tolerance of {:g} mm, output {}, prefer {}{}.",
                     options.tolerance_mm, name_of(options.output), name_of(options.prefer),
                     changes_text(row.before.four(), row.after.four()));
}

// Arguments that smooth the program so; none where nothing is recommended.
std::vector<std::string> command_of(const ExploreReport& report) {
  const Exploration& found = report.found;
  if (!found.recommended) return {};
  const SmoothOptions& options = found.rows[*found.recommended].options;
  std::vector<std::string> words = {"smooth", report.input};
  words.insert(words.end(), report.more_options.begin(), report.more_options.end());
  const std::string tolerance = options.tolerance_inch
                                    ? fmt::format("{}in", *options.tolerance_inch)
                                    : fmt::format("{}", options.tolerance_mm);
  for (const std::string_view word :
       {"--tolerance", tolerance.c_str(), "--output", name_of(options.output).data(), "--prefer",
        name_of(options.prefer).data()}) {
    words.emplace_back(word);
  }
  return words;
}

// What is said where some runs stand for all.
std::string sampled_runs(const Exploration& found) {
  const auto is_sampled = [](const ExploredRow& row) { return row.runs_looked_at < row.runs; };
  const auto row = std::ranges::find_if(found.rows, is_sampled);
  if (row == found.rows.end()) return {};
  return fmt::format(
      "  estimates from {} of {} runs, but for the recommended setting: that is of all runs\n",
      row->runs_looked_at, row->runs);
}

// What is said of the target's curves where all forms but them were explored.
std::string untried_curves(const Exploration& found) {
  const auto has = [&](Form form) {
    return std::ranges::any_of(
        found.rows, [form](const ExploredRow& row) { return row.options.output == form; });
  };
  if (!has(Form::kAuto) || has(Form::kCurves)) return {};
  const gcode::CurveFormat* curves = found.rows.front().options.target->curves;
  return curves == nullptr
             ? ""
             : fmt::format(
                   "  {} was not tried: not every such control has it, or runs it faster; "
                   "--output curves explores it\n",
                   curves->name);
}

Json json_of(const ExploredFigures& figures) {
  Json json = {{"time_s", figures.time_s},
               {"blocks", figures.blocks},
               {"distance_mm", figures.path.distance_mm},
               {"roughness", figures.path.roughness}};
  if (!figures.at_feeds.empty()) json["at_feeds_s"] = figures.at_feeds;
  return json;
}

Json json_of(const ExploredRow& row) {
  return {{"tolerance_mm", row.options.tolerance_mm},
          {"output", name_of(row.options.output)},
          {"prefer", name_of(row.options.prefer)},
          {"dominated", row.dominated},
          {"proved", row.proved},
          {"runs", row.runs},
          {"runs_looked_at", row.runs_looked_at},
          {"before", json_of(row.before)},
          {"after", json_of(row.after)}};
}

}  // namespace

std::string explore_text(const ExploreReport& report) {
  const Exploration& found = report.found;
  std::string text =
      fmt::format("{}: {}\n  {:<26} {:>10} {:>18} {:>18} {:>18}\n", report.source.name(),
                  plural(found.rows.size(), "setting"), "tolerance output prefer", "time", "blocks",
                  "distance mm", "roughness");
  const ExploredRow* last = nullptr;
  for (const ExploredRow& row : found.rows) {
    const double tolerance = row.options.tolerance_mm;
    if (last == nullptr || last->options.tolerance_mm != tolerance) {
      text += row_text(fmt::format("{:g} mm, as it is", tolerance), row.before, row.before);
    }
    text += row_text(fmt::format("{} {:<7} {:<6} {}", row.dominated ? ' ' : '*', tolerance,
                                 name_of(row.options.output), name_of(row.options.prefer)),
                     row.before, row.after);
    last = &row;
  }
  text += "  * no other setting is as good in all four figures and better in one\n" +
          sampled_runs(found) + untried_curves(found);
  if (found.recommended) {
    const ExploredRow& row = found.rows[*found.recommended];
    text += fmt::format("\n  {:<26}", "feed");
    for (const double feed : kExploredFeeds) text += fmt::format(" {:>8.0f} %{:8}", 100 * feed, "");
    text += "\n" + feeds_text("as it is", row.before, row.before) +
            feeds_text("recommended", row.before, row.after);
  }
  text += "\n" + sentence_of(found) + "\n";
  const std::vector<std::string> command = command_of(report);
  return command.empty() ? text : text + "  " + command_line_of(command) + "\n";
}

std::string explore_json(const ExploreReport& report) {
  const Exploration& found = report.found;
  return json_text(as_report(
      "explore", {{"input", {{"file", report.source.name()}, {"blocks", found.read.blocks_in}}},
                  {"understood", found.read.understood},
                  {"feeds", kExploredFeeds},
                  {"settings", json_list(found.rows, [](const auto& row) { return json_of(row); })},
                  {"recommended", found.recommended ? Json(*found.recommended) : Json(nullptr)},
                  {"recommendation", sentence_of(found)},
                  {"command", command_of(report)},
                  {"diagnostics", diagnostics_json(found.read.diagnostics, report.source)}}));
}

}  // namespace batten::postproc
