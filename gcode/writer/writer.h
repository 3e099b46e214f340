// Writes blocks for one control: words that change nothing are left out, numbers are rounded to the
// control's decimals, and the rounded position is the writer's position.
#pragma once

#include <array>
#include <optional>
#include <string>
#include <string_view>

#include "gcode/control/block_spelling.h"
#include "gcode/control/control.h"
#include "gcode/state/modal_state.h"
#include "geometry/path/bspline_curve.h"
#include "geometry/path/path.h"

namespace batten::gcode {

struct WriterState {
  ModalState modal;   // as the control has it before the first block written
  Position position;  // mm
};

class Writer {
 public:
  // `line_end` as the source has it: "\n" or "\r\n". Throws std::invalid_argument unless the
  // state has known units, absolute distances and feeds per minute.
  Writer(const Control& control, WriterState state, std::string_view line_end);

  // From here on coordinates are printed so, rather than as place_format says.
  void use_coordinates(const NumberFormat& format) { coordinates_ = format; }

  // From here on feeds are whole numbers without a decimal point.
  void use_feeds_without_point() { feeds_ = {.decimals = 0}; }

  // A straight move at feed rate (mm/min; written when it changes). Words of axes whose printed
  // value does not change are left out; a move that moves nothing writes nothing. An axis that is
  // already at its end to within kSamePlace stays there, even where its number has more decimals.
  void line_to(const geometry::Point3& end, double feed);

  // An arc in the plane across `arc.axis` (throws std::invalid_argument unless that is an axis of
  // the coordinate system) from the writer's position, whatever arc.start is. Selects the plane
  // when it is not active. The printed centre offsets, or the radius where the control gives that,
  // are computed from the printed ends, so that both radii agree to within rounding. Returns the
  // arc that the printed numbers say; returns and writes nothing when the control's rules refuse
  // that one, when rounding would make it a full turn or none, or when it is not known how centres
  // are to be given (G90.1, G91.1).
  [[nodiscard]] std::optional<geometry::Arc> arc_to(const geometry::Arc& arc, double feed);

  // A clamped cubic curve in the control's own words (Control::curves), from the writer's position,
  // which is the curve's first point but for rounding. Axes that it does not move are not named,
  // unless the control wants them. `last_decimals`: of the last place, where they are more than
  // coordinates have. What is written is read again: returned are the pieces that the printed
  // numbers say. Returns and writes nothing where the control has no curves, refuses this one or
  // the state, or does not read what it wrote. Afterwards the motion mode is MotionMode::kOther:
  // what follows says its own.
  [[nodiscard]] std::optional<geometry::Path> curve_to(const geometry::BsplineCurve& curve,
                                                       double feed, int last_decimals);

  // Ends a curve that the control takes as going on, if one was written last: the motion word of
  // lines, on a line of its own.
  void end_curve();

  // A line of its own, copied as it is (a comment of the source).
  void copy_line(std::string_view text);

  // Puts a comment of the source behind the line or arc that was written last. Returns false and
  // writes nothing where there is none, one has a comment already, or the control's line would be
  // too long.
  [[nodiscard]] bool add_comment(std::string_view text);

  // Restores plane, motion word and feed for the next copied block, by one block at the most. What
  // `expected` does not know stays. Throws std::invalid_argument when it expects a motion word
  // other than G0 and G1 that is not active.
  void restore(const ModalState& expected);

  // Whether it is known how arc centres are to be given, if at all; arc_to refuses every arc if
  // not.
  [[nodiscard]] bool centers_understood() const;
  [[nodiscard]] bool says_center(double sweep) const;

  [[nodiscard]] const std::string& text() const { return text_; }
  [[nodiscard]] const WriterState& state() const { return state_; }

 private:
  // One coordinate of the next place, as it will be printed.
  struct Coordinate {
    bool changes = false;
    double mm = 0;  // where the axis is afterwards
    std::string digits;
  };
  using Coordinates = std::array<Coordinate, 3>;
  struct PrintedArc;

  [[nodiscard]] Coordinate print(int axis, double mm) const;
  [[nodiscard]] Coordinates print(const geometry::Point3& place) const;
  [[nodiscard]] std::optional<PrintedArc> print_arc(const geometry::Arc& arc) const;
  [[nodiscard]] Coordinates print_arc_end(const geometry::Point3& end,
                                          const PlaneAxes& plane) const;
  void name_again(Coordinate& coordinate) const;
  [[nodiscard]] bool print_radius(const geometry::Point3& wanted, double sweep,
                                  PrintedArc& printed) const;
  void print_center(const geometry::Point3& wanted, double sweep, PrintedArc& printed) const;
  [[nodiscard]] bool absolute_centers() const;

  // The words of one block, gathered until it ends.
  void add_plane(Plane plane);
  void add_motion(MotionMode motion);
  void add_coordinates(const Coordinates& coordinates);
  void add_feed(double feed);
  [[nodiscard]] bool feed_is_said(double feed) const;
  void end_block();

  const Control& control_;
  WriterState state_;
  std::string line_end_;
  double unit_;  // mm
  NumberFormat coordinates_;
  NumberFormat feeds_;
  SpokenBlock block_;
  std::string text_;
  std::size_t move_end_ = 0;  // of text_, where the last block ended
};

// A line with a comment behind its words; nothing where that would be too long for the control.
[[nodiscard]] std::optional<std::string> with_comment(const Control& control, std::string_view line,
                                                      std::string_view comment);

}  // namespace batten::gcode
