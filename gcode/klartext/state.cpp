#include "gcode/klartext/state.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <charconv>
#include <optional>

#include "gcode/klartext/flow.h"
#include "gcode/klartext/statement.h"
#include "gcode/state/own_words.h"
#include "gcode/state/reason.h"
#include "gcode/text/characters.h"
#include "gcode/text/line_cursor.h"
#include "gcode/text/number_format.h"

namespace batten::gcode {
namespace {

bool starts_with_word(std::string_view text, std::string_view upper_case) {
  return text.size() >= upper_case.size() &&
         is_same_word(text.substr(0, upper_case.size()), upper_case);
}

// The number behind `prefix` letters of the token, as `+1,5` or `20`.
std::optional<double> number_in(std::string_view token, std::size_t prefix) {
  std::string digits(token.substr(prefix));
  std::ranges::replace(digits, ',', '.');
  const auto number = read_number(digits);
  if (!number || !(number->value > -kNumberLimit && number->value < kNumberLimit)) return {};
  return number->value;
}

// FMAX counts in its block only; a plain number is modal; others are not followed.
void apply_feed(std::string_view token, std::string_view next, ModalState& modal) {
  if (is_same_word(token, "FMAX") || (token.size() == 1 && is_same_word(next, "MAX"))) return;
  const auto number = token.size() == 1 ? number_in(next, 0) : number_in(token, 1);
  modal.feed.reset();
  const bool plain = number && *number > 0 && modal.feed_mode == FeedMode::kPerMinute;
  if (plain && modal.units != Units::kUnknown) {
    modal.feed = *number * millimetres_per(modal.units);
  }
}

// Those that are known below, and whatever the user says of them.
bool is_known_function(double code) {
  static constexpr double kKnown[] = {2,   30,  89,  99,  112, 113, 114, 115,
                                      124, 128, 129, 136, 137, 144, 145};
  return std::ranges::find(kKnown, code) != std::end(kKnown);
}

// Of a line of M words that the user vouches for, every one of them: what they keep together.
std::optional<OwnEffect> own_functions(std::string_view content, const ControlState& state) {
  OwnEffect all = {.keeps_modes = true, .keeps_motion = true, .keeps_place = true};
  KlartextTokens tokens(content);
  for (std::string_view token = tokens.next(); !token.empty(); token = tokens.next()) {
    const auto code = upper(token[0]) == 'M' ? number_in(token, 1) : std::nullopt;
    if (!code || is_known_function(*code)) return std::nullopt;
    const OwnWord* own = own_call(state, fmt::format("M{:.0f}", *code));
    if (own == nullptr) return std::nullopt;
    all.keeps_motion &= own->effect.keeps_motion;
    all.keeps_place &= own->effect.keeps_place;
  }
  return all;
}

void hold_center(CenterHold way, TriState value, ControlState& state) {
  state.klartext.center_holds[static_cast<std::size_t>(way)] = value;
  state.modal.tool_center_point = state.klartext.holds_center();
}

struct CenterFunctions {
  double begin, end;  // M codes
  CenterHold way;
};
constexpr CenterFunctions kCenterFunctions[] = {
    {128, 129, CenterHold::kM128}, {114, 115, CenterHold::kM114}, {144, 145, CenterHold::kM144}};

void apply_function(double code, ControlState& state) {
  ModalState& modal = state.modal;
  for (const CenterFunctions& row : kCenterFunctions) {
    if (code == row.begin) hold_center(row.way, TriState::kOn, state);
    if (code == row.end) hold_center(row.way, TriState::kOff, state);
  }
  if (code == 136 || code == 137) {
    modal.feed_mode = code == 136 ? FeedMode::kPerRevolution : FeedMode::kPerMinute;
    modal.feed.reset();
  }
  if (code == 112 || code == 124) modal.control_smoothing = TriState::kOn;
  if (code == 113) modal.control_smoothing = TriState::kOff;
  if (code == 89) modal.modal_macro = TriState::kOn;  // a cycle at each place from now on
  if (code == 99) modal.modal_macro = TriState::kOff;
  if (code == 2 || code == 30) forget_klartext(state);
}

// What the words of a copied statement set beside its path.
void apply_words(std::string_view content, ControlState& state) {
  KlartextTokens tokens(content);
  for (std::string_view token = tokens.next(); !token.empty(); token = tokens.next()) {
    if (is_same_word(token, "R0")) state.modal.cutter_compensation = TriState::kOff;
    const bool on =
        is_same_word(token, "RL") || is_same_word(token, "RR") || token == "R+" || token == "R-";
    if (on) state.modal.cutter_compensation = TriState::kOn;
    if (upper(token[0]) == 'F') apply_feed(token, tokens.peek(), state.modal);
    if (upper(token[0]) == 'M' && token.size() > 1 && is_digit(token[1])) {
      if (const auto code = number_in(token, 1)) apply_function(*code, state);
    }
  }
}

class CycleEffect {
 public:
  CycleEffect(std::string_view content, ControlState& state) : tokens_(content), state_(state) {}

  std::string_view apply() {
    (void)tokens_.next();  // CYCL
    (void)tokens_.next();  // DEF
    read_number(tokens_.next());
    value_ = tokens_.next();
    switch (major_) {
      case 7:    // datum shift
      case 247:  // preset
        forget_position(state_);
        return reason::kCoordinateChange;
      case 8:
        return set_frame(state_.modal.mirror, value_.empty() ? TriState::kOff : TriState::kOn,
                         reason::kMirror);
      case 10:
        return set_frame(state_.modal.rotation, says("ROT", 0) ? TriState::kOff : TriState::kOn,
                         reason::kRotation);
      case 11:
        return apply_scaling();
      case 26:
        return apply_axis_scaling();
      case 19:
        return set_frame(state_.modal.tilted_plane, value_.empty() ? TriState::kOff : TriState::kOn,
                         reason::kTiltedPlane);
      case 9:
        return reason::kDwell;
      case 32:  // TOLERANCE: how far the control may round, not where the path is
        return reason::kControlSmoothing;
      default:
        return apply_other();
    }
  }

 private:
  // 19.1: 19 and 1.
  void read_number(std::string_view token) {
    const char* end = token.data() + token.size();
    const auto major = std::from_chars(token.data(), end, major_);
    if (major.ec == std::errc{} && major.ptr != end && *major.ptr == '.') {
      std::from_chars(major.ptr + 1, end, minor_);
    }
  }

  // The first line (8.0, 10.0) only says the name; the values follow in the next.
  std::string_view set_frame(TriState& item, TriState value, std::string_view why) {
    forget_position(state_);
    if (minor_ == 1) item = value;
    if (minor_ > 1 || minor_ < 0) item = TriState::kUnknown;
    return why;
  }

  // A factor for each axis (cycle 26) counts beside it.
  std::string_view apply_scaling() {
    const std::string_view why = set_frame(
        state_.modal.scaling, says("SCL", 1) ? TriState::kOff : TriState::kOn, reason::kScaling);
    if (state_.klartext.scaled_by_axis) state_.modal.scaling = TriState::kUnknown;
    return why;
  }

  // Cycle 11 does not end it, nor does it end cycle 11: with a factor of 1 for X, Y and Z cycle 11
  // says what holds from there on.
  std::string_view apply_axis_scaling() {
    forget_position(state_);
    std::array<bool, 3> is_one = {};
    for (; minor_ == 1 && !value_.empty(); value_ = tokens_.next()) {
      const char axis = upper(value_[0]);
      const auto factor = value_.size() == 1 ? number_in(tokens_.peek(), 0) : number_in(value_, 1);
      if (axis >= 'X' && axis <= 'Z' && factor == 1)
        is_one[static_cast<std::size_t>(axis - 'X')] = true;
    }
    const bool ends = std::ranges::all_of(is_one, [](bool one) { return one; });
    if (minor_ == 1) state_.klartext.scaled_by_axis = !ends;
    state_.modal.scaling = TriState::kUnknown;
    return reason::kScaling;
  }

  // `ROT+0` or `ROT +0`.
  [[nodiscard]] bool says(std::string_view name, double value) {
    if (!starts_with_word(value_, name)) return false;
    if (value_.size() == name.size()) return number_in(tokens_.peek(), 0) == value;
    return number_in(value_, name.size()) == value;
  }

  // Cycles that wait for their call change nothing until then. Patterns run at once, probing sets
  // coordinates, others are not known.
  std::string_view apply_other() {
    const int n = major_;
    const bool waits = (n >= 1 && n <= 6) || n == 17 || n == 18 || (n >= 200 && n <= 215) ||
                       (n >= 225 && n <= 241) || (n >= 251 && n <= 277);
    if (n == 220 || n == 221) {
      forget_position(state_);
      state_.modal.feed.reset();
    } else if (waits) {
      state_.modal.modal_macro = TriState::kOff;  // M89 calls the cycle before it no longer
    } else {
      forget_klartext(state_);
    }
    return reason::kCannedCycle;
  }

  KlartextTokens tokens_;
  ControlState& state_;
  int major_ = -1;
  int minor_ = -1;
  std::string_view value_;
};

// TOOL CALL 5 Z S5000: the tool axis is across the plane of arcs. TOOL CALL S3000 keeps it. With
// the axis Z, S and F and nothing else the tool stays, and so does its length.
void apply_tool_call(std::string_view content, ControlState& state) {
  state.modal.spindle_speed.reset();
  state.modal.feed.reset();
  bool keeps_tool = true;
  KlartextTokens tokens(content);
  (void)tokens.next();  // TOOL
  (void)tokens.next();  // CALL
  for (std::string_view token = tokens.next(); !token.empty(); token = tokens.next()) {
    const char letter = upper(token[0]);
    const bool axis = token.size() == 1;
    if (axis && letter == 'Z') state.modal.plane = Plane::kXY;
    if (axis && letter == 'Y') state.modal.plane = Plane::kZX;
    if (axis && letter == 'X') state.modal.plane = Plane::kYZ;
    if (axis && letter >= 'U' && letter <= 'W') state.modal.plane = Plane::kUnknown;
    const bool value = (letter == 'S' || letter == 'F') && number_in(token, 1);
    keeps_tool = keeps_tool && (value || (axis && letter == 'Z'));
  }
  if (!keeps_tool) forget_position(state);
}

// BEGIN PGM name MM
void apply_begin(std::string_view content, ControlState& state) {
  KlartextTokens tokens(content);
  std::string_view last;
  for (std::string_view token = tokens.next(); !token.empty(); token = tokens.next()) last = token;
  if (is_same_word(last, "MM")) set_units(state, Units::kMillimetre);
  if (is_same_word(last, "INCH")) set_units(state, Units::kInch);
}

std::string_view apply_plane(std::string_view content, ControlState& state) {
  KlartextTokens tokens(content);
  (void)tokens.next();  // PLANE
  state.modal.tilted_plane = is_same_word(tokens.next(), "RESET") ? TriState::kOff : TriState::kOn;
  forget_position(state);
  return reason::kTiltedPlane;
}

// FUNCTION TCPM .., FUNCTION RESET TCPM
std::string_view apply_tcpm(std::string_view content, ControlState& state) {
  KlartextTokens tokens(content);
  (void)tokens.next();
  const bool resets = is_same_word(tokens.next(), "RESET");
  if (resets && !is_same_word(tokens.next(), "TCPM")) {
    forget_klartext(state);
    return reason::kForeignWords;
  }
  hold_center(CenterHold::kFunction, resets ? TriState::kOff : TriState::kOn, state);
  forget_position(state);
  return reason::kToolCenterPoint;
}

// CALL LBL, LBL, FN 9: a label that control can come to is known to program_flow.
std::string_view apply_flow(KlartextKind kind, std::string_view content, ControlState& state) {
  const bool by_name = kind == KlartextKind::kCallProgram;
  if (const OwnWord* own = by_name ? own_call(state, klartext_call(content)) : nullptr) {
    own->effect.keeps_modes ? apply_own(own->effect, state) : forget_klartext(state);
    return reason::kSubprogram;
  }
  if (kind == KlartextKind::kCallLabel || kind == KlartextKind::kCallProgram) {
    state.calls_keep_modes ? forget_what_calls_change(state) : forget_klartext(state);
    return reason::kSubprogram;
  }
  return reason::kProgramFlow;
}

// The tool is somewhere else afterwards.
std::string_view apply_path(KlartextKind kind, std::string_view content, std::string_view statement,
                            ControlState& state) {
  const bool of_contour = starts_with_word(content, "APPR") || starts_with_word(content, "DEP");
  if (of_contour) state.modal.cutter_compensation = TriState::kUnknown;
  forget_position(state);
  LineCursor lines(statement);
  while (const auto line = lines.next()) {
    const SourceSpan span = klartext_parts(statement, {line->begin, line->text_end}).content;
    apply_words(statement.substr(span.begin, span.size()), state);
  }
  return kind == KlartextKind::kSpline ? reason::kSpline : reason::kForeignWords;
}

}  // namespace

// Increments and polar coordinates are said in each block, cylinders by cycles with an end of their
// own; the control rounds by itself (M112, M124) within what is its own in both programs.
constexpr ModeSet kNoModeOfKlartext =
    mode::kDistance + mode::kPath + mode::kPolar + mode::kPolarInterpolation + mode::kCylindrical +
    mode::kControlSmoothing + mode::kSurfaceSpeed + mode::kLatheDiameter;

void start_klartext(ControlState& state) { state.modal.arc_distance = DistanceMode::kAbsolute; }

void forget_klartext(ControlState& state) {
  const Units units = state.modal.units;
  state.lacks = kNoModeOfKlartext;
  forget_everything(state);
  state.modal.units = units;
  start_klartext(state);
  state.klartext.scaled_by_axis = true;
}

std::string_view klartext_statement_text(const Program& program, std::uint32_t first) {
  std::uint32_t last = first;
  while (last + 1 < program.blocks.size() &&
         program.blocks[last + 1].opacity == ParseStatus::kContinued) {
    ++last;
  }
  return program.source.text({program.blocks[first].span.begin, program.blocks[last].span.end});
}

std::string_view apply_klartext(std::string_view statement, ControlState& state) {
  LineCursor lines(statement);
  const auto first = lines.next();
  if (!first) return reason::kNotUnderstood;
  const SourceSpan span = klartext_parts(statement, {first->begin, first->text_end}).content;
  const std::string_view content = statement.substr(span.begin, span.size());
  const KlartextKind kind = klartext_kind(content);
  switch (kind) {
    case KlartextKind::kNothing:
    case KlartextKind::kEnd:
      return reason::kProgramMark;
    case KlartextKind::kBegin:
      apply_begin(content, state);
      return reason::kProgramMark;
    case KlartextKind::kAssignment:
      return reason::kAssignment;
    case KlartextKind::kDefinition:
      return reason::kForeignWords;
    case KlartextKind::kStop:
      forget_position(state);  // M6 may stand there
      return reason::kProgramEnd;
    case KlartextKind::kToolCall:
      apply_tool_call(content, state);
      return reason::kToolChange;
    case KlartextKind::kCycleDef:
      return CycleEffect(content, state).apply();
    case KlartextKind::kCycleCall:
      forget_position(state);
      state.modal.feed.reset();
      apply_words(content, state);
      return reason::kCannedCycle;
    case KlartextKind::kProbe:
      forget_klartext(state);
      return reason::kProbe;
    case KlartextKind::kPlane:
      return apply_plane(content, state);
    case KlartextKind::kFunctionTcpm:
      return apply_tcpm(content, state);
    case KlartextKind::kJump:
    case KlartextKind::kLabel:
    case KlartextKind::kCallLabel:
    case KlartextKind::kCallProgram:
      return apply_flow(kind, content, state);
    case KlartextKind::kUnknown:
      forget_klartext(state);
      return reason::kNotUnderstood;
    case KlartextKind::kCentre:
      return reason::kArc;
    case KlartextKind::kFunctions:
      if (const auto own = own_functions(content, state)) {
        apply_own(*own, state);
        return reason::kOwnWord;
      }
      forget_position(state);
      apply_words(content, state);
      return reason::kMiscFunction;
    default:
      return apply_path(kind, content, statement, state);
  }
}

}  // namespace batten::gcode
