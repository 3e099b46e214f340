#include "postproc/stream/prescan_chunks.h"

#include <algorithm>
#include <utility>

#include "gcode/interpreter/interpreter.h"
#include "gcode/reading/source_kind.h"
#include "gcode/state/reason.h"
#include "postproc/convert/conversion.h"
#include "postproc/profile/target_profile.h"
#include "postproc/proof/program_events.h"

namespace batten::postproc {

namespace {

// Blocks that are held at once: much more than what a part costs by itself, and much less than a
// window, which is read again from the begin of a part on.
constexpr std::size_t kBlocksAtOnce = 4096;

// Bytes of a part, but for the rest of its last line. Without a bound, a search for a kind of line
// end that the text does not have would go through all of it, part for part.
constexpr std::size_t kBytesAtOnce = std::size_t{1} << 19;
constexpr std::size_t kLongestRest = std::size_t{1} << 20;

}  // namespace

ChunkReader::ChunkReader(const gcode::SourceText& source, const SmoothOptions& options)
    : source_(source), options_(options) {
  now_.decimals = {reading_of(options, gcode::Language::kRs274).decimals, options.units};
}

std::shared_ptr<PrescanChunk> ChunkReader::next() {
  if (needs_whole_ || now_.begin >= source_.text().size()) return nullptr;
  auto part = std::make_shared<PrescanChunk>(PrescanChunk{{}, 0, {source_, {}, {}, {}}, {}});
  const auto end = gcode::end_of_lines(source_, now_.begin, kBytesAtOnce, kLongestRest);
  if (end) {
    part->begin.text = now_;
    part->program =
        gcode::parse_part(source_, {.byte = *end, .blocks = kBlocksAtOnce}, now_, found_);
    part->program.dwells = gcode::dwells_of(options_.source);
    part->end = now_.begin;
  }
  needs_whole_ = !end || needs_whole(part->program);
  part->needs_whole = needs_whole_;
  return part;
}

bool ChunkReader::needs_whole(const gcode::Program& part) const {
  if (!now_.marks.closes_nothing() || gcode::has_error(found_)) return true;
  gcode::Diagnostics others;
  tell_of_other_meanings(part, *options_.target, others);
  gcode::tell_of_contradictions(part, options_.source, others);
  return !others.empty() || is_of_another_family(part, *options_.target);
}

gcode::Diagnostics ChunkReader::finish() {
  gcode::finish_text(now_, found_);
  return std::move(found_);
}

PartMeanings::PartMeanings(const SmoothOptions& options)
    : read_options_(read_options_of(options)), now_{gcode::ControlCarry(options.units)} {}

void PartMeanings::add_to(PrescanChunk& part) {
  part.begin.before = now_;
  part.meaning = gcode::interpret_part(part.program, read_options_, now_.control, found_);
  now_.events = events_before_next({&part.program, &part.meaning, now_.events});
  part.needs_whole = needs_whole(part.meaning);
}

bool PartMeanings::needs_whole(const gcode::Interpretation& meaning) const {
  if (now_.control.reaches_out || gcode::has_error(found_)) return true;
  // A curve may go on in the next part.
  return read_options_.curves != nullptr &&
         std::ranges::any_of(meaning.blocks, [](const gcode::BlockMeaning& block) {
           return block.of_curve || block.barrier == gcode::reason::kSpline;
         });
}

gcode::Diagnostics PartMeanings::finish() {
  gcode::finish_interpretation(now_.control, found_);
  return std::move(found_);
}

}  // namespace batten::postproc
