#include "postproc/machine/models/stream_limit.h"

#include <algorithm>
#include <cmath>
#include <vector>

namespace batten::postproc {

void limit_by_stream(std::span<TimedPiece> pieces, const Machine& machine) {
  if (!std::isfinite(machine.stream_rate)) return;
  const std::size_t n = pieces.size();
  std::vector<double> way(n + 1, 0.0);    // mm of the pieces before
  std::vector<double> bytes(n + 1, 0.0);  // of their blocks
  for (std::size_t i = 0; i < n; ++i) {
    way[i + 1] = way[i] + geometry::length_of(pieces[i].piece);
    bytes[i + 1] = bytes[i] + pieces[i].bytes;
  }
  const auto half = static_cast<std::size_t>(machine.look_ahead) / 2;
  for (std::size_t i = 0; i < n; ++i) {
    const std::size_t first = i > half ? i - half : 0;
    const std::size_t last = std::min(n, i + half + 1);
    const double sent = bytes[last] - bytes[first];
    if (!(sent > 0)) continue;
    const double pace = (way[last] - way[first]) / sent * machine.stream_rate;  // mm/s
    pieces[i].feed = std::min(pieces[i].feed, pace * 60);
  }
}

}  // namespace batten::postproc
