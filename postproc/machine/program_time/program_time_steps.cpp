#include "postproc/machine/program_time/program_time_steps.h"

#include <algorithm>
#include <array>
#include <optional>
#include <utility>

#include "gcode/state/modal_state.h"
#include "gcode/state/reason.h"
#include "postproc/machine/program_time/program_time_blocks.h"

namespace batten::postproc {
namespace {

namespace reason = gcode::reason;

struct NotTimedText {
  std::string_view id;
  std::string_view text;
};

constexpr std::array kTexts = {
    NotTimedText{
        not_timed::kPlaceUnknown,
        "the tool's position before the move is not known: the axes without one take no time"},
    NotTimedText{not_timed::kPlaceAssumed,
                 "after a tool change or an offset: timed from the last programmed position"},
    NotTimedText{reason::kFeedUnknown, "no feed is known: timed as fast as the machine cuts"},
    NotTimedText{not_timed::kSpindleUnknown,
                 "feed per revolution without a known spindle speed: timed as fast as the machine "
                 "cuts"},
    NotTimedText{not_timed::kRotaryAxis, "A, B, C, U, V or W move too: only X, Y and Z are timed"},
    NotTimedText{not_timed::kPathChanged,
                 "cutter compensation, scaling, rotation or the like is on: timed as programmed"},
    NotTimedText{reason::kLoopBody, "in a loop or subprogram: timed once"},
    NotTimedText{not_timed::kDwellUnknown, "a dwell whose length is not known: not timed"},
    NotTimedText{not_timed::kDwellAssumed,
                 "G4 P without a decimal point: taken for milliseconds (--target decides)"},
    NotTimedText{not_timed::kReferenceMove,
                 "G28, G30, G53: the path to a machine position is not timed"},
    NotTimedText{not_timed::kOperatorStop, "M0, M1, M60: waits for the operator, not timed"},
    NotTimedText{reason::kMiscFunction,
                 "M functions of the machine's builder or the user: not timed"},
    NotTimedText{reason::kCannedCycle, "canned cycles that are not followed: not timed"},
    NotTimedText{reason::kSpline,
                 "splines (G5, G6.2 ..) that are not read, also where no -t "
                 "says whose they are: not timed"},
    NotTimedText{reason::kProbe, "probing moves: not timed"},
    NotTimedText{reason::kThreading, "threading and tapping moves: not timed"},
    NotTimedText{reason::kSubprogram, "calls of subprograms and macros: not timed"},
    NotTimedText{reason::kProgramFlow, "jumps, loops and calls: not followed"},
    NotTimedText{reason::kExpression, "words with parameters or expressions: not timed"},
    NotTimedText{reason::kBlockDelete, "blocks with / : not timed"},
    NotTimedText{reason::kStateUnknown,
                 "moves in a state that is not known (after a call or an unknown word): not timed"},
    NotTimedText{reason::kPositionUnknown, "arcs from a position that is not known: not timed"},
    NotTimedText{reason::kArc, "arcs that are not understood: not timed"},
    NotTimedText{not_timed::kAfterEnd, "blocks after the end of the program (M2, M30): not timed"},
};

std::string_view text_of(std::string_view id) {
  for (const NotTimedText& known : kTexts) {
    if (known.id == id) return known.text;
  }
  for (const auto& known : reason::explanations()) {
    if (known.id == id) return known.text;
  }
  return "not understood: not timed";
}

using gcode::BlockKind;
using gcode::BlockWords;
using gcode::Code;
using gcode::CodeAct;
using gcode::CodeGroup;
using gcode::ModalState;
using gcode::PathMode;
using gcode::TriState;

// The control bends or shifts the programmed path.
bool is_path_changed(const ModalState& s) {
  return std::ranges::any_of(gcode::kModalSwitches, [&s](const gcode::ModalSwitch& each) {
    return each.moves_path && s.*each.item == TriState::kOn;
  });
}

}  // namespace

bool has_m6(const gcode::Program& program) {
  return std::ranges::any_of(program.words, [](const gcode::Word& w) {
    return w.letter == 'M' && w.is_number && w.value == 6;
  });
}

void NotTimedList::add(std::string_view id, std::uint32_t line) {
  const auto known = std::ranges::find(entries_, id, &NotTimed::id);
  if (known == entries_.end()) {
    entries_.push_back({id, text_of(id), 1, line});
  } else {
    ++known->count;
  }
}

namespace {

class StepWork {
 public:
  explicit StepWork(const StepOptions& options) : options_(options), has_m6_(options.has_m6) {
    read_.controls.emplace_back(PathMode::kUnknown);
    if (options.start) place_.set(*options.start);
  }

  ProgramSteps& read(const gcode::Program& part, const gcode::Interpretation& meaning,
                     std::size_t first_block, std::size_t end_block) {
    program_ = &part;
    meaning_ = &meaning;
    read_.steps.clear();
    read_.steps.reserve(end_block - first_block);
    if (first_block == end_block) return read_;
    sent_ = part.blocks[first_block].span.begin;
    for (index_ = first_block; index_ < end_block && !ended_; ++index_) read_block();
    if (ended_) note_what_follows(end_block);
    unsent_ += part.blocks[end_block - 1].end - sent_;
    return read_;
  }

 private:
  [[nodiscard]] const gcode::Block& block() const { return program_->blocks[index_]; }
  [[nodiscard]] const gcode::BlockMeaning& block_meaning() const {
    return meaning_->blocks[index_];
  }
  [[nodiscard]] const ModalState& state() const {
    return meaning_->states[block_meaning().state_after];
  }
  [[nodiscard]] const gcode::Motion& motion() const {
    return meaning_->motions[static_cast<std::size_t>(block_meaning().motion)];
  }
  void note(std::string_view id) { read_.not_timed.add(id, block().line); }

  void read_block() {
    const gcode::BlockMeaning& m = block_meaning();
    if (m.of_curve) return add_curve_piece();
    switch (m.kind) {
      case BlockKind::kEmpty:
        return;
      case BlockKind::kMotion:
        return add_plain_motion(BlockWords(program_->words_of(block())));
      case BlockKind::kSettings:
      case BlockKind::kMotionAndMore:
        return read_words(BlockWords(program_->words_of(block())));
      case BlockKind::kOpaque:
        return read_opaque();
    }
  }

  // --- blocks that are not understood -------------------------------------------------------

  void read_opaque() {
    const gcode::BlockMeaning& m = block_meaning();
    if (m.barrier == reason::kProgramMark || m.barrier == reason::kAssignment) return;
    const BlockWords words(program_->words_of(block()));
    const bool exact_stop = m.barrier == reason::kExactStop && words.has_g(90) && is_line_mode();
    if (exact_stop && words.all_numbers() && words.has_any("XYZ")) {
      read_words(words);
      add_placed(line_of_words(words, state(), place_), words);
      read_.steps.back().stops_after = true;
      return;
    }
    if (words.has_words() || block().opacity != gcode::ParseStatus::kNone) note(m.barrier);
    forget_named(words);
    if (state().motion == gcode::MotionMode::kUnknown) place_.forget();
    cycle_.reset();
    add_rest();
  }

  void forget_named(const BlockWords& words) {
    for (std::size_t axis = 0; axis < 3; ++axis) {
      if (words.has("XYZ"[axis])) place_.forget_axis(axis);
    }
  }

  [[nodiscard]] bool is_line_mode() const {
    return state().motion == gcode::MotionMode::kRapid ||
           state().motion == gcode::MotionMode::kLine;
  }

  // --- words --------------------------------------------------------------------------------

  void read_words(const BlockWords& words) {
    if (const gcode::Word* t = words.find('T'); t != nullptr && t->is_number) {
      selected_ = static_cast<std::int32_t>(t->value);
      if (!changes_by_m6()) change_tool(selected_);
    }
    for (const Code code : words.m_codes()) read_m(code);
    if (words.has('S') && !words.has_m(30) && !words.has_m(40)) add_rest();
    for (const Code code : words.g_codes()) read_g(code, words);
    if (block_meaning().motion >= 0) {
      add_motion(words);
    } else if (state().motion == gcode::MotionMode::kOther) {
      read_other_motion(words);
    } else {
      cycle_.reset();
      add_rotary(words);
    }
    for (const Code code : words.m_codes()) read_late_m(code);
  }

  // A lathe's T changes the tool at once; where a program says M6, T only gets it ready.
  bool changes_by_m6() {
    if (!has_m6_) has_m6_ = has_m6(*program_);
    return *has_m6_;
  }

  void change_tool(std::int32_t tool) {
    tool_ = tool;
    add_wait(StepKind::kToolChange, 0);
    place_.doubt();
  }

  void read_m(Code code) {
    switch (gcode::row_of_m(code).act) {
      case CodeAct::kSpindleOn:
        return add_wait(StepKind::kSpindle, 0);
      case CodeAct::kChangesTool:
        return change_tool(selected_);
      case CodeAct::kStops:  // at the end of the block
      case CodeAct::kEnds:
      case CodeAct::kOverride:
      case CodeAct::kCalls:  // said with their own reason
        return;
      case CodeAct::kSwitches:
        return add_rest();
      default:
        note(reason::kMiscFunction);
        return add_rest();
    }
  }

  void read_late_m(Code code) {
    switch (gcode::row_of_m(code).act) {
      case CodeAct::kStops:
        note(not_timed::kOperatorStop);
        return add_rest();
      case CodeAct::kEnds:
        ended_ = true;
        return;
      case CodeAct::kCalls:
        note(reason::kSubprogram);
        place_.forget();
        return add_rest();
      default:
        return;
    }
  }

  void read_g(Code code, const BlockWords& words) {
    const gcode::CodeRow& row = gcode::row_of_g(code);
    switch (row.group) {
      case CodeGroup::kPath:
        return set_control(row.value.as<PathMode>(), words);
      case CodeGroup::kToolLength:
        return change_tool_length(row);
      case CodeGroup::kWorkOffset:
        return change_work_offset(code);
      case CodeGroup::kCycleReturn:
        returns_to_initial_ = row.value.as<TriState>() == TriState::kOn;
        return;
      case CodeGroup::kCycleEnd:
        return cycle_.reset();
      default:
        return read_act(row.act, words);
    }
  }

  void read_act(CodeAct act, const BlockWords& words) {
    switch (act) {
      case CodeAct::kDwell:
        return add_dwell(words);
      case CodeAct::kHome:
      case CodeAct::kMachinePlace:
        return leave_for_reference(words);
      case CodeAct::kSetsPlace:
        return set_coordinates(words);
      case CodeAct::kWritesData:
      case CodeAct::kMovesOrigin:
        place_.forget();
        return add_rest();
      case CodeAct::kCalls:
        note(reason::kSubprogram);
        place_.forget();
        return;
      default:
        return;
    }
  }

  void change_tool_length(const gcode::CodeRow& row) {
    const bool on = row.value.as<TriState>() != TriState::kOff;
    if (std::exchange(has_tool_offset_, on) || on) place_.doubt();
    add_rest();
  }

  void change_work_offset(Code code) {
    // The first one says in which coordinates the program is meant.
    if (work_offset_ != 0 && work_offset_ != code) place_.forget();
    work_offset_ = code;
    add_rest();
  }

  void leave_for_reference(const BlockWords& words) {
    note(not_timed::kReferenceMove);
    add_rest();
    words.has_any("XYZ") ? forget_named(words) : place_.forget();
  }

  void set_coordinates(const BlockWords& words) {
    const PlacedMotion here = line_of_words(words, absolute(state()), place_);
    for (std::size_t axis = 0; axis < 3; ++axis) {
      if (!words.has("XYZ"[axis])) continue;
      place_.set_axis(axis, geometry::end_point(here.piece)[static_cast<Eigen::Index>(axis)],
                      Certainty::kKnown);
    }
    add_rest();
  }

  static ModalState absolute(ModalState state) {
    state.distance = gcode::DistanceMode::kAbsolute;
    return state;
  }

  void set_control(PathMode mode, const BlockWords& words) {
    const gcode::PathControl control = gcode::path_control_of(mode, words, state().units);
    const auto known = std::ranges::find(read_.controls, control);
    control_ = static_cast<std::uint16_t>(known - read_.controls.begin());
    if (known == read_.controls.end()) read_.controls.push_back(control);
  }

  // --- steps --------------------------------------------------------------------------------

  ProgramStep& add_step(StepKind kind) {
    ProgramStep& step = read_.steps.emplace_back();
    step.kind = kind;
    step.control = control_;
    step.tool = tool_;
    step.line = block().line;
    step.bytes = unsent_ + block().end - sent_;
    unsent_ = 0;
    sent_ = block().end;
    is_moving_ = kind == StepKind::kCut || kind == StepKind::kRapid;
    return step;
  }

  void add_wait(StepKind kind, double seconds) { add_step(kind).seconds = seconds; }

  void add_rest() {
    if (is_moving_) add_step(StepKind::kRest);
  }

  void add_dwell(const BlockWords& words) {
    const DwellTime dwell = dwell_of(words, options_.dwell_unit, state().spindle_speed);
    if (!dwell.seconds) note(not_timed::kDwellUnknown);
    if (dwell.unit_assumed) note(not_timed::kDwellAssumed);
    add_wait(StepKind::kDwell, dwell.seconds.value_or(0));
  }

  // A rotary axis alone: in G93 the program says how long it turns.
  void add_rotary(const BlockWords& words) {
    if (!words.has_any("ABC") || words.has_any("XYZ")) return;
    const auto feed = state().feed;
    if (state().feed_mode == gcode::FeedMode::kInverseTime && feed && *feed > 0) {
      return add_wait(StepKind::kRotary, 60 / (*feed * options_.feed_override));
    }
    note(not_timed::kRotaryAxis);
  }

  void add_plain_motion(const BlockWords& words) {
    add_motion(words);
    read_.steps.back().says_speed = words.has('S');
  }

  void add_motion(const BlockWords& words) {
    cycle_.reset();
    add_placed(place_motion(motion(), words, state(), place_), words);
  }

  void add_placed(const PlacedMotion& placed, const BlockWords& words) {
    const bool rapid = state().motion == gcode::MotionMode::kRapid;
    if (placed.start == Certainty::kUnknown) note(not_timed::kPlaceUnknown);
    if (placed.start == Certainty::kAssumed) note(not_timed::kPlaceAssumed);
    if (words.has_any("ABCUVW")) note(not_timed::kRotaryAxis);
    if (is_path_changed(state())) note(not_timed::kPathChanged);
    if (block_meaning().barrier == reason::kLoopBody) note(reason::kLoopBody);
    ProgramStep& step = add_step(rapid ? StepKind::kRapid : StepKind::kCut);
    step.piece = placed.piece;
    step.feed = rapid ? last_feed() : feed_along(placed.piece);
    move_to_end(place_, placed, words, state());
  }

  // Of a curve that was read exactly: the place before it is known.
  void add_curve_piece() {
    cycle_.reset();
    for (const gcode::Motion& motion : gcode::motions_of(*meaning_, index_)) {
      ProgramStep& step = add_step(StepKind::kCut);
      step.piece = motion.piece;
      step.feed = feed_along(step.piece);
      step.goes_on = &motion != &this->motion();
      step.arcs = motion.arcs;
      const geometry::Point3& end = motion.piece.end();
      for (std::size_t axis = 0; axis < 3; ++axis) {
        if (!motion.axes_named[axis]) continue;
        place_.set_axis(axis, end[static_cast<Eigen::Index>(axis)], Certainty::kKnown);
      }
    }
  }

  // mm/min, at which a control without rapids runs them; 0: not known.
  [[nodiscard]] double last_feed() const {
    const bool is_known = state().feed_mode == gcode::FeedMode::kPerMinute;
    return is_known ? options_.feed_override * state().feed.value_or(0) : 0;
  }

  // mm/min; 0 where it is not known.
  double feed_along(const geometry::PathPiece& piece) {
    return options_.feed_override * programmed_feed(piece);
  }

  double programmed_feed(const geometry::PathPiece& piece) {
    const ModalState& s = state();
    if (!s.feed || !(*s.feed > 0)) {
      note(reason::kFeedUnknown);
      return 0;
    }
    switch (s.feed_mode) {
      case gcode::FeedMode::kInverseTime:
        return *s.feed * geometry::length_of(piece);
      case gcode::FeedMode::kPerRevolution:
        if (s.spindle_speed && s.constant_surface_speed == TriState::kOff) {
          return *s.feed * *s.spindle_speed;
        }
        note(not_timed::kSpindleUnknown);
        return 0;
      case gcode::FeedMode::kPerMinute:
        return *s.feed;
      case gcode::FeedMode::kUnknown:
        break;
    }
    note(reason::kFeedUnknown);
    return 0;
  }

  // --- motions that are no line and no arc ----------------------------------------------------

  void read_other_motion(const BlockWords& words) {
    for (const Code code : words.g_codes()) {
      const gcode::CodeRow& row = gcode::row_of_g(code);
      if (row.act != CodeAct::kDrills) continue;
      if (cycle_) {
        cycle_->change(row);
      } else {
        cycle_.emplace(row, place_.mm().z());
      }
    }
    // Axis words may belong to a word of their own block and not to the modal motion.
    if (words.has_trait(gcode::trait::kTakesAxes)) return;
    if (cycle_ && !words.has_group(CodeGroup::kCycleEnd)) return drill(words);
    if (!words.has_any("XYZ")) return add_rotary(words);
    note(block_meaning().barrier.empty() ? reason::kCannedCycle : block_meaning().barrier.id());
    forget_named(words);
    add_rest();
  }

  void drill(const BlockWords& words) {
    const bool starts = std::ranges::any_of(
        words.g_codes(), [](Code code) { return gcode::row_of_g(code).act == CodeAct::kDrills; });
    std::optional<double> dwell;
    if (words.has('P')) {
      const DwellTime time = dwell_of(words, options_.dwell_unit, std::nullopt);
      dwell = time.seconds;
      if (time.unit_assumed) note(not_timed::kDwellAssumed);
    }
    cycle_->read(words, state(), dwell);
    cycle_->set_return_to_initial(returns_to_initial_);
    if (!starts && !words.has_any("XYZ")) return;
    const bool plane_xy = state().plane == gcode::Plane::kXY;
    const auto moves = plane_xy && place_.is_known() && words.all_numbers()
                           ? cycle_->moves(words, state(), place_.mm())
                           : std::nullopt;
    if (!moves) {
      note(reason::kCannedCycle);
      place_.forget();
      return add_rest();
    }
    if (is_path_changed(state())) note(not_timed::kPathChanged);
    if (block_meaning().barrier == reason::kLoopBody) note(reason::kLoopBody);
    for (const CycleMove& move : *moves) add_cycle_move(move);
  }

  void add_cycle_move(const CycleMove& move) {
    if (move.kind == StepKind::kDwell || move.kind == StepKind::kSpindle) {
      return add_wait(move.kind, move.seconds);
    }
    ProgramStep& step = add_step(move.kind);
    step.piece = move.line;
    step.stops_after = true;  // cycles end each of their moves in position
    if (move.kind == StepKind::kCut) step.feed = feed_along(move.line);
    place_.set(move.line.end);
  }

  void note_what_follows(std::size_t end_block) {
    for (; index_ < end_block; ++index_) {
      if (BlockWords(program_->words_of(block())).has_any("XYZ")) note(not_timed::kAfterEnd);
    }
  }

  const gcode::Program* program_ = nullptr;  // the part that is being read
  const gcode::Interpretation* meaning_ = nullptr;
  StepOptions options_;
  ProgramSteps read_;
  std::uint32_t sent_ = 0;    // where the bytes end that a step has counted
  std::uint32_t unsent_ = 0;  // bytes of the parts before that no step has counted
  bool is_moving_ = false;    // the last step is a motion
  std::size_t index_ = 0;     // of the block that is being read
  ToolPlace place_;
  std::int32_t tool_ = ProgramStep::kNoTool;
  std::int32_t selected_ = ProgramStep::kNoTool;
  std::uint16_t control_ = 0;
  Code work_offset_ = 0;
  bool has_tool_offset_ = false;
  bool returns_to_initial_ = true;
  bool ended_ = false;
  std::optional<bool> has_m6_;
  std::optional<DrillingCycle> cycle_;
};

}  // namespace

StepReader step_reader(const StepOptions& options) {
  return [work = StepWork(options)](const auto&... part) mutable -> const ProgramSteps& {
    return work.read(part...);
  };
}

ProgramSteps read_steps(const gcode::Program& program, const gcode::Interpretation& meaning,
                        const StepOptions& options) {
  return std::move(StepWork(options).read(program, meaning, 0, program.blocks.size()));
}

}  // namespace batten::postproc
