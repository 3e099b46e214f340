// What the controls that descend from the NIST RS274/NGC interpreter have in common: G2 and G3
// by centre offsets in the three planes, helices, comments in parentheses. A dialect of the
// family says only where it differs.
#pragma once

#include "gcode/control/dialect.h"

namespace batten::gcode {

// The radii at the two ends of a printed arc, mm, in double precision.
struct EndRadii {
  double start = 0;
  double end = 0;
  [[nodiscard]] double mismatch() const;
};
[[nodiscard]] EndRadii end_radii(const geometry::Arc& arc);

class Rs274Dialect : public Dialect {
 public:
  // Feeds are copied from the source, never computed: as many decimals as any source carries,
  // since a feed that differs in its last digit is a changed feed.
  [[nodiscard]] NumberFormat feeds(Units units) const override;

  // Every byte of the line, blanks and comments too.
  [[nodiscard]] std::size_t line_length(std::string_view line) const override;

  [[nodiscard]] bool takes_arcs_in(Plane plane) const override;
  [[nodiscard]] bool takes_helices() const override { return true; }
  [[nodiscard]] bool takes_arc_distance_mode() const override { return false; }
  [[nodiscard]] bool blanks_between_words() const override { return true; }

  // "(text)". Empty for text with brackets, control characters or bytes outside ASCII, for
  // text that the control would act on ("MSG,", "DEBUG,", ..), and when the line is too long.
  [[nodiscard]] std::string comment(std::string_view text) const override;
};

}  // namespace batten::gcode
