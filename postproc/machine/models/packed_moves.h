// Moves that are kept to be timed once more, in little memory.
#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "postproc/machine/models/timed_piece.h"

namespace batten::postproc {

// A value. Of a line that goes on from the one before it at its feed some 30 bytes, where a
// TimedPiece takes that of its greatest segment.
class PackedMoves {
 public:
  PackedMoves() = default;
  explicit PackedMoves(std::span<const TimedPiece> moves);

  [[nodiscard]] bool empty() const { return count_ == 0; }

  // The same moves, bit for bit.
  [[nodiscard]] std::vector<TimedPiece> unpacked() const;

 private:
  std::vector<std::byte> bytes_;
  std::size_t count_ = 0;
};

}  // namespace batten::postproc
