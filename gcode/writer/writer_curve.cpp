#include <array>
#include <cmath>
#include <variant>

#include "gcode/curves/curve_format.h"
#include "gcode/reading/parser.h"
#include "gcode/writer/writer.h"
#include "geometry/basic/rounding.h"

namespace batten::gcode {
namespace {

using geometry::Point3;

// The axes that the curve moves by more than rounding noise.
std::array<bool, 3> moved_axes(const geometry::BsplineCurve& curve, const Point3& start) {
  std::array<bool, 3> moved = {false, false, false};
  for (const Point3& point : curve.control_points()) {
    for (int axis = 0; axis < 3; ++axis) {
      moved[static_cast<std::size_t>(axis)] |=
          std::abs(point[axis] - start[axis]) > geometry::kSamePlace;
    }
  }
  return moved;
}

bool all_known(const std::array<bool, 3>& axes, const Position& position) {
  for (std::size_t axis = 0; axis < 3; ++axis) {
    if (axes[axis] && !position.known[axis]) return false;
  }
  return true;
}

// Where the curve ends that the control reads in these lines, and its feed.
struct ReadAgain {
  Position end;
  std::optional<double> feed;
};

// Nothing when the control reads the lines as anything else than curves that follow each other.
std::optional<ReadAgain> read_again(const std::string& text, std::size_t lines,
                                    const Dialect& dialect, const CurveStart& start) {
  Diagnostics ignored;
  const CurveFormat& format = *dialect.curves();
  const Program program = parse(SourceText("", text), dialect.language(), ignored);
  ReadAgain read{start.position, {}};
  for (std::uint32_t block = 0; block < lines;) {
    const CurveResult result = format.read(program, block, {read.end, start.units});
    const auto* reading = std::get_if<CurveReading>(&result);
    if (reading == nullptr || reading->blocks == 0 || reading->motions.empty()) return {};
    read.end.mm = geometry::end_point(reading->motions.back().piece);
    if (reading->feed) read.feed = reading->feed;
    block += reading->blocks;
  }
  return read;
}

}  // namespace

bool Writer::curve_to(const geometry::BsplineCurve& curve, double feed, int last_decimals) {
  const CurveFormat* format = dialect_.curves();
  if (format == nullptr || !format->complaint(state_.modal).empty()) return false;
  CurveSetting setting;
  setting.units = state_.modal.units;
  setting.places = coordinates_;
  setting.other = format->other_numbers(setting.units);
  setting.feeds = feeds_;
  setting.last_decimals = last_decimals;
  setting.start = state_.position.mm;
  setting.axes = moved_axes(curve, setting.start);
  if (format->names_all_axes()) setting.axes = {true, true, true};
  if (!all_known(setting.axes, state_.position)) return false;
  if (!feed_is_said(feed)) setting.feed = feed;
  setting.blanks = dialect_.blanks_between_words();

  const CurveWriting written = format->write(curve, setting);
  const auto* lines = std::get_if<CurveLines>(&written);
  if (lines == nullptr) return false;
  std::string text;
  for (const std::string& line : *lines) {
    text += line;
    text += line_end_;
  }
  const auto read = read_again(text, lines->size(), dialect_, {state_.position, setting.units});
  if (!read) return false;
  text_ += text;
  state_.position = read->end;
  state_.modal.motion = MotionMode::kOther;
  if (read->feed) state_.modal.feed = *read->feed * unit_;
  return true;
}

void Writer::end_curve() {
  if (state_.modal.motion != MotionMode::kOther || !dialect_.spelling().motion_stays()) return;
  add_motion(MotionMode::kLine);
  end_block();
}

}  // namespace batten::gcode
