// Words without a decimal point, on controls where X1000 may be 1000 least increments
// (gcode/text/language.h).
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>

#include "gcode/state/block_words.h"
#include "gcode/state/modal_state.h"
#include "gcode/text/diagnostic.h"
#include "gcode/text/language.h"
#include "gcode/text/program.h"

namespace batten::gcode {

// Goes through the blocks of a program and gives each number its value in the program's units.
//
// Lengths: X Y Z, U V W, I J K, R, Q. No lengths are the numbers of a dwell (G4), of a macro call
// (G65, G66), of the high speed modes (G5 P, G5.1 Q), the repeats K of a cycle, and codes, counts
// and angles everywhere. Zero is zero.
//
// F keeps its number: how a feed without a point is counted is said by another parameter. Its word
// is marked, so that such a feed is written without a point again.
class DecimalPoints {
 public:
  DecimalPoints() = default;
  // `units` are those of a program that names none.
  DecimalPoints(const Decimals& rule, Units units) : rule_(rule), units_(units) {}

  [[nodiscard]] const Decimals& rule() const { return rule_; }

  // The words of the next block that is understood as words. Returns whether a length among them
  // has no known value: it is no number then.
  bool read(std::span<Word> words);

  // One warning for all of them, at the first: implied-decimals.
  void tell(Diagnostics& found) const;

 private:
  enum class Mode : std::uint8_t { kPlain, kCycle, kCurve };

  void follow(const BlockWords& words);
  [[nodiscard]] bool is_length(char letter) const;
  void scale(Word& word) const;

  Decimals rule_;
  Units units_ = Units::kUnknown;
  Mode mode_ = Mode::kPlain;
  std::size_t unknown_ = 0;  // blocks
  Word first_unknown_;
};

}  // namespace batten::gcode
