#include "gcode/curves/bspline_format.h"

#include "gcode/curves/siemens_bspline.h"
#include "gcode/curves/siemens_poly.h"

namespace batten::gcode {
namespace {

class BsplineFormat final : public CurveFormat {
 public:
  std::string_view name() const override { return "BSPLINE"; }
  bool is_default() const override { return false; }
  std::string_view caution() const override { return kBsplineUnverified; }

  // Both are members of one group, and what forbids the one forbids the other.
  std::string_view complaint(const ModalState& state) const override {
    return poly_complaint(state);
  }
  bool is_block_per_piece() const override { return false; }

  // PL, in the units of the curve's parameter: scaled as the knots of G06.2 are.
  NumberFormat other_numbers(Units) const override { return {.decimals = 4}; }

  CurveWriting write(const geometry::BsplineCurve& curve,
                     const CurveSetting& setting) const override {
    return write_bspline(curve, setting, BsplineUse::kAcceptedUnverified);
  }

  CurveResult read(const Program& program, std::uint32_t first,
                   const CurveStart& start) const override {
    return read_bspline(program, first, start, BsplineUse::kAcceptedUnverified);
  }
};

}  // namespace

const CurveFormat& siemens_bspline() {
  static const BsplineFormat kFormat;
  return kFormat;
}

}  // namespace batten::gcode
