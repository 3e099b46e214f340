#include "postproc/report/html_report.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <nlohmann/json.hpp>

#include "gcode/interpreter/interpreter.h"
#include "gcode/reading/parser.h"
#include "postproc/convert/conversion.h"
#include "postproc/proof/verification.h"
#include "postproc/report/page_files.h"
#include "postproc/text/words.h"

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

std::int64_t rounded(double value) { return std::llround(value); }

std::int64_t curvature_step(double curvature) {
  if (!(curvature > kLeastCurvature)) return 0;
  return rounded(kStepsPerDoubling * std::log2(curvature / kLeastCurvature));
}

bool has_offset(const PageVertex& v) {
  return v.step == PageStep::kRewritten || !v.offset.isZero();
}

Column offsets_of(const PagePath& path, int axis) {
  Column column;
  // Of the rounded places, so that place and offset together are the new place.
  for (const PageVertex& v : path.vertices) {
    if (has_offset(v)) column.push_back(rounded(v.offset[axis] / kUnit));
  }
  return column;
}

// One list per field instead of a name per field and run.
Json columns_of(const Json& runs) {
  Json columns = Json::object();
  for (const Json& run : runs) {
    for (const auto& [name, value] : run.items()) columns[name].push_back(value);
  }
  return columns;
}

// {"drawn": n, .. the corners of each polygon, and their places in a text per axis}
Json region_columns(const PageRegion& region) {
  Column sizes;
  std::array<Column, 3> places;
  for (const auto& polygon : region.polygons) {
    sizes.push_back(static_cast<std::int64_t>(polygon.size()));
    for (const geometry::Point3& corner : polygon) {
      for (int axis = 0; axis < 3; ++axis) places[axis].push_back(rounded(corner[axis] / kUnit));
    }
  }
  return {{"drawn", region.drawn},
          {"in_space", region.in_space},
          {"left_out", region.left_out},
          {"most_edges", kMostRegionEdges},
          {"sizes", packed(sizes)},
          {"x", packed(steps_of(places[0]))},
          {"y", packed(steps_of(places[1]))},
          {"z", packed(steps_of(places[2]))}};
}

// {"count": n, "unit_mm": 0.0001, .. and a text per column (postproc/report/page_path.h)}
Json path_columns(const PagePath& path) {
  using V = const PageVertex&;
  const auto column = [&](const auto& value) {
    Column numbers;
    for (V v : path.vertices) numbers.push_back(static_cast<std::int64_t>(value(v)));
    return numbers;
  };
  const auto place = [&](int axis) {
    return packed(steps_of(column([axis](V v) { return rounded(v.place[axis] / kUnit); })));
  };
  const auto lines = [&](auto PageVertex::*line) {
    return packed_runs(steps_of(column([line](V v) { return v.*line; })));
  };
  const auto curvature = [&](double PageVertex::*of) {
    return packed(steps_of(column([of](V v) { return curvature_step(v.*of); })));
  };
  const double fastest = fastest_of(path.vertices);
  const auto speed = [&](double PageVertex::*of) {
    return packed(steps_of(
        column([&](V v) { return fastest > 0 ? rounded(kSpeedSteps * v.*of / fastest) : 0; })));
  };
  return {{"count", path.vertices.size()},
          {"unit_mm", kUnit},
          {"drawn_within_mm", path.drawn_within},
          {"sections", path.sections},
          {"sections_not_shown", path.sections_not_shown},
          {"pairs", path.pairs},
          {"x", place(0)},
          {"y", place(1)},
          {"z", place(2)},
          {"has_offset", packed_runs(column(&has_offset))},
          {"dx", packed(offsets_of(path, 0))},
          {"dy", packed(offsets_of(path, 1))},
          {"dz", packed(offsets_of(path, 2))},
          {"step", packed_runs(column([](V v) { return v.step; }))},
          {"old_line", lines(&PageVertex::old_line)},
          {"new_line", lines(&PageVertex::new_line)},
          {"run", packed_runs(column([](V v) { return v.run; }))},
          {"feed_unit", kFeedUnit},
          {"feed", packed_runs(column([](V v) { return rounded(v.feed / kFeedUnit); }))},
          {"curvature_least", kLeastCurvature},
          {"curvature_steps", kStepsPerDoubling},
          {"curvature_before", curvature(&PageVertex::curvature_before)},
          {"curvature_after", curvature(&PageVertex::curvature_after)},
          {"speed_unit", fastest / kSpeedSteps},
          {"speed_before", speed(&PageVertex::speed_before)},
          {"speed_after", speed(&PageVertex::speed_after)},
          {"region", region_columns(path.region)}};
}

Json path_of(const SmoothReport& report) {
  const SmoothResult& result = report.result;
  const SmoothOptions& options = report.options;
  if (!result.understood) return path_columns({});
  const gcode::SourceText written(report.source.name(), result.text);
  const gcode::ReadOptions reading = read_options_of(options);
  gcode::Diagnostics ignored;
  const auto foreign = language_to_translate(report.source, options);
  const auto language = foreign ? foreign : language_read(report.source, options, ignored);
  if (!language) return path_columns({});
  const gcode::Reading words = reading_of(options, *language);
  const gcode::Program before = gcode::parse(report.source, words, ignored);
  const gcode::Interpretation old_meaning = gcode::interpret(before, reading, ignored);
  gcode::Reading new_words = foreign ? reading_of(options, options.target->language) : words;
  if (foreign) new_words.dwells = options.target->dwell_form;
  const gcode::Program after = gcode::parse(written, new_words, ignored);
  const gcode::Interpretation new_meaning = gcode::interpret(after, reading, ignored);
  const ReadProgram old_program{&before, &old_meaning};
  const ReadProgram new_program{&after, &new_meaning};
  const Verification verification =
      verify(old_program, new_program, {options.tolerance_mm, options.tolerance_kind});
  std::vector<PageLines> runs;
  for (const RunReport& run : result.runs) runs.push_back({run.first_line, run.last_line});
  Json columns = path_columns(page_path(old_program, new_program, verification, runs,
                                        {.tolerance_mm = options.tolerance_mm,
                                         .kind = options.tolerance_kind,
                                         .machine = options.machine}));
  columns["events"] = verification.events_compared;
  return columns;
}

// --- the page ----------------------------------------------------------------------------------

// Inside <script> only `<` could end the element or begin a comment; JSON may say it as \u003c.
std::string script_safe(std::string_view json) { return escaped(json, {{'<', "\\u003c"}}); }

std::string html_safe(std::string_view text) {
  return escaped(text, {{'<', "&lt;"}, {'>', "&gt;"}, {'&', "&amp;"}});
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

std::string page_of(std::string_view title, const Json& data) {
  const std::string json = data.dump(-1, ' ', false, Json::error_handler_t::replace);
  return filled(page_template(), {{"@TITLE@", html_safe(title)},
                                  {"@STYLE@", page_style()},
                                  {"@DATA@", script_safe(json)},
                                  {"@SCRIPT@", page_script()}});
}

std::string page_of(const PageOf& page, const ReadProgram& program, Json path) {
  return page_of(page.title, {{"kind", page.kind},
                              {"report", page.report},
                              {"command", page.command},
                              {"units", name_of(first_units(*program.interpretation))},
                              {"path", std::move(path)}});
}

}  // namespace

Json page_data(const SmoothReport& report, const std::string& command) {
  Json figures = smooth_json(report);
  figures["runs"] = columns_of(figures["runs"]);
  return {{"kind", "smooth"},
          {"report", std::move(figures)},
          {"command", command},
          {"units", name_of(report.result.units)},
          {"path", path_of(report)}};
}

std::string html_report(const SmoothReport& report, const std::string& command) {
  return page_of(report.source.name(), page_data(report, command));
}

std::string html_report(const PageOf& page, const ReadProgram& program, const Machine* machine) {
  const PagePathOptions options{.machine = machine};
  return page_of(page, program, path_columns(page_path(program, program, {}, page.rows, options)));
}

std::string html_report(const PageOf& page, const ReadProgram& before, const ReadProgram& after,
                        const Promise& promise) {
  const Verification verification = verify(before, after, promise);
  Json path = path_columns(page_path(before, after, verification, page.rows,
                                     {.tolerance_mm = promise.tolerance_mm, .kind = promise.kind}));
  path["events"] = verification.events_compared;
  return page_of(page, before, std::move(path));
}

}  // namespace batten::postproc
