// Two texts, read and compared by verify (postproc/proof/verification.h): long ones part by part,
// in the memory of some parts, as long as they keep the promise.
//
// Why the parts together are the proof: a part of the old program is compared with the part of the
// new one that ends at the same position, by the same code as the whole, with what the parts before
// have left (PartReader, EventsBefore):
//
//   - After as many plain rapids, which are then the same events. No section goes over a rapid and
//     no event is joined with another over it, so each section and event of the whole is compared
//     in one of the parts, from the same states, with the same bounds.
//   - In a long run without rapids, where a motion ends at the same position in both, to the last
//     digit. Two paths that are followed in order within the tolerance, and two more that begin
//     where these end, are followed as wholes one after the other. Each part of the section is
//     listed with its own bounds. Beside the distance the whole asks two things of a section: that
//     the feeds come in the same order, so a feed goes on over the cut in both programs or in
//     neither; and that the new path does not cross itself where the old one did not, so it must
//     not meet itself at all in such a run (postproc/proof/self_meeting.h). A side is not proved in
//     parts, for the corner at the cut would be in none of them.
//
// All else is left to the whole. So nothing is accepted here that the whole shows to be broken;
// only where its search for a proof costs too much may the parts be proved and the whole left open.
#pragma once

#include <cstddef>
#include <functional>
#include <optional>
#include <vector>

#include "gcode/text/diagnostic.h"
#include "gcode/text/source_text.h"
#include "postproc/proof/verification.h"
#include "postproc/stream/assembly.h"
#include "postproc/stream/part_reader.h"

namespace batten::postproc {

struct TextToVerify {
  const gcode::SourceText& source;
  PartReading reading;
  std::vector<LineBracket> brackets = {};  // of a new program: lines between which runs are
};

struct VerifyLimits {
  PartLimits parts = {};
  std::size_t longest = 65536;  // old blocks without a rapid that are held before a run is cut
  // 0: all cores; one for programs of less text together than these bytes, which are done before
  // another has begun.
  int threads = 0;
  std::size_t least_for_threads = std::size_t{1} << 16;
};

struct VerifiedTexts {
  Verification verification;  // where both are understood
  gcode::Diagnostics of_old;
  gcode::Diagnostics of_new;
  std::vector<Violation> in_brackets;  // see events_in_brackets
  bool as_whole = false;               // else blocks of the sections count within their parts

  // An error of either: a tolerance means nothing without a unit, say.
  [[nodiscard]] bool understood() const {
    return !gcode::has_error(of_old) && !gcode::has_error(of_new);
  }
};

// As one part: short programs, all that is not proved in parts, what PartReader does not read, and
// programs with brackets. Nothing where `stopped` says so, before a part or the whole is read.
[[nodiscard]] std::optional<VerifiedTexts> verify_texts(const TextToVerify& before,
                                                        const TextToVerify& after,
                                                        const Promise& promise,
                                                        const std::function<bool()>& stopped = {},
                                                        const VerifyLimits& limits = {});

}  // namespace batten::postproc
