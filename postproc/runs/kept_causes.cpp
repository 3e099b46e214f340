#include "postproc/runs/kept_causes.h"

#include <algorithm>
#include <array>
#include <utility>
#include <variant>

#include "gcode/state/code_table.h"
#include "gcode/state/reason.h"
#include "gcode/text/characters.h"
#include "geometry/path/path.h"

namespace batten::postproc {
namespace {

namespace reason = gcode::reason;
using gcode::MotionMode;

// The block may have moved the tool, the origin, or what is known of them.
bool may_lose_place(std::string_view barrier) {
  static constexpr std::array kThese = {
      reason::kNotUnderstood,    reason::kExpression,  reason::kProgramFlow,  reason::kForeignWords,
      reason::kBlockDelete,      reason::kOtherAxis,   reason::kCornerWord,   reason::kProbe,
      reason::kCannedCycle,      reason::kThreading,   reason::kSpline,       reason::kAssignment,
      reason::kCoordinateChange, reason::kToolChange,  reason::kMiscFunction, reason::kSubprogram,
      reason::kReferencedLabel,  reason::kStateChange, reason::kLoopBody,     reason::kScaling,
      reason::kRotation,         reason::kMirror,      reason::kPolar,        reason::kCylindrical,
      reason::kTiltedPlane};
  return std::ranges::find(kThese, barrier) != kThese.end();
}

double length_of(const gcode::Motion& motion) {
  if (motion.kind != gcode::MotionKind::kLine) return geometry::length_of(motion.piece);
  return (motion.piece.end() - motion.piece.start()).norm();
}

// A block whose motion is not followed and may cut.
bool may_cut(const gcode::Program& program, const gcode::Block& block,
             const gcode::BlockMeaning& meaning, const gcode::ModalState& state) {
  const bool lists_words = block.opacity == gcode::ParseStatus::kNone ||
                           block.opacity == gcode::ParseStatus::kExpression ||
                           block.opacity == gcode::ParseStatus::kCornerWord;
  if (!lists_words || meaning.kind != gcode::BlockKind::kOpaque) return false;
  if (state.motion == MotionMode::kRapid || state.motion == MotionMode::kOther) return false;
  bool names_place = false;
  for (const gcode::Word& word : program.words_of(block)) {
    names_place |= word.letter >= 'X' && word.letter <= 'Z';
    if (word.letter != 'G') continue;
    const gcode::CodeRow& row = gcode::row_of_g(gcode::code_of(word));
    if (row.is(gcode::trait::kTakesAxes) || row.group == gcode::CodeGroup::kUnknown) return false;
    if (row.group == gcode::CodeGroup::kMotion &&
        row.value.as<MotionMode>() == MotionMode::kRapid) {
      return false;
    }
  }
  return names_place;
}

CutMoves cut_of(const gcode::Program& part, const gcode::Interpretation& read, std::uint32_t i) {
  const gcode::BlockMeaning& meaning = read.blocks[i];
  if (meaning.motion < 0) {
    const gcode::ModalState& state = read.states[meaning.state_after];
    if (!may_cut(part, part.blocks[i], meaning, state)) return {};
    return {.moves = 1, .without_length = 1};
  }
  const gcode::Motion& motion = read.motions[static_cast<std::size_t>(meaning.motion)];
  if (motion.kind == gcode::MotionKind::kRapid) return {};
  if (!motion.start_known || !motion.end_known) return {.moves = 1, .without_length = 1};
  return {.moves = 1, .length_mm = length_of(motion)};
}

}  // namespace

CutMoves& CutMoves::operator+=(const CutMoves& other) {
  moves += other.moves;
  without_length += other.without_length;
  length_mm += other.length_mm;
  return *this;
}

double KeptCauses::share(const CutMoves& part) const {
  if (is_by_length()) return part.length_mm / all.length_mm;
  return all.moves == 0 ? 0 : static_cast<double>(part.moves) / static_cast<double>(all.moves);
}

void CauseTally::add(const gcode::Program& part, const gcode::Interpretation& read,
                     const std::vector<Section>& sections, const GroupingOptions& options,
                     const std::vector<std::string_view>& rejected) {
  UnsafeStates states(options);
  states.begin(read);
  if (!std::exchange(begun_, true)) state_ = states.reason(0);
  const auto here = [&part](std::uint32_t i) -> Since {
    return {part.blocks[i].line, gcode::shown(part.source.text(part.blocks[i].span))};
  };
  for (std::size_t s = 0; s < sections.size(); ++s) {
    const Section& section = sections[s];
    const auto* verbatim = std::get_if<Verbatim>(&section.content);
    kept_.any_run |= verbatim == nullptr;
    const std::string_view why = verbatim != nullptr ? verbatim->reason
                                 : rejected.empty()  ? std::string_view()
                                                     : rejected[s];
    for (std::uint32_t i = section.first_block; i <= section.last_block; ++i) {
      const gcode::BlockMeaning& meaning = read.blocks[i];
      if (const std::string_view state = states.reason(meaning.state_after); state != state_) {
        state_ = state;
        state_since_ = here(i);
      }
      const CutMoves cut = cut_of(part, read, i);
      kept_.all += cut;
      if (cut.moves > 0 && !why.empty()) {
        KeptCause& cause = cause_of(why);
        if (cause.first_line == 0) {
          begin(cause, here(i));
        } else {
          go_on(cause);
        }
        cause.cut += cut;
      }
      if (meaning.motion < 0 && may_lose_place(meaning.barrier)) place_since_ = here(i);
    }
  }
}

const CauseTally::Since* CauseTally::since(std::string_view reason) const {
  if (reason == state_) return &state_since_;
  return reason == reason::kPositionUnknown ? &place_since_ : nullptr;
}

void CauseTally::begin(KeptCause& cause, const Since& move) const {
  const Since* from = since(cause.reason);
  cause.first_line = move.line;
  cause.line = cause.last_from = from != nullptr ? from->line : 0;
  cause.text = cause.line > 0 ? from->text : move.text;
  cause.times = 1;
}

void CauseTally::go_on(KeptCause& cause) const {
  const Since* from = since(cause.reason);
  if (from == nullptr || from->line <= cause.last_from) return;
  ++cause.times;
  cause.last_from = from->line;
}

KeptCause& CauseTally::cause_of(std::string_view reason) {
  const auto known = std::ranges::find(kept_.causes, reason, &KeptCause::reason);
  if (known != kept_.causes.end()) return *known;
  KeptCause& cause = kept_.causes.emplace_back();
  cause.reason = reason;
  return cause;
}

void CauseTally::add(const CauseTally& behind) {
  kept_.all += behind.kept_.all;
  kept_.any_run |= behind.kept_.any_run;
  for (const KeptCause& more : behind.kept_.causes) {
    KeptCause& cause = cause_of(more.reason);
    const Since* from = more.line == 0 ? since(more.reason) : nullptr;
    if (cause.first_line == 0) {
      cause = more;
      if (from != nullptr) begin(cause, {more.first_line, more.text});
      cause.times = more.times;
    } else {
      // What holds from the begin of the part on has begun before it, with moves or without.
      const bool began = more.line > 0 || (from != nullptr && from->line > cause.last_from);
      cause.times += more.times - (began ? 0 : 1);
      cause.cut += more.cut;
    }
    cause.last_from = std::max({cause.last_from, more.last_from, from != nullptr ? from->line : 0});
  }
  if (behind.state_since_.line > 0) {
    state_ = behind.state_;
    state_since_ = behind.state_since_;
  }
  if (behind.place_since_.line > 0) place_since_ = behind.place_since_;
  begun_ = true;
}

KeptCauses CauseTally::causes() const {
  KeptCauses sorted = kept_;
  std::ranges::stable_sort(sorted.causes, std::ranges::greater{},
                           [&](const KeptCause& each) { return sorted.share(each.cut); });
  return sorted;
}

}  // namespace batten::postproc
