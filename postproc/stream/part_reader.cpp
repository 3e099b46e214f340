#include "postproc/stream/part_reader.h"

#include <algorithm>
#include <utility>

#include "gcode/state/reason.h"

namespace batten::postproc {

gcode::ReadPart read_whole(const gcode::SourceText& source, const PartReading& reading,
                           gcode::Diagnostics& found) {
  gcode::ReadPart read{gcode::parse(source, reading.text, found), {}};
  gcode::tell_of_contradictions(read.program, reading.source, found);
  read.meaning = gcode::interpret(read.program, reading.options, found);
  return read;
}

PartTexts::PartTexts(const gcode::SourceText& source, const PartReading& reading,
                     const PartLimits& limits)
    : source_(&source), kind_(reading.source), dwells_(reading.text.dwells), limits_(limits) {
  now_.decimals = {reading.text.decimals, reading.text.units};
}

std::shared_ptr<PartOfText> PartTexts::next() {
  if (needs_whole_ || now_.begin >= source_->text().size()) return nullptr;
  auto part = std::make_shared<PartOfText>(PartOfText{{}, 0, {{*source_, {}, {}, {}}, {}}});
  // Without a bound of its bytes, a search for a kind of line end that the text does not have would
  // go through all of it for each part.
  const auto end = gcode::end_of_lines(*source_, now_.begin, limits_.bytes, limits_.longest_line);
  if (end) {
    part->begin.text = now_;
    part->read.program =
        gcode::parse_part(*source_, {.byte = *end, .blocks = limits_.blocks}, now_, found_);
    part->read.program.dwells = dwells_;
    part->end = now_.begin;
  }
  needs_whole_ = !end || needs_whole(part->read.program);
  part->needs_whole = needs_whole_;
  return part;
}

bool PartTexts::needs_whole(const gcode::Program& part) const {
  if (!now_.marks.closes_nothing() || now_.uses_variables || gcode::has_error(found_)) return true;
  gcode::Diagnostics contradictions;
  gcode::tell_of_contradictions(part, kind_, contradictions);
  return !contradictions.empty();
}

gcode::Diagnostics PartTexts::finish() {
  gcode::finish_text(now_, found_);
  return std::move(found_);
}

void PartMeanings::add_to(PartOfText& part) {
  part.begin.before.control = now_;
  part.read.meaning = gcode::interpret_part(part.read.program, options_, now_, found_);
  part.needs_whole = needs_whole(part.read.meaning);
}

bool PartMeanings::needs_whole(const gcode::Interpretation& meaning) const {
  if (now_.reaches_out || gcode::has_error(found_)) return true;
  // A curve may go on in the next part.
  return options_.curves != nullptr &&
         std::ranges::any_of(meaning.blocks, [](const gcode::BlockMeaning& block) {
           return block.of_curve || block.barrier == gcode::reason::kSpline;
         });
}

gcode::Diagnostics PartMeanings::finish() {
  gcode::finish_interpretation(now_, found_);
  return std::move(found_);
}

PartReader::PartReader(const gcode::SourceText& source, const PartReading& reading,
                       const PartLimits& limits, bool as_whole)
    : source_(&source),
      reading_(reading),
      is_whole_(as_whole),
      texts_(source, reading, limits),
      meanings_(reading.options),
      held_{{source, {}, {}, {}}, {}} {
  if (!is_whole_) source.release_pages({0, static_cast<std::uint32_t>(source.text().size())});
}

PartReader::Next PartReader::read_on() {
  if (is_whole_) {
    add(read_whole(*source_, reading_, of_whole_));
    return Next::kAtEnd;
  }
  const auto part = texts_.next();
  if (!part) return Next::kAtEnd;
  if (part->needs_whole) return Next::kNeedsWhole;
  const std::uint32_t last_mark = texts_.marks().last_mark();
  for (gcode::Block& block : part->read.program.blocks) {
    if (last_mark > 0 && block.line > last_mark) gcode::close_behind_marks(block);
  }
  meanings_.add_to(*part);
  if (part->needs_whole) return Next::kNeedsWhole;
  add(std::move(part->read));
  return Next::kRead;
}

void PartReader::add(gcode::ReadPart part) {
  blocks_read_ += part.program.blocks.size();
  unit_word_seen_ = part.meaning.unit_word_seen;
  gcode::append(held_, std::move(part));
}

gcode::ReadPart PartReader::take(std::uint32_t count) {
  if (taken_.size() > 0) source_->release_pages(taken_);
  gcode::ReadPart rest{{*source_, {}, {}, {}}, {}};
  if (!is_whole_) rest = gcode::take_rest(held_, count);
  gcode::ReadPart taken = std::exchange(held_, std::move(rest));
  if (!taken.program.blocks.empty()) {
    taken_ = {taken.program.blocks.front().span.begin, taken.program.blocks.back().end};
  }
  return taken;
}

std::optional<gcode::Diagnostics> PartReader::finish() {
  gcode::Diagnostics found = std::move(reading_.of_language);
  for (const gcode::Diagnostics& more : {of_whole_, texts_.finish(), meanings_.finish()}) {
    found.insert(found.end(), more.begin(), more.end());
  }
  if (!is_whole_ && gcode::has_error(found)) return std::nullopt;
  return found;
}

}  // namespace batten::postproc
