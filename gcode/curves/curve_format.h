// The curve words of one control, as its dialect gives them (Dialect::curves). The text itself is
// made and read by the pure functions beside this file.
#pragma once

#include <cstdint>
#include <string_view>

#include "gcode/curves/curve_text.h"
#include "gcode/state/modal_state.h"
#include "gcode/text/program.h"
#include "geometry/path/bspline_curve.h"
#include "geometry/path/path.h"

namespace batten::gcode {

class CurveFormat {
 public:
  virtual ~CurveFormat() = default;

  [[nodiscard]] virtual std::string_view name() const = 0;  // "G06.2"

  // Whether curves are tried under --output auto: the control reads them without an option that
  // the user has to own, and runs them as they are meant.
  [[nodiscard]] virtual bool is_default() const = 0;

  // What a user has to be told when such curves were written, since it is not verified; empty where
  // there is nothing.
  [[nodiscard]] virtual std::string_view caution() const { return {}; }

  // Why no curve may start in this state (cutter compensation, feed mode, plane ..); empty where it
  // may. Units, absolute distances and feed per minute are known already.
  [[nodiscard]] virtual std::string_view complaint(const ModalState& state) const = 0;

  // Whether the control runs this piece of a curve. What it does not is written as lines.
  [[nodiscard]] virtual bool takes(const geometry::CubicBezier&) const { return true; }

  // Whether the control runs curves as chords of its own that count. They leave a piece by
  // chords_error (mm) at the most.
  [[nodiscard]] virtual bool is_run_as_chords() const { return false; }
  [[nodiscard]] virtual double chords_error(const geometry::CubicBezier&) const { return 0; }

  // Whether every piece is a block for itself. Otherwise a curve has blocks beside those of its
  // pieces, and short curves are not worth them.
  [[nodiscard]] virtual bool is_block_per_piece() const = 0;

  // Whether the control wants X, Y and Z in every curve, moved or not.
  [[nodiscard]] virtual bool names_all_axes() const { return false; }

  // How knots, coefficients or offsets are printed.
  [[nodiscard]] virtual NumberFormat other_numbers(Units units) const = 0;

  [[nodiscard]] virtual CurveWriting write(const geometry::BsplineCurve& curve,
                                           const CurveSetting& setting) const = 0;

  // The curve whose first block is block `first`. Quick where that block starts none.
  [[nodiscard]] virtual CurveResult read(const Program& program, std::uint32_t first,
                                         const CurveStart& start) const = 0;
};

}  // namespace batten::gcode
