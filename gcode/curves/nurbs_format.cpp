#include "gcode/curves/nurbs_format.h"

#include "gcode/curves/nurbs_read.h"
#include "gcode/curves/nurbs_rules.h"
#include "gcode/curves/nurbs_write.h"

namespace batten::gcode {
namespace {

class NurbsFormat final : public CurveFormat {
 public:
  using Rules = NurbsRules (*)(Units);
  explicit NurbsFormat(Rules rules) : rules_(rules) {}

  std::string_view name() const override { return "G06.2"; }
  bool is_default() const override { return false; }
  std::string_view complaint(const ModalState& state) const override {
    return nurbs_complaint(state);
  }
  bool is_block_per_piece() const override { return false; }
  bool names_all_axes() const override { return rules_(Units::kMillimetre).three_axes; }
  NumberFormat other_numbers(Units units) const override {
    return {.decimals = rules_(units).knots.decimals, .always_point = true};
  }

  CurveWriting write(const geometry::BsplineCurve& curve,
                     const CurveSetting& setting) const override {
    return write_nurbs(curve, setting, rules_(setting.units));
  }

  CurveResult read(const Program& program, std::uint32_t first,
                   const CurveStart& start) const override {
    return read_nurbs(program, first, start, rules_(start.units));
  }

 private:
  Rules rules_;
};

NurbsRules mitsubishi_in(Units) { return mitsubishi_nurbs(); }

}  // namespace

const CurveFormat& fanuc_curves() {
  static const NurbsFormat kFormat(&fanuc_nurbs);
  return kFormat;
}

const CurveFormat& syntec_curves() {
  static const NurbsFormat kFormat(&syntec_nurbs);
  return kFormat;
}

const CurveFormat& mitsubishi_curves() {
  static const NurbsFormat kFormat(&mitsubishi_in);
  return kFormat;
}

}  // namespace batten::gcode
