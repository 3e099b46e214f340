#include "gcode/curves/spl_format.h"

#include "gcode/curves/heidenhain_spl.h"
#include "gcode/klartext/statement.h"

namespace batten::gcode {
namespace {

bool starts_spline(const Program& program, std::uint32_t block) {
  const SourceSpan content =
      klartext_parts(program.source.text(), program.blocks[block].span).content;
  return klartext_kind(program.source.text(content)) == KlartextKind::kSpline;
}

class SplFormat final : public CurveFormat {
 public:
  std::string_view name() const override { return "SPL"; }

  // A software option on the iTNC 530.
  bool is_default() const override { return false; }
  std::string_view complaint(const ModalState& state) const override {
    return spl_complaint(state);
  }
  bool is_block_per_piece() const override { return true; }

  // Of the size of the piece; write_spl takes more where a joint would have a kink.
  NumberFormat other_numbers(Units) const override { return {.decimals = 6}; }

  CurveWriting write(const geometry::BsplineCurve& curve,
                     const CurveSetting& setting) const override {
    return write_spl(curve.bezier_pieces(), setting, {});
  }

  CurveResult read(const Program& program, std::uint32_t first,
                   const CurveStart& start) const override {
    const bool may_be = program.blocks[first].opacity == ParseStatus::kForeign;
    if (!may_be || !starts_spline(program, first)) return CurveRefusal{"no SPL"};
    return read_spl(program, first, start);
  }
};

}  // namespace

const CurveFormat& heidenhain_spl() {
  static const SplFormat kFormat;
  return kFormat;
}

}  // namespace batten::gcode
