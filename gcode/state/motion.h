// What the blocks of a program do: motions in millimetres, and for every block whether it
// may stand inside a run of motions that is rewritten.
#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <span>
#include <variant>
#include <vector>

#include "gcode/state/modal_state.h"
#include "gcode/state/reason.h"
#include "gcode/text/program.h"
#include "geometry/basic/point.h"
#include "geometry/path/path.h"

namespace batten::gcode {

// A geometry::PathPiece in half its room: 56 bytes, and another 112 for an arc or a cubic piece.
// Copies are cheap for lines.
class MotionPath {
 public:
  MotionPath() = default;  // no length, at the origin
  MotionPath(const geometry::Line& line) : start_(line.start), end_(line.end) {}
  MotionPath(const geometry::PathPiece& piece)
      : start_(geometry::start_point(piece)), end_(geometry::end_point(piece)) {
    if (!std::holds_alternative<geometry::Line>(piece)) {
      bend_ = std::make_unique<const geometry::PathPiece>(piece);
    }
  }
  MotionPath(const geometry::Arc& arc) : MotionPath(geometry::PathPiece(arc)) {}

  MotionPath(const MotionPath& other) : start_(other.start_), end_(other.end_) {
    if (other.bend_ != nullptr) bend_ = std::make_unique<const geometry::PathPiece>(*other.bend_);
  }
  MotionPath& operator=(const MotionPath& other) { return *this = MotionPath(other); }
  MotionPath(MotionPath&&) noexcept = default;
  MotionPath& operator=(MotionPath&&) noexcept = default;
  ~MotionPath() = default;

  [[nodiscard]] const geometry::Point3& start() const { return start_; }
  [[nodiscard]] const geometry::Point3& end() const { return end_; }
  [[nodiscard]] bool is_line() const { return bend_ == nullptr; }
  // nullptr where it is no arc.
  [[nodiscard]] const geometry::Arc* arc() const {
    return bend_ != nullptr ? std::get_if<geometry::Arc>(bend_.get()) : nullptr;
  }
  // nullptr where it is no cubic piece.
  [[nodiscard]] const geometry::CubicBezier* cubic() const {
    return bend_ != nullptr ? std::get_if<geometry::CubicBezier>(bend_.get()) : nullptr;
  }

  operator geometry::PathPiece() const {
    return bend_ != nullptr ? *bend_ : geometry::PathPiece(geometry::Line{start_, end_});
  }

 private:
  geometry::Point3 start_ = geometry::Point3::Zero();
  geometry::Point3 end_ = geometry::Point3::Zero();
  std::unique_ptr<const geometry::PathPiece> bend_;  // an arc or a cubic piece
};

// mm: curves with weights, or of a degree above three, are read as cubic pieces that are nowhere
// farther from them. A thousandth of what a control resolves, for their number grows with it.
inline constexpr double kReadWithin = 1e-6;

enum class MotionKind : std::uint8_t {
  kRapid,  // G0
  kLine,   // G1
  kArc,    // G2, G3
  kCurve,  // a cubic piece of a curve that is read: ReadOptions::curves
};

struct Motion {
  std::uint32_t block = 0;  // index into Program::blocks
  MotionKind kind = MotionKind::kLine;
  // Every axis that the block names was known before it; for arcs both axes of the plane too.
  // Axes that are not known stand at 0 in `piece`, before and after: an axis that a 2D program
  // never names is a constant, and which one does not matter.
  bool start_known = false;
  // Every axis that the block names is known after it. False in G91 from an unknown place.
  bool end_known = false;
  std::array<bool, 3> axes_named = {false, false, false};  // X, Y, Z stand in the block
  std::uint8_t curve_decimals = 0;  // of kCurve: most digits after the point of the curve's places
  bool is_near = false;             // of kCurve: the curve is within kReadWithin of its pieces
  float arcs = 0;                   // of kCurve: CurveMotion::arcs
  // A Line for kRapid and kLine, an Arc for kArc, a CubicBezier or a Line for kCurve; absolute mm.
  MotionPath piece;
};

// What a block is, as far as grouping and checking are concerned.
enum class BlockKind : std::uint8_t {
  kEmpty,          // nothing, comments, N, or words that change nothing
  kMotion,         // one motion of MotionKind, and words that only describe it (F, G1) or change
                   // nothing
  kSettings,       // words that change the state or act (M, S, T, G54, an F alone ..), without a
                   // motion that can be followed (G28, cycles)
  kMotionAndMore,  // a motion with words that change the state or act in the same block
  kOpaque,         // not understood, not certain to be executed, or of an unknown state
};

struct BlockMeaning {
  BlockKind kind = BlockKind::kEmpty;
  // Why this block itself cannot be part of a run; empty where it can (see reason.h). The state
  // may still forbid it. Empty also for blocks without motion that may stand inside a run and
  // vanish with it: empty lines, comments, and words that change nothing or the feed only.
  ReasonId barrier;
  bool label_referenced = false;  // its N number is the target of GOTO, P, M97, M99 ..
  // Before this block the state and place are not what the block before it left: control can
  // come from elsewhere (a label that is jumped to).
  bool entered_from_elsewhere = false;
  // One of the blocks that say a curve together, which is read. Each of its pieces is a motion of
  // one of them, which may have several: motions_of. `barrier` is reason::kSpline: they are no
  // blocks that act each for itself, and stay or are rewritten together.
  bool of_curve = false;
  bool begins_curve = false;      // the first of them
  std::int32_t motion = -1;       // index into Interpretation::motions, the first; -1: none
  std::uint32_t state_after = 0;  // index into Interpretation::states
};

// A block that says another tolerance than held before it.
struct StatedAt {
  std::uint32_t block = 0;
  StatedTolerances stated;  // from it on
};

struct Interpretation {
  std::vector<BlockMeaning> blocks;  // one per block of the program
  std::vector<Motion> motions;       // in order
  std::vector<ModalState> states;    // states[0] is the state before the first block
  std::vector<StatedAt> stated;      // in order
  // G20 or G21 (or G70/G71 without parameters) stood somewhere, or --units was given.
  bool unit_word_seen = false;
};

// All that a block does: one, none, or of a curve several.
[[nodiscard]] std::span<const Motion> motions_of(const Interpretation& read, std::uint32_t block);

// mm: the least tolerance that the program says for a motion of these blocks, the last one
// included; nothing where it says none.
[[nodiscard]] std::optional<double> least_stated_mm(const Interpretation& read, std::uint32_t first,
                                                    std::uint32_t last);

}  // namespace batten::gcode
