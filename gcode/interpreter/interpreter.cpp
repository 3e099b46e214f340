#include "gcode/interpreter/interpreter.h"

#include <fmt/format.h>

#include <algorithm>
#include <utility>

#include "gcode/curves/curve_format.h"
#include "gcode/interpreter/called_programs.h"
#include "gcode/interpreter/lost_modes.h"
#include "gcode/interpreter/motion_words.h"
#include "gcode/interpreter/plain_text.h"
#include "gcode/interpreter/program_flow.h"
#include "gcode/interpreter/tolerance_words.h"
#include "gcode/interpreter/word_applier.h"
#include "gcode/klartext/flow.h"
#include "gcode/klartext/state.h"
#include "gcode/klartext/statement.h"
#include "gcode/siemens/flow.h"
#include "gcode/siemens/names.h"
#include "gcode/state/block_words.h"
#include "gcode/state/dwell.h"
#include "gcode/state/modal_state.h"
#include "gcode/state/reason.h"
#include "gcode/text/characters.h"
#include "gcode/text/large_pages.h"

namespace batten::gcode {
namespace {

// What is reported of blocks that cannot be followed: at most one diagnostic per block, and not the
// same one a thousand times.
class BlockDiagnostics {
 public:
  // `limiter`: of the whole program, `found`: where the diagnostics go.
  BlockDiagnostics(const Program& program, DiagnosticLimiter& limiter, Diagnostics& found)
      : program_(program), limiter_(limiter), found_(found) {}

  // What follows is about this block.
  void begin_block(std::uint32_t block) {
    block_ = block;
    is_reported_ = false;
  }

  // Its words cannot be taken together. Of expressions nothing is reported.
  void report_words(const BlockWords& words) {
    const auto text = [this](const Word* word) { return program_.source.text(word->span); };
    const std::string_view first = text(words.first());
    switch (words.problem()) {
      case BlockWords::Problem::kNone:
        return;
      case BlockWords::Problem::kSameGroupTwice:
        return report("two-words-of-one-group", words.second()->span,
                      fmt::format("{} and {} in one block; expected one word of their group", first,
                                  text(words.second())));
      case BlockWords::Problem::kLetterTwice:
        return report("word-repeated", words.second()->span,
                      fmt::format("{} and {} in one block; expected one {} word", first,
                                  text(words.second()), words.first()->letter));
      case BlockWords::Problem::kBadCode:
        if (!words.all_numbers()) return;
        return report(
            "bad-code", words.first()->span,
            fmt::format("{} is no code; expected a G or M number that a block can hold", first));
    }
  }

  // A code that no control is known to have: once per code.
  void report_unknown_code(Code code) {
    if (!limiter_.is_new(code)) return;
    report("unknown-g-code",
           fmt::format("G{} is not known and may change anything; what follows is left alone until "
                       "the program has set every mode again",
                       code % 10 == 0 ? fmt::format("{}", code / 10)
                                      : fmt::format("{}.{}", code / 10, code % 10)));
  }

  // The whole block is at fault. `id`: of a warning (docs/diagnostics.md).
  void report(std::string_view id, std::string message) {
    report(id, program_.blocks[block_].span, std::move(message));
  }

  // Nothing is left alone for it.
  void note(std::string_view id, SourceSpan where, std::string message) {
    report(id, where, std::move(message), Severity::kNote);
  }

 private:
  void report(std::string_view id, SourceSpan where, std::string message,
              Severity severity = Severity::kWarning) {
    if (std::exchange(is_reported_, true) || !limiter_.counts(id, where)) return;
    found_.push_back({severity, id, where, std::move(message)});
  }

  const Program& program_;
  DiagnosticLimiter& limiter_;
  Diagnostics& found_;
  std::uint32_t block_ = 0;
  bool is_reported_ = false;  // the block has its diagnostic
};

class Interpreter {
 public:
  // `depth`: of calls within each other.
  Interpreter(const Program& program, const ReadOptions& options, ControlCarry& carry,
              Diagnostics& found, int depth = 0)
      : program_(program),
        options_(options),
        depth_(depth),
        curves_(options.curves),
        has_plain_way_(options.short_ways && program.language == Language::kRs274),
        carry_(carry),
        found_(found),
        diagnostics_(program, carry.told, found),
        now_(carry.state) {
    now_.calls_keep_modes = options.calls_keep_modes;
    now_.lacks = options.lacks;
    now_.centers_follow_distance = options.centers_follow_distance;
    if (options.centers_follow_distance) now_.modal.arc_distance = now_.modal.distance;
    now_.own_words = options.own_words.get();
    carry.is_klartext = is_klartext();
    if (is_klartext()) start_klartext(now_);
    least_by_control_ = now_.modal.stated.by_control_mm;
    read_.unit_word_seen = carry.unit_word_seen;
    read_.states.push_back(now_.modal);
    // Nearly every block of a long program moves.
    reserve_in_large_pages(read_.blocks, program.blocks.size());
    reserve_in_large_pages(read_.motions, program.blocks.size());
  }

  Interpretation run() {
    const ProgramFlow whole_flow = flow_of_program();
    const std::vector<BlockFlow>& flow = whole_flow.blocks;
    const auto count = static_cast<std::uint32_t>(program_.blocks.size());
    for (std::uint32_t i = 0; i < count;) {
      if (has_plain_way_ && has_command(i) && read_plain_line(program_, i, flow[i], now_, read_)) {
        ++i;
      } else if (const auto curve = curve_at(program_, i, now_, curves_, flow)) {
        add_curve(i, *curve);
        i += curve->blocks;
      } else {
        read_block(i, flow[i]);
        ++i;
      }
    }
    follow_lost_modes(program_, flow, read_, options_.asked, carry_.lost, carry_.told, found_);
    carry_.any_words |= !nothing_said_yet();
    carry_.state = now_;
    carry_.unit_word_seen = read_.unit_word_seen;
    carry_.reaches_out |= whole_flow.reaches_out;
    // All of it is kept then, in whatever unit.
    const bool kept_for_caller =
        !options_.usual_caller_modes &&
        std::ranges::any_of(flow, [](const BlockFlow& each) { return each.in_called; });
    if (!carry_.any_motion && !read_.motions.empty() && !kept_for_caller) {
      carry_.any_motion = true;
      carry_.first_motion = program_.blocks[read_.motions.front().block].span;
    }
    return std::move(read_);
  }

  // Where the modes of a caller are not known, all of a called program is a body.
  [[nodiscard]] ProgramFlow flow_of_program() const {
    ProgramFlow flow =
        follow_flow(program_, now_.calls_keep_modes ? Returns::kBehindCalls : Returns::kToAnyLabel,
                    now_.own_words, options_.subprograms.get(), options_.names_blocks);
    for (BlockFlow& each : flow.blocks) {
      each.in_body |= each.in_called && !options_.usual_caller_modes;
    }
    return flow;
  }

  // What is known behind a call of the program, where so much is known at the call.
  ControlState run_called(const Subprogram& sub) {
    const ProgramFlow whole_flow = flow_of_program();
    const std::vector<BlockFlow>& flow = whole_flow.blocks;
    const Units units = now_.modal.units;
    std::optional<ControlState> behind;
    auto end = sub.ends.begin();
    for (std::uint32_t i = sub.begin; end != sub.ends.end();) {
      if (i > *end) {  // a curve went on through its end
        forget_everything(now_);
        return now_;
      }
      if (i == *end) {
        if (flow[i].jump_target) is_klartext() ? forget_klartext(now_) : forget_everything(now_);
        behind = behind ? either(*behind, now_) : now_;
        if (++end == sub.ends.end()) break;
        // What follows is done only where it was skipped.
        if (program_.blocks[i].block_delete) {
          ++i;
          continue;
        }
      }
      if (const auto curve = curve_at(program_, i, now_, curves_, flow)) {
        add_curve(i, *curve);
        i += curve->blocks;
      } else {
        read_block(i, flow[i]);
        ++i;
      }
    }
    // INCH of a program counts for itself.
    if (is_klartext() && behind->modal.units != units) forget_everything(*behind);
    return *behind;
  }

 private:
  void read_block(std::uint32_t index, const BlockFlow& flow) {
    const Block& block = program_.blocks[index];
    meaning_ = BlockMeaning{};
    block_index_ = index;
    diagnostics_.begin_block(index);
    meaning_.label_referenced = flow.label_referenced;
    if (flow.jump_target) {
      meaning_.entered_from_elsewhere = true;
      is_klartext() ? forget_klartext(now_) : forget_everything(now_);
      now_.modal.stated.by_control_mm = least_by_control_;
    }
    if (flow.in_definition == InDefinition::kFirst) before_definition_ = now_;
    if (block.block_delete) {
      read_uncertain(block, reason::kBlockDelete);
    } else if (!has_command(index)) {
      read_uncertain(block, reason::kNoCommand);
    } else {
      read_words_or_text(block);
    }
    if (flow.in_definition == InDefinition::kLast && before_definition_) leave_definition();
    if (options_.stated_tolerances) read_stated_tolerances(block);
    add_barriers_of_surroundings(block, flow);
    forget_motion_word();
    // No word of Siemens programs changes it: AC() and IC() say it of one number.
    if (is_siemens()) now_.modal.arc_distance = DistanceMode::kIncremental;
    meaning_.state_after = state_now();
    read_.blocks.push_back(meaning_);
  }

  // What it defines was not run. Comments are for the text that follows them.
  void leave_definition() {
    const StatedTolerances stated = now_.modal.stated;
    now_ = *before_definition_;
    now_.modal.stated = stated;
    before_definition_.reset();
  }

  // What a block says holds for its own motion, too: comments are for the text that follows them,
  // wherever it is executed from.
  void read_stated_tolerances(const Block& block) {
    for (const Comment& comment : program_.comments_of(block)) {
      if (comment.kind != CommentKind::kParenthesis && comment.kind != CommentKind::kSemicolon) {
        continue;
      }
      const ToleranceWords said = tolerance_in_comment(program_.source.text(comment.span));
      if (said.kind == ToleranceWords::Kind::kStated) now_.modal.stated.by_comment = said.length;
      note_if_uncertain(said, comment.span);
    }
    const ToleranceWords told = tolerance_for_control(block);
    take_control_tolerance(told, block);
    note_if_uncertain(told, block.span);
    // Of a comment before the first word of units: those that follow.
    std::optional<StatedLength>& by_comment = now_.modal.stated.by_comment;
    if (by_comment && by_comment->units == Units::kUnknown) by_comment->units = now_.modal.units;
    // Calls and labels change it, too.
    if (now_.modal.stated != read_.states.back().stated)
      read_.stated.push_back({block_index_, now_.modal.stated});
  }

  [[nodiscard]] ToleranceWords tolerance_for_control(const Block& block) const {
    if (block.opacity == ParseStatus::kNone) return {};
    if (is_siemens()) return tolerance_in_cycle832(program_.source.text(block.span));
    if (!is_klartext()) return {};
    const SourceSpan content = klartext_parts(program_.source.text(), block.span).content;
    return tolerance_in_cycle32(program_.source.text(content));
  }

  // Of a block that may be left out the lesser one counts, with it or without it.
  void take_control_tolerance(const ToleranceWords& told, const Block& block) {
    std::optional<double>& mm = now_.modal.stated.by_control_mm;
    const std::optional<double> before = mm;
    if (told.kind == ToleranceWords::Kind::kEnded && !block.block_delete) mm.reset();
    if (told.kind != ToleranceWords::Kind::kStated) return;
    mm = told.length.value;
    if (block.block_delete && before) mm = std::min(*before, *mm);
    remember_control_tolerance();
  }

  void remember_control_tolerance() {
    const std::optional<double>& mm = now_.modal.stated.by_control_mm;
    if (mm) least_by_control_ = std::min(*mm, least_by_control_.value_or(*mm));
  }

  void note_if_uncertain(const ToleranceWords& said, SourceSpan where) {
    if (said.kind != ToleranceWords::Kind::kUncertain) return;
    diagnostics_.note(
        "tolerance-uncertain", where,
        fmt::format("'{}' names a tolerance, but no length that is certain; expected one number of "
                    "the program's units, as in {}. What was said before it still holds",
                    shown(program_.source.text(where)),
                    is_siemens()    ? "; TOLERANCE 0.005 or CYCLE832(0.005, _FINISH, 1)"
                    : is_klartext() ? "; TOLERANCE 0.005 or CYCL DEF 32.1 T0.005"
                                    : "(TOLERANCE 0.005)"));
  }

  // The index of the state that is known now.
  std::uint32_t state_now() {
    if (read_.states.back() != now_.modal) read_.states.push_back(now_.modal);
    return static_cast<std::uint32_t>(read_.states.size() - 1);
  }

  // The blocks of a curve together. Until it is over nothing but the curve happens.
  void add_curve(std::uint32_t first, const CurveReading& curve) {
    now_.modal.motion = MotionMode::kOther;
    now_.other_motion = reason::kSpline;
    forget_motion_word();
    if (curve.feed) {
      now_.modal.feed = *curve.feed * (now_.modal.units == Units::kInch ? kMillimetresPerInch : 1);
      now_.modal.feed_without_point = is_feed_without_point(program_, first, curve);
    }
    auto next = curve.motions.begin();
    for (std::uint32_t i = first; i < first + curve.blocks; ++i) {
      meaning_ = BlockMeaning{};
      meaning_.kind = BlockKind::kSettings;  // it says a knot, or that the curve begins
      meaning_.barrier = reason::kSpline;
      meaning_.of_curve = true;
      meaning_.begins_curve = i == first;
      block_index_ = i;
      diagnostics_.begin_block(i);
      if (options_.stated_tolerances) read_stated_tolerances(program_.blocks[i]);
      meaning_.state_after = state_now();
      if (next != curve.motions.end() && next->block == i) {
        meaning_.kind = BlockKind::kMotion;
        meaning_.motion = static_cast<std::int32_t>(read_.motions.size());
      }
      for (; next != curve.motions.end() && next->block == i; ++next) {
        read_.motions.push_back(motion_of(*next, curve));
      }
      read_.blocks.push_back(meaning_);
    }
    // It started where the position was known, and so it ends.
    now_.position.mm = read_.motions.back().piece.end();
  }

  // Whether no build of the control leaves the block out for want of a command word.
  [[nodiscard]] bool has_command(std::uint32_t index) const {
    if (!options_.needs_commands) return true;
    bool any = false;
    for (const Word& word : program_.words_of(program_.blocks[index])) {
      if (word.letter == 'G' || word.letter == 'M' || word.letter == 'T') return true;
      any |= word.letter != 'N';
    }
    return !any;
  }

  // The operator, or the build of the firmware, chooses whether the block is executed: what it
  // changes is unknown afterwards.
  void read_uncertain(const Block& block, std::string_view why) {
    const ControlState skipped = now_;
    read_words_or_text(block);
    now_ = either(skipped, now_);
    drop_motion();
    if (meaning_.kind != BlockKind::kEmpty) meaning_.kind = BlockKind::kOpaque;
    meaning_.barrier = why;
  }

  void read_words_or_text(const Block& block) {
    const std::optional<CalledProgram> call = call_of(block);
    const ControlState before = call ? now_ : ControlState();
    read_without_call(block);
    if (!call) return;
    const std::optional<StatedLength> by_comment = now_.modal.stated.by_comment;
    if (const auto behind = state_behind(*call, before)) now_ = *behind;
    now_.modal.stated.by_comment = by_comment;  // comments there are of that text
    remember_control_tolerance();
  }

  // Of a program that was read, and that the user says nothing of.
  [[nodiscard]] std::optional<CalledProgram> call_of(const Block& block) const {
    if (options_.subprograms == nullptr) return std::nullopt;
    std::optional<CalledProgram> call = called_program(program_, block);
    const bool known = call && options_.subprograms->find(call->name) != nullptr;
    const bool by_user = known && is_vouched_for(block);
    return known && !by_user ? call : std::nullopt;
  }

  [[nodiscard]] bool is_vouched_for(const Block& block) const {
    if (now_.own_words == nullptr) return false;
    if (is_klartext()) {
      return own_call(now_, klartext_call(program_.source.text(
                                klartext_parts(program_.source.text(), block.span).content))) !=
             nullptr;
    }
    const BlockWords words(program_.words_of(block));
    return own_called_by(block) != nullptr || own_call(now_, numbered_call(words)) != nullptr;
  }

  // Nothing: not followed, for too much was followed already.
  std::optional<ControlState> state_behind(const CalledProgram& call, const ControlState& before) {
    const Subprogram& sub = *options_.subprograms->find(call.name);
    std::optional<ControlState> once = state_behind_once(sub, before);
    if (!once || call.is_once) return once;
    // What is so after one time and after another is so after each.
    std::optional<ControlState> twice = state_behind_once(sub, *once);
    if (!twice || *twice == *once) return twice;
    ControlState any = either(*once, *twice);
    forget_position(any);
    const std::optional<ControlState> again = state_behind_once(sub, any);
    return again && either(any, *again) == any ? std::optional(any) : std::nullopt;
  }

  std::optional<ControlState> state_behind_once(const Subprogram& sub, const ControlState& before) {
    carry_.called_blocks += sub.program.blocks.size();
    if (depth_ >= kMostCalledWithin || carry_.called_blocks > kMostCalledBlocks) {
      return std::nullopt;
    }
    ControlCarry carry(before.modal.units);
    carry.state = before;
    carry.any_words = true;
    carry.any_motion = true;  // a line for people may mean anything here
    carry.called_blocks = carry_.called_blocks;
    Diagnostics ignored;
    Interpreter called(sub.program, options_, carry, ignored, depth_ + 1);
    ControlState behind = called.run_called(sub);
    carry_.called_blocks = carry.called_blocks;
    read_.unit_word_seen |= called.read_.unit_word_seen;
    return behind;
  }

  void read_without_call(const Block& block) {
    switch (block.opacity) {
      case ParseStatus::kNone:
      case ParseStatus::kExpression:
        return read_words(block);
      case ParseStatus::kNamedWords:
        return read_named(block);
      case ParseStatus::kCornerWord:
        // The block's motion stops short of its end, and the next one starts beside it.
        read_words(block);
        drop_motion();
        forget_position(now_);
        return make_opaque(reason::kCornerWord);
      case ParseStatus::kContinued:
        return make_opaque(opacity_reason(block.opacity));
      default:
        return is_klartext() ? read_klartext(block) : read_opaque(block);
    }
  }

  void read_opaque(const Block& block) {
    const std::string_view text = program_.source.text(block.span);
    const bool is_flow = block.opacity == ParseStatus::kFlow;
    if (const OwnWord* own = own_called_by(block)) {
      apply_own(own->effect, now_);
      return make_opaque(reason::kSubprogram);
    }
    if (is_siemens() && is_flow) {
      if (siemens_flow_effect(text) != FlowEffect::kNothing) forget_everything(now_);
      return make_opaque(reason::kProgramFlow);
    }
    if (block.opacity == ParseStatus::kForeign || block.opacity == ParseStatus::kUnreadable) {
      if (speaks_to_people(text) || is_bounded_text(text)) {
        return make_opaque(reason::kForeignWords);
      }
    }
    if (options_.names_blocks && names_block(text)) return make_opaque(reason::kProgramFlow);
    apply_opaque(block.opacity, text, now_);
    const bool calls = is_flow && flow_effect(text) == FlowEffect::kCall;
    make_opaque(calls ? reason::kSubprogram : opacity_reason(block.opacity));
  }

  // Where something may jump to the name, what it finds there was forgotten.
  [[nodiscard]] bool names_block(std::string_view text) {
    return is_letter_name(text, 'N') || (is_letter_name(text, 'O') && nothing_said_yet());
  }

  // What the user says of a line that is a call by name.
  [[nodiscard]] const OwnWord* own_called_by(const Block& block) const {
    if (now_.own_words == nullptr) return nullptr;
    const std::string_view text = program_.source.text(block.span);
    const bool may_call =
        block.opacity == ParseStatus::kForeign || block.opacity == ParseStatus::kNamedWords;
    if (!is_siemens()) {
      const bool is_flow = block.opacity == ParseStatus::kFlow;
      return is_flow    ? own_call(now_, o_word_call(text))
             : may_call ? own_call(now_, leading_name(text))
                        : nullptr;
    }
    return may_call ? own_call(now_, siemens_call(text)) : nullptr;
  }

  // Before the first motion such a line changes nothing; behind it, what it is for is not known.
  bool speaks_to_people(std::string_view text) {
    if (carry_.any_motion || !read_.motions.empty() || is_siemens()) return false;
    return is_plain_text(text) || (nothing_said_yet() && is_title(text));
  }

  // Whether it is known what such a line can have changed; that is forgotten.
  bool is_bounded_text(std::string_view text) {
    const TextEffect effect = is_siemens() ? TextEffect::kAnything : text_effect(text);
    if (effect == TextEffect::kPlace) forget_position(now_);
    if (effect == TextEffect::kSpindle) now_.modal.spindle_speed.reset();
    return effect != TextEffect::kAnything;
  }

  // Only comments, program numbers and titles so far.
  bool nothing_said_yet() {
    const auto is_silent = [](const BlockMeaning& block) {
      return block.kind == BlockKind::kEmpty || block.barrier == reason::kProgramMark ||
             block.barrier == reason::kForeignWords;
    };
    while (silent_ < read_.blocks.size() && is_silent(read_.blocks[silent_])) ++silent_;
    return !carry_.any_words && silent_ == read_.blocks.size();
  }

  [[nodiscard]] bool is_siemens() const { return program_.language == Language::kSiemens; }
  [[nodiscard]] bool is_klartext() const { return program_.language == Language::kKlartext; }

  void read_klartext(const Block& block) {
    if (block.opacity == ParseStatus::kUnreadable) {
      forget_klartext(now_);
      return make_opaque(reason::kNotUnderstood);
    }
    const std::string_view text = klartext_statement_text(program_, block_index_);
    make_opaque(apply_klartext(text, now_));
    read_.unit_word_seen |= now_.modal.units != Units::kUnknown;
  }

  // Every block of Klartext that moves says how.
  void forget_motion_word() {
    if (is_klartext()) now_.modal.motion = MotionMode::kUnknown;
  }

  void make_opaque(std::string_view why) {
    meaning_.kind = BlockKind::kOpaque;
    meaning_.barrier = why;
  }

  void drop_motion() {
    if (meaning_.motion < 0) return;
    read_.motions.pop_back();
    meaning_.motion = -1;
  }

  // Which of two reasons it is that a value is not known.
  void distinguish_expression_from_decimals(const Block& block) {
    if (meaning_.barrier != reason::kExpression) return;
    const bool no_point = std::ranges::any_of(program_.words_of(block), [](const Word& word) {
      return word.without_point && !word.is_number;
    });
    if (no_point) meaning_.barrier = reason::kImpliedDecimals;
  }

  void add_barriers_of_surroundings(const Block& block, const BlockFlow& flow) {
    distinguish_expression_from_decimals(block);
    const bool active = std::ranges::any_of(program_.comments_of(block), [](const Comment& c) {
      return c.kind == CommentKind::kActive || c.kind == CommentKind::kUncertain;
    });
    if (block.has_checksum) block_run(reason::kChecksum);  // the host counts these lines
    if (active) {
      block_run(reason::kActiveComment);
      if (meaning_.kind == BlockKind::kEmpty) {
        meaning_.kind = BlockKind::kSettings;
      } else if (meaning_.kind == BlockKind::kMotion) {
        meaning_.kind = BlockKind::kMotionAndMore;
      }
    }
    if (meaning_.label_referenced) block_run(reason::kReferencedLabel);
    if (flow.in_body && meaning_.kind != BlockKind::kEmpty) {
      block_run(flow.in_called && !options_.usual_caller_modes ? reason::kCallerModes
                                                               : reason::kLoopBody);
    }
    // Last: an arc that may stand in a run has this barrier alone.
    if (meaning_.motion >= 0 && read_.motions.back().kind == MotionKind::kArc) {
      block_run(reason::kArc);
    }
  }

  void block_run(std::string_view why) {
    if (meaning_.barrier.empty()) meaning_.barrier = why;
  }

  // --- words --------------------------------------------------------------------------------

  void read_words(const Block& block) {
    const BlockWords words(program_.words_of(block));
    if (words.problem() != BlockWords::Problem::kNone) {
      const ControlState before = now_;
      refuse_words(words);
      if (const auto after = after_some_of(program_.words_of(block), before)) now_ = *after;
      return;
    }
    if (waits_alone(block)) {
      meaning_.kind = BlockKind::kSettings;
      meaning_.barrier = reason::kDwell;
      return;
    }
    const StateEffect effect = apply_words(words, now_);
    read_.unit_word_seen |= effect.unit_word;
    if (effect.unknown_code != kNoCode) diagnostics_.report_unknown_code(effect.unknown_code);
    meaning_.barrier = effect.barrier;
    read_motion(words, effect);
    apply_late_words(words, now_);
    const bool refused = !effect.understood && meaning_.kind != BlockKind::kOpaque;
    if (words.all_numbers() && !refused) return;
    drop_motion();
    make_opaque(words.all_numbers() ? effect.barrier : reason::kExpression);
  }

  // A dwell whose one word is a time on every control that reads it, not a position, feed or speed.
  [[nodiscard]] bool waits_alone(const Block& block) const {
    const DwellForm form = is_siemens() ? DwellForm::kSecondsF : DwellForm::kUnknown;
    return dwell_ms(program_.words_of(block), form).has_value();
  }

  // Siemens: the block is copied; what it does to the state is known where all its names are.
  void read_named(const Block& block) {
    const BlockWords words(program_.words_of(block));
    if (words.problem() != BlockWords::Problem::kNone) return refuse_words(words);
    if (const OwnWord* own = own_called_by(block)) {
      apply_own(own->effect, now_);
      return make_opaque(reason::kSubprogram);
    }
    const NamedEffect named =
        apply_names(program_.source.text(block.span), words, variables_, now_);
    if (!named.understood) {
      forget_everything(now_);
      return make_opaque(reason::kForeignWords);
    }
    StateEffect effect = apply_words(words, now_);
    read_.unit_word_seen |= effect.unit_word || named.unit_word;
    if (effect.motion != nullptr) set_motion_mode(*effect.motion);
    effect.takes_axes |= named.takes_axes;
    const bool moves = words.has_any("XYZIJKR") && !effect.takes_axes;
    if (moves && now_.modal.motion != MotionMode::kOther &&
        why_not_followed(words, effect, now_).empty()) {
      now_.position = end_of_motion(words, now_);
    } else if (moves) {
      forget_position(now_);
    }
    forget_increments(words);
    if (named.loses_place || !words.all_numbers()) {
      forget_position(now_);
    }
    apply_late_words(words, now_);
    if (named.own != nullptr) apply_late_own(*named.own, words, now_);
    make_opaque(named.barrier);
  }

  void refuse_words(const BlockWords& words) {
    forget_everything(now_);
    make_opaque(words.all_numbers() ? reason::kNotUnderstood : reason::kExpression);
    diagnostics_.report_words(words);
  }

  void read_motion(const BlockWords& words, const StateEffect& effect) {
    if (effect.motion != nullptr) set_motion_mode(*effect.motion);
    const MotionMode mode = now_.modal.motion;
    const bool arc_words = is_arc(mode) && words.has_any("IJKR");
    const bool moves = !effect.takes_axes && (words.has_any("XYZ") || arc_words);
    if (mode == MotionMode::kOther && (moves || effect.motion != nullptr)) {
      return read_other_motion();
    }
    if (!moves) return finish_without_motion(words, effect);
    if (const std::string_view why = why_not_followed(words, effect, now_); !why.empty()) {
      return lose_motion(words, why);
    }
    if (!add_motion(words)) return;
    meaning_.kind = effect.barrier.empty() ? BlockKind::kMotion : BlockKind::kMotionAndMore;
    forget_increments(words);
  }

  void set_motion_mode(const CodeRow& motion) {
    now_.modal.motion = motion.value.as<MotionMode>();
    now_.other_motion = motion.why;
  }

  // Cycles, threads, splines, probes: where the tool is afterwards depends on the control.
  void read_other_motion() {
    forget_position(now_);
    block_run(now_.other_motion);
    meaning_.kind = BlockKind::kSettings;
  }

  void finish_without_motion(const BlockWords& words, const StateEffect& effect) {
    // G1 alone: the next block moves in this mode.
    if (effect.motion != nullptr && !effect.takes_axes &&
        read_.states.back().motion != now_.modal.motion) {
      block_run(reason::kStateChange);
    }
    forget_increments(words);
    if (!effect.takes_parameters && words.has_any("PQLIJKR")) {
      // L54 calls a subprogram on Sinumerik.
      words.has('L') ? forget_everything(now_) : forget_position(now_);
      return make_opaque(reason::kNotUnderstood);
    }
    const bool nothing = meaning_.barrier.empty() && !effect.feed_changed;
    meaning_.kind = nothing ? BlockKind::kEmpty : BlockKind::kSettings;
  }

  // U, V, W move X, Y, Z by increments on lathes, and axes of their own elsewhere.
  void forget_increments(const BlockWords& words) {
    for (std::size_t axis = 0; axis < 3; ++axis) {
      if (words.has("UVW"[axis])) forget_axis(now_, axis);
    }
  }

  // The motion happens, but its path is not known. Nor is its end, as a rule: controls that
  // refuse the block stop, others go where the words say.
  void lose_motion(const BlockWords& words, std::string_view why) {
    make_opaque(why);
    if (why == reason::kExpression) {
      forget_named_axes(now_, words);
    } else if (why == reason::kPositionUnknown && now_.modal.distance == DistanceMode::kAbsolute) {
      now_.position = end_of_motion(words, now_);
    } else {
      forget_position(now_);
    }
  }

  // --- geometry -----------------------------------------------------------------------------

  // False: the words say no arc.
  bool add_motion(const BlockWords& words) {
    const Position end = end_of_motion(words, now_);
    Motion motion;
    motion.block = block_index_;
    if (is_arc(now_.modal.motion)) {
      const ArcReading reading = arc_from_words(arc_words(words, now_, end));
      if (!reading.arc) {
        diagnostics_.report(reading.problem, reading.message);
        lose_motion(words, reason::kArc);
        return false;
      }
      motion.kind = MotionKind::kArc;
      motion.piece = *reading.arc;
    } else {
      const bool rapid = now_.modal.motion == MotionMode::kRapid;
      motion.kind = rapid ? MotionKind::kRapid : MotionKind::kLine;
      motion.piece = geometry::Line{now_.position.mm, end.mm};
      if (rapid) block_run(reason::kRapid);
    }
    motion.start_known = true;
    motion.end_known = true;
    for (std::size_t axis = 0; axis < 3; ++axis) {
      motion.axes_named[axis] = words.has("XYZ"[axis]);
      motion.start_known &= !motion.axes_named[axis] || now_.position.known[axis];
      motion.end_known &= !motion.axes_named[axis] || end.known[axis];
    }
    now_.position = end;
    meaning_.motion = static_cast<std::int32_t>(read_.motions.size());
    read_.motions.push_back(std::move(motion));
    return true;
  }

  const Program& program_;
  const ReadOptions& options_;
  int depth_;
  const CurveFormat* curves_;
  bool has_plain_way_;
  ControlCarry& carry_;
  Diagnostics& found_;
  BlockDiagnostics diagnostics_;
  ControlState now_;
  std::optional<ControlState> before_definition_;  // of a subprogram, in which the block stands
  SiemensVariables variables_;
  std::optional<double> least_by_control_;  // mm: of all that was told so far
  std::size_t silent_ = 0;  // so many blocks at the beginning say nothing to the control
  Interpretation read_;
  BlockMeaning meaning_;  // of the block that is being read
  std::uint32_t block_index_ = 0;
};

// Nothing of it is certain, and no word alone says what it seems to say.
void make_all_opaque(const Program& program, Interpretation& read) {
  for (std::size_t i = 0; i < read.blocks.size(); ++i) {
    BlockMeaning& meaning = read.blocks[i];
    const Block& block = program.blocks[i];
    const bool says_nothing = block.opacity == ParseStatus::kNone && block.word_count == 0 &&
                              meaning.kind == BlockKind::kEmpty;
    if (says_nothing || meaning.barrier == reason::kProgramMark) continue;
    meaning.kind = BlockKind::kOpaque;
    meaning.barrier = reason::kLatheProgram;
    meaning.of_curve = meaning.begins_curve = false;
  }
}

Diagnostic lathe_warning(const LatheWatch& lathe) {
  return {
      Severity::kWarning, "lathe-program", lathe.where(),
      fmt::format("{}: this is a program for a lathe, where X may be a diameter and G90 a cycle; "
                  "it is copied as it is. If it is for a mill, write this in another way",
                  lathe.evidence())};
}

}  // namespace

Interpretation interpret(const Program& program, const ReadOptions& options, Diagnostics& found) {
  ControlCarry carry(options.units);
  Interpretation read = interpret_part(program, options, carry, found);
  finish_interpretation(carry, found);
  return read;
}

Interpretation interpret_part(const Program& part, const ReadOptions& options, ControlCarry& carry,
                              Diagnostics& found) {
  carry.lathe.see(part);
  if (!carry.lathe.is_lathe()) return Interpreter(part, options, carry, found).run();
  // What is told of single blocks would be told of a mill.
  Diagnostics of_a_mill;
  Interpretation read = Interpreter(part, options, carry, of_a_mill).run();
  make_all_opaque(part, read);
  found.push_back(lathe_warning(carry.lathe));
  carry.told = {};
  carry.lost = {};
  carry.any_motion = false;  // it needs no units
  carry.reaches_out = true;
  return read;
}

void finish_interpretation(const ControlCarry& carry, Diagnostics& found) {
  tell_lost_modes(carry.lost, found);
  carry.told.tell_rest(found);
  if (carry.unit_word_seen || !carry.any_motion) return;
  const std::string_view missing =
      carry.is_klartext ? "no BEGIN PGM with MM or INCH" : "no G20 or G21";
  found.push_back({Severity::kError, "units-missing", carry.first_motion,
                   fmt::format("{} in the whole program; without a unit a tolerance means nothing. "
                               "Say --units mm or --units inch",
                               missing)});
}

}  // namespace batten::gcode
