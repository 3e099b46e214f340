// Writes blocks for one dialect: words that change nothing are left out, numbers are
// rounded to the dialect's decimals, and the rounded place is the writer's place.
#pragma once

#include <string>
#include <string_view>

#include "gcode/dialect.h"
#include "gcode/modal_state.h"
#include "geometry/path.h"

namespace batten::gcode {

struct WriterState {
  ModalState modal;   // as the control has it before the first block written
  Position position;  // mm
};

class Writer {
 public:
  // `line_end` as the source has it: "\n" or "\r\n".
  Writer(const Dialect& dialect, WriterState state, std::string_view line_end);

  // A straight move at feed rate. Words of axes whose printed value does not change are left
  // out; a move that moves nothing writes nothing. `feed` in mm/min; written when it changes.
  void line_to(const geometry::Point3& end, double feed);

  // An arc in the plane across `arc.axis` (which must be an axis of the coordinate system).
  // Selects the plane when it is not active. The printed centre offsets are computed from
  // the printed start and end, so that both radii agree to within rounding. Returns false
  // and writes nothing when the dialect's rules refuse the printed arc.
  [[nodiscard]] bool arc_to(const geometry::Arc& arc, double feed);

  // A line of its own, copied as it is (a comment of the source).
  void copy_line(std::string_view text);

  // Restores plane, motion word and feed, so that the next copied block finds what it
  // expects. Writes at most one block.
  void restore(const ModalState& expected);

  [[nodiscard]] const std::string& text() const { return text_; }
  [[nodiscard]] const WriterState& state() const { return state_; }

 private:
  const Dialect& dialect_;
  WriterState state_;
  std::string line_end_;
  std::string text_;
};

}  // namespace batten::gcode
