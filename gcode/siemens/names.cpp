#include "gcode/siemens/names.h"

#include <cstdint>
#include <string>

#include "gcode/siemens/block.h"
#include "gcode/siemens/lexer.h"
#include "gcode/siemens/name_kinds.h"
#include "gcode/state/reason.h"

namespace batten::gcode {
namespace {

class NameApplier {
 public:
  NameApplier(std::string_view text, const BlockWords& words, SiemensVariables& variables,
              ControlState& state)
      : text_(text), words_(words), variables_(variables), state_(state) {}

  NamedEffect apply() {
    SiemensLexer lexer(text_, {0, static_cast<std::uint32_t>(text_.size())});
    for (;;) {
      const SiemensToken token = lexer.next();
      if (token.kind == SiemensTokenKind::kEnd || token.kind == SiemensTokenKind::kComment) break;
      if (token.kind == SiemensTokenKind::kLabel) block(reason::kProgramFlow);
      const std::string name = siemens_name(text_, token);
      if (name.empty()) continue;
      const bool own = token.assigned && variables_.contains(name);
      const auto kind = own ? NameKind::kVariable : kind_of_siemens_name(name, token.assigned);
      if (!kind) {
        effect_.understood = false;
        block(reason::kForeignWords);
        break;
      }
      if (*kind == NameKind::kDeclaration) {
        block(reason::kForeignWords);
        if (name == "DEF") add_declared_names(text_.substr(token.span.end), variables_);
        break;
      }
      calls_modally_ = calls_modally_ || *kind == NameKind::kModalCall;
      apply(*kind, token.arguments);
    }
    block(reason::kStateChange);
    return effect_;
  }

 private:
  void block(std::string_view why) {
    if (effect_.barrier.empty()) effect_.barrier = why;
  }

  void lose_place(std::string_view why) {
    block(why);
    effect_.loses_place = true;
  }

  [[nodiscard]] bool names_axes() const { return words_.has_any("XYZABCUVW"); }

  ModalState& modal() { return state_.modal; }

  // With axis words the frame is set; without it all programmable frames are taken back.
  void apply_frame(TriState& item, std::string_view why) {
    add_frame(item, why);
    if (!names_axes()) take_frames_back();
  }

  void apply_offset() {
    effect_.takes_axes = true;
    lose_place(reason::kCoordinateChange);
  }

  void take_frames_back() {
    for (TriState* each : {&modal().rotation, &modal().scaling, &modal().mirror})
      *each = TriState::kOff;
  }

  void add_frame(TriState& item, std::string_view why) {
    lose_place(why);
    effect_.takes_axes = true;
    item = TriState::kOn;
  }

  void set_units_to(Units units) {
    block(reason::kStateChange);
    set_units(state_, units);
    state_.mark_set(CodeGroup::kUnits);
    effect_.unit_word = true;
  }

  void apply(NameKind kind, bool arguments) {
    switch (kind) {
      case NameKind::kNothing:
      case NameKind::kDeclaration:
        return block(reason::kStateChange);
      case NameKind::kVariable:
        return block(reason::kAssignment);
      case NameKind::kTolerance:
        return block(reason::kControlSmoothing);
      case NameKind::kRefitOn:
        modal().control_smoothing = TriState::kOn;
        return block(reason::kControlSmoothing);
      case NameKind::kRefitOff:
        modal().control_smoothing = TriState::kOff;
        return block(reason::kControlSmoothing);
      case NameKind::kToolCenterOn:
        modal().tool_center_point = TriState::kOn;
        return lose_place(reason::kToolCenterPoint);
      case NameKind::kTransformationOff:
        modal().tool_center_point = TriState::kOff;
        modal().polar = TriState::kOff;
        modal().cylindrical = TriState::kOff;
        return lose_place(reason::kToolCenterPoint);
      case NameKind::kPolarOn:
        modal().polar = TriState::kOn;
        return lose_place(reason::kPolar);
      case NameKind::kCylinderOn:
        modal().cylindrical = TriState::kOn;
        return lose_place(reason::kCylindrical);
      case NameKind::kTilt:
        modal().tilted_plane = arguments ? TriState::kOn : TriState::kOff;
        return lose_place(reason::kTiltedPlane);
      case NameKind::kTiltOn:
        modal().tilted_plane = TriState::kOn;
        return lose_place(reason::kTiltedPlane);
      case NameKind::kTiltOff:
        modal().tilted_plane = TriState::kOff;
        return lose_place(reason::kTiltedPlane);
      case NameKind::kOffset:
        if (!names_axes()) take_frames_back();
        return apply_offset();
      case NameKind::kOffsetOn:
        return apply_offset();
      case NameKind::kRotation:
        return apply_frame(modal().rotation, reason::kRotation);
      case NameKind::kScaling:
        return apply_frame(modal().scaling, reason::kScaling);
      case NameKind::kMirror:
        return apply_frame(modal().mirror, reason::kMirror);
      case NameKind::kRotationOn:
        return add_frame(modal().rotation, reason::kRotation);
      case NameKind::kScalingOn:
        return add_frame(modal().scaling, reason::kScaling);
      case NameKind::kMirrorOn:
        return add_frame(modal().mirror, reason::kMirror);
      default:
        return apply_other(kind);
    }
  }

  void apply_other(NameKind kind) {
    switch (kind) {
      case NameKind::kSpline:
        modal().motion = MotionMode::kOther;
        state_.other_motion = reason::kSpline;
        return lose_place(reason::kSpline);
      case NameKind::kBlockPath:
        return lose_place(reason::kNotUnderstood);
      case NameKind::kBlending:
        modal().path = PathMode::kBlending;
        return block(reason::kStateChange);
      case NameKind::kInch:
        return set_units_to(Units::kInch);
      case NameKind::kMillimetre:
        return set_units_to(Units::kMillimetre);
      case NameKind::kPole:
        effect_.takes_axes = true;
        return block(reason::kStateChange);
      case NameKind::kApproach:
        effect_.takes_axes = true;
        return lose_place(reason::kCoordinateChange);
      case NameKind::kWorkOffset:
        state_.work_offset = 0;
        return lose_place(reason::kCoordinateChange);
      case NameKind::kTool:
        return lose_place(reason::kToolChange);
      case NameKind::kSpindle:
        modal().spindle_speed.reset();
        return block(reason::kSpindle);
      case NameKind::kDiameterOn:
        lose_place(reason::kLatheDiameter);
        modal().lathe_diameter = TriState::kOn;
        return;
      case NameKind::kDiameterOff:
        block(reason::kStateChange);
        if (modal().lathe_diameter != TriState::kOff) lose_place(reason::kLatheDiameter);
        modal().lathe_diameter = TriState::kOff;
        return;
      default:
        return apply_motions(kind);
    }
  }

  void apply_motions(NameKind kind) {
    switch (kind) {
      case NameKind::kCycle:
        modal().motion = MotionMode::kUnknown;
        modal().feed.reset();
        modal().spindle_speed.reset();
        if (calls_modally_) modal().modal_macro = TriState::kOn;
        return lose_place(reason::kCannedCycle);
      case NameKind::kModalCall:
        modal().modal_macro = TriState::kOff;
        return block(reason::kCannedCycle);
      case NameKind::kSurfaceSpeedOn:
        modal().constant_surface_speed = TriState::kOn;
        return block(reason::kSpindle);
      case NameKind::kSurfaceSpeedOff:
        // With G971 F is per minute, with G973 what it was.
        modal().constant_surface_speed = TriState::kOff;
        modal().feed_mode = FeedMode::kUnknown;
        modal().feed.reset();
        return block(reason::kSpindle);
      case NameKind::kThread:
        modal().motion = MotionMode::kOther;
        state_.other_motion = reason::kThreading;
        return lose_place(reason::kThreading);
      case NameKind::kOtherAxis:
        return lose_place(reason::kOtherAxis);
      default:
        return;
    }
  }

  std::string_view text_;
  const BlockWords& words_;
  SiemensVariables& variables_;
  ControlState& state_;
  NamedEffect effect_;
  bool calls_modally_ = false;  // MCALL stands before it in the block
};

}  // namespace

NamedEffect apply_names(std::string_view text, const BlockWords& words, SiemensVariables& variables,
                        ControlState& state) {
  return NameApplier(text, words, variables, state).apply();
}

}  // namespace batten::gcode
