// The written text of a part of a program, proved.
//
// Windows. The verifier compares two programs stretch by stretch between events, and the state of
// the control at each event (postproc/proof/verification.h). Beside them it looks at two things
// only: two stretches that both break the tolerance may be joined over the event between them,
// though never over a rapid, and the state at the end. So where old and new text are both cut
// behind the same rapid, each reader goes on with what it knew there (WindowStart), and each window
// is proved, every stretch and every event of the whole was compared as it would be in the whole:
// the windows together are proved, with the same bounds. A window ends behind a plain rapid
// (is_plain_rapid), and its end is compared as the end of a program is.
//
// Windows that end in a long run cut a stretch in two. Each half is held against its half of the
// old path, from where the reader of each text knows the tool to stand: two paths that are matched
// in order within the tolerance, and two more that begin where these end, are matched as wholes by
// the two matchings one after the other. Where the whole is proved at once it is cut at the same
// places (ReadProgram::cuts), so its bounds are those of the windows.
//
// Only that the pieces do not cross each other is not said by the proof of each. It is asked when
// all of them are proved (postproc/stream/part_crossings.h): where they do, the stretches about it
// are copied, and the program is smoothed anew.
//
// What a window takes over from the new text before it may be a guess, when it is made; it is
// believed once the window before it is proved and has left exactly that behind.
#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include "gcode/interpreter/interpreter.h"
#include "postproc/options/options.h"
#include "postproc/proof/verification.h"
#include "postproc/runs/section.h"
#include "postproc/smooth/part_runs.h"
#include "postproc/stream/assembly.h"
#include "postproc/stream/part_crossings.h"

namespace batten::postproc {

struct ProvedText {
  std::string text;        // empty where `unchanged`
  bool unchanged = false;  // no run is rewritten: the bytes of the part, which need no proof
  bool proved = false;
  std::size_t blocks = 0;
  std::size_t added_lines = 0;
  Verification verification;  // of the text as it is
  // Of a window whose new text was read: what the next one takes over from it.
  std::optional<TextBefore> behind = {};
  // Of long runs, what parts that are proved one by one must be asked for together.
  std::vector<NearEdges> near_edges = {};
  // False: a window that is not proved cannot be judged by itself, for something differs that none
  // of its runs is to blame for.
  bool stands_alone = true;
};

// Assembles the text, reads it back as a control would, and verifies it. A run that does not hold
// its tolerance tries its next candidate and in the end goes back to its original blocks, so each
// round leaves fewer candidates and the loop ends. Nothing where `tell` stops the work: it is
// called before each round.
[[nodiscard]] std::optional<ProvedText> prove_text(const ProgramPart& part,
                                                   const SmoothOptions& options,
                                                   const gcode::ReadOptions& read_options,
                                                   const Additions& additions,
                                                   const ProgressCallback& tell, PartRuns& runs);

}  // namespace batten::postproc
