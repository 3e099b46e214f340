// What one controller family reads and writes. One .cpp per family in dialects/; nothing
// else in the program asks for a dialect's name.
#pragma once

#include <cstddef>
#include <span>
#include <string>
#include <string_view>

#include "gcode/modal_state.h"
#include "gcode/number_format.h"
#include "geometry/path.h"

namespace batten::gcode {

class CurveFormat;  // gcode/curves/curve_format.h

class Dialect {
 public:
  virtual ~Dialect() = default;

  [[nodiscard]] virtual std::string_view name() const = 0;         // "linuxcnc"
  [[nodiscard]] virtual std::string_view description() const = 0;  // one line, for `batten targets`

  // How coordinates, arc centres and feeds are printed in these units.
  [[nodiscard]] virtual NumberFormat coordinates(Units units) const = 0;
  [[nodiscard]] virtual NumberFormat arc_offsets(Units units) const = 0;
  [[nodiscard]] virtual NumberFormat feeds(Units units) const = 0;

  // Coordinates in a chain that contains arcs: as many decimals as `coordinates`, or more where
  // a rounded joint would no longer be tangent for the control.
  [[nodiscard]] virtual NumberFormat arc_ends(Units units) const { return coordinates(units); }

  // Greatest number of bytes in a line, as line_length counts them.
  [[nodiscard]] virtual std::size_t max_line_length() const = 0;

  // The bytes of a line that the control has to keep: without the line end; whether blanks
  // and comments count is the control's matter.
  [[nodiscard]] virtual std::size_t line_length(std::string_view line) const = 0;

  [[nodiscard]] virtual bool takes_arcs_in(Plane plane) const = 0;
  [[nodiscard]] virtual bool takes_helices() const = 0;
  [[nodiscard]] virtual bool takes_arc_distance_mode() const = 0;  // G90.1, G91.1
  [[nodiscard]] virtual bool blanks_between_words() const = 0;

  // Would the control run this arc? The piece is the arc as its printed numbers say it
  // (end, centre offsets rounded). Returns the control's complaint, empty when it takes it.
  [[nodiscard]] virtual std::string_view arc_complaint(const geometry::Arc& printed,
                                                       Units units) const = 0;

  // Least useful arc: shorter or tighter ones are written as lines (mm).
  [[nodiscard]] virtual double min_arc_radius() const = 0;
  [[nodiscard]] virtual double max_arc_radius() const = 0;

  // The curves that the control reads; nullptr: none.
  [[nodiscard]] virtual const CurveFormat* curves() const { return nullptr; }

  // A comment line with this text, or empty when the text cannot be said.
  [[nodiscard]] virtual std::string comment(std::string_view text) const = 0;

  // Name of the built-in machine model that runs this target when no machine is given.
  [[nodiscard]] virtual std::string_view default_machine() const = 0;
};

// All built-in dialects, in the order in which `batten targets` lists them.
[[nodiscard]] std::span<const Dialect* const> dialects();

// Nothing when there is no dialect of that name.
[[nodiscard]] const Dialect* find_dialect(std::string_view name);

// 1 or 25.4. Throws std::invalid_argument for unknown units.
[[nodiscard]] double millimetres_per(Units units);

// The step between neighbouring numbers of a format, in mm.
[[nodiscard]] double printed_step(const NumberFormat& format, Units units);

}  // namespace batten::gcode
