// `batten methods --table`: paths from a JSON file, and what each method makes of them.
#include <fmt/format.h>

#include <algorithm>
#include <cstddef>
#include <nlohmann/json.hpp>
#include <optional>
#include <span>
#include <stdexcept>
#include <string>
#include <string_view>
#include <utility>
#include <variant>
#include <vector>

#include "geometry/basic/point.h"
#include "geometry/basic/rounding.h"
#include "postproc/commands/commands.h"
#include "postproc/commands/files.h"
#include "postproc/options/options.h"
#include "postproc/smooth/methods/method_table.h"
#include "postproc/system/exit_code.h"
#include "postproc/system/interrupt.h"
#include "postproc/text/json_values.h"

namespace batten::postproc {

namespace {

using geometry::Point3;
using geometry::ToleranceKind;

struct TableCase {
  std::string name;
  std::vector<double> tolerances;  // mm
  std::variant<PolylineCase, CurveCase> path;
  std::optional<double> first_step = {};  // of a curve that becomes lines
  std::vector<Json> printed = {};  // rows of a paper: their method, tolerance_mm and some figures
};

// What is wrong with the file: for the user.
class TableError : public std::runtime_error {
  using std::runtime_error::runtime_error;
};

// --- what is printed of a path -------------------------------------------------------------------

// A figure of a row: its key in the report, and as what it is printed.
struct Column {
  std::string_view key;
  std::string_view title;
  int decimals = 0;
};

// Of each kind of path. `less`: than of the curve as it is, in per cent.
constexpr Column kPolylineColumns[] = {
    {"time_s", "time, s", 4},
    {"greatest_curvature_per_mm", "curv., 1/mm", 3},
    {"deviation_mm", "deviation, mm", 4},
    {"pieces", "pieces"},
};
constexpr Column kTubeColumns[] = {
    {"mean_curvature_per_mm", "mean curv.", 4},   {"mean_curvature_less_percent", "less, %", 2},
    {"greatest_curvature_per_mm", "greatest", 4}, {"bends", "bends"},
    {"displacement_mm", "moved, mm", 4},          {"length_mm", "length, mm", 3},
    {"length_less_percent", "less, %", 2},        {"mean_feed_mm_per_s", "mm/s", 1},
    {"sampled_feed_mm_per_s", "sampled", 1},      {"s_curve_time_s", "time, s", 3},
    {"s_curve_time_less_percent", "less, %", 2},
};
constexpr Column kLinesColumns[] = {
    {"lines", "lines"},
    {"length_mm", "length, mm", 6},
    {"deviation_mm", "deviation, mm", 6},
    {"left_mm", "left, mm", 6},
    {"right_mm", "right, mm", 6},
    {"jumps", "jumps"},
    {"jumps_mm", "jumps, mm", 4},
};

std::span<const Column> columns_of(const TableCase& given) {
  if (std::holds_alternative<PolylineCase>(given.path)) return kPolylineColumns;
  if (given.first_step) return kLinesColumns;
  return kTubeColumns;
}

// --- from JSON -----------------------------------------------------------------------------------

constexpr double kUsualTolerance = 0.05;                        // mm, of polylines
const std::vector<double> kThesisRadii = {0.025, 0.125, 0.25};  // mm, Naseath 2007

double number_in(const nlohmann::json& value, std::string_view what) {
  if (!value.is_number()) throw TableError(fmt::format("{}: expected a number", what));
  return value.get<double>();
}

std::vector<double> numbers_in(const nlohmann::json& value, std::string_view what) {
  if (!value.is_array()) return {number_in(value, what)};
  std::vector<double> numbers;
  for (const auto& each : value) numbers.push_back(number_in(each, what));
  return numbers;
}

std::vector<Point3> points_in(const nlohmann::json& value, std::string_view what) {
  std::vector<Point3> points;
  for (const auto& each : value) {
    const std::vector<double> xyz = numbers_in(each, what);
    if (xyz.size() != 2 && xyz.size() != 3) {
      throw TableError(fmt::format("{}: expected a list of [x, y] or [x, y, z] in mm", what));
    }
    points.emplace_back(xyz[0], xyz[1], xyz.size() == 3 ? xyz[2] : 0.0);
  }
  return points;
}

TableCase case_in(const std::string& name, const nlohmann::json& given) {
  const auto what = [&](std::string_view key) { return fmt::format("case '{}': {}", name, key); };
  TableCase found{name, {}, PolylineCase{}};
  if (given.contains("tolerance")) {
    found.tolerances = numbers_in(given["tolerance"], what("tolerance"));
  }
  const bool ring = given.value("ring", false);
  if (given.contains("points")) {
    PolylineCase path{points_in(given["points"], what("points")), ring};
    if (ring) {
      if (path.points.size() < 3) throw TableError(what("points: a ring has three or more"));
      if ((path.points.front() - path.points.back()).norm() > geometry::kSamePlace) {
        path.points.push_back(path.points.front());
      }
    }
    found.path = std::move(path);
    return found;
  }
  if (!given.contains("control_points") || !given.contains("distinct_knots")) {
    throw TableError(what("expected points, or control_points and distinct_knots"));
  }
  if (given.contains("first_step")) {
    found.first_step = number_in(given["first_step"], what("first_step"));
  }
  try {
    const std::vector<double> knots = numbers_in(given["distinct_knots"], what("distinct_knots"));
    const std::vector<Point3> points = points_in(given["control_points"], what("control_points"));
    const auto clamped = [&] {
      return geometry::BsplineCurve(geometry::BsplineBasis::clamped(3, knots), points);
    };
    found.path = CurveCase{ring ? geometry::ring_of(knots, points) : clamped(), ring};
  } catch (const std::invalid_argument& error) {
    throw TableError(what(error.what()));
  }
  return found;
}

// Rows as a paper prints them: {"method": .., "tolerance": .., and keys of the columns}. A figure
// without a tolerance is one of the path as it is, beside each of them.
std::vector<Json> printed_in(const nlohmann::json& given, const TableCase& of) {
  const std::string what = fmt::format("case '{}': printed", of.name);
  if (!given.is_array()) throw TableError(what + ": expected a list of rows");
  std::vector<Json> rows;
  for (const auto& row : given) {
    if (!row.is_object() || !row.contains("method") || !row["method"].is_string()) {
      throw TableError(what + ": expected a method in each row");
    }
    Json read = {{"method", row["method"].get<std::string>()}};
    for (const auto& [key, value] : row.items()) {
      if (key == "method" || key == "tolerance") continue;
      if (std::ranges::find(columns_of(of), key, &Column::key) == columns_of(of).end()) {
        std::vector<std::string_view> names;
        for (const Column& column : columns_of(of)) names.push_back(column.key);
        throw TableError(
            fmt::format("{}: {}: expected one of {}", what, key, fmt::join(names, ", ")));
      }
      read[key] = number_in(value, fmt::format("{}: {}", what, key));
    }
    const std::vector<double> tolerances = row.contains("tolerance")
                                               ? numbers_in(row["tolerance"], what + ": tolerance")
                                               : of.tolerances;
    for (const double tolerance : tolerances) {
      read["tolerance_mm"] = tolerance;
      rows.push_back(read);
    }
  }
  return rows;
}

geometry::Vector3 axes_in(const nlohmann::json& value, std::string_view what) {
  const std::vector<double> numbers = numbers_in(value, what);
  if (numbers.size() == 1) return geometry::Vector3::Constant(numbers[0]);
  if (numbers.size() != 3) {
    throw TableError(fmt::format("{}: expected a number, or three for X, Y and Z", what));
  }
  return {numbers[0], numbers[1], numbers[2]};
}

KinematicPathLimits limits_in(const nlohmann::json& given) {
  KinematicPathLimits limits;
  for (const auto& [key, value] : given.items()) {
    const std::string what = "limits: " + key;
    if (key == "feed_mm_per_s") {
      limits.feed = number_in(value, what);
    } else if (key == "speed_mm_per_s") {
      limits.speed = axes_in(value, what);
    } else if (key == "acceleration_mm_per_s2") {
      limits.acceleration = axes_in(value, what);
    } else if (key == "jerk_mm_per_s3") {
      limits.jerk = axes_in(value, what);
    } else if (key == "path_acceleration_mm_per_s2") {
      limits.tangential_acceleration = number_in(value, what);
    } else if (key == "path_jerk_mm_per_s3") {
      limits.tangential_jerk = number_in(value, what);
    } else if (key == "period_s") {
      limits.period = number_in(value, what);
    } else {
      throw TableError(
          what +
          ": expected feed_mm_per_s, speed_mm_per_s, acceleration_mm_per_s2, "
          "jerk_mm_per_s3, path_acceleration_mm_per_s2, path_jerk_mm_per_s3, period_s");
    }
  }
  require_sound(limits);
  return limits;
}

struct TableFile {
  TableSettings settings;
  std::vector<TableCase> cases;
};

TableFile table_in(std::string_view text, const MethodsCommand& command) {
  const auto document = nlohmann::ordered_json::parse(text);
  if (!document.is_object()) throw TableError("expected an object of cases");
  TableFile file;
  file.settings.guo_lambda = command.guo_lambda;
  if (document.contains("limits")) file.settings.limits = limits_in(document["limits"]);
  const auto& cases = document.contains("cases") ? document["cases"] : document;
  for (const auto& [name, given] : cases.items()) {
    if (!given.is_object() || name == "limits") continue;
    file.cases.push_back(case_in(name, given));
    TableCase& last = file.cases.back();
    if (command.tolerance_mm) last.tolerances = {*command.tolerance_mm};
    if (last.tolerances.empty()) {
      last.tolerances = std::holds_alternative<PolylineCase>(last.path)
                            ? std::vector<double>{kUsualTolerance}
                            : kThesisRadii;
    }
    if (given.contains("printed")) last.printed = printed_in(given["printed"], last);
  }
  if (file.cases.empty()) throw TableError("no case in it");
  return file;
}

// --- as text and as JSON -------------------------------------------------------------------------

std::string title_line(std::span<const Column> columns, std::string_view name) {
  std::string line = fmt::format("  {:<26}", name);
  for (const Column& column : columns) line += fmt::format(" {:>8}", column.title);
  return line + '\n';
}

std::string row_line(std::span<const Column> columns, std::string_view name, const Json& row) {
  std::string line = fmt::format("  {:<26}", name);
  for (const Column& column : columns) {
    const bool given = row.contains(column.key) && row[column.key].is_number();
    const std::string text =
        given ? fmt::format("{:.{}f}", row[column.key].get<double>(), column.decimals) : "-";
    line += fmt::format(" {:>{}}", text, std::max<std::size_t>(8, column.title.size()));
  }
  return line + '\n';
}

Json or_null(const std::optional<double>& value) { return value ? Json(*value) : Json(); }

Json json_of(const PolylineRow& row, double tolerance) {
  Json json = {{"method", row.method},
               {"tolerance_kind", name_of(row.kind)},
               {"tolerance_mm", tolerance},
               {"time_s", nullptr}};
  if (!row.figures) return json;
  json["time_s"] = row.figures->time;
  json["greatest_curvature_per_mm"] = or_null(row.figures->curvature);
  json["deviation_mm"] = or_null(row.figures->deviation);
  json["pieces"] = row.figures->pieces;
  return json;
}

// `before`: of the curve as it is.
Json json_of(const CurveRow& row, const CurveRow& before, double radius) {
  const auto less = [](double now, double was) { return 100 * (1 - now / was); };
  return {{"method", row.method},
          {"tolerance_mm", radius},
          {"mean_curvature_per_mm", row.curvature},
          {"mean_curvature_less_percent", less(row.curvature, before.curvature)},
          {"greatest_curvature_per_mm", row.greatest_curvature},
          {"bends", row.bends},
          {"displacement_mm", row.displacement},
          {"length_mm", row.length},
          {"length_less_percent", less(row.length, before.length)},
          {"mean_feed_mm_per_s", row.length / row.time},
          {"sampled_feed_mm_per_s", row.sampled_feed},
          {"s_curve_time_s", row.time},
          {"s_curve_time_less_percent", less(row.time, before.time)}};
}

Json json_of(const LinesRow& row, double tolerance) {
  return {{"method", row.method},
          {"tolerance_mm", tolerance},
          {"lines", row.lines},
          {"length_mm", row.length},
          {"deviation_mm", row.deviation},
          {"left_mm", row.beside.left},
          {"right_mm", row.beside.right},
          {"jumps", row.jumps},
          {"jumps_mm", row.jumped}};
}

std::vector<Json> rows_of(const TableCase& given, double tolerance, const TableSettings& settings) {
  std::vector<Json> rows;
  if (const auto* polyline = std::get_if<PolylineCase>(&given.path)) {
    for (const PolylineRow& row : method_rows(*polyline, tolerance, settings)) {
      rows.push_back(json_of(row, tolerance));
    }
    return rows;
  }
  const auto& curve = std::get<CurveCase>(given.path);
  if (given.first_step) {
    for (const LinesRow& row : line_rows(curve.curve, tolerance, *given.first_step)) {
      rows.push_back(json_of(row, tolerance));
    }
    return rows;
  }
  const std::vector<CurveRow> made = tube_rows(curve, tolerance, settings);
  for (const CurveRow& row : made) rows.push_back(json_of(row, made.front(), tolerance));
  return rows;
}

std::string name_in_table(const Json& row) {
  return row["method"].get<std::string>() +
         (row.value("tolerance_kind", "path") == "band" ? ", band" : "");
}

struct CaseTable {
  std::string text;
  Json json;
};

CaseTable table_of(const TableCase& given, const TableSettings& settings) {
  const std::span<const Column> columns = columns_of(given);
  const bool in_tube = columns.data() == kTubeColumns;
  CaseTable table{given.name + "\n", {{"case", given.name}, {"rows", Json::array()}}};
  for (const double tolerance : given.tolerances) {
    table.text +=
        title_line(columns, fmt::format("{} {} mm", in_tube ? "radius" : "tolerance", tolerance));
    for (Json& row : rows_of(given, tolerance, settings)) {
      table.text += row_line(columns, name_in_table(row), row);
      for (const Json& printed : given.printed) {
        if (printed["method"] != name_in_table(row) || printed["tolerance_mm"] != tolerance)
          continue;
        table.text += row_line(columns, "  as printed", printed);
      }
      table.json["rows"].push_back(std::move(row));
    }
  }
  if (!given.printed.empty()) table.json["printed"] = given.printed;
  table.text += '\n';
  return table;
}

}  // namespace

int run(const MethodsCommand& command) {
  if (!may_be_written(command.json_file, command.force)) {
    return static_cast<int>(ExitCode::kFileError);
  }
  const auto source = read_program(command.table_file);
  if (!source) return static_cast<int>(ExitCode::kFileError);
  Json cases = Json::array();
  try {
    const TableFile file = table_in(source->text(), command);
    for (const TableCase& each : file.cases) {
      const CaseTable table = table_of(each, file.settings);
      if (interrupted()) return end_interrupted();
      cases.push_back(table.json);
      if (command.json_file == "-") continue;
      if (const int code = write_result("-", table.text, false); code != 0) return code;
    }
  } catch (const nlohmann::json::exception& error) {
    say(fmt::format("{}: not as expected: {}", command.table_file, error.what()));
    return static_cast<int>(ExitCode::kNotUnderstood);
  } catch (const TableError& error) {
    say(fmt::format("{}: {}", command.table_file, error.what()));
    return static_cast<int>(ExitCode::kNotUnderstood);
  } catch (const std::invalid_argument& error) {
    say(fmt::format("{}: {}", command.table_file, error.what()));
    return static_cast<int>(ExitCode::kNotUnderstood);
  }
  write_report(command.json_file, command.force, [&] {
    return json_text(as_report("method-table", {{"cases", cases}}));
  });
  return static_cast<int>(ExitCode::kDone);
}

}  // namespace batten::postproc
