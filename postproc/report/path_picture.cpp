#include "postproc/report/path_picture.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdlib>
#include <iterator>
#include <optional>
#include <set>
#include <utility>
#include <vector>

#include "gcode/interpreter/interpreter.h"
#include "gcode/reading/parser.h"
#include "geometry/path/path.h"
#include "postproc/convert/conversion.h"

namespace batten::postproc {
namespace {

using geometry::Point3;

// More lines than this look the same at this size: the grid on which the path is drawn gets coarser
// until so many are left.
constexpr std::size_t kMostLines = 1500;
constexpr int kFinest = 1;  // of the grid, in units of the picture
constexpr int kCoarsest = 16;
constexpr int kShortest = 3;  // line, in steps of the grid: shorter ones are seen as steps
constexpr double kMargin = 6;
constexpr int kPartsOfArc = 12;

struct Places {
  std::vector<Point3> places;
  std::vector<bool> begins;  // a chain: nothing leads here
  std::vector<bool> is_rewritten;
};

Places places_of(const gcode::Program& program, const gcode::Interpretation& meaning,
                 const std::vector<RunReport>& runs) {
  Places path;
  const auto add = [&path](const Point3& place, bool begins, bool is_rewritten) {
    path.places.push_back(place);
    path.begins.push_back(begins);
    path.is_rewritten.push_back(is_rewritten);
  };
  bool goes_on = false;
  auto run = runs.begin();
  for (const gcode::Motion& motion : meaning.motions) {
    if (motion.kind == gcode::MotionKind::kRapid || !motion.start_known || !motion.end_known) {
      goes_on = false;
      continue;
    }
    const std::uint32_t line = program.blocks[motion.block].line;
    while (run != runs.end() && run->last_line < line) ++run;
    const bool is_rewritten =
        run != runs.end() && run->first_line <= line && run->status == RunStatus::kRewritten;
    const geometry::PathPiece piece = motion.piece;
    if (!goes_on) add(geometry::point_at(piece, 0), true, is_rewritten);
    const int parts = std::holds_alternative<geometry::Line>(piece) ? 1 : kPartsOfArc;
    for (int k = 1; k <= parts; ++k) {
      add(geometry::point_at(piece, double(k) / parts), false, is_rewritten);
    }
    goes_on = true;
  }
  return path;
}

// In the picture: its axes, and where the path lies.
struct View {
  int right = 0;
  int up = 1;
  Point3 low = Point3::Zero();
  double scale = 1;
  double left = 0;
  double bottom = PathPicture::kHeight;
};

View view_of(const Places& path) {
  View view;
  Point3 high = path.places.front();
  view.low = high;
  for (const Point3& place : path.places) {
    view.low = view.low.cwiseMin(place);
    high = high.cwiseMax(place);
  }
  const geometry::Vector3 size = high - view.low;
  // From above unless it is a line from there.
  if (std::min(size.x(), size.y()) < 0.02 * size.maxCoeff() && size.z() > size.minCoeff()) {
    view.right = size.x() >= size.y() ? 0 : 1;
    view.up = 2;
  }
  const double wide = std::max(size[view.right], 1e-9);
  const double tall = std::max(size[view.up], 1e-9);
  const double room_right = PathPicture::kWidth - 2 * kMargin;
  const double room_up = PathPicture::kHeight - 2 * kMargin;
  view.scale = std::min(room_right / wide, room_up / tall);
  view.left = (PathPicture::kWidth - wide * view.scale) / 2;
  view.bottom = (PathPicture::kHeight + tall * view.scale) / 2;
  return view;
}

using Cell = std::pair<int, int>;
using Line = std::pair<Cell, Cell>;

// Each line once, as pens draw: a text for what is kept, one for what is rewritten. Nothing: there
// are more lines than wanted.
std::optional<PathPicture> drawn(const Places& path, const View& view, int step,
                                 std::size_t most_lines) {
  const auto cell_of = [&](const Point3& place) -> Cell {
    const double right = view.left + (place[view.right] - view.low[view.right]) * view.scale;
    const double down = view.bottom - (place[view.up] - view.low[view.up]) * view.scale;
    return {static_cast<int>(std::lround(right / step)) * step,
            static_cast<int>(std::lround(down / step)) * step};
  };
  PathPicture picture;
  std::set<Line> lines;
  Cell last;
  std::array<std::optional<Cell>, 2> pens;  // where they stand
  for (std::size_t i = 0; i < path.places.size(); ++i) {
    const Cell cell = cell_of(path.places[i]);
    if (path.begins[i]) {
      last = cell;
      continue;
    }
    const int way =
        std::max(std::abs(cell.first - last.first), std::abs(cell.second - last.second));
    const bool is_end = i + 1 == path.places.size() || path.begins[i + 1];
    if (way == 0 || (way < kShortest * step && !is_end)) continue;
    if (lines.insert(std::minmax(last, cell)).second) {
      if (lines.size() > most_lines) return std::nullopt;
      std::string& text = path.is_rewritten[i] ? picture.rewritten : picture.kept;
      auto& pen = pens.at(path.is_rewritten[i] ? 1 : 0);
      if (pen != last) fmt::format_to(std::back_inserter(text), "M{} {}", last.first, last.second);
      fmt::format_to(std::back_inserter(text), "L{} {}", cell.first, cell.second);
      pen = cell;
    }
    last = cell;
  }
  return picture;
}

}  // namespace

PathPicture path_picture(const SmoothReport& report) {
  gcode::Diagnostics ignored;
  const auto foreign = language_to_translate(report.source, report.options);
  const auto language = foreign ? foreign : language_read(report.source, report.options, ignored);
  if (!report.result.understood || !language) return {};
  const gcode::Program program =
      gcode::parse(report.source, reading_of(report.options, *language), ignored);
  const gcode::Interpretation meaning =
      gcode::interpret(program, read_options_of(report.options), ignored);
  const Places path = places_of(program, meaning, report.result.runs);
  if (path.places.empty()) return {};
  const View view = view_of(path);
  for (int step = kFinest; step < kCoarsest; step *= 2) {
    if (auto picture = drawn(path, view, step, kMostLines)) return *picture;
  }
  return drawn(path, view, kCoarsest, path.places.size()).value_or(PathPicture{});
}

}  // namespace batten::postproc
