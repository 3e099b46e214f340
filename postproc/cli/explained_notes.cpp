#include "postproc/cli/explained_notes.h"

namespace batten::postproc {
namespace {

constexpr gcode::ExplainedDiagnostic kExplained[] = {
    // --- the program and its target ---
    {"other-family", "error",
     "Words that only other controls have, in a program in which something would be rewritten.",
     "Choose another target; --convert tells which blocks could not be said."},
    {"cannot-convert", "error",
     "With --convert: the block does not say the same on the target, or not for certain.",
     "Where the message names a choice (--source, --allow ..), take it if it is right for this "
     "program; else post the part again for this control."},
    {"word-means-other", "error",
     "A G word that the target takes for something else than the reader does: G21 mirrors on a "
     "Beckhoff control, G20 is unknown to Klipper. The program was not read as its control reads "
     "it.",
     "Choose the target that the program was made for, or post it again for this one."},
    // --- the words of a profile ---
    {"profile-words-in-program", "error",
     "The program has smoothing words itself that the profile would add: they would undo each "
     "other.",
     "Take them out of one of the two."},
    // --- the band around a run ---
    {"band-overlap", "note",
     "Two parts of a flat run are nearer to each other than twice the tolerance. The place is "
     "where "
     "they are nearest.",
     "Nothing, or a smaller tolerance where the wall between them matters."},
    {"band-cusp", "note",
     "A flat run bends with a radius below the tolerance. The place is the first such bend.",
     "Nothing, or a smaller tolerance where the bend matters."},
    // --- what was written ---
    {"smoothing-not-told", "note",
     "The target has no comment that all its controls take, so nothing in the new program says "
     "that "
     "it was smoothed. Batten would smooth it again, and the tolerances would add up.",
     "Keep the original, and smooth that. Where the control takes comments, a profile with its "
     "`comments` says so, and the program tells it."},
    {"curves-unverified", "warning",
     "The target's curve words were written, and what its control makes of them is not known for "
     "certain. The message says what is open.",
     "Run the program without a part, or on the vendor's simulator, and compare it with another "
     "form."},
    {"chords-for-steps", "note",
     "The equal steps of --linearize ilca are as short everywhere as the tightest place of the run "
     "asks for, and were too many. Its lines are chords, as --linearize chord lays them.",
     "Nothing, or a larger tolerance."},
};

}  // namespace

std::span<const gcode::ExplainedDiagnostic> explained_notes() { return kExplained; }

}  // namespace batten::postproc
