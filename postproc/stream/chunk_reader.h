// A long program read part by part, of which only those blocks are held that are still asked for.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>

#include "gcode/interpreter/interpreter.h"
#include "gcode/reading/part_reading.h"
#include "gcode/reading/source_kind.h"
#include "gcode/text/diagnostic.h"
#include "gcode/text/language.h"
#include "gcode/text/source_text.h"

namespace batten::postproc {

// How a program of the RS-274 family is read.
struct PartReading {
  gcode::SourceKind source = gcode::SourceKind::kAuto;
  gcode::Decimals decimals = {};
  gcode::DwellForm dwells = gcode::DwellForm::kUnknown;
  gcode::ReadOptions options = {};
};

struct PartLimits {
  std::size_t blocks = 8192;                        // of a part, at most
  std::size_t bytes = std::size_t{1} << 19;         // of a part, but for the rest of its last line
  std::size_t longest_line = std::size_t{1} << 20;  // bytes
};

// The blocks, motions and states, part behind part, are those of the whole, and so are the
// diagnostics at the end. Where they would not be it says that the program needs the whole: with
// errors of any kind, jumps, loops or subprograms, words outside the % marks, curves that are
// followed, marks of another source, lines that are too long or end without a line feed.
//
// A copy goes on from the same place.
class PartReader {
 public:
  // `source` must outlive the reader.
  PartReader(const gcode::SourceText& source, const PartReading& reading,
             const PartLimits& limits = {});

  enum class Next { kRead, kAtEnd, kNeedsWhole };
  // One part more behind the blocks that are held.
  [[nodiscard]] Next read_on();

  [[nodiscard]] const gcode::ReadPart& held() const { return held_; }
  [[nodiscard]] std::size_t blocks_held() const { return held_.program.blocks.size(); }

  // The first `count` blocks that are held, which then are held no longer. The bytes of those that
  // were taken before are given back (gcode::SourceText::release_pages).
  [[nodiscard]] gcode::ReadPart take(std::uint32_t count);

  // Of the whole program, at its end; nothing: it needs the whole.
  [[nodiscard]] std::optional<gcode::Diagnostics> finish();

  [[nodiscard]] std::size_t blocks_read() const { return text_.blocks; }
  [[nodiscard]] bool unit_word_seen() const { return control_.unit_word_seen; }

 private:
  void close_behind_marks(gcode::Program& part) const;
  [[nodiscard]] bool needs_whole(const gcode::ReadPart& part) const;

  const gcode::SourceText* source_;
  PartReading reading_;
  PartLimits limits_;
  gcode::TextCarry text_;
  gcode::ControlCarry control_;
  gcode::Diagnostics of_text_;
  gcode::Diagnostics of_meaning_;
  gcode::ReadPart held_;
  gcode::SourceSpan taken_;  // bytes of the last blocks that were taken
};

}  // namespace batten::postproc
