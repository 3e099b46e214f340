// grbl 1.1. Facts: docs/controllers/grbl.md.
#include <cmath>
#include <numbers>

#include "gcode/dialects/built_in.h"
#include "gcode/dialects/rs274_family.h"
#include "gcode/plane_axes.h"

namespace batten::gcode {
namespace {

// grbl refuses an arc (error 33) whose radii differ by more than kMismatch and by more than
// either of the other two.
constexpr float kMismatch = 0.005F;          // mm
constexpr float kGreatestMismatch = 0.5F;    // mm
constexpr float kRelativeMismatch = 0.001F;  // of the radius at the start

// Below half a degree the angle that grbl computes in single precision is mostly noise, and a
// noisy angle of the wrong sign is a full turn. Near a full turn the same noise makes it none.
constexpr double kLeastSweep = 0.5 * std::numbers::pi / 180;
constexpr double kGreatestSweep = 350 * std::numbers::pi / 180;

// A coordinate as grbl holds it: read into 32 bits in the program's units, inches then
// multiplied by 25.4 in 32 bits.
float held(double mm, Units units) {
  if (units != Units::kInch) return static_cast<float>(mm);
  return static_cast<float>(mm / 25.4) * 25.4F;
}

// The check of its g-code parser, number by number, in 32 bits as on its processor.
bool radii_differ(const geometry::Arc& arc, Units units) {
  const PlaneAxes* plane = plane_across(arc.axis);
  if (plane == nullptr) return true;
  const int a = plane->first;
  const int b = plane->second;
  const float offset_a = held(arc.center[a] - arc.start[a], units);
  const float offset_b = held(arc.center[b] - arc.start[b], units);
  const float end_a = held(arc.end[a], units) - held(arc.start[a], units) - offset_a;
  const float end_b = held(arc.end[b], units) - held(arc.start[b], units) - offset_b;
  const float start_radius = std::sqrt(offset_a * offset_a + offset_b * offset_b);
  const float end_radius = std::sqrt(end_a * end_a + end_b * end_b);
  const float mismatch = std::abs(end_radius - start_radius);
  return mismatch > kMismatch &&
         (mismatch > kGreatestMismatch || mismatch > kRelativeMismatch * start_radius);
}

class Grbl final : public Rs274Dialect {
 public:
  std::string_view name() const override { return "grbl"; }
  std::string_view description() const override {
    return "grbl 1.1: arcs and helices in G17, G18, G19; lines of 79 characters";
  }

  // grbl holds 32-bit numbers (0.00002 mm at 200 mm) and steps of some 0.004 mm, and its serial
  // line is what starves it: the fourth decimal would be sent for nothing. A kink of 0.006 rad,
  // the most that 3 decimals make between arcs of 0.5 mm, allows 1000 mm/s and more by its
  // junction deviation of 0.01 mm.
  NumberFormat coordinates(Units units) const override {
    return {.decimals = units == Units::kInch ? 4 : 3};
  }

  // One more, so that the radii at the two ends agree to 0.0002 mm, far inside the 0.005 mm
  // that grbl asks for, and the arc lies where the rounded ends say to within their own rounding.
  NumberFormat arc_offsets(Units units) const override {
    return {.decimals = units == Units::kInch ? 5 : 4};
  }

  // The line buffer is 80 bytes with its terminator, filled after blanks and comments are gone.
  std::size_t max_line_length() const override { return 79; }

  std::size_t line_length(std::string_view line) const override {
    std::size_t kept = 0;
    bool in_parentheses = false;
    for (const char c : line) {
      if (in_parentheses) {
        in_parentheses = c != ')';
      } else if (c == ';') {
        break;
      } else if (c == '(') {
        in_parentheses = true;
      } else if (static_cast<unsigned char>(c) > ' ') {
        ++kept;
      }
    }
    return kept;
  }

  std::string_view arc_complaint(const geometry::Arc& printed, Units units) const override {
    const double sweep = std::abs(printed.sweep);
    if (end_radii(printed).start < min_arc_radius()) return "arc radius below 0.1 mm";
    if (radii_differ(printed, units)) return "error 33: radii at the ends of the arc differ";
    if (sweep < kLeastSweep) return "arc of less than 0.5 degrees";
    if (sweep > kGreatestSweep) return "arc of more than 350 degrees";
    return {};
  }

  double min_arc_radius() const override { return 0.1; }
  // Centres are 32-bit numbers: at 1000 mm they are right to 0.0001 mm, at ten times that to
  // 0.001 mm only, and so are the chords that grbl makes.
  double max_arc_radius() const override { return 1000; }

  // $ at the start of a line is an order to grbl, and ! ~ ? are taken out of the serial stream and
  // obeyed wherever they stand, in comments too.
  std::string comment(std::string_view text) const override {
    if (text.find_first_of("$!~?") != std::string_view::npos) return {};
    return Rs274Dialect::comment(text);
  }

  std::string_view default_machine() const override { return "grbl"; }
};

}  // namespace

const Dialect& grbl_dialect() {
  static const Grbl kDialect;
  return kDialect;
}

}  // namespace batten::gcode
