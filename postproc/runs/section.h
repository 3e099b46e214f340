// A program cut into runs, which may be rewritten, and the rest, which is copied.
#pragma once

#include <algorithm>
#include <cstdint>
#include <optional>
#include <string_view>
#include <variant>
#include <vector>

#include "gcode/interpreter/interpreter.h"
#include "gcode/reading/part_reading.h"
#include "gcode/state/motion.h"
#include "gcode/text/program.h"
#include "gcode/text/source_text.h"
#include "geometry/basic/point.h"
#include "geometry/path/path.h"
#include "postproc/machine/models/cycle_time.h"
#include "postproc/proof/program_events.h"

namespace batten::postproc {

// The feed from this vertex of the run on. The first entry is vertex 0.
struct FeedFrom {
  std::size_t vertex = 0;
  double feed = 0;  // mm/min
};

// A comment of the block that leads to this vertex (1 .., an end of a motion), or of a line of its
// own before that block.
struct CommentAt {
  std::size_t vertex = 0;
  gcode::SourceSpan text;
  bool behind_words = false;  // of the block, not on a line of its own
};

// A motion of the run that is an arc or belongs to a curve. The points from `first` to `last` lie
// on it, at even steps of its parameter; those between them are no ends of motions.
struct RunBend {
  std::size_t first = 0;  // vertices
  std::size_t last = 0;
  geometry::PathPiece piece = {};  // a Line only in a curve
  // A run may begin with it: its block says G2 or G3 itself, or begins the curve.
  bool can_start = true;
  bool goes_on = false;  // it is of the block of the bend before it
  float arcs = 0;        // of a piece of a curve: CurveMotion::arcs
};

// A chain of cutting moves, lines, arcs and curves, with unchanged state that may be rewritten
// together. Its first and last block are motions of some length, or belong to one curve with such a
// motion: blocks that say a curve together are all in the run. Between them may be motions of no
// length, lines that change only the feed or nothing, comments and empty lines. No block after it
// takes its motion word from an arc or a curve of it. Axes whose position is not known are 0 in all
// points: no block of it names them.
struct Run {
  std::vector<geometry::Point3> points;  // mm: start and end of every motion, and some of bends
  std::vector<RunBend> bends;            // in order
  double chord_error = 0;                // mm: no bend leaves the chords of its points by more
  std::vector<FeedFrom> feeds;           // each differs from the one before it; at ends of motions
  std::vector<CommentAt> comments;
  std::vector<std::size_t> speed_words;  // vertices: the block of the motion from there says S
  int decimals = 3;         // most digits after the point of its places: 4 of X.1234 in inches
  std::uint32_t state = 0;  // Interpretation::states before its first block
  bool closed = false;      // first and last point are one position
  // mm: the least that the program says for one of its motions; nothing where it says none.
  std::optional<double> stated_tolerance_mm = {};
};

// mm: how far the new path of a run may be from the old one, where the user allows so much.
[[nodiscard]] inline double tolerance_of(const Run& run, double user_mm) {
  return std::min(user_mm, run.stated_tolerance_mm.value_or(user_mm));
}

// Copied byte for byte.
struct Verbatim {
  std::string_view reason;  // why (gcode::reason); for mixed blocks the first one
};

struct Section {
  std::uint32_t first_block = 0;
  std::uint32_t last_block = 0;  // inclusive
  std::variant<Run, Verbatim> content;
};

// What a window takes over from the windows before it in one of the two texts.
struct TextBefore {
  gcode::ControlCarry control{gcode::Units::kUnknown};
  EventsBefore events = {};
};

struct WindowStart {
  EventsBefore old_events;
  TextBefore new_text;
  bool words_seen = false;  // gcode::TextCarry
  gcode::DecimalPoints decimals;
  bool same_as_old = false;  // the same is known of both texts
  // Where it begins, or ends, at a cut of a long run: the moves before and after it
  // (postproc/runs/run_cutting.h). Empty elsewhere.
  std::vector<TimedPiece> moves_before = {};
  std::vector<TimedPiece> moves_behind = {};
};

// What of a program is smoothed and proved at once: the whole, or a window of a long one.
struct ProgramPart {
  gcode::Program program;
  gcode::Interpretation meaning;
  std::optional<WindowStart> window = {};  // nothing: the whole
};

}  // namespace batten::postproc
