#include "postproc/stream/inspect.h"

#include <algorithm>
#include <utility>
#include <variant>

#include "geometry/basic/rounding.h"
#include "geometry/path/path.h"

namespace batten::postproc {

namespace {

bool moves(const gcode::Interpretation& interpretation, std::uint32_t block) {
  const std::int32_t motion = interpretation.blocks[block].motion;
  if (motion < 0) return false;
  const gcode::MotionPath& path = interpretation.motions[static_cast<std::size_t>(motion)].piece;
  const double length =
      path.is_line() ? (path.end() - path.start()).norm() : geometry::length_of(path);
  return length > geometry::kSamePlace;
}

// The line of the section's block that moves, counted from 1 among those that do; 0 for none.
std::uint32_t line_of_motion(std::size_t number, const gcode::Program& program,
                             const gcode::Interpretation& interpretation, const Section& section) {
  std::size_t left = number;
  for (std::uint32_t b = section.first_block; left > 0 && b <= section.last_block; ++b) {
    if (moves(interpretation, b) && --left == 0) return program.blocks[b].line;
  }
  return 0;
}

std::size_t cutting_moves_in(const gcode::Interpretation& interpretation, const Section& section) {
  std::size_t count = 0;
  for (std::uint32_t block = section.first_block; block <= section.last_block; ++block) {
    const std::int32_t motion = interpretation.blocks[block].motion;
    if (motion < 0) continue;
    if (interpretation.motions[static_cast<std::size_t>(motion)].kind !=
        gcode::MotionKind::kRapid) {
      ++count;
    }
  }
  return count;
}

InspectedSection described(const gcode::Program& program,
                           const gcode::Interpretation& interpretation, const Section& section) {
  InspectedSection description;
  description.first_line = program.blocks[section.first_block].line;
  description.last_line = program.blocks[section.last_block].line;
  description.blocks = section.last_block - section.first_block + 1;
  description.cutting_moves = cutting_moves_in(interpretation, section);
  if (const auto* verbatim = std::get_if<Verbatim>(&section.content)) {
    description.reason = verbatim->reason;
  }
  return description;
}

void add_feeds(const Run& run, bool first, InspectedSection& section) {
  if (run.feeds.empty()) return;
  const auto [least, greatest] = std::ranges::minmax(run.feeds, {}, &FeedFrom::feed);
  section.least_feed = first ? least.feed : std::min(section.least_feed, least.feed);
  section.greatest_feed = first ? greatest.feed : std::max(section.greatest_feed, greatest.feed);
}

}  // namespace

void Inspection::add(const gcode::Program& part, const gcode::Interpretation& meaning,
                     const std::vector<Section>& sections, bool goes_on) {
  for (const Section& section : sections) {
    if (!goes_on) {
      end_run();
      sections_.push_back(described(part, meaning, section));
    }
    if (const auto* run = std::get_if<Run>(&section.content)) {
      if (!goes_on) begin_run(*run);
      if (goes_on) {
        const InspectedSection more = described(part, meaning, section);
        sections_.back().blocks += more.blocks;
        sections_.back().cutting_moves += more.cutting_moves;
      }
      add_run(part, meaning, section);
    }
    goes_on = false;
  }
}

void Inspection::begin_run(const Run& run) {
  in_run_ = true;
  start_ = run.points.front();
  turn_line_ = 0;
  add_feeds(run, true, sections_.back());
}

void Inspection::add_run(const gcode::Program& part, const gcode::Interpretation& meaning,
                         const Section& section) {
  const Run& run = std::get<Run>(section.content);
  InspectedSection& description = sections_.back();
  const std::size_t motions_before = tally_.count();
  const std::size_t turn_before = tally_.turn_motion();
  tally_.add(run);
  const std::size_t turn = tally_.turn_motion();
  if (turn != turn_before) {
    // A piece ends with a block that moves.
    turn_line_ = turn == motions_before
                     ? description.last_line
                     : line_of_motion(turn - motions_before, part, meaning, section);
  }
  add_feeds(run, false, description);
  description.last_line = part.blocks[section.last_block].line;
  description.decimals = std::max(description.decimals, run.decimals);
  description.closed = (run.points.back() - start_).norm() <= geometry::kSamePlace;
}

void Inspection::end_run() {
  if (!in_run_) return;
  in_run_ = false;
  sections_.back().segments = tally_.take();
  sections_.back().segments.turn_line = turn_line_;
}

void Inspection::go_back_to(std::size_t size) {
  in_run_ = false;
  tally_ = {};
  sections_.resize(size);
}

std::vector<InspectedSection> Inspection::take() {
  end_run();
  return std::move(sections_);
}

std::vector<InspectedSection> inspect(const gcode::Program& program,
                                      const gcode::Interpretation& interpretation,
                                      const std::vector<Section>& sections) {
  Inspection inspection;
  inspection.add(program, interpretation, sections, false);
  return inspection.take();
}

}  // namespace batten::postproc
