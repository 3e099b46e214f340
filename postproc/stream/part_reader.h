// Programs read part by part, of which only those blocks are held that are still needed. A
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
  gcode::Diagnostics of_language = {};  // reported when its language was found out
};

struct PartLimits {
  std::size_t blocks = 8192;                        // of a part, at most
  std::size_t bytes = std::size_t{1} << 19;         // of a part, but for the rest of its last line
  std::size_t longest_line = std::size_t{1} << 20;  // bytes
  std::size_t least_text = std::size_t{1} << 21;    // bytes: shorter programs are one part
};

// All of it at once.
[[nodiscard]] gcode::ReadPart read_whole(const gcode::SourceText& source,
                                         const PartReading& reading, gcode::Diagnostics& found);

// Where reading may begin, and all that is known there.
struct ReadingPlace {
  gcode::TextCarry text;
  TextBefore before;
};

struct PartOfText {
  ReadingPlace begin;
  std::uint32_t end = 0;  // byte
  gcode::ReadPart read;
  bool needs_whole = false;  // the rest says nothing then
};

// Cuts the text of a program of the RS-274 family, which must outlive it, into parts of whole
// lines. Text and meaning are two steps: a thread may read the next part while another one
// interprets this one.
class PartTexts {
 public:
  PartTexts(const gcode::SourceText& source, const PartReading& reading, const PartLimits& limits);

  // The text of the next part; `begin.before` and its meaning are not known yet. Null after the
  // last one, and after one that needs the whole.
  [[nodiscard]] std::shared_ptr<PartOfText> next();
  [[nodiscard]] const gcode::PercentMarkScanner& marks() const { return now_.marks; }

  // After the last part: where the text ends, and the diagnostics of all of it.
  [[nodiscard]] std::uint32_t end() const { return now_.begin; }
  [[nodiscard]] gcode::Diagnostics finish();

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

  void add_to(PartOfText& part);              // also the control of `begin.before`, but no events
  [[nodiscard]] gcode::Diagnostics finish();  // after the last part

 private:
  [[nodiscard]] bool needs_whole(const gcode::Interpretation& meaning) const;

  gcode::ReadOptions options_;
  gcode::ControlCarry now_;
  gcode::Diagnostics found_;
};

// The blocks, motions and states, part after part, are those of the whole, and so are the
// diagnostics at the end. Where they would not be, the program needs the whole: with errors of any
// kind, jumps, loops or subprograms, words outside the % marks, curves that are followed, marks of
// another source, lines that are too long or end without a line feed. A copy goes on from the same
// position.
class PartReader {
 public:
  // `source` must outlive the reader. `as_whole`, else in parts: of the RS-274 family only.
  PartReader(const gcode::SourceText& source, const PartReading& reading, const PartLimits& limits,
             bool as_whole);

  enum class Next { kRead, kAtEnd, kNeedsWhole };
  // One part more after the blocks that are held; the whole, which then is at its end.
  [[nodiscard]] Next read_on();

  [[nodiscard]] const gcode::ReadPart& held() const { return held_; }
  [[nodiscard]] std::uint32_t blocks_held() const {
    return static_cast<std::uint32_t>(held_.program.blocks.size());
  }

  // The first `count` blocks that are held, of a whole all of them, which then are held no longer.
  // Gives back the bytes of those that were taken before (gcode::SourceText::release_pages).
  [[nodiscard]] gcode::ReadPart take(std::uint32_t count);

  // Of the whole program, at its end; nothing: it needs the whole.
  [[nodiscard]] std::optional<gcode::Diagnostics> finish();

  [[nodiscard]] std::size_t blocks_read() const { return blocks_read_; }
  [[nodiscard]] bool unit_word_seen() const { return unit_word_seen_; }
  [[nodiscard]] bool is_whole() const { return is_whole_; }

 private:
  void add(gcode::ReadPart part);

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
