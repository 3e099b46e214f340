#include "postproc/runs/long_run_cuts.h"

#include <algorithm>
#include <cstddef>
#include <utility>

#include "postproc/runs/run_grouping.h"

namespace batten::postproc {

namespace {

// The axis across which a cover is.
constexpr int axis_of(std::size_t cover) { return 2 - static_cast<int>(cover); }

}  // namespace

double cluster_width(double tolerance_mm) { return tolerance_mm; }

ProximityIndex::ProximityIndex(double tolerance_mm)
    : tolerance_(tolerance_mm),
      covers_{geometry::ClusterCover(axis_of(0), cluster_width(tolerance_mm)),
              geometry::ClusterCover(axis_of(1), cluster_width(tolerance_mm)),
              geometry::ClusterCover(axis_of(2), cluster_width(tolerance_mm))} {}

void ProximityIndex::add(const geometry::Point3& from, const geometry::Point3& to,
                         std::uint32_t line) {
  if (first_line_ == 0) first_line_ = line;
  last_line_ = line;
  for (geometry::ClusterCover& cover : covers_) cover.add(from, to, line);
}

void ProximityIndex::clear() {
  for (geometry::ClusterCover& cover : covers_) cover.clear();
  first_line_ = 0;
}

std::optional<SelfProximity> ProximityIndex::self_proximity(std::vector<std::uint32_t> cuts) const {
  std::size_t most = 0;
  for (std::size_t i = 1; i < covers_.size(); ++i) {
    if (covers_[i].edges() > covers_[most].edges()) most = i;
  }
  const auto clusters = covers_[most].clusters();
  if (!clusters) return std::nullopt;
  SelfProximity near{first_line_, last_line_, std::move(cuts), axis_of(most), {}};
  const double reach = geometry::reach_between_parts(cluster_width(tolerance_), tolerance_);
  near.clusters = geometry::clusters_near_other_parts(*clusters, near.cuts, reach);
  if (near.clusters.empty()) return std::nullopt;
  return near;
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
  asked_state_.reset();
}

bool LongRunCuts::is_unsafe(std::uint32_t state) {
  if (asked_state_ != state) {
    asked_state_ = state;
    unsafe_ = !unsafe_state(meaning_->states[state], grouping_).empty();
  }
  return unsafe_;
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
      is_unsafe(meaning.state_after)) {
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
  if (adjacent_ && moves_ >= from_ + limits_.shortest) {
    const gcode::Block& of_text = program_->blocks[block];
    candidates_.push_back(
        {moves_, split_score_at(before_, start, end), {of_text.line, of_text.span.begin}});
  }
  if (limits_.rewritten) clusters_.add(start, end, program_->blocks[block].line);
  ++moves_;
  before_ = start;
  adjacent_ = true;
  cut(false);
}

// As in cut_places: the best one up to `longest`, and further than that only where there is none.
// `end`: the last vertex that leaves enough behind it.
std::optional<LongRunCuts::Candidate> LongRunCuts::choice(std::size_t end) const {
  std::optional<Candidate> best;
  for (const Candidate& candidate : candidates_) {
    if (candidate.vertex > end) break;
    if (best && candidate.vertex > from_ + limits_.longest) break;
    if (!best || !(candidate.split_score < best->split_score)) best = candidate;
  }
  return best;
}

// A cut is certain where the run goes on behind all places that could be better.
void LongRunCuts::cut(bool run_ends) {
  const std::size_t room = limits_.longest + (run_ends ? 0 : limits_.shortest);
  while (moves_ - from_ > room && !candidates_.empty()) {
    const auto best = choice(moves_ - limits_.shortest);
    if (!best) return;
    pending_.push_back(best->place);
    cut_lines_.push_back(best->place.line);
    from_ = best->vertex;
    std::erase_if(candidates_, [&](const Candidate& candidate) {
      return candidate.vertex < from_ + limits_.shortest;
    });
  }
  if (moves_ + 1 <= limits_.whole_at_most) return;
  found_.insert(found_.end(), pending_.begin(), pending_.end());
  pending_.clear();
}

void LongRunCuts::end_run() {
  if (moves_ > 0) cut(true);
  if (moves_ + 1 > limits_.whole_at_most && !cut_lines_.empty() && limits_.rewritten) {
    if (auto near = clusters_.self_proximity(cut_lines_)) near_.push_back(std::move(*near));
  }
  clusters_.clear();
  cut_lines_.clear();
  moves_ = 0;
  plunging_ = 0;
  flat_ = false;
  adjacent_ = false;
  from_ = 0;
  candidates_.clear();
  pending_.clear();
}

void LongRunCuts::end() { end_run(); }

std::vector<LongRunCut> LongRunCuts::found() { return std::exchange(found_, {}); }

std::vector<SelfProximity> LongRunCuts::self_proximity() { return std::exchange(near_, {}); }

LongRuns find_long_runs(const gcode::Program& program, const gcode::Interpretation& meaning,
                        const LongRunLimits& limits, const GroupingOptions& grouping) {
  if (program.blocks.size() < limits.whole_at_most) return {};
  LongRunCuts cuts(limits, grouping);
  cuts.begin_part(program, meaning);
  for (std::uint32_t i = 0; i < program.blocks.size(); ++i) cuts.take(i);
  cuts.end();
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
  moves.push_back({blocks.motion(block).piece, *meaning.states[of_block.state_after].feed});
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
