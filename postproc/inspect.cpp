#include "postproc/inspect.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "geometry/numeric.h"
#include "geometry/path.h"
#include "postproc/runs/run_path.h"

namespace batten::postproc {

namespace {

using geometry::Vector3;

// In between, the mean of the two middle ones.
double median_of(std::vector<double> values) {
  const std::size_t middle = values.size() / 2;
  std::ranges::nth_element(values, values.begin() + static_cast<std::ptrdiff_t>(middle));
  const double upper = values[middle];
  if (values.size() % 2 == 1) return upper;
  return (upper +
          *std::max_element(values.begin(), values.begin() + static_cast<std::ptrdiff_t>(middle))) /
         2;
}

// atan2 keeps small turns exact where acos loses half of the digits.
double turn_in_degrees(const Vector3& from, const Vector3& to) {
  return std::atan2(from.cross(to).norm(), from.dot(to)) * 180 / std::numbers::pi;
}

bool moves(const gcode::Interpretation& interpretation, std::uint32_t block) {
  const std::int32_t motion = interpretation.blocks[block].motion;
  if (motion < 0) return false;
  const auto& piece = interpretation.motions[static_cast<std::size_t>(motion)].piece;
  return geometry::length_of(piece) > geometry::kSamePlace;
}

// The lines of the blocks that move, in order: one per segment of a run.
std::vector<std::uint32_t> lines_of_motions(const gcode::Program& program,
                                            const gcode::Interpretation& interpretation,
                                            const Section& section) {
  std::vector<std::uint32_t> lines;
  for (std::uint32_t block = section.first_block; block <= section.last_block; ++block) {
    if (moves(interpretation, block)) lines.push_back(program.blocks[block].line);
  }
  return lines;
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

void describe_run(const Run& run, const std::vector<std::uint32_t>& lines,
                  InspectedSection& section) {
  section.closed = run.closed;
  section.decimals = run.decimals;
  section.segments = segment_statistics(run, lines);
  if (run.feeds.empty()) return;
  const auto [least, greatest] = std::ranges::minmax(run.feeds, {}, &FeedFrom::feed);
  section.least_feed = least.feed;
  section.greatest_feed = greatest.feed;
}

}  // namespace

SegmentStatistics segment_statistics(const Run& run, const std::vector<std::uint32_t>& lines) {
  SegmentStatistics statistics;
  std::vector<double> lengths;
  Vector3 before = Vector3::Zero();
  for (const RunMotion& motion : motions_between(run, 0, run.points.size() - 1)) {
    const Vector3 start = geometry::direction_at(motion.piece, 0);
    const double turn = before.isZero() ? 0 : turn_in_degrees(before, start);
    if (turn > statistics.greatest_turn_deg) {
      statistics.greatest_turn_deg = turn;
      const std::size_t i = lengths.size();
      statistics.turn_line = i > 0 && i <= lines.size() ? lines[i - 1] : 0;
    }
    lengths.push_back(geometry::length_of(motion.piece));
    before = geometry::direction_at(motion.piece, 1);
  }
  if (lengths.empty()) return statistics;
  statistics.count = lengths.size();
  statistics.shortest = *std::ranges::min_element(lengths);
  statistics.longest = *std::ranges::max_element(lengths);
  for (const double length : lengths) statistics.length += length;
  statistics.median = median_of(std::move(lengths));
  return statistics;
}

std::vector<InspectedSection> inspect(const gcode::Program& program,
                                      const gcode::Interpretation& interpretation,
                                      const std::vector<Section>& sections) {
  std::vector<InspectedSection> inspected;
  for (const Section& section : sections) {
    InspectedSection description;
    description.first_line = program.blocks[section.first_block].line;
    description.last_line = program.blocks[section.last_block].line;
    description.blocks = section.last_block - section.first_block + 1;
    description.cutting_moves = cutting_moves_in(interpretation, section);
    if (const auto* verbatim = std::get_if<Verbatim>(&section.content)) {
      description.reason = verbatim->reason;
    } else {
      describe_run(std::get<Run>(section.content),
                   lines_of_motions(program, interpretation, section), description);
    }
    inspected.push_back(description);
  }
  return inspected;
}

}  // namespace batten::postproc
