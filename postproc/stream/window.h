// One window of a program, smoothed, written and proved for itself: the whole of a short program,
// or a part of a long one.
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "gcode/interpreter/interpreter.h"
#include "gcode/text/diagnostic.h"
#include "gcode/text/source_text.h"
#include "postproc/options/options.h"
#include "postproc/proof/verification.h"
#include "postproc/runs/band_notes.h"
#include "postproc/runs/section.h"
#include "postproc/smooth/part_runs.h"
#include "postproc/stream/assembly.h"
#include "postproc/stream/part_crossings.h"
#include "postproc/stream/prescan.h"
#include "postproc/stream/smooth_result.h"

namespace batten::postproc {

// What the windows of a program have in common.
struct WindowSetting {
  const gcode::SourceText& source;
  const SmoothOptions& options;
  gcode::ReadOptions read_options;
  LongRunLimits long_runs = {};
  bool was_smoothed = false;  // the program: all runs are kept
  LongRunFacts facts = {};
};

// What a window takes over from the new text before it.
struct NewTextBefore {
  TextBefore known;
  bool says_smoothed = false;  // that it was smoothed stands there already
};

enum class WindowOutcome {
  kDone,
  kStopped,
  kNeedsWhole,  // something differs that none of its runs is to blame for
};

struct WindowDone {
  WindowOutcome outcome = WindowOutcome::kDone;
  NewTextBefore before;  // that it was made for
  NewTextBefore behind;
  bool read_again = false;  // `behind.known` is set: the new text was read for the proof
  bool unchanged = false;   // the text is the bytes of the window
  bool proved = false;
  std::string text;
  std::size_t blocks = 0;  // of the text
  std::size_t added_lines = 0;
  double corner_mm = 0;
  double deviation_mm = 0;
  std::uint32_t deviation_line = 0;
  std::vector<RunReport> runs;
  std::vector<gcode::Diagnostics> notes;
  gcode::Diagnostics notes_on_runs;  // postproc/stream/provenance.h
  TextBefore old_behind;
  std::shared_ptr<const std::vector<SelfProximity>> near;  // of its long runs; or none
  std::vector<NearEdges> near_edges;
  std::uint32_t last_line = 0;
};

// What the new text before a window may have told the control, by what the old text told it there.
using Guess = std::function<NewTextBefore(const TextBefore& old_before)>;

// Smooths the runs of a part and proves its text; `additions.comment` is said before the first run
// that is rewritten. `tell` is told the share of the work that is done. Neither `before` nor
// `behind` is set.
[[nodiscard]] WindowDone smooth_part(const WindowSetting& setting, const ProgramPart& part,
                                     PartRuns runs, const Additions& additions,
                                     const ProgressCallback& tell);

// A part of a long program, read from its place and smoothed. One that is not proved needs the
// whole.
[[nodiscard]] WindowDone smooth_window(const WindowSetting& setting, const WindowPlace& place,
                                       const Guess& before, const ProgressCallback& tell);

// Whether what is made for one of them is what is made for the other.
[[nodiscard]] bool same_before(const NewTextBefore& a, const NewTextBefore& b);

// The result of a program, collected window by window.

class CollectedResult {
 public:
  // What is known before the first window: of the text, and what reading it tells.
  SmoothResult result;

  // The figures, runs and notes of the next window; its text is the caller's.
  void take(WindowDone window);

  // Behind the last window.
  void finish();

 private:
  BandNoteTally notes_;
  gcode::Diagnostics notes_on_runs_;
};

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
