#include "gcode/interpreter/plain_line.h"

#include <array>
#include <cstddef>
#include <optional>
#include <utility>

#include "gcode/state/reason.h"

namespace batten::gcode {
namespace {

// But for the way of moving, which the block may say.
bool is_plain_state(const ModalState& modal) {
  return modal.distance == DistanceMode::kAbsolute && modal.polar == TriState::kOff &&
         modal.modal_macro == TriState::kOff;
}

bool is_plain_block(const Block& block, const BlockFlow& flow) {
  return block.opacity == ParseStatus::kNone && !block.block_delete && !block.has_checksum &&
         block.comment_count == 0 && block.word_count > 0 && !flow.label_referenced &&
         !flow.jump_target && !flow.in_body;
}

// What the words of a block say, each at most once.
struct PlainWords {
  std::array<const Word*, 3> places{};  // X, Y, Z
  const Word* number = nullptr;         // N
  const Word* motion = nullptr;         // G0 or G1
  const Word* feed = nullptr;           // F

  [[nodiscard]] bool moves() const {
    return places[0] != nullptr || places[1] != nullptr || places[2] != nullptr;
  }
};

// Where the word belongs; nullptr where it is none of these.
const Word** slot_of_plain(const Word& word, PlainWords& words) {
  switch (word.letter) {
    case 'X':
    case 'Y':
    case 'Z':
      return &words.places[static_cast<std::size_t>(word.letter - 'X')];
    case 'N':
      return &words.number;
    case 'G':
      return word.value == 0 || word.value == 1 ? &words.motion : nullptr;
    case 'F':
      return &words.feed;
    default:
      return nullptr;
  }
}

// Nothing where the interpreter has more to do or to tell: other words, one of them twice.
std::optional<PlainWords> plain_words_of(std::span<const Word> words) {
  PlainWords found;
  for (const Word& word : words) {
    const Word** const slot = word.is_number ? slot_of_plain(word, found) : nullptr;
    if (slot == nullptr || std::exchange(*slot, &word) != nullptr) return std::nullopt;
  }
  return found.moves() ? std::optional(found) : std::nullopt;
}

// The feed that the block says, in the state's way of saying feeds; nothing where it says one in
// another way.
bool take_feed(const Word* word, ModalState& modal) {
  if (word == nullptr) return true;
  if (modal.feed_mode != FeedMode::kPerMinute || !(word->value > 0) ||
      word->without_point != modal.feed_without_point) {
    return false;
  }
  modal.feed = modal.units == Units::kInch ? word->value * kMillimetresPerInch : word->value;
  return true;
}

void take_motion_word(const Word* word, ControlState& state) {
  if (word == nullptr) return;
  state.modal.motion = word->value == 0 ? MotionMode::kRapid : MotionMode::kLine;
  state.other_motion = {};
}

bool is_straight(MotionMode mode) {
  return mode == MotionMode::kLine || mode == MotionMode::kRapid;
}

}  // namespace

bool read_plain_line(const Program& program, std::uint32_t index, const BlockFlow& flow,
                     ControlState& now, Interpretation& read) {
  const Block& block = program.blocks[index];
  if (!is_plain_state(now.modal) || !is_plain_block(block, flow)) return false;
  const auto words = plain_words_of(program.words_of(block));
  if (!words || (words->motion == nullptr && !is_straight(now.modal.motion)) ||
      !take_feed(words->feed, now.modal)) {
    return false;
  }
  take_motion_word(words->motion, now);
  const ModalState& modal = now.modal;
  if (words->motion != nullptr || words->feed != nullptr) {
    if (read.states.back() != modal) read.states.push_back(modal);
  }

  const bool rapid = modal.motion == MotionMode::kRapid;
  BlockMeaning& meaning = read.blocks.emplace_back();
  meaning.kind = BlockKind::kMotion;
  meaning.motion = static_cast<std::int32_t>(read.motions.size());
  meaning.state_after = static_cast<std::uint32_t>(read.states.size() - 1);
  if (rapid) meaning.barrier = reason::kRapid;

  const geometry::Point3 start = now.position.mm;
  const double unit = modal.units == Units::kInch ? kMillimetresPerInch : 1;
  Motion& motion = read.motions.emplace_back();
  motion.block = index;
  motion.kind = rapid ? MotionKind::kRapid : MotionKind::kLine;
  motion.end_known = true;
  motion.start_known = true;
  for (std::size_t axis = 0; axis < words->places.size(); ++axis) {
    const Word* const place = words->places[axis];
    if (place == nullptr) continue;
    motion.axes_named[axis] = true;
    motion.start_known &= now.position.known[axis];
    now.position.mm[static_cast<Eigen::Index>(axis)] = place->value * unit;
    now.position.known[axis] = true;
  }
  motion.piece = geometry::Line{start, now.position.mm};
  return true;
}

}  // namespace batten::gcode
