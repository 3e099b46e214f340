#include "postproc/stream/chunk_reader.h"

#include <algorithm>
#include <utility>

#include "gcode/interpreter/interpreter.h"
#include "gcode/state/reason.h"

namespace batten::postproc {

PartReader::PartReader(const gcode::SourceText& source, const PartReading& reading,
                       const PartLimits& limits)
    : source_(&source),
      reading_(reading),
      limits_(limits),
      control_(reading.options.units),
      held_{{source, {}, {}, {}}, {}} {
  text_.decimals = {reading.decimals, reading.options.units};
}

PartReader::Next PartReader::read_on() {
  if (text_.begin >= source_->text().size()) return Next::kAtEnd;
  const auto end = gcode::end_of_lines(*source_, text_.begin, limits_.bytes, limits_.longest_line);
  if (!end) return Next::kNeedsWhole;
  gcode::ReadPart part{
      gcode::parse_part(*source_, {.byte = *end, .blocks = limits_.blocks}, text_, of_text_), {}};
  part.program.dwells = reading_.dwells;
  close_behind_marks(part.program);
  part.meaning = gcode::interpret_part(part.program, reading_.options, control_, of_meaning_);
  if (needs_whole(part)) return Next::kNeedsWhole;
  gcode::append(held_, std::move(part));
  return Next::kRead;
}

void PartReader::close_behind_marks(gcode::Program& part) const {
  const std::uint32_t last = text_.marks.last_mark();
  if (last == 0) return;
  for (gcode::Block& block : part.blocks) {
    if (block.line > last) gcode::close_behind_marks(block);
  }
}

bool PartReader::needs_whole(const gcode::ReadPart& part) const {
  if (control_.reaches_out || !text_.marks.closes_nothing()) return true;
  if (gcode::has_error(of_text_) || gcode::has_error(of_meaning_)) return true;
  gcode::Diagnostics contradictions;
  gcode::tell_of_contradictions(part.program, reading_.source, contradictions);
  if (!contradictions.empty()) return true;
  // A curve may go on in the next part.
  return reading_.options.curves != nullptr &&
         std::ranges::any_of(part.meaning.blocks, [](const gcode::BlockMeaning& block) {
           return block.of_curve || block.barrier == gcode::reason::kSpline;
         });
}

gcode::ReadPart PartReader::take(std::uint32_t count) {
  if (taken_.size() > 0) source_->release_pages(taken_);
  gcode::ReadPart rest = gcode::take_rest(held_, count);
  gcode::ReadPart taken = std::exchange(held_, std::move(rest));
  if (!taken.program.blocks.empty()) {
    taken_ = {taken.program.blocks.front().span.begin, taken.program.blocks.back().end};
  }
  return taken;
}

std::optional<gcode::Diagnostics> PartReader::finish() {
  gcode::finish_text(text_, of_text_);
  gcode::finish_interpretation(control_, of_meaning_);
  gcode::Diagnostics found = std::move(of_text_);
  found.insert(found.end(), of_meaning_.begin(), of_meaning_.end());
  if (gcode::has_error(found)) return std::nullopt;
  return found;
}

}  // namespace batten::postproc
