// Does the new program do what the old one did, within the tolerance? Believes only text:
// it takes two programs as they were read and knows nothing of how the new one was made.
//
// What is compared, in order: every block that acts (M, S, T words, coordinate systems,
// dwells, opaque blocks ..) must stand in both, the same; rapids must have the same ends; and
// between them each section of cutting moves at one feed must keep the tolerance, both ways
// and in order (geometry/distance/path_distance). What counts as an event:
// postproc/proof/program_events.h.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <vector>

#include "gcode/text/source_text.h"
#include "postproc/proof/event_violations.h"
#include "postproc/proof/program_events.h"
#include "postproc/proof/section_comparison.h"

namespace batten::postproc {

struct Verification {
  std::vector<Violation> violations;      // empty: proved
  std::vector<ComparedSection> sections;  // in order; identical ones are not listed
  double deviation_mm = 0;                // greatest proved bound
  std::uint32_t deviation_line = 0;       // of the old program
  double corner_mm = 0;                   // greatest of the sections
  std::size_t events_compared = 0;
  [[nodiscard]] bool proved() const { return violations.empty(); }
};

// Feeds are the same when they differ by less than a millionth: they are printed again. Requires a
// tolerance > 0 (throws std::invalid_argument otherwise). `threads`: 0: all cores; the result is
// the same for any number, since sections do not look at each other.
//
// Programs of two languages are compared in the words that all have
// (list_common_events); their rapids end at the same place to within what printing a
// place in other digits moves it.
[[nodiscard]] Verification verify(const ReadProgram& before, const ReadProgram& after,
                                  const Promise& promise, int threads = 1);

// Do two programs write their numbers alike, with a decimal point or without one? Some controls of
// the FANUC kind take X5. for 5 mm and X5 for 0.005 mm (gcode/text/language.h). Where nobody says
// which control the programs are for, the one is not the other.

// Two programs of the RS-274 family. The first length of the new one that
//   - has no point, where the old one ends whole numbers with a bare point (X5.), and either all
//     lengths of it have a point or this one always has a bare one;
//   - ends with a bare point, where no length of the old one has a point.
// The same for feeds, F100. and F100: the second is 1 in/min on controls of the FANUC kind.
// Zero is zero. Programs that do not end numbers with a bare point, X5 or X5.000, are for other
// controls. Linear time; holds the numbers of the old program that end with a bare point.
[[nodiscard]] std::optional<Violation> other_point_spelling(const gcode::SourceText& before,
                                                            const gcode::SourceText& after);

}  // namespace batten::postproc
