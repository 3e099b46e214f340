// Why blocks are kept as they are: stable ids, shown in reports, lifted by --allow where
// that can be safe. Every id is explained in reason.cpp and in docs/diagnostics.md.
#pragma once

#include <cstdint>
#include <span>
#include <string_view>

namespace batten::gcode::reason {

// --- a block that cannot be part of a run -------------------------------------------------
inline constexpr std::string_view kNotUnderstood = "not-understood";
inline constexpr std::string_view kNoCommand = "no-command";
inline constexpr std::string_view kExpression = "expression";
inline constexpr std::string_view kImpliedDecimals = "implied-decimals";
inline constexpr std::string_view kAssignment = "parameter-assignment";
inline constexpr std::string_view kProgramFlow = "program-flow";
inline constexpr std::string_view kForeignWords = "foreign-words";
inline constexpr std::string_view kProgramMark = "program-mark";
inline constexpr std::string_view kBlockDelete = "block-delete";
inline constexpr std::string_view kActiveComment = "active-comment";
inline constexpr std::string_view kReferencedLabel = "referenced-label";
inline constexpr std::string_view kOtherAxis = "other-axis";  // A B C U V W, vectors
inline constexpr std::string_view kExtruder = "extruder";
inline constexpr std::string_view kCornerWord = "corner-word";
inline constexpr std::string_view kRapid = "rapid";
inline constexpr std::string_view kPlunge = "plunge";
inline constexpr std::string_view kArc = "arc";
inline constexpr std::string_view kIntendedArc = "intended-arc";
inline constexpr std::string_view kDwell = "dwell";
inline constexpr std::string_view kProbe = "probe";
inline constexpr std::string_view kCannedCycle = "canned-cycle";
inline constexpr std::string_view kThreading = "threading";
inline constexpr std::string_view kSpline = "spline";  // G5, G5.1, G5.2, G6.x
inline constexpr std::string_view kCoordinateChange = "coordinate-change";
inline constexpr std::string_view kToolChange = "tool-change";
inline constexpr std::string_view kSpindle = "spindle";
inline constexpr std::string_view kCoolant = "coolant";
inline constexpr std::string_view kMiscFunction = "misc-function";
inline constexpr std::string_view kOwnWord = "own-word";
inline constexpr std::string_view kStateChange = "state-change";
inline constexpr std::string_view kComment = "comment";  // only where comments must stand alone
inline constexpr std::string_view kStatedTolerance = "stated-tolerance";
inline constexpr std::string_view kChecksum = "checksum";  // N5 G1 X1*71
inline constexpr std::string_view kSubprogram = "subprogram";
inline constexpr std::string_view kProgramEnd = "program-end";

// --- a state in which nothing is rewritten ------------------------------------------------
inline constexpr std::string_view kUnitsUnknown = "units-unknown";
inline constexpr std::string_view kStateUnknown = "state-unknown";
inline constexpr std::string_view kPositionUnknown = "position-unknown";
inline constexpr std::string_view kCutterCompensation = "cutter-compensation";
inline constexpr std::string_view kToolCenterPoint = "tool-center-point";
inline constexpr std::string_view kTiltedPlane = "tilted-plane";
inline constexpr std::string_view kIncremental = "incremental-distance";
inline constexpr std::string_view kInverseTime = "inverse-time-feed";
inline constexpr std::string_view kFeedPerRevolution = "feed-per-revolution";
inline constexpr std::string_view kConstantSurfaceSpeed = "constant-surface-speed";
inline constexpr std::string_view kPolar = "polar-coordinates";
inline constexpr std::string_view kCylindrical = "cylindrical";
inline constexpr std::string_view kScaling = "scaling";
inline constexpr std::string_view kRotation = "rotation";
inline constexpr std::string_view kMirror = "mirror";
inline constexpr std::string_view kExactStop = "exact-stop";
inline constexpr std::string_view kControlSmoothing = "control-smoothing";
inline constexpr std::string_view kModalMacro = "modal-macro";
inline constexpr std::string_view kLatheDiameter = "lathe-diameter";
inline constexpr std::string_view kLatheProgram = "lathe-program";
inline constexpr std::string_view kFeedUnknown = "feed-unknown";
inline constexpr std::string_view kLoopBody = "loop-body";
inline constexpr std::string_view kCallerModes = "caller-modes";

// --- a run that was tried and went back -----------------------------------------------------
inline constexpr std::string_view kTooShort = "too-short";  // fewer motions than a run needs
inline constexpr std::string_view kNoGain = "no-gain";
inline constexpr std::string_view kSlower = "slower";
inline constexpr std::string_view kLarger = "larger";
inline constexpr std::string_view kFarther = "farther";
inline constexpr std::string_view kNotProved = "not-proved";
inline constexpr std::string_view kCrossesItself = "crosses-itself";
inline constexpr std::string_view kWrongSide = "wrong-side";
inline constexpr std::string_view kAlreadySmoothed = "already-smoothed";
inline constexpr std::string_view kNoFit = "no-fit";
inline constexpr std::string_view kTargetCannot = "target-cannot";
inline constexpr std::string_view kMethodNone = "method-none";

// --- a program that is not converted, where the user may say that it can be ------------------
inline constexpr std::string_view kWorkOffset = "work-offset";
inline constexpr std::string_view kToolLength = "tool-length";
inline constexpr std::string_view kBlankForm = "blank-form";

struct Explanation {
  std::string_view id;
  std::string_view text;        // what it means, one or two sentences
  std::string_view advice;      // what a user can do about it
  bool can_be_allowed = false;  // --allow ID lifts it
};

// Every id above, in this order.
[[nodiscard]] std::span<const Explanation> explanations();

}  // namespace batten::gcode::reason

namespace batten::gcode {

// A reason in one byte, for what is held once per block. Reads as its id, empty where there is
// none.
class ReasonId {
 public:
  ReasonId() = default;
  // Throws std::invalid_argument for an id that is none of the above, nor empty.
  ReasonId(std::string_view id);

  [[nodiscard]] bool empty() const { return number_ == 0; }
  [[nodiscard]] std::string_view id() const;
  operator std::string_view() const { return id(); }

  friend bool operator==(ReasonId, ReasonId) = default;
  friend bool operator==(ReasonId a, std::string_view b) { return a.id() == b; }

 private:
  std::uint8_t number_ = 0;  // in reason::explanations(), from 1; 0: none
};

}  // namespace batten::gcode
