#include "postproc/runs/run_cutting.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

#include "geometry/basic/rounding.h"
#include "postproc/runs/run_grouping.h"

namespace batten::postproc {

namespace {

using geometry::Point3;

// The part of a run between two ends of its motions.
Run part_of(const Run& run, std::size_t first, std::size_t last) {
  Run part;
  const auto at = [&](std::size_t i) {
    return run.points.begin() + static_cast<std::ptrdiff_t>(i);
  };
  part.points.assign(at(first), at(last + 1));
  for (const RunBend& bend : run.bends) {
    if (bend.first < first || bend.last > last) continue;
    part.bends.push_back({bend.first - first, bend.last - first, bend.piece, bend.can_start});
  }
  if (!part.bends.empty()) part.chord_error = run.chord_error;
  for (const FeedFrom& from : run.feeds) {
    if (from.vertex >= last) break;
    if (from.vertex <= first) part.feeds.clear();
    part.feeds.push_back({from.vertex <= first ? 0 : from.vertex - first, from.feed});
  }
  for (const CommentAt& comment : run.comments) {
    if (comment.vertex <= first || comment.vertex > last) continue;
    part.comments.push_back({comment.vertex - first, comment.text, comment.behind_words});
  }
  for (const std::size_t vertex : run.speed_words) {
    if (vertex >= first && vertex < last) part.speed_words.push_back(vertex - first);
  }
  part.decimals = run.decimals;
  part.stated_tolerance_mm = run.stated_tolerance_mm;
  part.closed = (part.points.front() - part.points.back()).norm() <= geometry::kSamePlace;
  return part;
}

// By vertex: whether the run can be cut there.
std::vector<bool> cuttable(const Run& run) {
  std::vector<bool> can(run.points.size(), true);
  for (const RunBend& bend : run.bends) {
    if (!bend.can_start) can[bend.first] = false;
    for (std::size_t i = bend.first + 1; i < bend.last; ++i) can[i] = false;
  }
  return can;
}

}  // namespace

const CutCandidate* best_cut(std::span<const CutCandidate> candidates, std::size_t furthest,
                             std::size_t end) {
  const CutCandidate* best = nullptr;
  for (const CutCandidate& candidate : candidates) {
    if (candidate.vertex > end || (best != nullptr && candidate.vertex > furthest)) break;
    if (best == nullptr || candidate.split_score >= best->split_score) best = &candidate;
  }
  return best;
}

std::vector<std::size_t> cut_places(const Run& run, const CuttingOptions& options) {
  const std::vector<Point3>& points = run.points;
  const std::vector<bool> can = cuttable(run);
  std::vector<CutCandidate> candidates;
  for (std::size_t i = options.shortest; i + options.shortest < points.size(); ++i) {
    if (can[i]) candidates.push_back({i, split_score_at(points[i - 1], points[i], points[i + 1])});
  }
  std::vector<std::size_t> places;
  std::size_t from = 0;
  // The rest is not cut when its pieces would be too short.
  while (points.size() - 1 - from > options.longest) {
    const auto first =
        std::ranges::lower_bound(candidates, from + options.shortest, {}, &CutCandidate::vertex);
    const CutCandidate* best = best_cut({first, candidates.end()}, from + options.longest,
                                        points.size() - 1 - options.shortest);
    if (best == nullptr) break;
    from = best->vertex;
    places.push_back(from);
  }
  return places;
}

std::vector<RunPiece> cut_run(const Section& section, const gcode::Interpretation& interpretation,
                              const CuttingOptions& options) {
  const Run& run = std::get<Run>(section.content);
  const std::vector<std::uint32_t> blocks = blocks_of_edges(section, interpretation);
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
    const std::uint32_t last = together_with(blocks[place - 1], interpretation).last;
    if (together_with(blocks[place], interpretation).first == last + 1) add(place, last);
  }
  add(run.points.size() - 1, section.last_block);
  return pieces;
}

namespace {

// The machine stops at a reversal anyway.
constexpr double kTurnsBack = 170 * std::numbers::pi / 180;

// At a corner like this the machine slows down whether it is rounded or not; raster rows end so.
constexpr double kSharp = 60 * std::numbers::pi / 180;

constexpr int kSharpCorner = 2;  // rank in a Fitness, and above it

// A line that was cut into blocks does not turn between them, but for rounding.
constexpr double kNoTurn = 1e-6;

}  // namespace

Fitness split_score_at(const geometry::Point3& before, const geometry::Point3& at,
                       const geometry::Point3& after) {
  const geometry::Vector3 a = at - before;
  const geometry::Vector3 b = after - at;
  const double turn = std::atan2(a.cross(b).norm(), a.dot(b));
  if (turn > kTurnsBack) return {3, 0};
  if (turn > kSharp) return {kSharpCorner, turn};
  if (turn <= kNoTurn) return {1, 0};
  return {0, -turn};
}

std::vector<LineRange> joined(std::vector<LineRange> ranges, std::span<const LineRange> others) {
  ranges.insert(ranges.end(), others.begin(), others.end());
  std::ranges::sort(ranges, {}, &LineRange::first);
  std::vector<LineRange> all;
  for (const LineRange& range : ranges) {
    if (all.empty() || range.first > all.back().last) {
      all.push_back(range);
    } else {
      all.back().last = std::max(all.back().last, range.last);
    }
  }
  return all;
}

std::size_t lines_in(std::span<const LineRange> ranges) {
  std::size_t lines = 0;
  for (const LineRange& range : ranges) lines += range.last - range.first + 1;
  return lines;
}

bool holds(std::span<const LineRange> ranges, std::uint32_t line) {
  const auto found = std::ranges::lower_bound(ranges, line, {}, &LineRange::last);
  return found != ranges.end() && found->first <= line;
}

void LongRunCuts::begin_part(const gcode::Program& program, const gcode::Interpretation& meaning) {
  program_ = &program;
  meaning_ = &meaning;
  states_.begin(meaning);
}

void LongRunCuts::take(std::uint32_t block) {
  const gcode::BlockMeaning& meaning = meaning_->blocks[block];
  if (!meaning.barrier.empty()) return end_run();
  if (meaning.motion < 0) {
    adjacent_ = false;
    return;
  }
  const gcode::Motion& motion = meaning_->motions[static_cast<std::size_t>(meaning.motion)];
  if (motion.kind != gcode::MotionKind::kLine || !motion.start_known ||
      !states_.reason(meaning.state_after).empty()) {
    return end_run();
  }
  take_move(block, motion);
}

void LongRunCuts::take_move(std::uint32_t block, const gcode::Motion& motion) {
  const RunBlocks blocks(*program_, *meaning_);
  if (!blocks.moves(block)) {
    adjacent_ = false;
    return;
  }
  const RunBlocks::Heading heading = blocks.heading(block);
  if (heading == RunBlocks::Heading::kAlongZ) {
    if (moves_ > 0) ++plunging_;  // else it is a plunge at the begin
    adjacent_ = false;
    return;
  }
  const bool flat = heading == RunBlocks::Heading::kInPlane;
  if (plunging_ > 0 && flat_ && flat) end_run();
  moves_ += std::exchange(plunging_, 0);
  add_move(block, motion.piece.start(), motion.piece.end());
  flat_ = flat;
}

void LongRunCuts::add_move(std::uint32_t block, const geometry::Point3& start,
                           const geometry::Point3& end) {
  const std::size_t from_corner = corners_.empty() ? 0 : corners_.back().vertex;
  const bool after_corner = moves_ >= from_corner + limits_.uncut_at_most / 2;
  if (adjacent_ && (moves_ >= from_ + limits_.shortest || after_corner)) {
    const gcode::Block& of_text = program_->blocks[block];
    const CutCandidate here{
        moves_, split_score_at(before_, start, end), {of_text.line, of_text.span.begin}};
    if (moves_ >= from_ + limits_.shortest) candidates_.push_back(here);
    if (after_corner && here.split_score.first >= kSharpCorner) corners_.push_back(here);
  }
  last_line_ = program_->blocks[block].line;
  if (moves_ == 0) first_line_ = last_line_;
  if (limits_.rewritten) {
    for (geometry::ClusterCover& cover : covers_) cover.add(start, end, last_line_);
  }
  ++moves_;
  before_ = start;
  adjacent_ = true;
  cut(false);
}

// A cut is certain where the run goes on after all positions that could be better.
void LongRunCuts::cut(bool run_ends) {
  const std::size_t room = limits_.longest + (run_ends ? 0 : limits_.shortest);
  while (moves_ - from_ > room && !candidates_.empty()) {
    const CutCandidate* best =
        best_cut(candidates_, from_ + limits_.longest, moves_ - limits_.shortest);
    if (best == nullptr) return;
    pending_.push_back(best->block);
    cut_lines_.push_back(best->block.line);
    from_ = best->vertex;
    std::erase_if(candidates_, [&](const CutCandidate& candidate) {
      return candidate.vertex < from_ + limits_.shortest;
    });
  }
  if (moves_ + 1 <= limits_.whole_at_most) return;
  found_.insert(found_.end(), pending_.begin(), pending_.end());
  pending_.clear();
}

void LongRunCuts::end_run() {
  if (moves_ > 0) cut(true);
  if (moves_ + 1 <= limits_.whole_at_most) cut_at_corners();
  if (!cut_lines_.empty() && limits_.rewritten) note_self_proximity();
  for (geometry::ClusterCover& cover : covers_) cover.clear();
  cut_lines_.clear();
  moves_ = plunging_ = from_ = 0;
  flat_ = adjacent_ = false;
  candidates_.clear();
  corners_.clear();
  pending_.clear();
}

void LongRunCuts::cut_at_corners() {
  cut_lines_.clear();
  if (moves_ + 1 <= limits_.uncut_at_most) return;
  for (const CutCandidate& corner : corners_) {
    if (corner.vertex + limits_.uncut_at_most / 2 > moves_) break;
    found_.push_back(corner.block);
    cut_lines_.push_back(corner.block.line);
  }
}

void LongRunCuts::note_self_proximity() {
  std::size_t axis = 2;
  for (const std::size_t other : {std::size_t{1}, std::size_t{0}}) {
    if (covers_[other].edges() > covers_[axis].edges()) axis = other;
  }
  const auto clusters = covers_[axis].clusters();
  if (!clusters) return;
  const double reach = geometry::reach_between_parts(tolerance_, tolerance_);
  auto near = geometry::clusters_near_other_parts(*clusters, cut_lines_, reach);
  if (near.empty()) return;
  near_.push_back({first_line_, last_line_, cut_lines_, static_cast<int>(axis), std::move(near)});
}

LongRuns find_long_runs(const gcode::Program& program, const gcode::Interpretation& meaning,
                        const LongRunLimits& limits, const GroupingOptions& grouping) {
  if (program.blocks.size() < std::min(limits.whole_at_most, limits.uncut_at_most)) return {};
  LongRunCuts cuts(limits, grouping);
  cuts.begin_part(program, meaning);
  for (std::uint32_t i = 0; i < program.blocks.size(); ++i) cuts.take(i);
  cuts.end_run();
  LongRuns long_runs;
  for (const LongRunCut& cut : cuts.found()) {
    long_runs.cuts.push_back(cut.line - program.blocks.front().line);
  }
  long_runs.near = cuts.self_proximity();
  return long_runs;
}

namespace {

bool ends_chain(const gcode::Interpretation& meaning, std::uint32_t block) {
  const gcode::BlockMeaning& of_block = meaning.blocks[block];
  return !of_block.barrier.empty() ||
         (of_block.motion >= 0 && !meaning.states[of_block.state_after].feed);
}

void add_move_of(std::uint32_t block, const gcode::Program& program,
                 const gcode::Interpretation& meaning, std::vector<TimedPiece>& moves) {
  const gcode::BlockMeaning& of_block = meaning.blocks[block];
  const RunBlocks blocks(program, meaning);
  if (of_block.motion < 0 || !blocks.moves(block)) return;
  for (const gcode::Motion& motion : blocks.motions(block)) {
    moves.push_back({motion.piece, *meaning.states[of_block.state_after].feed});
    moves.back().goes_on = &motion != &blocks.motion(block);
    moves.back().arcs = motion.arcs;
  }
  moves.back().says_speed = blocks.says_speed(block);
}

}  // namespace

std::vector<TimedPiece> moves_before(const gcode::Program& program,
                                     const gcode::Interpretation& meaning, std::uint32_t block,
                                     std::uint32_t from) {
  std::uint32_t first = block;
  while (first > from && block - first < kNeighbourBlocks && !ends_chain(meaning, first - 1))
    --first;
  std::vector<TimedPiece> moves;
  for (std::uint32_t i = first; i < block; ++i) add_move_of(i, program, meaning, moves);
  return moves;
}

std::vector<TimedPiece> moves_from(const gcode::Program& program,
                                   const gcode::Interpretation& meaning, std::uint32_t block,
                                   std::uint32_t end) {
  const auto all = static_cast<std::uint32_t>(program.blocks.size());
  const std::uint32_t last = std::min({all, end, block + kNeighbourBlocks});
  std::vector<TimedPiece> moves;
  for (std::uint32_t i = block; i < last && !ends_chain(meaning, i); ++i) {
    add_move_of(i, program, meaning, moves);
  }
  return moves;
}

}  // namespace batten::postproc
