#include "gcode/state/reason.h"

#include <algorithm>
#include <limits>
#include <stdexcept>
#include <string>

namespace batten::gcode::reason {
namespace {

constexpr std::string_view kCopied = "Nothing: such blocks are copied as they are.";
constexpr std::string_view kSeparate =
    "Put it in a block of its own, outside the cutting moves, if it is not needed there.";

constexpr Explanation kExplanations[] = {
    {kNotUnderstood,
     "The block holds words that this reader does not know, or that a control would refuse.",
     "See the warnings: they name the words.", false},
    {kExpression, "A word's value is an expression or a parameter (X[#1+2], X#5).",
     "Let the CAM system write plain numbers.", false},
    {kImpliedDecimals,
     "A length has no decimal point (X1000), and such a control may take it for that many least "
     "increments (1.000 mm).",
     "Say --decimals explicit where X5 is 5 mm, --decimals implied where it is 0.005 mm, or let "
     "the "
     "CAM system write decimal points.",
     false},
    {kAssignment, "The block sets a parameter (#1=5, R1=5).", kCopied, false},
    {kProgramFlow, "The block changes the order of blocks: O-word, IF, WHILE, GOTO, label.",
     "Smooth the straight programs that it calls, one by one.", false},
    {kForeignWords, "The block is written in words of another language or for the sender.",
     "Choose a post-processor of the CAM system that writes G01 X Y Z.", false},
    {kProgramMark, "A % line, the program's number, or text outside the % marks.", kCopied, false},
    {kBlockDelete,
     "The block starts with /: the operator chooses whether it is executed. What it changes is "
     "not known afterwards.",
     "Remove the / if the block is always meant.", false},
    {kActiveComment,
     "The comment acts when it is reached: (MSG,..), (DEBUG,..), (LOGOPEN,..). Or its brackets are "
     "nested or not closed: controls differ in where it ends, and some refuse it.",
     "Write it as a plain comment if it need not act.", false},
    {kReferencedLabel,
     "The block's N number is, or may be, the target of a jump, a call, or a return (M99 P) from a "
     "called program that is not read.",
     "--allow subprogram where called programs return after their calls; otherwise nothing: "
     "such blocks are copied as they are.",
     false},
    {kOtherAxis, "The block moves or names an axis other than X, Y, Z.",
     "Only three-axis motion is smoothed.", false},
    {kExtruder, "The block has an E word: the amount is proportional to the path.",
     "Programs for printers are not smoothed.", false},
    {kCornerWord, "A corner is rounded or chamfered by a word (,R ,C, or R beside G1).",
     "Let the CAM system write the corner as an arc or a line.", false},
    {kRapid, "A rapid move.", kCopied, false},
    {kPlunge, "A move straight along Z into or out of a cut: its end is a corner that was meant.",
     "Nothing: the cuts on either side are smoothed by themselves.", false},
    {kArc, "An arc that is not understood, or one whose G2 or G3 is needed after it.", kCopied,
     false},
    {kIntendedArc,
     "An arc that was meant as one: a full circle, or it meets its neighbours tangentially or in "
     "corners. Arcs that meet at small angles are pieces of a curve, and are smoothed.",
     kCopied, false},
    {kDwell, "A dwell (G4).", kCopied, false},
    {kProbe, "A probing move.", kCopied, false},
    {kCannedCycle, "A canned cycle, or a position of one.", kCopied, false},
    {kThreading, "A thread: the path is tied to the spindle.", kCopied, false},
    {kSpline, "The block is part of a spline already.", kCopied, false},
    {kCoordinateChange,
     "The origin moves, or a move is given in machine coordinates (G54, G92, G10, G28, G53 ..).",
     kCopied, false},
    {kToolChange, "The tool or its offsets change (T, M6, H, D, G43, G49).", kCopied, false},
    {kSpindle, "The spindle or its speed changes (S, M3, M4, M5).", kSeparate, false},
    {kCoolant, "The coolant changes (M7, M8, M9).", kSeparate, false},
    {kMiscFunction, "Another M word: when it acts depends on where its block ends.", kSeparate,
     false},
    {kStateChange, "The block changes a mode (units, plane, distance, feed, path ..).", kCopied,
     false},
    {kComment, "Comments or empty lines alone.", kCopied, false},
    {kChecksum, "The line has a check sum: the sender counts such lines.",
     "Take numbers and sums off; the sender adds them when it sends.", false},
    {kSubprogram, "A subprogram is called, or ends. Nothing is known afterwards.",
     "Smooth the called programs as files of their own; and --allow subprogram where they "
     "leave all modes (units, plane, G90, compensation, rotation ..) as they find them and come "
     "back behind the call: then only position and feed are unknown there, and N numbers are no "
     "targets.",
     true},
    {kProgramEnd, "The program stops or ends (M0, M1, M2, M30, M60).", kCopied, false},

    {kUnitsUnknown, "Inch or millimetre is not known here.",
     "Write G20 or G21 before the first motion, or say --units mm or --units inch.", false},
    {kStateUnknown,
     "A block before this one could have changed any mode, and not every mode was set again.",
     "Look for the call, jump or unknown word above; set the modes again after it. Behind "
     "calls that keep all modes: --allow subprogram.",
     false},
    {kPositionUnknown, "The tool's position before this motion is not known.",
     "The first motion after a call, tool change or offset change is always kept.", false},
    {kCutterCompensation, "Cutter compensation is on (G41, G42): the path is not the tool's.",
     "Let the CAM system compute the tool's path.", false},
    {kToolCenterPoint, "Tool centre point control is on (G43.4, G43.5, M128).",
     "Only three-axis motion is smoothed.", false},
    {kTiltedPlane, "The working plane is tilted (G68.2).", "Only plain coordinates are smoothed.",
     false},
    {kIncremental, "Distances are incremental (G91): rounding would add up.",
     "Let the CAM system write absolute coordinates (G90).", false},
    {kInverseTime, "The feed is inverse time (G93): each block's time is its own.",
     "Let the CAM system write feeds per minute (G94).", false},
    {kFeedPerRevolution, "The feed is per revolution (G95).",
     "Let the CAM system write feeds per minute (G94).", false},
    {kConstantSurfaceSpeed, "Constant surface speed is on (G96).", kCopied, false},
    {kPolar, "Coordinates are polar (G16, G12.1).",
     "Let the CAM system write Cartesian coordinates.", false},
    {kCylindrical, "Coordinates are on a cylinder (G7.1).",
     "Let the CAM system write Cartesian coordinates.", false},
    {kScaling, "Coordinates are scaled (G51): the tolerance would be too.",
     "Let the CAM system scale the part.", false},
    {kRotation, "Coordinates are rotated (G68).", "Let the CAM system turn the part.", false},
    {kMirror, "Coordinates are mirrored (G51.1), or may be (M21, M22).",
     "Let the CAM system mirror the part.", false},
    {kExactStop, "The program asks for the exact path or for a stop at each point (G61, G61.1).",
     "--allow exact-stop lifts it for G61; or take G61 out of the program.", true},
    {kControlSmoothing,
     "The control fits a curve of its own here (G5.1 Q2, G5 P10000, G131, COMPCAD): its tolerance "
     "would come on top.",
     "Switch one of the two off; or --allow control-smoothing where both tolerances together are "
     "fine.",
     true},
    {kModalMacro, "A macro runs after each motion (G66).", kCopied, false},
    {kLatheDiameter, "X is a diameter (G7).", "Lathe programs in diameters are not smoothed.",
     false},
    {kLatheProgram,
     "The program is one for a lathe, by its marks: X may be a diameter, U and W increments, G90, "
     "G92 "
     "and G94 cycles.",
     "Programs for lathes are copied as they are. The warning names the mark: if this is a program "
     "for a mill, write that word in another way.",
     false},
    {kFeedUnknown, "No feed is known for this motion.", "Write F before the first cutting move.",
     false},
    {kLoopBody,
     "The block is inside a loop, a branch, a subprogram or a contour that a cycle uses: it can "
     "be entered in a state that is not seen here.",
     "Write the loop out, or smooth the subprogram as a program of its own.", false},

    {kTooShort, "Fewer motions in a row than a run needs.", "--min-points lowers the number.",
     false},
    {kNoGain, "The new form was neither faster, nor smaller, nor nearer to the path.",
     "Nothing: the program is good here.", false},
    {kSlower, "The new form would take more time on the machine.",
     "--prefer size or a larger tolerance may help.", false},
    {kNotProved, "The new path could not be proved to keep the tolerance.",
     "A larger tolerance helps, or more decimals.", false},
    {kCrossesItself,
     "Two parts of the run are so near to each other that the new path would cross itself where "
     "the old one does not.",
     "A smaller tolerance may help.", false},
    {kWrongSide, "The new path could not be proved to stay on the side that --side asks for.",
     "A larger tolerance may help, or more decimals.", false},
    {kAlreadySmoothed, "The program says that it was smoothed before; tolerances add up.",
     "Smooth the original instead, or --allow already-smoothed.", true},
    {kNoFit, "No curve inside the tolerance was found.", "A larger tolerance may help.", false},
    {kTargetCannot, "The target control cannot say the new form.",
     "--output lines works with every target.", false},
    {kMethodNone, "--method none: nothing was to be smoothed.", "Choose another --method.", false},

    {kWorkOffset,
     "With --convert: the program names a work offset (G54), and the target's language has none: "
     "the datum is set at the control.",
     "--allow work-offset converts the program for the datum that is active when it runs.", true},
    {kToolLength,
     "With --convert: the program moves without the length of its tool (G49, or along Z without "
     "G43 "
     "behind the tool), which always counts on the target.",
     "--allow tool-length converts such motions as if the length counted: their Z is that of the "
     "tip then.",
     true},
    {kBlankForm,
     "With --convert: the program draws the blank for the control's simulation (BLK FORM), and the "
     "target's language has no word for that.",
     "--allow blank-form leaves the block as a comment.", true},
};

}  // namespace

std::span<const Explanation> explanations() { return kExplanations; }

}  // namespace batten::gcode::reason

namespace batten::gcode {

ReasonId::ReasonId(std::string_view id) {
  if (id.empty()) return;
  const auto all = reason::explanations();
  // The constants of reason.h are one text each: nearly always this is enough.
  auto found = std::ranges::find_if(
      all, [id](const reason::Explanation& each) { return each.id.data() == id.data(); });
  if (found == all.end() || found->id != id) {
    found = std::ranges::find(all, id, &reason::Explanation::id);
  }
  if (found == all.end() || found - all.begin() >= std::numeric_limits<std::uint8_t>::max()) {
    throw std::invalid_argument("reason '" + std::string(id) +
                                "' is not one of gcode/state/reason.h");
  }
  place_ = static_cast<std::uint8_t>(found - all.begin() + 1);
}

std::string_view ReasonId::id() const {
  return empty() ? std::string_view() : reason::explanations()[place_ - 1U].id;
}

}  // namespace batten::gcode
