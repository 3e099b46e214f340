// Programs read part by part, of which only those blocks are held that are still asked for. A
// program that needs the whole is one part.
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>

#include "gcode/interpreter/interpreter.h"
#include "gcode/reading/parser.h"
#include "gcode/reading/part_reading.h"
#include "gcode/reading/source_kind.h"
#include "gcode/text/diagnostic.h"
#include "gcode/text/source_text.h"
#include "postproc/runs/section.h"

namespace batten::postproc {

// How a program is read.
struct PartReading {
  gcode::SourceKind source = gcode::SourceKind::kAuto;
  gcode::Reading text = {};
  gcode::ReadOptions options = {};
  gcode::Diagnostics of_language = {};  // what was told when its language was found out
};

struct PartLimits {
  std::size_t blocks = 8192;                        // of a part, at most
  std::size_t bytes = std::size_t{1} << 19;         // of a part, but for the rest of its last line
  std::size_t longest_line = std::size_t{1} << 20;  // bytes
  std::size_t least_text = std::size_t{1} << 21;    // bytes: shorter programs are one part
};

// All of it at once. What is told of it is added to `found`.
[[nodiscard]] gcode::ReadPart read_whole(const gcode::SourceText& source,
                                         const PartReading& reading, gcode::Diagnostics& found);

// A place of the text where reading may begin, and all that is known there.
struct ReadingPlace {
  gcode::TextCarry text;
  TextBefore before;
};

// A part as it is read.
struct PartOfText {
  ReadingPlace begin;
  std::uint32_t end = 0;  // byte
  gcode::ReadPart read;
  bool needs_whole = false;  // the rest says nothing then
};

// Text and meaning of the parts are two steps, which two threads may take: the meaning of one part
// while the text of the next one is read.

// Cuts the text of a program of the RS-274 family into parts of whole lines.
class PartTexts {
 public:
  // `source` must outlive it.
  PartTexts(const gcode::SourceText& source, const PartReading& reading, const PartLimits& limits);

  // The text of the next part and what it begins with: `begin.before` and its meaning are not
  // known yet. Null behind the last one, and behind one that needs the whole.
  [[nodiscard]] std::shared_ptr<PartOfText> next();

  // Behind the last part: where the text ends, and what is told of all of it.
  [[nodiscard]] std::uint32_t end() const { return now_.begin; }
  [[nodiscard]] gcode::Diagnostics finish();

  [[nodiscard]] const gcode::PercentMarkScanner& marks() const { return now_.marks; }

 private:
  [[nodiscard]] bool needs_whole(const gcode::Program& part) const;

  const gcode::SourceText* source_;
  gcode::SourceKind kind_;
  gcode::DwellForm dwells_;
  PartLimits limits_;
  gcode::TextCarry now_;
  gcode::Diagnostics found_;
  bool needs_whole_ = false;
};

// What the parts mean, one after the other.
class PartMeanings {
 public:
  explicit PartMeanings(const gcode::ReadOptions& options)
      : options_(options), now_(options.units) {}

  // `begin.before` gets the control, but no events.
  void add_to(PartOfText& part);

  // Behind the last part.
  [[nodiscard]] gcode::Diagnostics finish();

 private:
  [[nodiscard]] bool needs_whole(const gcode::Interpretation& meaning) const;

  gcode::ReadOptions options_;
  gcode::ControlCarry now_;
  gcode::Diagnostics found_;
};

// The blocks, motions and states, part behind part, are those of the whole, and so are the
// diagnostics at the end. Where they would not be it says that the program needs the whole: with
// errors of any kind, jumps, loops or subprograms, words outside the % marks, curves that are
// followed, marks of another source, lines that are too long or end without a line feed.
//
// A copy goes on from the same place.
class PartReader {
 public:
  // `source` must outlive the reader. In parts are read programs of the RS-274 family only.
  PartReader(const gcode::SourceText& source, const PartReading& reading, const PartLimits& limits,
             bool as_whole);

  enum class Next { kRead, kAtEnd, kNeedsWhole };
  // One part more behind the blocks that are held; the whole, which then is at its end.
  [[nodiscard]] Next read_on();

  [[nodiscard]] const gcode::ReadPart& held() const { return held_; }
  [[nodiscard]] std::uint32_t blocks_held() const {
    return static_cast<std::uint32_t>(held_.program.blocks.size());
  }

  // The first `count` blocks that are held, of a whole all of them, which then are held no longer.
  // The bytes of those that were taken before are given back (gcode::SourceText::release_pages).
  [[nodiscard]] gcode::ReadPart take(std::uint32_t count);

  // Of the whole program, at its end; nothing: it needs the whole.
  [[nodiscard]] std::optional<gcode::Diagnostics> finish();

  [[nodiscard]] std::size_t blocks_read() const { return blocks_read_; }
  [[nodiscard]] bool unit_word_seen() const { return unit_word_seen_; }
  [[nodiscard]] bool is_whole() const { return is_whole_; }

 private:
  Next read_all();
  void close_behind_marks(gcode::Program& part) const;

  const gcode::SourceText* source_;
  PartReading reading_;
  bool is_whole_;
  PartTexts texts_;
  PartMeanings meanings_;
  gcode::Diagnostics of_whole_;
  gcode::ReadPart held_;
  std::size_t blocks_read_ = 0;
  bool unit_word_seen_ = false;
  gcode::SourceSpan taken_;  // bytes of the last blocks that were taken
};

}  // namespace batten::postproc
