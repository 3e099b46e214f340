// `batten methods --table`: paths from a JSON file, and what each method makes of them.
#include <fmt/format.h>

#include <cmath>
#include <nlohmann/json.hpp>
#include <optional>
#include <stdexcept>
#include <string>
#include <string_view>
#include <utility>
#include <variant>
#include <vector>

#include "geometry/basic/point.h"
#include "postproc/commands/commands.h"
#include "postproc/commands/files.h"
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
  std::variant<PolylineCase, geometry::BsplineCurve> path;
  std::optional<double> first_step;  // of a curve that becomes lines
};

// What is wrong with the file: for the user.
class TableError : public std::runtime_error {
  using std::runtime_error::runtime_error;
};

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
  TableCase found{name, {}, PolylineCase{}, std::nullopt};
  if (given.contains("tolerance")) {
    found.tolerances = numbers_in(given["tolerance"], what("tolerance"));
  }
  if (given.contains("points")) {
    PolylineCase path{points_in(given["points"], what("points"))};
    if (given.contains("ring") && given["ring"].is_boolean() && given["ring"].get<bool>()) {
      if (path.points.size() < 3) throw TableError(what("points: a ring has three or more"));
      path.ring = true;
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
    found.path =
        geometry::BsplineCurve(geometry::BsplineBasis::clamped(
                                   3, numbers_in(given["distinct_knots"], what("distinct_knots"))),
                               points_in(given["control_points"], what("control_points")));
  } catch (const std::invalid_argument& error) {
    throw TableError(what(error.what()));
  }
  return found;
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
    if (!last.tolerances.empty()) continue;
    last.tolerances = std::holds_alternative<PolylineCase>(last.path)
                          ? std::vector<double>{kUsualTolerance}
                          : kThesisRadii;
  }
  if (file.cases.empty()) throw TableError("no case in it");
  return file;
}

// --- as text and as JSON -------------------------------------------------------------------------

std::string or_dash(const std::optional<double>& value, int decimals) {
  return value ? fmt::format("{:.{}f}", *value, decimals) : "-";
}

Json or_null(const std::optional<double>& value) { return value ? Json(*value) : Json(); }

struct CaseTable {
  std::string text;
  Json rows = Json::array();
};

void add_polyline(const PolylineCase& path, double tolerance, const TableSettings& settings,
                  CaseTable& table) {
  table.text +=
      fmt::format("  {:<22} {:>9} {:>13} {:>13} {:>7}\n", fmt::format("tolerance {} mm", tolerance),
                  "time, s", "curv., 1/mm", "deviation, mm", "pieces");
  for (const PolylineRow& row : method_rows(path, tolerance, settings)) {
    const bool band = row.kind == ToleranceKind::kBand;
    const std::string name = row.method + (band ? ", band" : "");
    Json json = {{"method", row.method},
                 {"tolerance_kind", band ? "band" : "path"},
                 {"tolerance_mm", tolerance},
                 {"time_s", nullptr}};
    if (row.figures) {
      const auto& [time, curvature, deviation, pieces] = *row.figures;
      table.text += fmt::format("  {:<22} {:>9.4f} {:>13} {:>13} {:>7}\n", name, time,
                                or_dash(curvature, 3), or_dash(deviation, 4), pieces);
      json["time_s"] = time;
      json["greatest_curvature_per_mm"] = or_null(curvature);
      json["deviation_mm"] = or_null(deviation);
      json["pieces"] = pieces;
    } else {
      table.text += fmt::format("  {:<22} no curve\n", name);
    }
    table.rows.push_back(std::move(json));
  }
}

void add_curve(const geometry::BsplineCurve& curve, double radius, const TableSettings& settings,
               CaseTable& table) {
  table.text += fmt::format("  {:<22} {:>9} {:>7} {:>11} {:>11} {:>7} {:>8} {:>9} {:>7}\n",
                            fmt::format("radius {} mm", radius), "mean curv.", "less", "greatest",
                            "length, mm", "less", "mm/s", "time, s", "less");
  const std::vector<CurveRow> rows = tube_rows(curve, radius, settings);
  const CurveRow& before = rows.front();
  const auto less = [](double now, double was) { return 100 * (1 - now / was); };
  for (const CurveRow& row : rows) {
    table.text += fmt::format(
        "  {:<22} {:>10.4f} {:>5.1f} % {:>11.4f} {:>11.3f} {:>5.2f} % {:>8.1f} {:>9.3f} {:>5.1f} "
        "%\n",
        row.method, row.curvature, less(row.curvature, before.curvature), row.greatest_curvature,
        row.length, less(row.length, before.length), row.length / row.time, row.time,
        less(row.time, before.time));
    table.rows.push_back({{"method", row.method},
                          {"tolerance_mm", radius},
                          {"mean_curvature_per_mm", row.curvature},
                          {"greatest_curvature_per_mm", row.greatest_curvature},
                          {"length_mm", row.length},
                          {"s_curve_time_s", row.time}});
  }
}

void add_lines(const geometry::BsplineCurve& curve, double tolerance, double first_step,
               CaseTable& table) {
  table.text +=
      fmt::format("  {:<22} {:>7} {:>13} {:>13}\n", fmt::format("tolerance {} mm", tolerance),
                  "lines", "length, mm", "deviation, mm");
  for (const LinesRow& row : line_rows(curve, tolerance, first_step)) {
    table.text += fmt::format("  {:<22} {:>7} {:>13.6f} {:>13.6f}\n", row.method, row.lines,
                              row.length, row.deviation);
    table.rows.push_back({{"method", row.method},
                          {"tolerance_mm", tolerance},
                          {"lines", row.lines},
                          {"length_mm", row.length},
                          {"deviation_mm", row.deviation}});
  }
}

CaseTable table_of(const TableCase& given, const TableSettings& settings) {
  CaseTable table;
  table.text = given.name + "\n";
  for (const double tolerance : given.tolerances) {
    if (const auto* polyline = std::get_if<PolylineCase>(&given.path)) {
      add_polyline(*polyline, tolerance, settings, table);
    } else if (given.first_step) {
      add_lines(std::get<geometry::BsplineCurve>(given.path), tolerance, *given.first_step, table);
    } else {
      add_curve(std::get<geometry::BsplineCurve>(given.path), tolerance, settings, table);
    }
  }
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
      cases.push_back({{"case", each.name}, {"rows", table.rows}});
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
