#include "gcode/interpreter/word_applier.h"

#include <algorithm>

#include "gcode/interpreter/program_flow.h"
#include "gcode/state/path_control.h"
#include "gcode/text/characters.h"

namespace batten::gcode {
namespace {

// One block's words at work on the control.
class WordApplier {
 public:
  WordApplier(const BlockWords& words, ControlState& state)
      : words_(words), state_(state), units_before_(state.modal.units) {}

  StateEffect apply() {
    for (const Code code : words_.g_codes()) apply_g(code);
    if (effect_.unknown_code != kNoCode) forget_everything(state_);
    apply_feed();
    apply_spindle_speed();
    apply_tool_words();
    for (const Code code : words_.m_codes()) apply_m(code);
    if (words_.has('E') && !effect_.takes_parameters) block(reason::kExtruder);
    if (words_.has_any("ABCUVW") && !effect_.takes_axes) block(reason::kOtherAxis);
    return effect_;
  }

 private:
  ModalState& modal() { return state_.modal; }

  void block(std::string_view why) {
    if (effect_.barrier.empty()) effect_.barrier = why;
  }

  // A word that acts, whatever the state was.
  void acts(std::string_view why) {
    block(why);
    effect_.takes_parameters = true;
  }

  // Sets the item of the word's group. Only a word that repeats an earlier word changes nothing.
  template <typename Item>
  void set(const CodeRow& row, Item& item) {
    const Item value = row.value.as<Item>();
    if (item != value || !state_.is_set(row.group)) block(row.why);
    item = value;
    state_.mark_set(row.group);
  }

  // Switches a transformation of the coordinates. When it changes, the position of the tool has
  // other coordinates than before.
  void set_frame(const CodeRow& row, TriState& item) {
    const bool on = is_on(row);
    if (item != row.value.as<TriState>() || on) forget_position(state_);
    set(row, item);
    if (on) acts(row.why);
  }

  static bool is_on(const CodeRow& row) { return row.value.as<TriState>() == TriState::kOn; }
  static bool is_off(const CodeRow& row) { return row.value.as<TriState>() == TriState::kOff; }

  // What the row says of any word.
  void apply_traits(const CodeRow& row) {
    if (row.is(trait::kEndsRun)) block(row.why);
    if (row.is(trait::kTakesAxes)) effect_.takes_axes = true;
    if (row.is(trait::kTakesParameters)) effect_.takes_parameters = true;
    if (row.is(trait::kNotUnderstood)) effect_.understood = false;
    if (row.is(trait::kLosesPlace)) forget_position(state_);
    if (row.is(trait::kLosesNamed)) forget_named_axes(state_, words_);
  }

  // A word that the user vouches for: what it keeps is said when the block is over. Axis words
  // beside an M word are a motion, or belong to the macro that it calls.
  void take_own(std::string_view why, bool takes_axes) {
    acts(why);
    effect_.takes_axes |= takes_axes;
    effect_.understood = false;
  }

  void apply_g(Code code) {
    const CodeRow& row = row_of_g(code);
    if (may_be_own_g(row) && own_word(state_, 'G', code, words_) != nullptr) {
      return take_own(row.act == CodeAct::kCalls ? row.why : reason::kOwnWord, true);
    }
    apply_traits(row);
    switch (row.group) {
      case CodeGroup::kUnknown:
        effect_.unknown_code = code;
        return;
      case CodeGroup::kAxisUser:
        return apply_axis_user(row);
      case CodeGroup::kMotion:
        return apply_motion_word(row);
      case CodeGroup::kCycleEnd:
        return apply_cycle_end();
      case CodeGroup::kPlane:
        return set(row, modal().plane);
      case CodeGroup::kDistance:
        set(row, modal().distance);
        if (state_.centers_follow_distance) modal().arc_distance = modal().distance;
        return;
      case CodeGroup::kArcDistance:
        return set(row, modal().arc_distance);
      case CodeGroup::kFeedMode:
        // The number before had another meaning; and LinuxCNC forgets it at each of these words,
        // also where the mode was set already.
        modal().feed.reset();
        return set(row, modal().feed_mode);
      case CodeGroup::kUnits:
        return apply_units(row);
      case CodeGroup::kCutter:
        // After it the tool is beside the programmed position.
        if (is_off(row) && modal().cutter_compensation != TriState::kOff) forget_position(state_);
        return set(row, modal().cutter_compensation);
      case CodeGroup::kToolLength:
        // Offsets lie along Z on mills, along X and Z on lathes, along any axis on LinuxCNC.
        if (row.value.as<TriState>() != TriState::kUnknown) {
          modal().tool_center_point = row.value.as<TriState>();
        }
        return;
      case CodeGroup::kCycleReturn:
        return apply_cycle_return(row);
      case CodeGroup::kWorkOffset:
        return apply_work_offset(row);
      case CodeGroup::kPath:
        set(row, modal().path.mode);
        modal().path = path_control_of(modal().path.mode, words_, modal().units);
        return;
      case CodeGroup::kSpindleMode:
        return set(row, modal().constant_surface_speed);
      case CodeGroup::kDiameter:
        return apply_diameter(row);
      case CodeGroup::kScaling:
        return apply_scaling(row);
      case CodeGroup::kRotation:
        return apply_rotation(row);
      case CodeGroup::kMirror:
        return set_frame(row, modal().mirror);
      case CodeGroup::kPolar:
        return set_frame(row, modal().polar);
      case CodeGroup::kPolarInterpolation:
        return set_frame(row, modal().polar_interpolation);
      case CodeGroup::kCylindrical:
        return apply_cylindrical(row);
      case CodeGroup::kSmoothing:
        return apply_smoothing(row);
      case CodeGroup::kModalMacro:
        // On: apply_late_words forgets everything.
        if (is_off(row)) modal().modal_macro = TriState::kOff;
        return;
      case CodeGroup::kNone:
        // Alone it ends offsets, where it does anything.
        if (row.act == CodeAct::kMachinePlace && !words_.has_any("XYZABCUVW")) {
          forget_position(state_);
          state_.work_offset = 0;
        }
        return;
      case CodeGroup::kStop:
      case CodeGroup::kTurning:
        return;
    }
  }

  void apply_feed() {
    const Word* f = words_.find('F');
    if (f == nullptr) return;
    const std::optional<double> before = modal().feed;
    // A run has one way of writing feeds.
    if (before && modal().feed_without_point != f->without_point) block(reason::kStateChange);
    modal().feed = feed_of(*f);
    modal().feed_without_point = f->without_point;
    effect_.feed_changed = before != modal().feed || !modal().feed;
  }

  std::optional<double> feed_of(const Word& f) const {
    const ModalState& now = state_.modal;
    // F of a dwell or a thread is no feed. Beside a word that changes the units, LinuxCNC takes F
    // in the units before it, grbl in those after it.
    const bool known = f.is_number && f.value > 0 && now.feed_mode != FeedMode::kUnknown &&
                       now.units == units_before_ && !words_.has_trait(trait::kOwnFeed);
    if (!known) return std::nullopt;
    const bool inches = now.units == Units::kInch && now.feed_mode != FeedMode::kInverseTime;
    return inches ? f.value * kMillimetresPerInch : f.value;
  }

  void apply_spindle_speed() {
    const Word* s = words_.find('S');
    if (s == nullptr) return;
    // S of a dwell or of a speed limit is not the speed.
    const bool is_speed = s->is_number && !words_.has_trait(trait::kOwnSpeed);
    const std::optional<double> speed = is_speed ? std::optional(s->value) : std::nullopt;
    if (!speed || modal().spindle_speed != speed) block(reason::kSpindle);
    modal().spindle_speed = speed;
  }

  // T changes the tool and its offsets at once on lathes; H and D may name other offsets.
  void apply_tool_words() {
    const bool tool = words_.has('T');
    if (tool || (words_.has('H') && !effect_.takes_parameters)) forget_position(state_);
    if (tool || (words_.has_any("HD") && !effect_.takes_parameters)) block(reason::kToolChange);
  }

  void apply_m(Code code) {
    const CodeRow& row = row_of_m(code);
    if (own_word(state_, 'M', code, words_) != nullptr) {
      return take_own(row.act == CodeAct::kCalls ? row.why : reason::kOwnWord, false);
    }
    apply_traits(row);
    const bool may_mirror = (state_.lacks & mode::kMirror) == 0;
    if (row.act == CodeAct::kMirrors && may_mirror) modal().mirror = row.value.as<TriState>();
    if (row.act == CodeAct::kTurnsToolTip) modal().tool_center_point = row.value.as<TriState>();
  }

  // --- words that move the origin, bend the coordinates, or act in their own block only --------

  void apply_axis_user(const CodeRow& row) {
    switch (row.act) {
      case CodeAct::kHome:
        // All axes when none is named. Named ones pass through an intermediate place.
        if (words_.has_any("XYZUVW")) return forget_named_axes(state_, words_);
        return words_.has_any("ABC") ? void() : forget_position(state_);
      case CodeAct::kStoresHome:
        // Nothing moves by itself. Axis words beside it are a motion on LinuxCNC, in its mode,
        // cycles too; of other controls nothing is known.
        return words_.has_any("XYZABCUVWIJKR") ? forget_position(state_) : void();
      case CodeAct::kSetsPlace:
        // With S alone it limits the spindle on lathes; with F it is a thread.
        if (!words_.has_any("FIKPQR")) return;
        forget_position(state_);
        modal().motion = MotionMode::kUnknown;
        return;
      case CodeAct::kWritesData:
        state_.work_offset = 0;
        modal().motion = MotionMode::kUnknown;
        return;
      default:
        state_.work_offset = 0;  // on some controls these are offsets beside G54
        return;
    }
  }

  // G51 scales. G50 ends that on mills; on lathes it limits the spindle (S) or sets coordinates.
  void apply_scaling(const CodeRow& row) {
    if (is_off(row) && words_.has_any("XYZUVWS")) {
      acts(reason::kCoordinateChange);
      return forget_named_axes(state_, words_);
    }
    set_frame(row, modal().scaling);
  }

  void apply_rotation(const CodeRow& row) {
    if (row.is(trait::kTilts)) return set_frame(row, modal().tilted_plane);
    if (row.value.as<TriState>() == TriState::kUnknown) {
      if (!words_.has_any("XYZP")) return;
      effect_.takes_axes = true;
      return set_frame(row, modal().rotation);
    }
    if (is_off(row)) {
      CodeRow tilting = row;
      tilting.why = reason::kTiltedPlane;
      set_frame(tilting, modal().tilted_plane);
    }
    set_frame(row, modal().rotation);
  }

  // G7.1 C<radius>: on; a radius of zero ends it.
  void apply_cylindrical(const CodeRow& row) {
    bool ends = false;
    for (const char letter : {'A', 'B', 'C'}) {
      const Word* word = words_.find(letter);
      ends |= word != nullptr && word->is_number && word->value == 0;
    }
    CodeRow turned = row;
    turned.value = ends ? TriState::kOff : TriState::kOn;
    set_frame(turned, modal().cylindrical);
  }

  // G5.1 Q0, Q1: look-ahead only. Q2, Q3: the control fits a curve. With I, J: a spline.
  void apply_smoothing(const CodeRow& row) {
    constexpr Code kHighSpeed = 51;
    constexpr Code kSpline = 50;
    if (row.code == kHighSpeed && words_.has_any("IJ")) {
      effect_.motion = &row_of_g(kSpline);
      return;
    }
    acts(row.why);
    effect_.takes_axes = true;  // X0 Y0 Z0 say which axes
    const Word* q = words_.find('Q');
    modal().control_smoothing = row.code != kHighSpeed          ? row.value.as<TriState>()
                                : q == nullptr || !q->is_number ? TriState::kUnknown
                                : q->value <= 1                 ? TriState::kOff
                                                                : TriState::kOn;
  }

  // --- words that say how motions are read ------------------------------------------------------

  void apply_motion_word(const CodeRow& row) {
    constexpr Code kHighSpeed = 50;
    const Word* p = words_.find('P');
    if (row.code != kHighSpeed || p == nullptr || words_.has_any("XYZIJ")) {
      effect_.motion = &row;
      return;
    }
    // G5 P10000, G5 P0.
    modal().control_smoothing = !p->is_number   ? TriState::kUnknown
                                : p->value == 0 ? TriState::kOff
                                                : TriState::kOn;
    acts(reason::kControlSmoothing);
  }

  void apply_cycle_end() {
    for (const Code code : words_.g_codes()) {
      if (row_of_g(code).is_plain_motion()) return;  // the motion word wins
    }
    // RS-274: no motion mode any more. FANUC: the G0 or G1 before the cycle. So: not known.
    modal().motion = MotionMode::kOther;
    state_.other_motion = reason::kCannedCycle;
  }

  void apply_units(const CodeRow& row) {
    if (is_lathe_cycle(row.code, words_)) {
      acts(reason::kCannedCycle);
      effect_.takes_axes = true;
      return forget_position(state_);
    }
    Units units = modal().units;
    set(row, units);
    set_units(state_, units);
    effect_.unit_word = true;
  }

  // Mills: where cycles retract to. Lathes of one kind: feed per minute and per revolution.
  void apply_cycle_return(const CodeRow& row) {
    const bool of_a_cycle =
        modal().motion == MotionMode::kOther || std::ranges::any_of(words_.g_codes(), is_cycle);
    if (is_on(row)) {  // G98
      if (modal().feed_mode != FeedMode::kUnknown) return;
      modal().feed_mode = FeedMode::kPerMinute;
    } else {
      if (of_a_cycle || words_.has_group(CodeGroup::kFeedMode)) return;
      modal().feed_mode = FeedMode::kUnknown;
    }
    modal().feed.reset();
  }

  void apply_work_offset(const CodeRow& row) {
    const bool extended = row.is(trait::kExtended) || words_.has('P');
    if (extended || state_.work_offset != row.code) forget_position(state_);
    state_.work_offset = extended ? 0 : row.code;
  }

  // G7: X is a diameter. G8 ends it; G8 P1 is look-ahead on FANUC.
  void apply_diameter(const CodeRow& row) {
    if (is_off(row) && words_.has('P')) return acts(row.why);
    if (modal().lathe_diameter != row.value.as<TriState>()) forget_axis(state_, 0);
    set(row, modal().lathe_diameter);
  }

  const BlockWords& words_;
  ControlState& state_;
  Units units_before_;
  StateEffect effect_;
};

// Parameter assignments of LinuxCNC and macro B change no modal state, but high numbers are
// windows into the control: FANUC's tool offsets begin at #2000, work offsets lie above #5000.
bool assigns_only_variables(std::string_view text) {
  constexpr int kFirstSystemVariable = 2000;
  for (std::size_t at = text.find('#'); at != std::string_view::npos; at = text.find('#', at + 1)) {
    int number = -1;
    std::size_t digit = at + 1;
    for (; digit < text.size() && (is_digit(text[digit]) || is_blank(text[digit])); ++digit) {
      if (is_blank(text[digit])) continue;  // they mean nothing within a number
      number = std::max(number, 0) * 10 + (text[digit] - '0');
      if (number >= kFirstSystemVariable) return false;
    }
    const bool named = digit < text.size() && text[digit] == '<';
    if (number < 0 && !named) return false;
  }
  return true;
}

void apply_assignment(std::string_view text, ControlState& state) {
  if (assigns_only_variables(text)) return;
  forget_position(state);
  state.work_offset = 0;
}

}  // namespace

StateEffect apply_words(const BlockWords& words, ControlState& state) {
  return WordApplier(words, state).apply();
}

void apply_late_own(const OwnWord& own, const BlockWords& words, ControlState& state) {
  apply_own(own.effect, state);
  // Of G65 axis words are arguments for certain.
  constexpr Code kMacro = 650;
  if (!words.has_g(kMacro)) forget_named_axes(state, words);
  if (words.has('F')) state.modal.feed.reset();
  if (words.has('S')) state.modal.spindle_speed.reset();
}

namespace {

// Whether all that the word does is to set an item of the state, to move, or to switch what is none
// of it.
bool sets_one_mode(const Word& word) {
  if (!word.is_number) return false;
  if (word.letter != 'G' && word.letter != 'M') return word.letter != ',';
  const Code code = code_of(word);
  if (code == kNoCode) return false;
  const CodeRow& row = word.letter == 'G' ? row_of_g(code) : row_of_m(code);
  if (row.is(trait::kNotUnderstood | trait::kUnknownBehind | trait::kCallsAtEnd | trait::kOldUnits |
             trait::kExtended)) {
    return false;
  }
  if (word.letter == 'M') {
    return row.act == CodeAct::kSpindleOn || row.act == CodeAct::kSwitches ||
           row.act == CodeAct::kStops || row.act == CodeAct::kChangesTool;
  }
  switch (row.group) {
    case CodeGroup::kMotion:
      return row.is_plain_motion() || row.act == CodeAct::kDrills;
    case CodeGroup::kCycleEnd:
    case CodeGroup::kPlane:
    case CodeGroup::kDistance:
    case CodeGroup::kArcDistance:
    case CodeGroup::kFeedMode:
    case CodeGroup::kUnits:
    case CodeGroup::kCutter:
    case CodeGroup::kWorkOffset:
      return true;
    case CodeGroup::kPath:
      return row.value.as<PathMode>() != PathMode::kUnknown;
    default:
      return false;
  }
}

}  // namespace

std::optional<ControlState> after_some_of(std::span<const Word> words, const ControlState& before) {
  ControlState after = before;
  for (const Word& word : words) {
    const BlockWords alone({&word, 1});
    const bool is_own =
        word.letter == 'G' && own_word(before, 'G', code_of(word), alone) != nullptr;
    if (is_own || !sets_one_mode(word)) return std::nullopt;
    ControlState with_it = before;
    const StateEffect effect = apply_words(alone, with_it);
    if (effect.motion != nullptr) {
      with_it.modal.motion = effect.motion->value.as<MotionMode>();
      with_it.other_motion = effect.motion->why;
    }
    after = either(after, with_it);
    if (alone.has_group(CodeGroup::kUnits)) after.modal.feed.reset();
  }
  forget_position(after);
  return after;
}

void apply_late_words(const BlockWords& words, ControlState& state) {
  bool own_macro = false;
  for (const Code code : words.g_codes()) {
    const CodeRow& row = row_of_g(code);
    if (!may_be_own_g(row)) continue;
    const OwnWord* own = own_word(state, 'G', code, words);
    if (own == nullptr) continue;
    apply_late_own(*own, words, state);
    own_macro |= row.is(trait::kCallsAtEnd);
  }
  for (const Code code : words.m_codes()) {
    const CodeRow& row = row_of_m(code);
    if (const OwnWord* own = own_word(state, 'M', code, words)) {
      apply_late_own(*own, words, state);
      continue;
    }
    if (row.is(trait::kUnknownBehind)) return forget_everything(state);
    if (row.is(trait::kCallsAtEnd)) forget_what_calls_change(state);
    if (row.is(trait::kLosesPlace)) forget_position(state);
  }
  if (words.has('T')) forget_position(state);
  if (words.has_trait(trait::kCallsAtEnd) && !own_macro) forget_what_calls_change(state);
  if (words.has_trait(trait::kUnknownBehind)) {
    forget_everything(state);
    state.modal.modal_macro = TriState::kOn;
  }
}

std::string_view opacity_reason(ParseStatus opacity) {
  switch (opacity) {
    case ParseStatus::kExpression:
      return reason::kExpression;
    case ParseStatus::kCornerWord:
      return reason::kCornerWord;
    case ParseStatus::kAssignment:
      return reason::kAssignment;
    case ParseStatus::kFlow:
      return reason::kProgramFlow;
    case ParseStatus::kForeign:
    case ParseStatus::kContinued:
    case ParseStatus::kNamedWords:
      return reason::kForeignWords;
    case ParseStatus::kProgramMark:
      return reason::kProgramMark;
    default:
      return reason::kNotUnderstood;
  }
}

void apply_opaque(ParseStatus opacity, std::string_view text, ControlState& state) {
  if (opacity == ParseStatus::kProgramMark) return;  // and text that no control reads
  if (opacity == ParseStatus::kAssignment) return apply_assignment(text, state);
  const FlowEffect effect =
      opacity == ParseStatus::kFlow ? flow_effect(text) : FlowEffect::kEverything;
  switch (effect) {
    case FlowEffect::kNothing:
      return;
    case FlowEffect::kAssignment:
      return apply_assignment(text, state);
    case FlowEffect::kCall:
      return forget_what_calls_change(state);
    case FlowEffect::kProgramNumber:
    case FlowEffect::kEverything:
      return forget_everything(state);
  }
}

}  // namespace batten::gcode
