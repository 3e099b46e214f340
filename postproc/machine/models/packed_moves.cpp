#include "postproc/machine/models/packed_moves.h"

#include <algorithm>
#include <cstdint>
#include <cstring>
#include <span>
#include <type_traits>
#include <variant>

namespace batten::postproc {
namespace {

using geometry::Point3;

// What a byte before each move says of it; its lowest bits are the kind of its segment.
enum Mark : std::uint8_t {
  kKind = 3,
  kGoesFromEnd = 4,  // of the move before it
  kSameFeed = 8,     // as the move before it
  kRapid = 16,
  kSaysSpeed = 32,
  kGoesOn = 64,
  kHasArcs = 128,
};

// The numbers of a segment behind its start, from where `see` reads them or where it writes them.
template <typename Piece, typename See>
void see_rest(Piece& piece, const See& see) {
  using Plain = std::remove_const_t<Piece>;
  if constexpr (std::is_same_v<Plain, geometry::CubicBezier>) {
    for (std::size_t i = 1; i < 4; ++i) see(piece.control[i]);
  } else {
    see(piece.end);
  }
  if constexpr (std::is_same_v<Plain, geometry::Arc>) {
    see(piece.center);
    see(piece.axis);
    see(piece.sweep);
  }
}

template <typename Value>
auto values_of(Value& value) {
  if constexpr (std::is_same_v<std::remove_const_t<Value>, Point3>) {
    return std::span(value.data(), 3);
  } else {
    return std::span(&value, 1);
  }
}

// Bit for bit: of two zeros each is itself.
template <typename Value>
bool is_same(const Value& a, const Value& b) {
  return std::ranges::equal(std::as_bytes(values_of(a)), std::as_bytes(values_of(b)));
}

}  // namespace

PackedMoves::PackedMoves(std::span<const TimedPiece> moves) : count_(moves.size()) {
  const auto put = [this](const auto& value) {
    const auto bytes = std::as_bytes(values_of(value));
    bytes_.insert(bytes_.end(), bytes.begin(), bytes.end());
  };
  const TimedPiece* before = nullptr;
  for (const TimedPiece& move : moves) {
    const Point3 start = geometry::start_point(move.piece);
    unsigned mark = static_cast<unsigned>(move.piece.index());
    if (before != nullptr && is_same(start, geometry::end_point(before->piece))) {
      mark |= kGoesFromEnd;
    }
    if (before != nullptr && is_same(before->feed, move.feed)) mark |= kSameFeed;
    if (move.rapid) mark |= kRapid;
    if (move.says_speed) mark |= kSaysSpeed;
    if (move.goes_on) mark |= kGoesOn;
    if (!is_same(move.arcs, 0.0F)) mark |= kHasArcs;
    put(static_cast<std::uint8_t>(mark));
    put(move.bytes);
    if ((mark & kSameFeed) == 0) put(move.feed);
    if ((mark & kHasArcs) != 0) put(move.arcs);
    if ((mark & kGoesFromEnd) == 0) put(start);
    std::visit([&](const auto& piece) { see_rest(piece, put); }, move.piece);
    before = &move;
  }
  bytes_.shrink_to_fit();
}

std::vector<TimedPiece> PackedMoves::unpacked() const {
  std::vector<TimedPiece> moves;
  moves.reserve(count_);
  const std::byte* next = bytes_.data();
  const auto take = [&next](auto& value) {
    const auto bytes = std::as_writable_bytes(values_of(value));
    std::memcpy(bytes.data(), next, bytes.size());
    next += bytes.size();
  };
  for (std::size_t i = 0; i < count_; ++i) {
    std::uint8_t mark = 0;
    take(mark);
    TimedPiece move;
    move.rapid = (mark & kRapid) != 0;
    move.says_speed = (mark & kSaysSpeed) != 0;
    move.goes_on = (mark & kGoesOn) != 0;
    take(move.bytes);
    if ((mark & kSameFeed) == 0) {
      take(move.feed);
    } else {
      move.feed = moves.back().feed;
    }
    if ((mark & kHasArcs) != 0) take(move.arcs);
    Point3 start = Point3::Zero();
    if ((mark & kGoesFromEnd) == 0) {
      take(start);
    } else {
      start = geometry::end_point(moves.back().piece);
    }
    switch (mark & kKind) {
      case 1:
        move.piece = geometry::Arc{start, start, start, start, 0};
        break;
      case 2:
        move.piece = geometry::CubicBezier{{start, start, start, start}};
        break;
      default:
        move.piece = geometry::Line{start, start};
    }
    std::visit([&](auto& piece) { see_rest(piece, take); }, move.piece);
    moves.push_back(std::move(move));
  }
  return moves;
}

}  // namespace batten::postproc
