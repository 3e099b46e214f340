#include "postproc/runs/run_blocks.h"

#include <algorithm>
#include <cmath>

#include "gcode/state/block_words.h"
#include "gcode/state/code_groups.h"
#include "gcode/state/reason.h"
#include "gcode/text/large_pages.h"
#include "geometry/basic/rounding.h"
#include "postproc/runs/run_path.h"

namespace batten::postproc {
namespace {

using gcode::BlockMeaning;
using gcode::MotionMode;
using geometry::Point3;

constexpr double kMmPerInch = 25.4;

// No coordinate is more than the distance: nearly always the first one that differs decides.
bool is_one_place(const Point3& a, const Point3& b) {
  for (int axis = 0; axis < 3; ++axis) {
    if (std::abs(a[axis] - b[axis]) > geometry::kSamePlace) return false;
  }
  return (a - b).norm() <= geometry::kSamePlace;
}

}  // namespace

const geometry::Arc* RunBlocks::arc(std::uint32_t block) const { return motion(block).piece.arc(); }

bool RunBlocks::moves(std::uint32_t block) const {
  const gcode::MotionPath& path = motion(block).piece;
  return path.arc() != nullptr || !is_one_place(path.start(), path.end());
}

RunBlocks::Heading RunBlocks::heading(std::uint32_t block) const {
  const gcode::MotionPath& path = motion(block).piece;
  const geometry::Vector3 way = path.end() - path.start();
  const bool along = std::abs(way.z()) > geometry::kSamePlace;
  if (const geometry::Arc* bend = path.arc()) {
    const bool about_z = std::abs(bend->axis.z()) > 1 - geometry::kSameDirection;
    return about_z && !along ? Heading::kInPlane : Heading::kOther;
  }
  const bool across =
      std::abs(way.x()) > geometry::kSamePlace || std::abs(way.y()) > geometry::kSamePlace;
  if (along && !across) return Heading::kAlongZ;
  return across && !along ? Heading::kInPlane : Heading::kOther;
}

bool RunBlocks::names_motion(std::uint32_t block) const {
  const gcode::BlockWords words(program_.words_of(program_.blocks[block]));
  return std::ranges::any_of(words.g_codes(), [](gcode::Code code) {
    return gcode::group_of_g(code) == gcode::CodeGroup::kMotion;
  });
}

bool RunBlocks::lends_arc_word(std::uint32_t block) const {
  const MotionMode mode = read_.states[read_.blocks[block].state_after].motion;
  if (mode != MotionMode::kClockwise && mode != MotionMode::kCounterclockwise) return false;
  for (std::uint32_t i = block + 1; i < read_.blocks.size(); ++i) {
    if (read_.blocks[i].kind == gcode::BlockKind::kEmpty) continue;
    if (names_motion(i)) return false;
    if (!says_only_functions(i)) return true;
  }
  return false;
}

// M, S, T words and the like: they do the same in any motion mode.
bool RunBlocks::says_only_functions(std::uint32_t block) const {
  const BlockMeaning& meaning = read_.blocks[block];
  if (meaning.kind == gcode::BlockKind::kOpaque || meaning.motion >= 0 ||
      meaning.label_referenced || meaning.entered_from_elsewhere ||
      meaning.barrier == gcode::reason::kSubprogram) {
    return false;
  }
  constexpr std::string_view kFunctions = "NFSTDHM";
  return std::ranges::all_of(program_.words_of(program_.blocks[block]),
                             [&](const gcode::Word& word) {
                               return kFunctions.find(word.letter) != std::string_view::npos;
                             });
}

PrintedMotion RunBlocks::printed(std::uint32_t block) const {
  const gcode::BlockWords words(program_.words_of(program_.blocks[block]));
  return {motion(block).piece, words.has('R')};
}

PrintedErrors RunBlocks::errors_of(std::span<const std::uint32_t> blocks) const {
  int of_places = 0;
  int of_centers = 0;
  for (const std::uint32_t block : blocks) {
    of_places = std::max(of_places, decimals(block, "XYZ"));
    of_centers = std::max(of_centers, decimals(block, "IJKR"));
  }
  const gcode::ModalState& state = read_.states[read_.blocks[blocks.front()].state_after];
  const double unit = state.units == gcode::Units::kInch ? kMmPerInch : 1;
  return {unit / 2 * std::pow(10.0, -of_places), unit / 2 * std::pow(10.0, -of_centers)};
}

// Most digits after the point among the block's words of these letters.
int RunBlocks::decimals(std::uint32_t block, std::string_view letters) const {
  int most = 0;
  for (const gcode::Word& word : program_.words_of(program_.blocks[block])) {
    for (const char letter : letters) {
      if (word.letter == letter) most = std::max(most, static_cast<int>(word.decimals));
    }
  }
  return most;
}

Run RunBlocks::run_of(std::span<const std::uint32_t> blocks, double max_chord_error) const {
  Run run;
  run.state = blocks.front() == 0 ? 0 : read_.blocks[blocks.front() - 1].state_after;
  run.decimals = 0;
  gcode::reserve_in_large_pages(run.points, blocks.size() + 1);
  run.points.push_back(motion(blocks.front()).piece.start());
  std::size_t next = 0;
  std::size_t placed = 0;  // comments whose vertex is known
  for (std::uint32_t i = blocks.front(); i <= blocks.back(); ++i) {
    add_comments(i, run);
    if (blocks[next] != i) continue;
    ++next;
    if (!moves(i)) continue;  // its feed is still there at the next motion that moves
    add_motion(i, max_chord_error, run);
    for (; placed < run.comments.size(); ++placed) {
      run.comments[placed].vertex = run.points.size() - 1;
    }
  }
  run.closed = is_one_place(run.points.front(), run.points.back());
  return run;
}

void RunBlocks::add_motion(std::uint32_t block, double max_chord_error, Run& run) const {
  const double feed = *read_.states[read_.blocks[block].state_after].feed;
  if (run.feeds.empty() || run.feeds.back().feed != feed) {
    run.feeds.push_back({run.points.size() - 1, feed});
  }
  run.decimals = std::max(run.decimals, decimals(block, "XYZ"));
  if (const geometry::Arc* bend = arc(block)) {
    append_arc(*bend, names_motion(block), max_chord_error, run);
  } else {
    append_line(motion(block).piece.end(), run);
  }
}

// They belong to the vertex that the block leads to, or where it moves nothing the next one that
// does; the run ends with one.
void RunBlocks::add_comments(std::uint32_t block, Run& run) const {
  for (const gcode::Comment& comment : program_.comments_of(program_.blocks[block])) {
    run.comments.push_back({0, comment.span});
  }
}

}  // namespace batten::postproc
