#include "postproc/runs/run_cutting.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <span>
#include <utility>

#include "geometry/basic/rounding.h"

namespace batten::postproc {

namespace {

using geometry::Point3;

// Inside an arc, or before one that takes its G2 or G3 from the block before it.
constexpr Fitness kNoPlace{-1, 0};

// The part of a run between two ends of its motions.
Run part_of(const Run& run, std::size_t first, std::size_t last) {
  Run part;
  const auto at = [&](std::size_t i) {
    return run.points.begin() + static_cast<std::ptrdiff_t>(i);
  };
  part.points.assign(at(first), at(last + 1));
  for (const RunArc& arc : run.arcs) {
    if (arc.first < first || arc.last > last) continue;
    part.arcs.push_back({arc.first - first, arc.last - first, arc.arc, arc.names_motion});
  }
  if (!part.arcs.empty()) part.chord_error = run.chord_error;
  for (const FeedFrom& from : run.feeds) {
    if (from.vertex >= last) break;
    if (from.vertex <= first) part.feeds.clear();
    part.feeds.push_back({from.vertex <= first ? 0 : from.vertex - first, from.feed});
  }
  for (const CommentAt& comment : run.comments) {
    if (comment.vertex <= first || comment.vertex > last) continue;
    part.comments.push_back({comment.vertex - first, comment.text});
  }
  part.decimals = run.decimals;
  part.closed = (part.points.front() - part.points.back()).norm() <= geometry::kSamePlace;
  return part;
}

bool moves(const gcode::Interpretation& read, std::uint32_t block) {
  const std::int32_t motion = read.blocks[block].motion;
  if (motion < 0) return false;
  const gcode::MotionPath& path = read.motions[static_cast<std::size_t>(motion)].piece;
  return path.arc() != nullptr || (path.end() - path.start()).norm() > geometry::kSamePlace;
}

// The block that leads to each vertex of the run that ends a motion; that of vertex 0 is none of
// its blocks, and those within arcs have that of the arc.
std::vector<std::uint32_t> blocks_of_vertices(const Section& section, const Run& run,
                                              const gcode::Interpretation& read) {
  std::vector<std::uint32_t> blocks = {section.first_block};
  auto arc = run.arcs.begin();
  for (std::uint32_t b = section.first_block; b <= section.last_block; ++b) {
    if (!moves(read, b)) continue;
    const std::size_t start = blocks.size() - 1;
    const bool bends = arc != run.arcs.end() && arc->first == start;
    const std::size_t vertices = bends ? arc->last - arc->first : 1;
    blocks.insert(blocks.end(), vertices, b);
    if (bends) ++arc;
  }
  return blocks;
}

// By vertex: whether the run can be cut there.
std::vector<bool> cuttable(const Run& run) {
  std::vector<bool> can(run.points.size(), true);
  for (const RunArc& arc : run.arcs) {
    if (!arc.names_motion) can[arc.first] = false;
    for (std::size_t i = arc.first + 1; i < arc.last; ++i) can[i] = false;
  }
  return can;
}

}  // namespace

std::vector<std::size_t> cut_places(const Run& run, const CuttingOptions& options) {
  const std::span<const Point3> points = run.points;
  const std::vector<bool> can = cuttable(run);
  const auto split_score_of = [&](std::size_t i) {
    return can[i] ? split_score_at(points[i - 1], points[i], points[i + 1]) : kNoPlace;
  };
  std::vector<std::size_t> places;
  std::size_t from = 0;
  // The rest is not cut when its pieces would be too short.
  while (points.size() - 1 - from > options.longest) {
    const std::size_t end = points.size() - 1 - options.shortest;
    std::size_t best = from + options.shortest;
    Fitness best_split_score = split_score_of(best);
    for (std::size_t i = best + 1; i <= end; ++i) {
      // Further than that only where nothing else can be cut.
      if (i > from + options.longest && can[best]) break;
      const Fitness split_score = split_score_of(i);
      if (split_score < best_split_score) continue;  // of equals the last: fewer pieces
      best_split_score = split_score;
      best = i;
    }
    if (!can[best]) break;
    places.push_back(best);
    from = best;
  }
  return places;
}

std::vector<RunPiece> cut_run(const Section& section, const gcode::Interpretation& interpretation,
                              const CuttingOptions& options) {
  const Run& run = std::get<Run>(section.content);
  const std::vector<std::uint32_t> blocks = blocks_of_vertices(section, run, interpretation);
  std::vector<RunPiece> pieces;
  std::size_t first = 0;
  std::uint32_t first_block = section.first_block;
  const auto add = [&](std::size_t last, std::uint32_t last_block) {
    Run part = part_of(run, first, last);
    part.state = first == 0 ? run.state : interpretation.blocks[first_block - 1].state_after;
    pieces.push_back({{first_block, last_block, std::move(part)}, first, last});
    first = last;
    first_block = last_block + 1;
  };
  for (const std::size_t place : cut_places(run, options)) {
    if (blocks[place + 1] == blocks[place] + 1) add(place, blocks[place]);
  }
  add(run.points.size() - 1, section.last_block);
  return pieces;
}

namespace {

// The machine stops at a reversal anyway.
constexpr double kTurnsBack = 170 * std::numbers::pi / 180;

// At a corner like this the machine slows down whether it is rounded or not; raster rows end so.
constexpr double kSharp = 60 * std::numbers::pi / 180;

// A line that was cut into blocks does not turn between them, but for rounding.
constexpr double kNoTurn = 1e-6;

}  // namespace

Fitness split_score_at(const geometry::Point3& before, const geometry::Point3& at,
                       const geometry::Point3& after) {
  const geometry::Vector3 a = at - before;
  const geometry::Vector3 b = after - at;
  const double turn = std::atan2(a.cross(b).norm(), a.dot(b));
  if (turn > kTurnsBack) return {3, 0};
  if (turn > kSharp) return {2, turn};
  if (turn <= kNoTurn) return {1, 0};
  return {0, -turn};
}

}  // namespace batten::postproc
