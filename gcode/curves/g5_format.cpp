#include "gcode/curves/g5_format.h"

#include "gcode/curves/g5_chopping.h"
#include "gcode/curves/g5_curve.h"

namespace batten::gcode {
namespace {

// What all controls with G5 have in common.
class G5Format : public CurveFormat {
 public:
  std::string_view name() const override { return "G5"; }

  // Arcs say the same with a deviation that we choose, and the controls run G5 as arcs or chords.
  bool is_default() const override { return false; }

  std::string_view complaint(const ModalState& state) const override {
    if (state.plane != Plane::kXY) return "G5 outside G17";
    if (state.cutter_compensation != TriState::kOff) return "G5 under cutter compensation";
    return {};
  }

  // The pieces that LinuxCNC takes: the others have no use for pieces that are nearly straight.
  bool takes(const geometry::CubicBezier& piece) const override { return bends_one_way(piece); }
  bool is_block_per_piece() const override { return true; }

  CurveWriting write(const geometry::BsplineCurve& curve,
                     const CurveSetting& setting) const override {
    return write_g5(curve.bezier_pieces(), setting);
  }

  CurveResult read(const Program& program, std::uint32_t first,
                   const CurveStart& start) const override {
    return read_g5(program, first, start);
  }
};

class LinuxCncG5 final : public G5Format {
 public:
  // As many as arc ends have: a direction that is off by half a step of the fifth decimal over the
  // third of a millimetre turns the joint by 2e-5 radians.
  NumberFormat other_numbers(Units units) const override {
    return {.decimals = units == Units::kInch ? 6 : 5};
  }
};

class ChoppedG5 final : public G5Format {
 public:
  bool is_run_as_chords() const override { return true; }
  double chords_error(const geometry::CubicBezier& piece) const override {
    return chopping_error(piece);
  }

  // Chords are found in 32-bit numbers: the fifth decimal would be noise.
  NumberFormat other_numbers(Units units) const override {
    return {.decimals = units == Units::kInch ? 5 : 4};
  }
};

}  // namespace

const CurveFormat& linuxcnc_g5() {
  static const LinuxCncG5 kFormat;
  return kFormat;
}

const CurveFormat& chopped_g5() {
  static const ChoppedG5 kFormat;
  return kFormat;
}

}  // namespace batten::gcode
