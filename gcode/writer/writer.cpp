#include "gcode/writer/writer.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <stdexcept>
#include <utility>
#include <variant>

#include "gcode/controls/arc_rules.h"
#include "gcode/curves/curve_format.h"
#include "gcode/reading/parser.h"
#include "gcode/text/number_format.h"
#include "geometry/basic/rounding.h"

namespace batten::gcode {
namespace {

// With no more decimals than it takes for steps of so much.
NumberFormat with_step(NumberFormat format, double step) {
  while (format.decimals > 0 && std::pow(10.0, 1 - format.decimals) <= step) --format.decimals;
  return format;
}

using geometry::Point3;

const PlaneAxes& arc_plane(const geometry::Vector3& axis) {
  const PlaneAxes* plane = plane_across(axis);
  if (plane != nullptr) return *plane;
  throw std::invalid_argument("Writer: arc axis (" + std::to_string(axis.x()) + ", " +
                              std::to_string(axis.y()) + ", " + std::to_string(axis.z()) +
                              "), expected an axis of the coordinate system");
}

// --- the printed centre of an arc between two printed ends ---

using PlanePoint = Eigen::Vector2d;  // in the arc's plane, in the program's units

// Centres that can be printed: `base` plus whole multiples of `step` on both axes. The base is
// the arc's start where centres are offsets, zero where they are absolute.
struct CenterGrid {
  PlanePoint base = PlanePoint::Zero();
  double step = 0;
};

// How many steps the centre may move along the bisector in search of a grid point near it. Among
// 16 steps of a line there are grid points within about a thirtieth of a step.
constexpr int kStepsAlong = 8;

// Ends closer than this many steps have no direction worth the name.
constexpr double kLeastChord = 4;

// What a step along the bisector costs at the least, so that the wanted centre wins where the
// choice is idle.
constexpr double kLeastCost = 0.05;

PlanePoint nearest(const PlanePoint& place, const CenterGrid& grid) {
  return ((place - grid.base) / grid.step).array().round().matrix();
}

// What a step along the bisector costs, per step across it: by so much it moves the middle of the
// arc. A step across makes the radii at the ends differ by up to two steps. So the centre that
// costs least moves no place of the arc by more than plain rounding of the centre could.
double cost_along(double sweep) { return std::max(1 - std::cos(sweep / 2), kLeastCost); }

// The whole multiples (not multiplied by the step) of the centre to be printed for an arc of
// this sweep (radians, either sign) from `start` to `end` about `wanted`.
//
// The printed centre is off the wanted one for two reasons. Across the bisector of the ends it
// makes the radii at the ends differ; along the bisector it keeps them equal and moves the middle
// of the arc, by the less the shorter the arc is. So a centre near the bisector is sought among
// those a few steps from the wanted one.
PlanePoint printed_center(const PlanePoint& start, const PlanePoint& end, const PlanePoint& wanted,
                          double sweep, const CenterGrid& grid) {
  const PlanePoint chord = end - start;
  if (chord.norm() < kLeastChord * grid.step) return nearest(wanted, grid);
  const PlanePoint across = chord.normalized();
  const PlanePoint along(-across.y(), across.x());
  const PlanePoint middle = (start + end) / 2;
  const PlanePoint equal_radii = middle + (wanted - middle).dot(along) * along;

  const double per_step_along = cost_along(sweep);
  PlanePoint best = nearest(equal_radii, grid);
  double least = std::numeric_limits<double>::infinity();
  for (int i = -kStepsAlong; i <= kStepsAlong; ++i) {
    const PlanePoint candidate = nearest(equal_radii + i * grid.step * along, grid);
    const PlanePoint off = grid.base + candidate * grid.step - equal_radii;
    const double cost = std::hypot(off.dot(across), per_step_along * off.dot(along));
    if (cost < least) {
      least = cost;
      best = candidate;
    }
  }
  return best;
}

PlanePoint in_plane(const Point3& place, const PlaneAxes& plane) {
  return {place[plane.first], place[plane.second]};
}

// The angle from `start` to `end` about `center` in the direction of `wanted`'s sign: above 0
// and at most a full turn in size.
double sweep_between(const PlanePoint& start, const PlanePoint& end, const PlanePoint& center,
                     double wanted) {
  const PlanePoint a = start - center;
  const PlanePoint b = end - center;
  const double angle = std::atan2(a.x() * b.y() - a.y() * b.x(), a.dot(b));
  if (wanted > 0) return angle > 0 ? angle : angle + 2 * std::numbers::pi;
  return angle < 0 ? angle : angle - 2 * std::numbers::pi;
}

void check(const ModalState& modal) {
  const bool known = modal.units != Units::kUnknown && modal.distance == DistanceMode::kAbsolute &&
                     modal.feed_mode == FeedMode::kPerMinute;
  if (!known) throw std::invalid_argument("Writer: expected known units, G90 and G94");
}

}  // namespace

struct Writer::PrintedArc {
  PlaneAxes plane;
  geometry::Arc arc;  // as the printed numbers say it, about the positive axis
  Coordinates end;
  std::array<std::string, 2> center;  // of the plane's first and second axis; empty: left out
  std::string radius;                 // empty where the centre is given

  // All in the plane, in units of the program; `sweep` as wished.
  void turn_about(const PlanePoint& about, const PlanePoint& from, const PlanePoint& to,
                  double sweep, double unit) {
    arc.sweep = sweep_between(from, to, about, sweep);
    arc.center = arc.start;
    arc.center[plane.first] = about.x() * unit;
    arc.center[plane.second] = about.y() * unit;
  }
};

Writer::Writer(const Control& control, WriterState state, std::string_view line_end)
    : control_(control),
      state_(std::move(state)),
      line_end_(line_end),
      unit_((check(state_.modal), millimetres_per(state_.modal.units))),
      coordinates_(place_format(control, state_.modal.units)),
      feeds_(feed_format(control)) {}

void Writer::line_to(const Point3& end, double feed) {
  const Coordinates coordinates = print(end);
  if (!coordinates[0].changes && !coordinates[1].changes && !coordinates[2].changes) return;
  add_motion(MotionMode::kLine);
  add_coordinates(coordinates);
  add_feed(feed);
  end_block();
}

std::optional<geometry::Arc> Writer::arc_to(const geometry::Arc& arc, double feed) {
  const std::optional<PrintedArc> printed = print_arc(arc);
  if (!printed) return std::nullopt;
  add_plane(printed->plane.plane);
  add_motion(printed->arc.sweep > 0 ? MotionMode::kCounterclockwise : MotionMode::kClockwise);
  add_coordinates(printed->end);
  block_.centers[static_cast<std::size_t>(printed->plane.first)] = printed->center[0];
  block_.centers[static_cast<std::size_t>(printed->plane.second)] = printed->center[1];
  block_.radius = printed->radius;
  add_feed(feed);
  end_block();
  return printed->arc;
}

void Writer::copy_line(std::string_view text) {
  text_ += text;
  text_ += line_end_;
}

bool Writer::add_comment(std::string_view text) {
  if (move_end_ != text_.size() || text_.empty()) return false;
  const std::string_view written(text_.data(), text_.size() - line_end_.size());
  const std::size_t begin = written.find_last_of("\r\n") + 1;  // of npos: 0
  const auto line = with_comment(control_, written.substr(begin), text);
  if (!line) return false;
  text_.resize(begin);
  text_ += *line;
  text_ += line_end_;
  return true;
}

void Writer::restore(const ModalState& expected) {
  if (expected.motion == MotionMode::kUnknown) end_curve();
  if (expected.plane != Plane::kUnknown) add_plane(expected.plane);
  const bool rapid = expected.motion == MotionMode::kRapid;
  const bool wants_motion = expected.motion != MotionMode::kUnknown &&
                            expected.motion != state_.modal.motion &&
                            motion_stays(control_.language);
  if (wants_motion && !rapid && expected.motion != MotionMode::kLine) {
    throw std::invalid_argument(
        "Writer::restore: expected G0 or G1, which can be alone in a block");
  }
  if (wants_motion) add_motion(expected.motion);
  if (expected.feed) add_feed(*expected.feed);
  SpokenBlock feed_alone;
  feed_alone.feed = block_.feed;
  if (!block_.feed.empty() && block_ == feed_alone && control_.repeats_words) {
    add_motion(rapid ? MotionMode::kRapid : MotionMode::kLine);
  }
  if (block_ != SpokenBlock()) end_block();
}

Writer::Coordinate Writer::print(int axis, double mm) const {
  const auto known = state_.position.known[static_cast<std::size_t>(axis)];
  const double now = state_.position.mm[axis];
  if (known && std::abs(mm - now) <= geometry::kSamePlace) return {false, now, {}};
  Coordinate printed;
  printed.digits = to_text(mm / unit_, coordinates_);
  printed.mm = read_number(printed.digits)->value * unit_;
  printed.changes = !known || std::abs(printed.mm - now) > geometry::kSamePlace;
  if (!printed.changes) printed.mm = now;
  return printed;
}

Writer::Coordinates Writer::print(const Point3& place) const {
  return {print(0, place[0]), print(1, place[1]), print(2, place[2])};
}

std::optional<Writer::PrintedArc> Writer::print_arc(const geometry::Arc& arc) const {
  PrintedArc printed;
  printed.plane = arc_plane(arc.axis);
  const int normal = printed.plane.normal;
  if (!takes_arcs_in(control_, printed.plane.plane) || !centers_understood()) return std::nullopt;

  printed.end = print_arc_end(arc.end, printed.plane);
  if (printed.end[static_cast<std::size_t>(normal)].changes && !control_.helices) {
    return std::nullopt;
  }
  printed.arc.start = state_.position.mm;
  printed.arc.end = {printed.end[0].mm, printed.end[1].mm, printed.end[2].mm};
  printed.arc.axis = geometry::Vector3::Unit(normal);
  // A centre that far away is no number of a program.
  if (!((arc.center - arc.start).cwiseAbs().maxCoeff() / unit_ < kNumberLimit / 2)) {
    return std::nullopt;
  }
  const double sweep = arc.axis[normal] > 0 ? arc.sweep : -arc.sweep;
  if (says_center(sweep)) {
    print_center(arc.center, sweep, printed);
  } else if (!print_radius(arc.center, sweep, printed)) {
    return std::nullopt;
  }
  if (std::abs(printed.arc.sweep - sweep) > std::numbers::pi) return std::nullopt;
  if (!arc_refusal(control_, printed.arc, state_.modal.units).empty()) return std::nullopt;
  return printed;
}

// R is well-conditioned far below half a turn: up to a sixth, a step of it moves the middle of the
// arc by less than a sixth of one.
bool Writer::says_center(double sweep) const {
  constexpr double kSixth = std::numbers::pi / 3;
  return control_.arc_form == ArcForm::kCenters ||
         (control_.arc_form == ArcForm::kShorter && std::abs(sweep) > (1 - 1e-9) * kSixth);
}

bool Writer::absolute_centers() const {
  if (centers_are_places(control_.language)) return true;
  return state_.modal.arc_distance == DistanceMode::kAbsolute && control_.arc_distance_mode;
}

bool Writer::centers_understood() const {
  return control_.arc_form == ArcForm::kRadius || absolute_centers() ||
         state_.modal.arc_distance == DistanceMode::kIncremental;
}

// An arc needs a word of its plane even where it comes back to where it began; some controls want
// both words always.
Writer::Coordinates Writer::print_arc_end(const Point3& end, const PlaneAxes& plane) const {
  Coordinates coordinates = print(end);
  Coordinate& first = coordinates[static_cast<std::size_t>(plane.first)];
  Coordinate& second = coordinates[static_cast<std::size_t>(plane.second)];
  const bool neither = !first.changes && !second.changes;
  if (neither || control_.repeats_words) name_again(first);
  if (control_.repeats_words) name_again(second);
  return coordinates;
}

// Where the axis is, exactly.
void Writer::name_again(Coordinate& coordinate) const {
  if (coordinate.changes) return;
  NumberFormat exact = coordinates_;
  exact.decimals = 9;  // enough for any number of a source
  exact.trailing_zeros = false;
  coordinate.changes = true;
  coordinate.digits = to_text(coordinate.mm / unit_, exact);
}

// The centre in the program's units, from printed start and printed end; then the sweep.
void Writer::print_center(const Point3& wanted, double sweep, PrintedArc& printed) const {
  const PlaneAxes& plane = printed.plane;
  const NumberFormat format = center_format(control_, state_.modal.units);
  const PlanePoint start = in_plane(printed.arc.start, plane) / unit_;
  const PlanePoint end = in_plane(printed.arc.end, plane) / unit_;
  CenterGrid grid;
  grid.step = std::pow(10.0, -format.decimals);
  if (!absolute_centers()) grid.base = start;
  const PlanePoint steps = printed_center(start, end, in_plane(wanted, plane) / unit_, sweep, grid);
  PlanePoint center = grid.base;
  for (const int i : {0, 1}) {
    std::string digits = to_text(steps[i] * grid.step, format);
    center[i] += read_number(digits)->value;
    // An offset of zero need not be said, unless both are. Absolute centres need both words.
    const bool says_nothing = !absolute_centers() && steps[i] == 0 && steps[1 - i] != 0;
    if (!says_nothing) printed.center[static_cast<std::size_t>(i)] = std::move(digits);
  }
  printed.turn_about(center, start, end, sweep, unit_);
}

// The radius in the program's units; then the centre that it says, and the sweep. A step of it
// turns the ends of the arc by no more than a fifth of what a step of their places does. False
// where R would not say the arc: half a turn and more, or ends further apart than the printed
// diameter.
bool Writer::print_radius(const Point3& wanted, double sweep, PrintedArc& printed) const {
  if (!(std::abs(sweep) < std::numbers::pi)) return false;
  const PlaneAxes& plane = printed.plane;
  const PlanePoint start = in_plane(printed.arc.start, plane) / unit_;
  const PlanePoint end = in_plane(printed.arc.end, plane) / unit_;
  const PlanePoint half = (end - start) / 2;
  if (!(half.norm() > 0)) return false;
  const PlanePoint along = PlanePoint(-half.y(), half.x()).normalized();
  const PlanePoint middle = start + half;
  const double height = (in_plane(wanted, plane) / unit_ - middle).dot(along);

  const double wanted_radius = std::hypot(height, half.norm());
  const double matters = 0.1 * wanted_radius * std::abs(height) / half.squaredNorm();
  printed.radius =
      to_text(wanted_radius, with_step(center_format(control_, state_.modal.units),
                                       matters * std::pow(10.0, -coordinates_.decimals)));
  const double radius = read_number(printed.radius)->value;
  if (!(radius > half.norm())) return false;
  // The centre of a short counter-clockwise arc lies to the left of its chord.
  const double side = sweep > 0 ? 1 : -1;
  const PlanePoint center = middle + side * std::sqrt(radius * radius - half.squaredNorm()) * along;
  printed.turn_about(center, start, end, sweep, unit_);
  return true;
}

void Writer::add_plane(Plane plane) {
  if (plane == state_.modal.plane) return;
  block_.plane = plane;
  state_.modal.plane = plane;
}

void Writer::add_motion(MotionMode motion) {
  if (motion == state_.modal.motion && !control_.repeats_words) return;
  block_.motion = motion;
  state_.modal.motion = motion;
}

void Writer::add_coordinates(const Coordinates& coordinates) {
  for (int axis = 0; axis < 3; ++axis) {
    const auto i = static_cast<std::size_t>(axis);
    if (!coordinates[i].changes) continue;
    block_.places[i] = coordinates[i].digits;
    state_.position.mm[axis] = coordinates[i].mm;
    state_.position.known[i] = true;
  }
}

bool Writer::feed_is_said(double feed) const {
  if (state_.modal.feed == feed) return true;
  return state_.modal.feed &&
         to_text(*state_.modal.feed / unit_, feeds_) == to_text(feed / unit_, feeds_);
}

void Writer::add_feed(double feed) {
  if (feed_is_said(feed)) return;
  const std::string digits = to_text(feed / unit_, feeds_);
  block_.feed = digits;
  state_.modal.feed = read_number(digits)->value * unit_;
}

void Writer::end_block() {
  add_lines(block_, control_.language, control_.blanks, line_end_, text_);
  move_end_ = text_.size();
  block_ = {};
}

namespace {

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

// The curve that the control reads in these lines, where it ends, and its feed.
struct ReadAgain {
  Position end;
  geometry::Path pieces;
  std::optional<double> feed;
};

// Nothing when the control reads the lines as anything else than curves that follow each other.
std::optional<ReadAgain> read_again(const std::string& text, std::size_t lines,
                                    const Control& control, const CurveStart& start) {
  Diagnostics ignored;
  const CurveFormat& format = *control.curves;
  const Program program = parse(SourceText("", text), control.language, ignored);
  ReadAgain read{start.position, {}, {}};
  for (std::uint32_t block = 0; block < lines;) {
    const CurveResult result = format.read(program, block, {read.end, start.units});
    const auto* reading = std::get_if<CurveReading>(&result);
    if (reading == nullptr || reading->blocks == 0 || reading->motions.empty()) return {};
    for (const CurveMotion& motion : reading->motions) read.pieces.push_back(motion.piece);
    read.end.mm = geometry::end_point(read.pieces.back());
    if (reading->feed) read.feed = reading->feed;
    block += reading->blocks;
  }
  return read;
}

}  // namespace

std::optional<geometry::Path> Writer::curve_to(const geometry::BsplineCurve& curve, double feed,
                                               int last_decimals) {
  const CurveFormat* format = control_.curves;
  if (format == nullptr || !may_start(*format, state_.modal)) return std::nullopt;
  CurveSetting setting;
  setting.units = state_.modal.units;
  setting.places = coordinates_;
  setting.other = setting.units == Units::kInch ? format->other_inch : format->other_mm;
  setting.feeds = feeds_;
  setting.last_decimals = last_decimals;
  setting.start = state_.position.mm;
  setting.axes = moved_axes(curve, setting.start);
  if (format->names_all_axes) setting.axes = {true, true, true};
  for (std::size_t axis = 0; axis < 3; ++axis) {
    if (setting.axes[axis] && !state_.position.known[axis]) return std::nullopt;
  }
  if (!feed_is_said(feed)) setting.feed = feed;
  setting.blanks = control_.blanks;

  const CurveWriting written = format->write(curve, setting);
  const auto* lines = std::get_if<CurveLines>(&written);
  if (lines == nullptr) return std::nullopt;
  std::string text;
  for (const std::string& line : *lines) {
    text += line;
    text += line_end_;
  }
  auto read = read_again(text, lines->size(), control_, {state_.position, setting.units});
  if (!read) return std::nullopt;
  text_ += text;
  state_.position = read->end;
  state_.modal.motion = MotionMode::kOther;
  if (read->feed) state_.modal.feed = *read->feed * unit_;
  return std::move(read->pieces);
}

void Writer::end_curve() {
  if (state_.modal.motion != MotionMode::kOther || !motion_stays(control_.language)) return;
  add_motion(MotionMode::kLine);
  end_block();
}

std::optional<std::string> with_comment(const Control& control, std::string_view line,
                                        std::string_view comment) {
  std::string both(line);
  if (control.blanks) both += ' ';
  both += comment;
  if (line_length(control, both) > control.max_line_length) return std::nullopt;
  return both;
}

}  // namespace batten::gcode
