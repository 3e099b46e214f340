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
     "See the warnings: they name the words."},
    {kNoCommand,
     "The block has no G, M or T word: most builds of this control leave such blocks out.",
     "Let the post write the G word in each block (G1 X1); for controls that repeat the motion, "
     "take another target."},
    {kExpression,
     "A word's value is an expression or a parameter that is not certain here (X[#1+2], X#5).",
     "Let the CAM system write plain numbers, or assign the variables (#1=5) in front of all "
     "jumps, "
     "loops and calls."},
    {kImpliedDecimals,
     "A length has no decimal point (X1000), and such a control may take it for that many least "
     "increments (1.000 mm).",
     "Say --decimals explicit where X5 is 5 mm, --decimals implied where it is 0.005 mm, or let "
     "the CAM system write decimal points."},
    {kAssignment, "The block sets a parameter (#1=5, R1=5).", kCopied},
    {kProgramFlow, "The block changes the order of blocks: O-word, IF, WHILE, GOTO, label.",
     "Smooth the straight programs that it calls, one by one."},
    {kForeignWords, "The block is written in words of another language or for the sender.",
     "Choose a post-processor of the CAM system that writes G01 X Y Z."},
    {kProgramMark, "A % line, the program's number, or text outside the % marks.", kCopied},
    {kBlockDelete,
     "The block starts with /: the operator chooses whether it is executed. What it changes is not "
     "known afterwards.",
     "Remove the / if the block is always meant."},
    {kActiveComment,
     "The comment acts when it is reached: (MSG,..), (DEBUG,..), (LOGOPEN,..). Or its brackets are "
     "nested or not closed: controls differ in where it ends, and some refuse it.",
     "Write it as a plain comment if it need not act."},
    {kReferencedLabel,
     "The block's N number is, or may be, the target of a jump, a call, or a return (M99 P) from a "
     "called program that is not read.",
     "--allow subprogram where called programs return after their calls; otherwise nothing: such "
     "blocks are copied as they are."},
    {kOtherAxis, "The block moves or names an axis other than X, Y, Z.",
     "Only three-axis motion is smoothed."},
    {kExtruder, "The block has an E word: the amount is proportional to the path.",
     "Programs for printers are not smoothed."},
    {kCornerWord, "A corner is rounded or chamfered by a word (,R ,C, or R beside G1).",
     "Let the CAM system write the corner as an arc or a line."},
    {kRapid, "A rapid move.", kCopied},
    {kPlunge, "A move straight along Z into or out of a cut: its end is a corner that was meant.",
     "Nothing: the cuts on either side are smoothed by themselves."},
    {kArc, "An arc that is not understood, or one whose G2 or G3 is needed after it.", kCopied},
    {kIntendedArc,
     "An arc that was meant as one: a full circle, or it meets its neighbours tangentially or in "
     "corners. Arcs that meet at small angles are pieces of a curve, and are smoothed.",
     kCopied},
    {kDwell, "A dwell (G4).", kCopied},
    {kProbe, "A probing move.", kCopied},
    {kCannedCycle, "A canned cycle, or a position of one.", kCopied},
    {kThreading, "A thread: the path is tied to the spindle.", kCopied},
    {kSpline,
     "The block is part of a spline that is not read (a weight that is not positive, a degree "
     "above five, words that the target does not have), or whose word or direction a block behind "
     "it "
     "needs.",
     "--source names the control that the program was written for where the target has no such "
     "words; let the block behind the spline name its motion (G1). Others are copied as they are."},
    {kCoordinateChange,
     "The origin moves, or a move is given in machine coordinates (G54, G92, G10, G28, G53 ..).",
     kCopied},
    {kToolChange, "The tool or its offsets change (T, M6, H, D, G43, G49).", kCopied},
    {kSpindle, "The spindle or its speed changes (S, M3, M4, M5).", kSeparate},
    {kCoolant, "The coolant changes (M7, M8, M9).", kSeparate},
    {kMiscFunction, "Another M word: when it acts depends on where its block ends.", kSeparate},
    {kOwnWord,
     "The block has a word of the control's own, or one that the user says something of "
     "(--word, or own-words of the profile): what it does is done there.",
     kCopied},
    {kStateChange, "The block changes a mode (units, plane, distance, feed, path ..).", kCopied},
    {kComment, "Comments or empty lines alone.", kCopied},
    {kStatedTolerance,
     "The program says a tolerance here that is less than --tolerance: beside a move, or less than "
     "what the decimals of the target can keep.",
     "Write the comment on a line of its own; or --one-tolerance, which takes --tolerance for all "
     "parts."},
    {kChecksum, "The line has a check sum: the sender counts such lines.",
     "Take numbers and sums off; the sender adds them when it sends."},
    {kSubprogram,
     "A subprogram is called, or ends. What is known afterwards is what its file in the same "
     "folder leaves, or what --word says of it; nothing without these.",
     "Put its file into the same folder; or --allow subprogram where all that are called leave "
     "all modes (units, plane, G90, compensation, rotation ..) as they find them and come back "
     "behind the call: then only position and feed are unknown there, and N numbers are no "
     "targets.",
     true},
    {kProgramEnd, "The program stops or ends (M0, M1, M2, M30, M60).", kCopied},

    {kUnitsUnknown, "Inch or millimetre is not known here.",
     "Write G20 or G21 before the first motion, or say --units mm or --units inch."},
    {kStateUnknown,
     "A block before this one could have changed any mode, and not every mode was set again.",
     "Look for the call, jump or unknown word above; set the modes again after it. Behind calls "
     "that keep all modes: --allow subprogram."},
    {kPositionUnknown, "The tool's position before this motion is not known.",
     "The first motion after a call, tool change or offset change is always kept."},
    {kCutterCompensation, "Cutter compensation is on (G41, G42): the path is not the tool's.",
     "Let the CAM system compute the tool's path."},
    {kToolCenterPoint, "Tool centre point control is on (G43.4, G43.5, M128).",
     "Only three-axis motion is smoothed."},
    {kTiltedPlane, "The working plane is tilted (G68.2).", "Only plain coordinates are smoothed."},
    {kIncremental, "Distances are incremental (G91): rounding would add up.",
     "Let the CAM system write absolute coordinates (G90)."},
    {kInverseTime, "The feed is inverse time (G93): each block's time is its own.",
     "Let the CAM system write feeds per minute (G94)."},
    {kFeedPerRevolution, "The feed is per revolution (G95).",
     "Let the CAM system write feeds per minute (G94)."},
    {kConstantSurfaceSpeed, "Constant surface speed is on (G96).", kCopied},
    {kPolar, "Coordinates are polar (G16, G12.1).",
     "Let the CAM system write Cartesian coordinates."},
    {kCylindrical, "Coordinates are on a cylinder (G7.1).",
     "Let the CAM system write Cartesian coordinates."},
    {kScaling, "Coordinates are scaled (G51): the tolerance would be too.",
     "Let the CAM system scale the part. Where G51 only chooses a zero point on your control: "
     "--word 'G51 = position unknown'."},
    {kRotation, "Coordinates are rotated (G68).", "Let the CAM system turn the part."},
    {kMirror, "Coordinates are mirrored (G51.1), or may be (M21, M22).",
     "Let the CAM system mirror the part."},
    {kExactStop,
     "The program asks for the exact path or for a stop at each point (G60, G61, G61.1).",
     "--allow exact-stop lifts it for G61; or take G60 or G61 out of the program.", true},
    {kControlSmoothing,
     "The control fits a curve of its own here (G5.1 Q2, G5 P10000, G131, COMPCAD): its tolerance "
     "would come on top.",
     "Switch one of the two off; or --allow control-smoothing where both tolerances together are "
     "fine.",
     true},
    {kModalMacro, "A macro runs after each motion (G66).", kCopied},
    {kLatheDiameter, "X is a diameter (G7).", "Lathe programs in diameters are not smoothed."},
    {kLatheProgram,
     "The program is one for a lathe, by its marks: X may be a diameter, U and W increments, G90, "
     "G92 and G94 cycles.",
     "Programs for lathes are copied as they are. The warning names the mark: if this is a program "
     "for a mill, write that word in another way."},
    {kFeedUnknown,
     "No feed is known for this motion. F in a block that changes the units (G20 F6) is none: some "
     "controls take it in the units before the block, others in those after it.",
     "Write F before the first cutting move, in a block behind that of the units; or say --units "
     "where the control has them from the beginning."},
    {kLoopBody,
     "The block is inside a loop, a branch, a subprogram or a contour that a cycle uses: it can be "
     "entered in a state that is not seen here.",
     "Write the loop out, or smooth the subprogram as a program of its own."},
    {kCallerModes,
     "The program is one that others call (it ends with M99, M17 or RET): it runs under the modes "
     "of its caller, which are not known here.",
     "--allow caller-modes where every caller calls it under the modes of power-on (G17, G90, G94, "
     "G40, no rotation, scaling or mirroring ..), but for those that it sets itself; and --units "
     "where it does not say them. N numbers are targets unless --allow subprogram says that "
     "nothing begins at them.",
     true},

    {kTooShort, "Fewer motions in a row than a run needs.",
     "Nothing: so few motions have little to win."},
    {kNoGain, "The new form was not clearly faster, smaller, nearer to the path or smoother.",
     "batten explore shows what other tolerances, forms and preferences would give."},
    {kSlower, "The new form would take more time on the machine.", "A larger tolerance may help."},
    {kLarger, "The new form would be more blocks or bytes, for too little.",
     "A larger tolerance; --prefer accuracy pays blocks for half the distance."},
    {kFarther, "The new form would be farther from the path that was meant, without being faster.",
     "--prefer size where fewer blocks are worth that."},
    {kNotProved, "The new path could not be proved to keep the tolerance.",
     "A larger tolerance helps, or more decimals."},
    {kCrossesItself,
     "Two parts of the run are so near to each other that the new path would cross itself where "
     "the old one does not.",
     "A smaller tolerance may help."},
    {kWrongSide, "The new path could not be proved to stay on the side that --side asks for.",
     "A larger tolerance may help, or more decimals."},
    {kAlreadySmoothed, "The program says that it was smoothed before; tolerances add up.",
     "Smooth the original instead, or --allow already-smoothed.", true},
    {kNoFit, "No curve inside the tolerance was found.", "A larger tolerance may help."},
    {kTargetCannot, "The target control cannot say the new form.",
     "--output lines works with every target."},
    {kMethodNone, "--method none: nothing was to be smoothed.", "Choose another --method."},

    {kWorkOffset,
     "With --convert: the program names a work offset (G54), and the target's language has none: "
     "the datum is set at the control.",
     "--allow work-offset converts the program for the datum that is active when it runs.", true},
    {kToolLength,
     "With --convert: the program moves without the length of its tool (G49, or along Z without "
     "G43 behind the tool), which always counts on the target.",
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
  static_assert(std::size(reason::kExplanations) < std::numeric_limits<std::uint8_t>::max());
  if (id.empty()) return;
  const auto all = reason::explanations();
  const auto found = std::ranges::find(all, id, &reason::Explanation::id);
  if (found == all.end()) {
    throw std::invalid_argument("reason '" + std::string(id) +
                                "' is not one of gcode/state/reason.h");
  }
  number_ = static_cast<std::uint8_t>(found - all.begin() + 1);
}

std::string_view ReasonId::id() const {
  return empty() ? std::string_view() : reason::explanations()[number_ - 1U].id;
}

}  // namespace batten::gcode
