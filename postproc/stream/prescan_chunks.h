// The parts of a long program as the first pass over it reads them. Text and meaning may be read by
// two threads: the meaning of one part while the text of the next one is read.
#pragma once

#include <cstdint>
#include <memory>

#include "gcode/reading/part_reading.h"
#include "gcode/text/diagnostic.h"
#include "gcode/text/program.h"
#include "gcode/text/source_text.h"
#include "postproc/options/options.h"
#include "postproc/runs/section.h"

namespace batten::postproc {

// A place of the text where reading may begin, and all that is known there.
struct ReadingPlace {
  gcode::TextCarry text;
  TextBefore before;
};

struct PrescanChunk {
  ReadingPlace begin;
  std::uint32_t end = 0;  // byte
  gcode::Program program;
  gcode::Interpretation meaning;
  bool needs_whole = false;  // the program is smoothed only as a whole; the rest says nothing then
};

// Cuts the text into parts of whole lines.
class ChunkReader {
 public:
  ChunkReader(const gcode::SourceText& source, const SmoothOptions& options);

  // The text of the next part and what it begins with: `begin.before` and `meaning` are not known
  // yet. Null behind the last one, and behind one that needs the whole.
  [[nodiscard]] std::shared_ptr<PrescanChunk> next();

  // Behind the last part: where the text ends, and what is told of all of it.
  [[nodiscard]] std::uint32_t end() const { return now_.begin; }
  [[nodiscard]] gcode::Diagnostics finish();

 private:
  [[nodiscard]] bool needs_whole(const gcode::Program& part) const;

  const gcode::SourceText& source_;
  const SmoothOptions& options_;
  gcode::TextCarry now_;
  gcode::Diagnostics found_;
  bool needs_whole_ = false;
};

// What the parts mean, one after the other.
class PartMeanings {
 public:
  explicit PartMeanings(const SmoothOptions& options);

  void add_to(PrescanChunk& part);

  // Behind the last part.
  [[nodiscard]] gcode::Diagnostics finish();

 private:
  [[nodiscard]] bool needs_whole(const gcode::Interpretation& meaning) const;

  gcode::ReadOptions read_options_;
  TextBefore now_;
  gcode::Diagnostics found_;
};

}  // namespace batten::postproc
