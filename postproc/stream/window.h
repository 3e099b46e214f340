// One window of a program, smoothed, written and proved for itself: the whole of a short program,
// or a part of a long one.
//
// Why windows that are proved one by one are proved together: the verifier compares two programs
// section by section between events, and the state of the control at each event and at the end
// (postproc/proof/verification.h). Two sections that both break the tolerance may be joined over
// the event between them, but never over a rapid. So where both texts are cut after the same plain
// rapid (is_plain_rapid), each reader goes on with what it knew there (WindowStart), and each
// window is proved, every section and event was compared as in the whole, with the same bounds.
//
// Windows that end in a long run cut a section in two. Two paths that are matched in order within
// the tolerance, and two more that begin where these end, are matched as wholes one after the
// other. The whole is cut at the same positions (ReadProgram::cuts), so its bounds are the same.
// Whether the parts cross each other is checked when all of them are proved
// (postproc/stream/part_crossings.h): where they do, the sections about it are copied, and the
// program is smoothed anew.
//
// What a window takes over from the new text before it may be a guess when it is made; it counts
// only if the window before it is proved and has left exactly that.
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
#include "postproc/runs/kept_causes.h"
#include "postproc/runs/section.h"
#include "postproc/runs/tolerance_scale.h"
#include "postproc/smooth/growth.h"
#include "postproc/smooth/part_runs.h"
#include "postproc/stream/assembly.h"
#include "postproc/stream/part_crossings.h"
#include "postproc/stream/prescan.h"
#include "postproc/stream/smooth_result.h"

namespace batten::postproc {

// Looks at the runs of a part in place of rewriting them, with the share of the work that is done
// as in smooth_runs. From several threads, one for each part; false stops the work.
using PartSurvey =
    std::function<bool(const ProgramPart&, const PartRuns&, const ProgressCallback&)>;

// What the windows of a program have in common.
struct WindowSetting {
  const gcode::SourceText& source;
  const SmoothOptions& options;
  gcode::ReadOptions read_options;
  ProfileWords words = {};  // with the tolerance filled in; of one window
  LongRunLimits long_runs = {};
  bool was_smoothed = false;  // the program: all runs are kept
  LongRunFacts facts = {};
  std::shared_ptr<const ProgramPart> whole = {};  // of one window, that was read already
  PartSurvey survey = {};
};

// What a window takes over from the new text before it.
struct NewTextBefore {
  TextBefore known;
  bool says_smoothed = false;  // that text says that the program was smoothed
};

// The written text of a window.
struct ProvedText {
  std::string text;        // empty where `unchanged`
  bool unchanged = false;  // no run is rewritten: the bytes of the window, which need no proof
  bool proved = false;
  std::size_t blocks = 0;
  std::size_t added_lines = 0;
  Verification verification;          // of the text as it is
  std::optional<TextBefore> after;    // for the next window, where the new text was read
  std::vector<NearEdges> near_edges;  // of long runs, to be checked with those of other windows
  std::shared_ptr<const gcode::ReadPart> read;  // the new text, where it was read
  bool stands_alone = true;  // false: something differs that none of its runs caused
};

enum class WindowOutcome { kDone, kStopped, kNotProvedAlone };

struct WindowDone {
  WindowOutcome outcome = WindowOutcome::kStopped;
  ProvedText proof;
  NewTextBefore before;  // that it was made for
  NewTextBefore after;
  TextBefore old_after;
  std::vector<RunReport> runs;
  std::vector<StatedFrom> stated;       // in this window
  CauseTally causes;                    // of what is kept
  std::optional<ToleranceScale> scale;  // where its runs were smoothed
  std::optional<SeamTally> seams;       // where its runs' seams were to be rounded
  Outlook outlook;
  PartSums sums;
  std::vector<gcode::Diagnostics> notes;
  gcode::Diagnostics notes_on_runs;                        // postproc/stream/smooth_result.h
  std::shared_ptr<const std::vector<SelfProximity>> near;  // of its long runs; or none
  std::uint32_t last_line = 0;
  std::shared_ptr<const ProgramPart> part;  // the old text
};

// What the new text before a window may have set in the control, by what the old text set there.
using Guess = std::function<NewTextBefore(const TextBefore& old_before)>;

// A window read from its position, smoothed and proved. `tell` gets the share of the work that is
// done. What is wrong between it and others shows as one of several that is not proved. `beside`:
// as PartRuns has it.
[[nodiscard]] WindowDone smooth_window(const WindowSetting& setting, const WindowPlace& place,
                                       const Guess& before, const ProgressCallback& tell,
                                       const std::optional<PartSums>& beside = {});

// Whether what is made for one of them is what is made for the other.
[[nodiscard]] bool same_before(const NewTextBefore& a, const NewTextBefore& b);

// Assembles the text, reads it back as a control would, and verifies it. A run that does not hold
// its tolerance tries its next candidate and in the end goes back to its original blocks, so each
// round leaves fewer candidates and the loop ends. Nothing where `tell`, called in each round,
// stops the work.
[[nodiscard]] std::optional<ProvedText> prove_text(const ProgramPart& part,
                                                   const SmoothOptions& options,
                                                   const gcode::ReadOptions& read_options,
                                                   const Additions& additions,
                                                   const ProgressCallback& tell, PartRuns& runs);

}  // namespace batten::postproc
