#include "postproc/report/html_report.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <memory>
#include <nlohmann/json.hpp>
#include <optional>
#include <string_view>
#include <utility>
#include <vector>

#include "gcode/interpreter/interpreter.h"
#include "gcode/reading/parser.h"
#include "postproc/convert/conversion.h"
#include "postproc/proof/verification.h"
#include "postproc/report/page_files.h"
#include "postproc/report/page_path.h"
#include "postproc/report/page_speed.h"
#include "postproc/report/smooth_report.h"

namespace batten::postproc {
namespace {

// --- what the page is told ---------------------------------------------------------------------

// mm: a tenth of the finest step that targets print.
constexpr double kUnit = 1e-4;
// mm/min: one step of a feed.
constexpr double kFeedUnit = 0.01;

// Curvatures are told in steps of a sixteenth of a doubling (4 %), from a radius of 100 m on.
constexpr double kLeastCurvature = 1e-5;
constexpr double kStepsPerDoubling = 16;
// Speeds in this many steps of the greatest.
constexpr double kSpeedSteps = 1000;

using Column = std::vector<std::int64_t>;

std::int64_t rounded(double value) { return std::llround(value); }

std::int64_t curvature_step(double curvature) {
  if (!(curvature > kLeastCurvature)) return 0;
  return rounded(kStepsPerDoubling * std::log2(curvature / kLeastCurvature));
}

template <typename Function>
Column column_of(const PagePath& path, const Function& value) {
  Column column;
  column.reserve(path.vertices.size());
  for (const PageVertex& v : path.vertices) column.push_back(value(v));
  return column;
}

// Three numbers for each vertex that has an offset to tell of.
Column offsets_of(const PagePath& path, int axis) {
  Column column;
  // Of the rounded places, so that place and offset together are the new place.
  for (const PageVertex& v : path.vertices) {
    if (v.step != PageStep::kRewritten && v.offset.isZero()) continue;
    column.push_back(rounded(v.offset[axis] / kUnit));
  }
  return column;
}

double fastest_of(const PagePath& path) {
  double fastest = 0;
  for (const PageVertex& v : path.vertices) {
    fastest = std::max({fastest, v.speed_before, v.speed_after});
  }
  return fastest;
}

// One list per field instead of a name per field and run.
Json columns_of(const Json& runs) {
  Json columns = Json::object();
  for (const Json& run : runs) {
    for (const auto& [name, value] : run.items()) columns[name].push_back(value);
  }
  return columns;
}

SpeedAlong speed_along(const ReadProgram& read, const Machine& machine) {
  const auto speeds = std::make_shared<ProgramSpeeds>(read, list_events(read), machine);
  return [speeds](std::uint32_t motion, double share) { return speeds->at(motion, share); };
}

Json path_of(const SmoothReport& report, std::size_t most_vertices) {
  const SmoothResult& result = report.result;
  if (!result.understood) return path_columns({});
  const gcode::SourceText written(report.source.name(), result.text);
  const gcode::ReadOptions reading = read_options_of(report.options);
  gcode::Diagnostics ignored;
  const auto foreign = language_to_translate(report.source, report.options);
  const bool translated = foreign.has_value();
  const auto language =
      translated ? foreign : language_read(report.source, report.options, ignored);
  if (!language) return path_columns({});
  const gcode::Reading words = reading_of(report.options, *language);
  const gcode::Program before = gcode::parse(report.source, words, ignored);
  const gcode::Interpretation old_meaning = gcode::interpret(before, reading, ignored);
  gcode::Reading new_words = words;
  if (translated) {
    new_words = reading_of(report.options, report.options.target->language);
    new_words.dwells = report.options.target->dwell_form;
  }
  const gcode::Program after = gcode::parse(written, new_words, ignored);
  const gcode::Interpretation new_meaning = gcode::interpret(after, reading, ignored);
  const ReadProgram old_program{&before, &old_meaning};
  const ReadProgram new_program{&after, &new_meaning};
  const SmoothOptions& options = report.options;
  const Verification verification =
      verify(old_program, new_program, {options.tolerance_mm, options.tolerance_kind});
  PagePathOptions drawing = {options.tolerance_mm, options.tolerance_kind, most_vertices};
  if (options.machine != nullptr) {
    drawing.speed_before = speed_along(old_program, *options.machine);
    drawing.speed_after = speed_along(new_program, *options.machine);
  }
  Json columns =
      path_columns(page_path(old_program, new_program, verification, result.runs, drawing));
  columns["events"] = verification.events_compared;
  return columns;
}

// --- the page ----------------------------------------------------------------------------------

// Inside <script> only `<` could end the element or begin a comment; JSON may say it as \u003c.
std::string script_safe(std::string_view json) {
  std::string safe;
  safe.reserve(json.size());
  for (const char c : json) {
    if (c == '<') {
      safe += "\\u003c";
    } else {
      safe += c;
    }
  }
  return safe;
}

std::string html_safe(std::string_view text) {
  std::string safe;
  for (const char c : text) {
    switch (c) {
      case '<':
        safe += "&lt;";
        break;
      case '>':
        safe += "&gt;";
        break;
      case '&':
        safe += "&amp;";
        break;
      default:
        safe += c;
    }
  }
  return safe;
}

// The template with each @NAME@ of `parts` replaced once, in the order in which they stand.
std::string filled(std::string_view page,
                   std::initializer_list<std::pair<std::string_view, std::string_view>> parts) {
  std::string text;
  for (const auto& [mark, part] : parts) {
    const std::size_t place = page.find(mark);
    text += page.substr(0, place);
    text += part;
    page.remove_prefix(place + mark.size());
  }
  text += page;
  return text;
}

}  // namespace

Json path_columns(const PagePath& path) {
  const double fastest = fastest_of(path);
  const auto speed = [&](double value) {
    return fastest > 0 ? rounded(kSpeedSteps * value / fastest) : 0;
  };
  const auto place = [&](int axis) {
    return packed_steps(
        column_of(path, [axis](const PageVertex& v) { return rounded(v.place[axis] / kUnit); }));
  };
  return {
      {"count", path.vertices.size()},
      {"unit_mm", kUnit},
      {"drawn_within_mm", path.drawn_within},
      {"stretches", path.stretches},
      {"stretches_not_shown", path.stretches_not_shown},
      {"pairs", path.pairs},
      {"x", place(0)},
      {"y", place(1)},
      {"z", place(2)},
      {"has_offset",
       packed_runs(column_of(path,
                             [](const PageVertex& v) {
                               return v.step == PageStep::kRewritten || !v.offset.isZero() ? 1 : 0;
                             }))},
      {"dx", packed(offsets_of(path, 0))},
      {"dy", packed(offsets_of(path, 1))},
      {"dz", packed(offsets_of(path, 2))},
      {"step", packed_runs(column_of(
                   path, [](const PageVertex& v) { return static_cast<std::int64_t>(v.step); }))},
      {"old_line",
       packed_step_runs(column_of(
           path, [](const PageVertex& v) { return static_cast<std::int64_t>(v.old_line); }))},
      {"new_line",
       packed_step_runs(column_of(
           path, [](const PageVertex& v) { return static_cast<std::int64_t>(v.new_line); }))},
      {"run", packed_runs(column_of(
                  path, [](const PageVertex& v) { return static_cast<std::int64_t>(v.run); }))},
      {"feed_unit", kFeedUnit},
      {"feed", packed_runs(column_of(
                   path, [](const PageVertex& v) { return rounded(v.feed / kFeedUnit); }))},
      {"curvature_least", kLeastCurvature},
      {"curvature_steps", kStepsPerDoubling},
      {"curvature_before",
       packed_steps(column_of(
           path, [](const PageVertex& v) { return curvature_step(v.curvature_before); }))},
      {"curvature_after",
       packed_steps(
           column_of(path, [](const PageVertex& v) { return curvature_step(v.curvature_after); }))},
      {"speed_unit", fastest / kSpeedSteps},
      {"speed_before",
       packed_steps(column_of(path, [&](const PageVertex& v) { return speed(v.speed_before); }))},
      {"speed_after",
       packed_steps(column_of(path, [&](const PageVertex& v) { return speed(v.speed_after); }))},
  };
}

Json page_data(const SmoothReport& report, const HtmlReportOptions& options) {
  Json figures = smooth_json(report);
  figures["runs"] = columns_of(figures["runs"]);
  return {{"report", std::move(figures)},
          {"command", options.command},
          {"path", path_of(report, options.most_vertices)}};
}

std::string html_report(const SmoothReport& report, const HtmlReportOptions& options) {
  const Json data = page_data(report, options);
  const std::string json = data.dump(-1, ' ', false, Json::error_handler_t::replace);
  return filled(page_template(), {{"@TITLE@", html_safe(report.source.name())},
                                  {"@STYLE@", page_style()},
                                  {"@DATA@", script_safe(json)},
                                  {"@SCRIPT@", page_script()}});
}

}  // namespace batten::postproc
