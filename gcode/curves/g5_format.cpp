#include "gcode/curves/g5_format.h"

#include <limits>

#include "gcode/curves/g5_curve.h"

namespace batten::gcode {
namespace {

class LinuxCncG5 final : public CurveFormat {
 public:
  std::string_view name() const override { return "G5"; }

  // Arcs say the same with a deviation that we choose, and the control runs G5 as arcs.
  bool is_default() const override { return false; }

  std::string_view complaint(const ModalState& state) const override {
    if (state.plane != Plane::kXY) return "G5 outside G17";
    if (state.cutter_compensation != Tri::kOff) return "G5 under cutter compensation";
    return {};
  }

  bool takes(const geometry::CubicBezier& piece) const override { return bends_one_way(piece); }
  bool is_block_per_piece() const override { return true; }
  std::size_t max_control_points() const override {
    return std::numeric_limits<std::size_t>::max();
  }

  // As many as arc ends have: a direction that is off by half a step of the fifth decimal over the
  // third of a millimetre turns the joint by 2e-5 radians.
  NumberFormat other_numbers(Units units) const override {
    return {.decimals = units == Units::kInch ? 6 : 5};
  }

  CurveWriting write(const geometry::BsplineCurve& curve,
                     const CurveSetting& setting) const override {
    return write_g5(curve.bezier_pieces(), setting);
  }

  CurveResult read(const Program& program, std::uint32_t first,
                   const CurveStart& start) const override {
    return read_g5(program, first, start);
  }
};

}  // namespace

const CurveFormat& linuxcnc_g5() {
  static const LinuxCncG5 kFormat;
  return kFormat;
}

}  // namespace batten::gcode
