#include "gcode/reading/explained_diagnostics.h"

namespace batten::gcode {
namespace {

constexpr ExplainedDiagnostic kExplained[] = {
    // --- while reading the text ---
    {"foreign-language", "error",
     "The file is certainly a program in another language than the target's: Heidenhain Klartext "
     "(BEGIN PGM), Siemens (%_N_.., ;$PATH, DEF REAL), or plain words (it begins with G21 or "
     "another G word) for a target that reads Klartext.",
     "Choose a target that reads this language, or say --convert: the program is then said in the "
     "target's language, where every block can be said there. Or post the part again for this "
     "control."},
    {"source-ambiguous", "error",
     "The text has marks that only programs in one language have, and marks that only those in "
     "another have: it is not certain how to read it.",
     "Take out what does not belong to the program, or say --source."},
    {"source-contradicted", "error",
     "--source names a control, and the program has words that programs for it do not have.",
     "Name the control that it was written for, or leave --source out."},
    {"sixteen-bit-text", "error", "The file starts with the mark of UTF-16.",
     "Save it as plain text or UTF-8."},
    {"unreadable-block", "warning",
     "A block follows no grammar that is known. It is copied; the run ends here, and what it could "
     "have changed is unknown after it. The message names the first place that was not understood.",
     "Write numbers without exponents, one number to each letter, and comments without comments in "
     "them."},
    {"unclosed-comment", "warning",
     "A ( without ). The rest of the line is read as a comment, as grbl does; LinuxCNC refuses "
     "such a line.",
     "Close the bracket."},
    {"implied-decimals", "warning",
     "A length has no decimal point (X1000), in a program for a control of the FANUC kind: there "
     "it is 1000 mm or 1000 least increments, 1.000 mm, as a parameter of the control says. Such "
     "blocks are copied, and the position is unknown after them. Reported once, at the first; 0 is "
     "0 in either reading.",
     "Say --decimals explicit where X5 is 5 mm, or --decimals implied where it is 0.005 mm "
     "(implied:0.0001 for another increment); look the parameter up in the control's manual."},
    {"text-outside-marks", "warning or note",
     "Words stand before the first % line (some controls run them, so the state after them is "
     "unknown) or after the second. They are copied.",
     "Cut what does not belong to the program."},
    // --- while following the program ---
    {"units-missing", "error",
     "The program has motions and neither G20 nor G21 (nor G70, G71 without parameters). A "
     "tolerance means nothing then.",
     "Say --units mm or --units inch."},
    {"lathe-program", "warning",
     "The program is one for a lathe: it has a word that only such programs have (G50 S, G71 P Q, "
     "LIMS, FUNCTION MODE TURN ..), or two of different kinds that mills hardly use (T0101, G96, a "
     "feed of 0.2 ..) and no Y. X may be a diameter there and G90 a cycle. It is copied as it is.",
     "If it is a program for a mill, write the word that the message names in another way."},
    {"two-words-of-one-group", "warning",
     "G0 G1, G17 G18, M3 M5, or a code twice, in one block: controls disagree what that does.",
     "Take one of them out."},
    {"word-repeated", "warning", "X1 X2 in one block: some controls take the last, others refuse.",
     "Take one of them out."},
    {"bad-code", "warning",
     "A G or M word that is no code (G1.25, M-3), or more codes than a block can hold.",
     "Correct the word."},
    {"unknown-g-code", "warning",
     "A G code that is not known, reported once for each code. It could have changed anything, so "
     "everything is unknown after it.",
     "Take it out, or set every mode again after it."},
    {"arc-centre-missing", "warning",
     "G2 or G3 without R and without I, J, K of the plane; or one centre word only under G90.1.",
     "Correct the arc."},
    {"arc-words-conflict", "warning",
     "R beside I, J, K, or a centre word along the normal of the plane that is not 0.",
     "Correct the arc; look for a plane word (G17, G18, G19) that is missing."},
    {"arc-radius-mismatch", "warning",
     "The radii at the start and the end differ by more than 0.0283 mm and by more than 0.1 % of "
     "the radius, or by more than 2.83 mm. LinuxCNC refuses such arcs.",
     "Let the CAM system write more decimals; look for G90.1, G91.1."},
    {"arc-radius-too-small", "warning",
     "The ends are further apart than twice R, the ends of an arc with R are one point, the centre "
     "is one of the ends, or the arc turns by so little that controls disagree whether it is a "
     "full turn.",
     "Correct the arc, or write it with I, J, K."},
};

}  // namespace

std::span<const ExplainedDiagnostic> explained_diagnostics() { return kExplained; }

}  // namespace batten::gcode
