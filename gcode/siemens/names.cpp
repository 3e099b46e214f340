#include "gcode/siemens/names.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <iterator>
#include <optional>
#include <string>

#include "gcode/characters.h"
#include "gcode/reason.h"
#include "gcode/siemens/block.h"
#include "gcode/siemens/lexer.h"

namespace batten::gcode {
namespace {

enum class NameKind : std::uint8_t {
  kNothing,      // how the axes are driven, messages, tolerances of the control: no path, no state
  kDeclaration,  // the rest of the line declares something
  kRefitOn,
  kRefitOff,
  kToolCenterOn,
  kTransformationOff,
  kPolarOn,
  kCylinderOn,
  kTilt,  // with arguments on, without off
  kTiltOn,
  kOffset,  // a frame that moves the origin
  kRotation,
  kScaling,
  kMirror,
  kRotationOn,  // the additive frames: whatever stands beside them, they do not take any back
  kScalingOn,
  kMirrorOn,
  kSpline,     // the motion group: splines, circles through points
  kBlockPath,  // the path of this block, or its end, is not what X, Y, Z say
  kBlending,
  kInch,
  kMillimetre,
  kPole,      // takes axis words; nothing moves
  kApproach,  // takes axis words; the axes go to places of the machine
  kWorkOffset,
  kTool,
  kSpindle,
  kDiameterOff,
};

struct NameRow {
  std::string_view name;
  NameKind kind;
};

// Not in it are words that are not known: they end the run, and nothing is known after them.
constexpr NameRow kNames[] = {
    {"SOFT", NameKind::kNothing},
    {"BRISK", NameKind::kNothing},
    {"DRIVE", NameKind::kNothing},
    {"FFWON", NameKind::kNothing},
    {"FFWOF", NameKind::kNothing},
    {"STOPRE", NameKind::kNothing},
    {"MSG", NameKind::kNothing},
    {"CYCLE832", NameKind::kNothing},
    {"CTOL", NameKind::kNothing},
    {"OTOL", NameKind::kNothing},
    {"ATOL", NameKind::kNothing},
    {"ADIS", NameKind::kNothing},
    {"ADISPOS", NameKind::kNothing},
    {"NORM", NameKind::kNothing},
    {"KONT", NameKind::kNothing},
    {"CUT2D", NameKind::kNothing},
    {"CUT2DF", NameKind::kNothing},
    {"CFC", NameKind::kNothing},
    {"CFIN", NameKind::kNothing},
    {"CFTCP", NameKind::kNothing},
    {"G450", NameKind::kNothing},
    {"G451", NameKind::kNothing},
    {"G601", NameKind::kNothing},
    {"G602", NameKind::kNothing},
    {"G603", NameKind::kNothing},
    {"WORKPIECE", NameKind::kNothing},
    {"DEF", NameKind::kDeclaration},
    {"EXTERN", NameKind::kDeclaration},
    {"COMPON", NameKind::kRefitOn},
    {"COMPCURV", NameKind::kRefitOn},
    {"COMPCAD", NameKind::kRefitOn},
    {"COMPSURF", NameKind::kRefitOn},
    {"COMPOF", NameKind::kRefitOff},
    {"TRAORI", NameKind::kToolCenterOn},
    {"TRAFOOF", NameKind::kTransformationOff},
    {"TRANSMIT", NameKind::kPolarOn},
    {"TRACYL", NameKind::kCylinderOn},
    {"CYCLE800", NameKind::kTilt},
    {"TOROT", NameKind::kTiltOn},
    {"TOFRAME", NameKind::kTiltOn},
    {"TRANS", NameKind::kOffset},
    {"ATRANS", NameKind::kOffset},
    {"ROT", NameKind::kRotation},
    {"ROTS", NameKind::kRotation},
    {"AROT", NameKind::kRotationOn},
    {"AROTS", NameKind::kRotationOn},
    {"RPL", NameKind::kRotationOn},
    {"SCALE", NameKind::kScaling},
    {"ASCALE", NameKind::kScalingOn},
    {"MIRROR", NameKind::kMirror},
    {"AMIRROR", NameKind::kMirrorOn},
    {"ASPLINE", NameKind::kSpline},
    {"BSPLINE", NameKind::kSpline},
    {"CSPLINE", NameKind::kSpline},
    {"POLY", NameKind::kSpline},
    {"CIP", NameKind::kSpline},
    {"CT", NameKind::kSpline},
    {"INVCW", NameKind::kSpline},
    {"INVCCW", NameKind::kSpline},
    {"PO", NameKind::kBlockPath},
    {"PL", NameKind::kBlockPath},
    {"PW", NameKind::kBlockPath},
    {"SD", NameKind::kBlockPath},
    {"BAUTO", NameKind::kBlockPath},
    {"BNAT", NameKind::kBlockPath},
    {"BTAN", NameKind::kBlockPath},
    {"EAUTO", NameKind::kBlockPath},
    {"ENAT", NameKind::kBlockPath},
    {"ETAN", NameKind::kBlockPath},
    {"RND", NameKind::kBlockPath},
    {"CHF", NameKind::kBlockPath},
    {"CHR", NameKind::kBlockPath},
    {"ANG", NameKind::kBlockPath},
    {"AR", NameKind::kBlockPath},
    {"AP", NameKind::kBlockPath},
    {"RP", NameKind::kBlockPath},
    {"TURN", NameKind::kBlockPath},
    {"FB", NameKind::kBlockPath},
    {"SUPA", NameKind::kBlockPath},
    {"G153", NameKind::kBlockPath},
    {"I1", NameKind::kBlockPath},
    {"J1", NameKind::kBlockPath},
    {"K1", NameKind::kBlockPath},
    {"G641", NameKind::kBlending},
    {"G642", NameKind::kBlending},
    {"G643", NameKind::kBlending},
    {"G644", NameKind::kBlending},
    {"G645", NameKind::kBlending},
    {"G70", NameKind::kInch},
    {"G700", NameKind::kInch},
    {"G71", NameKind::kMillimetre},
    {"G710", NameKind::kMillimetre},
    {"G110", NameKind::kPole},
    {"G111", NameKind::kPole},
    {"G112", NameKind::kPole},
    {"G25", NameKind::kPole},
    {"G26", NameKind::kPole},
    {"G58", NameKind::kOffset},
    {"G59", NameKind::kOffset},
    {"G74", NameKind::kApproach},
    {"G75", NameKind::kApproach},
    {"G500", NameKind::kWorkOffset},
    {"D", NameKind::kTool},
    {"DIAMOF", NameKind::kDiameterOff},
};

// R5, S2, M1, as addresses with digits.
bool is_address(std::string_view name, char letter) {
  return name.size() > 1 && name[0] == letter &&
         std::ranges::all_of(name.substr(1), [](char c) { return is_digit(c); });
}

std::optional<NameKind> kind_of(std::string_view name, bool assigned) {
  const auto* row = std::ranges::find(kNames, name, &NameRow::name);
  if (row != std::end(kNames)) return row->kind;
  // G505 to G599: more work offsets.
  if (name.size() == 4 && name.starts_with("G5") && is_digit(name[2]) && is_digit(name[3]) &&
      name.substr(2) >= "05") {
    return NameKind::kWorkOffset;
  }
  if (assigned && is_address(name, 'R')) return NameKind::kNothing;
  if (assigned && (is_address(name, 'S') || is_address(name, 'M'))) return NameKind::kSpindle;
  if (assigned && is_address(name, 'T')) return NameKind::kTool;
  return std::nullopt;
}

class NameApplier {
 public:
  NameApplier(std::string_view text, const BlockWords& words, ControlState& state)
      : text_(text), words_(words), state_(state) {}

  NamedEffect apply() {
    SiemensLexer lexer(text_, {0, static_cast<std::uint32_t>(text_.size())});
    for (;;) {
      const SiemensToken token = lexer.next();
      if (token.kind == SiemensTokenKind::kEnd || token.kind == SiemensTokenKind::kComment) break;
      const std::string name = name_of(token);
      if (name.empty()) continue;
      const auto kind = kind_of(name, token.assigned);
      if (!kind) {
        effect_.understood = false;
        block(reason::kForeignWords);
        break;
      }
      if (*kind == NameKind::kDeclaration) {
        block(reason::kForeignWords);
        break;
      }
      apply(*kind, token.arguments);
    }
    block(reason::kStateChange);
    return effect_;
  }

 private:
  // Empty for words that the block lists and the interpreter follows.
  [[nodiscard]] std::string name_of(const SiemensToken& token) const {
    std::string name;
    if (token.kind == SiemensTokenKind::kName) {
      for (const char c : text_.substr(token.name.begin, token.name.size())) {
        name.push_back(upper(c));
      }
      return name == "CR" ? std::string() : name;
    }
    if (token.letter == 'D') return "D";
    if (token.kind != SiemensTokenKind::kWord || token.letter != 'G' ||
        is_common_siemens_g(token.number.value)) {
      return name;
    }
    const double code = token.number.value;
    constexpr double kGreatestCode = 999;
    const bool whole = code >= 0 && code <= kGreatestCode && code == std::floor(code);
    return whole ? "G" + std::to_string(static_cast<int>(code)) : "G?";
  }

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
  void apply_frame(Tri& item, std::string_view why) {
    add_frame(item, why);
    if (names_axes()) return;
    for (Tri* each : {&modal().rotation, &modal().scaling, &modal().mirror}) *each = Tri::kOff;
  }

  void add_frame(Tri& item, std::string_view why) {
    lose_place(why);
    effect_.takes_axes = true;
    item = Tri::kOn;
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
      case NameKind::kRefitOn:
        modal().control_smoothing = Tri::kOn;
        return block(reason::kControlSmoothing);
      case NameKind::kRefitOff:
        modal().control_smoothing = Tri::kOff;
        return block(reason::kControlSmoothing);
      case NameKind::kToolCenterOn:
        modal().tool_center_point = Tri::kOn;
        return lose_place(reason::kToolCenterPoint);
      case NameKind::kTransformationOff:
        modal().tool_center_point = Tri::kOff;
        modal().polar = Tri::kOff;
        modal().cylindrical = Tri::kOff;
        return lose_place(reason::kToolCenterPoint);
      case NameKind::kPolarOn:
        modal().polar = Tri::kOn;
        return lose_place(reason::kPolar);
      case NameKind::kCylinderOn:
        modal().cylindrical = Tri::kOn;
        return lose_place(reason::kCylindrical);
      case NameKind::kTilt:
        modal().tilted_plane = arguments ? Tri::kOn : Tri::kOff;
        return lose_place(reason::kTiltedPlane);
      case NameKind::kTiltOn:
        modal().tilted_plane = Tri::kOn;
        return lose_place(reason::kTiltedPlane);
      case NameKind::kOffset:
        effect_.takes_axes = true;
        return lose_place(reason::kCoordinateChange);
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
      case NameKind::kDiameterOff:
        if (modal().lathe_diameter != Tri::kOff) lose_place(reason::kLatheDiameter);
        modal().lathe_diameter = Tri::kOff;
        return;
      default:
        return;
    }
  }

  std::string_view text_;
  const BlockWords& words_;
  ControlState& state_;
  NamedEffect effect_;
};

}  // namespace

NamedEffect apply_names(std::string_view text, const BlockWords& words, ControlState& state) {
  return NameApplier(text, words, state).apply();
}

}  // namespace batten::gcode
