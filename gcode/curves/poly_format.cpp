#include "gcode/curves/poly_format.h"

#include "gcode/curves/siemens_poly.h"

namespace batten::gcode {
namespace {

class PolyFormat final : public CurveFormat {
 public:
  std::string_view name() const override { return "POLY"; }
  bool is_default() const override { return true; }
  std::string_view complaint(const ModalState& state) const override {
    return poly_complaint(state);
  }
  bool is_block_per_piece() const override { return true; }

  // Of the size of the piece: half a step moves the piece by less than the rounding of its ends.
  NumberFormat other_numbers(Units) const override { return {.decimals = 6}; }

  CurveWriting write(const geometry::BsplineCurve& curve,
                     const CurveSetting& setting) const override {
    return write_poly(curve.bezier_pieces(), setting);
  }

  CurveResult read(const Program& program, std::uint32_t first,
                   const CurveStart& start) const override {
    return read_poly(program, first, start);
  }
};

}  // namespace

const CurveFormat& siemens_poly() {
  static const PolyFormat kFormat;
  return kFormat;
}

}  // namespace batten::gcode
