#include "postproc/stream/part_crossings.h"

#include <algorithm>
#include <iterator>
#include <utility>

#include "gcode/state/motion.h"
#include "geometry/path/path.h"

namespace batten::postproc {

namespace {

using geometry::PartEdge;
using geometry::SegmentCluster;

// A new path is within the tolerance of the old one, and its chords within a hundredth of that.
constexpr double kTolerancesAway = 1.1;

void append(const std::vector<PartEdge>& more, std::vector<PartEdge>& edges) {
  edges.insert(edges.end(), more.begin(), more.end());
}

// The edges of one long run in the sections of a window.
class NearEdgeFinder {
 public:
  NearEdgeFinder(const ReadProgram& old, std::span<const Section> sections,
                 const std::optional<WrittenSections>& written, const SelfProximity& near,
                 double tolerance)
      : old_(old), sections_(sections), written_(written), near_(near), tolerance_(tolerance) {}

  void run(NearEdges& found) {
    for (std::size_t i = 0; i < sections_.size(); ++i) {
      const std::uint32_t first = line_of(sections_[i].first_block);
      const std::uint32_t last = line_of(sections_[i].last_block);
      if (last < near_.first_line || first > near_.last_line) continue;
      const auto clusters = clusters_in(first, last);
      if (clusters.empty()) continue;
      const std::vector<PartEdge> before = old_edges(sections_[i], clusters);
      const bool rewritten = written_ && std::holds_alternative<Run>(sections_[i].content);
      append(before, found.before);
      append(rewritten ? new_edges(i, clusters) : before, found.after);
    }
  }

 private:
  [[nodiscard]] std::uint32_t line_of(std::uint32_t block) const {
    return old_.program->blocks[block].line;
  }

  [[nodiscard]] std::span<const SegmentCluster> clusters_in(std::uint32_t first,
                                                            std::uint32_t last) const {
    const auto begin = std::ranges::lower_bound(near_.clusters, first, {}, &SegmentCluster::last);
    const auto end =
        std::ranges::upper_bound(begin, near_.clusters.end(), last, {}, &SegmentCluster::first);
    return {begin, end};
  }

  [[nodiscard]] std::vector<PartEdge> old_edges(const Section& section,
                                                std::span<const SegmentCluster> clusters) const {
    std::vector<PartEdge> edges;
    const std::uint32_t offset = old_.program->blocks.front().line;
    for (const SegmentCluster& cluster : clusters) {
      const std::uint32_t begin = std::max(section.first_block + offset, cluster.first) - offset;
      const std::uint32_t end = std::min(section.last_block + offset, cluster.last);
      for (std::uint32_t block = begin; block + offset <= end; ++block) {
        const std::int32_t motion = old_.interpretation->blocks[block].motion;
        if (motion < 0) continue;
        const gcode::Motion& move = old_.interpretation->motions[static_cast<std::size_t>(motion)];
        if (move.kind != gcode::MotionKind::kLine) continue;
        const geometry::PathPiece piece = move.piece;
        append(flat({&piece, 1}, line_of(block)), edges);
      }
    }
    return edges;
  }

  [[nodiscard]] std::vector<PartEdge> new_edges(std::size_t index,
                                                std::span<const SegmentCluster> clusters) const {
    const auto& motions = written_->read.interpretation->motions;
    const bool is_last = index + 1 == written_->begins.size();
    geometry::Path path;
    auto move =
        std::ranges::lower_bound(motions, written_->begins[index], {}, &gcode::Motion::block);
    for (; move != motions.end(); ++move) {
      if (!is_last && move->block >= written_->begins[index + 1]) break;
      if (move->kind != gcode::MotionKind::kRapid) path.push_back(move->piece);
    }
    const double distance = tolerance_ + kTolerancesAway * tolerance_;
    return geometry::edges_near(flat(path, line_of(sections_[index].first_block)), clusters,
                                distance);
  }

  [[nodiscard]] std::vector<PartEdge> flat(std::span<const geometry::PathPiece> path,
                                           std::uint32_t line) const {
    return geometry::flat_edges(path, near_.axis, tolerance_, line,
                                geometry::part_of(line, near_.cuts));
  }

  const ReadProgram& old_;
  std::span<const Section> sections_;
  const std::optional<WrittenSections>& written_;
  const SelfProximity& near_;
  double tolerance_;
};

bool follow_each_other(const SegmentCluster& a, const SegmentCluster& b,
                       const std::vector<std::uint32_t>& cuts) {
  return a.to == b.from && a.height == b.height &&
         geometry::part_of(a.last, cuts) == geometry::part_of(b.first, cuts);
}

// The clusters about a line that follow each other, as far as its part goes.
LineRange section_about(std::uint32_t line, const SelfProximity& near) {
  const auto& clusters = near.clusters;
  const std::uint32_t part = geometry::part_of(line, near.cuts);
  LineRange range{line, line};
  auto first = std::ranges::lower_bound(clusters, line, {}, &SegmentCluster::last);
  if (first != clusters.end() && first->first <= line) {
    auto last = first;
    while (first != clusters.begin() && follow_each_other(*std::prev(first), *first, near.cuts)) {
      --first;
    }
    while (std::next(last) != clusters.end() &&
           follow_each_other(*last, *std::next(last), near.cuts)) {
      ++last;
    }
    range = {first->first, last->last};
  }
  if (part > 0) range.first = std::max(range.first, near.cuts[part - 1]);
  if (part < near.cuts.size()) range.last = std::min(range.last, near.cuts[part] - 1);
  return range;
}

}  // namespace

std::vector<NearEdges> near_edges_of(const ReadProgram& old, std::span<const Section> sections,
                                     const std::optional<WrittenSections>& written,
                                     std::span<const SelfProximity> near, double tolerance_mm) {
  std::vector<NearEdges> all;
  if (old.program->blocks.empty()) return all;
  const std::uint32_t first = old.program->blocks.front().line;
  const std::uint32_t last = old.program->blocks.back().line;
  for (std::size_t i = 0; i < near.size(); ++i) {
    if (near[i].last_line < first || near[i].first_line > last) continue;
    NearEdges edges{i, {}, {}};
    NearEdgeFinder(old, sections, written, near[i], tolerance_mm).run(edges);
    if (!edges.before.empty()) all.push_back(std::move(edges));
  }
  return all;
}

void PartCrossings::take(std::vector<NearEdges> edges) {
  for (NearEdges& some : edges) {
    if (held_.empty() || held_.back().edges.run != some.run) held_.push_back({{some.run, {}, {}}});
    Held& held = held_.back();
    const std::size_t most = std::max(held.edges.before.size() + some.before.size(),
                                      held.edges.after.size() + some.after.size());
    if (held.too_many || most > kMostEdges) {
      held = {{some.run, {}, {}}, true};
    } else {
      append(some.before, held.edges.before);
      append(some.after, held.edges.after);
    }
  }
}

void PartCrossings::look_up_to(std::uint32_t line) {
  std::erase_if(held_, [&](const Held& held) {
    const SelfProximity& near = (*near_)[held.edges.run];
    if (near.last_line > line) return false;
    for (const geometry::PartCrossing& crossing :
         geometry::new_crossings_of_parts(held.edges.before, held.edges.after, tolerance_)) {
      for (const std::uint32_t at : crossing.labels) found_.push_back(section_about(at, near));
    }
    return true;
  });
}

std::vector<LineRange> more_to_copy(const std::vector<LineRange>& copied,
                                    const std::vector<LineRange>& found,
                                    std::span<const SelfProximity> near) {
  const auto is_copied = [&](const LineRange& range) {
    return holds(copied, range.first) && holds(copied, range.last);
  };
  std::vector<LineRange> more = found;
  if (std::ranges::all_of(found, is_copied)) {
    for (const SelfProximity& run : near) {
      const auto is_in_run = [&](const LineRange& range) {
        return range.first >= run.first_line && range.first <= run.last_line;
      };
      if (std::ranges::any_of(found, is_in_run)) more.push_back({run.first_line, run.last_line});
    }
  }
  return joined(std::move(more), copied);
}

}  // namespace batten::postproc
