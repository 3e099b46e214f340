#include "postproc/report/page_path.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <optional>
#include <utility>

#include "geometry/basic/rounding.h"
#include "geometry/distance/band_comparison.h"
#include "geometry/distance/path_distance.h"
#include "postproc/report/page_speed.h"

namespace batten::postproc {
namespace {

using geometry::PathPiece;
using geometry::Point3;

// What is left out is nearer than this part of the tolerance to what is drawn: magnified so that
// the tolerance is 60 pixels wide, that is half a pixel.
constexpr double kDrawnWithin = 0.01;
constexpr double kSpeedWithin = 0.005;  // of the greatest speed
// Each round of thinning a path that is still too long is that much coarser.
constexpr double kCoarser = 4;
// mm: speed changes within a long line, so longer steps are cut, and what is too much thinned
// again.
constexpr double kLongestStep = 0.5;
constexpr std::size_t kMostCuts = 200;

// One of the two programs, and what is known along its motions.
struct PageSide {
  PageSide(const ReadProgram& program, const SpeedAlong& predicted)
      : read(program), events(list_events(program)), speed(predicted) {
    feeds.resize(read.interpretation->motions.size());
    for (const Cut& cut : events.cuts) feeds[cut.motion] = cut.feed.value_or(0);
  }

  [[nodiscard]] const gcode::Motion& motion(std::size_t i) const {
    return read.interpretation->motions[i];
  }
  [[nodiscard]] double speed_at(std::uint32_t m, double share) const {
    return speed ? speed(m, share) : 0;
  }
  [[nodiscard]] bool is_cut(std::size_t i) const { return feeds[i].has_value(); }
  [[nodiscard]] std::uint32_t line(std::size_t i) const {
    return read.program->blocks[motion(i).block].line;
  }
  // The cuts of a range of blocks.
  [[nodiscard]] std::vector<std::uint32_t> cuts_in(std::uint32_t first, std::uint32_t last) const {
    const auto block_of = [&](const Cut& cut) { return motion(cut.motion).block; };
    std::vector<std::uint32_t> motions;
    for (auto cut = std::ranges::lower_bound(events.cuts, first, {}, block_of);
         cut != events.cuts.end() && block_of(*cut) <= last; ++cut) {
      motions.push_back(cut->motion);
    }
    return motions;
  }
  [[nodiscard]] geometry::Path path_of(const std::vector<std::uint32_t>& motions) const {
    geometry::Path path;
    path.reserve(motions.size());
    for (const std::uint32_t m : motions) path.push_back(motion(m).piece);
    return path;
  }

  ReadProgram read;
  ProgramEvents events;
  SpeedAlong speed;
  std::vector<std::optional<double>> feeds;  // of the motions that are cuts
};

// The motions that are in no stretch: those of the one program are those of the other, in order.
std::vector<std::uint32_t> copied_motions(
    const PageSide& side, const std::vector<std::pair<std::uint32_t, std::uint32_t>>& stretches) {
  std::vector<std::uint32_t> copied;
  std::size_t next = 0;
  for (std::uint32_t i = 0; i < side.feeds.size(); ++i) {
    const std::uint32_t block = side.motion(i).block;
    while (next < stretches.size() && stretches[next].second < block) ++next;
    const bool inside = next < stretches.size() && stretches[next].first <= block;
    if (!inside || !side.is_cut(i)) copied.push_back(i);
  }
  return copied;
}

class PagePathBuilder {
 public:
  PagePathBuilder(const ReadProgram& before, const ReadProgram& after,
                  const Verification& verification, std::span<const RunReport> runs,
                  const PagePathOptions& options)
      : old_(before, options.speed_before),
        new_(after, options.speed_after),
        verification_(verification),
        runs_(runs),
        options_(options) {
    for (const Stretch& s : verification.stretches) {
      old_stretches_.emplace_back(s.old_first_block, s.old_last_block);
      new_stretches_.emplace_back(s.new_first_block, s.new_last_block);
    }
  }

  PagePath build() {
    const auto old_copied = copied_motions(old_, old_stretches_);
    const auto new_copied = copied_motions(new_, new_stretches_);
    same_copied_ = old_copied.size() == new_copied.size();
    std::size_t stretch = 0;
    for (std::size_t k = 0; k < old_copied.size(); ++k) {
      const std::uint32_t block = old_.motion(old_copied[k]).block;
      while (stretch < old_stretches_.size() && old_stretches_[stretch].first < block) {
        add_stretch(stretch++);
      }
      add_copied(old_copied[k], same_copied_ ? new_copied[k] : 0);
    }
    while (stretch < old_stretches_.size()) add_stretch(stretch++);
    flush_copied();
    thin();
    return std::move(result_);
  }

 private:
  // --- copied moves ----------------------------------------------------------------------------

  void add_copied(std::uint32_t old_motion, std::uint32_t new_motion) {
    const gcode::Motion& motion = old_.motion(old_motion);
    if (!motion.start_known || !motion.end_known) {
      flush_copied();
      return;
    }
    if (motion.kind != gcode::MotionKind::kRapid) {
      chain_.push_back(motion.piece);
      chain_motions_.emplace_back(old_motion, new_motion);
      return;
    }
    flush_copied();
    PageVertex end = vertex_at(motion.piece.end(), old_motion);
    end.new_line = same_copied_ ? new_.line(new_motion) : 0;
    end.step = PageStep::kRapid;
    start_at(motion.piece.start(), end);
    result_.vertices.push_back(end);
  }

  void flush_copied() {
    const ChainCurvature curvature(chain_);
    for (std::size_t i = 0; i < chain_.size(); ++i) add_copied_cut(i, curvature);
    chain_.clear();
    chain_motions_.clear();
  }

  void add_copied_cut(std::size_t i, const ChainCurvature& curvature) {
    const PathPiece& piece = chain_[i];
    const auto [old_motion, new_motion] = chain_motions_[i];
    const std::size_t parts = parts_of(piece);
    for (std::size_t k = 0; k <= parts; ++k) {
      const double t = static_cast<double>(k) / static_cast<double>(parts);
      PageVertex v = vertex_at(geometry::point_at(piece, t), old_motion);
      v.step = PageStep::kCopied;
      v.new_line = same_copied_ ? new_.line(new_motion) : 0;
      v.feed = old_.feeds[old_motion].value_or(0);
      v.curvature_before = v.curvature_after = curvature.at(i, v.place);
      v.speed_before = old_.speed_at(old_motion, t);
      v.speed_after = same_copied_ ? new_.speed_at(new_motion, t) : 0;
      if (k == 0) {
        start_at(v.place, v);
      } else {
        result_.vertices.push_back(v);
      }
    }
  }

  // Chords of an arc that nobody can tell from it, and steps of lines that are not too long.
  [[nodiscard]] std::size_t parts_of(const PathPiece& piece) const {
    const double bend = geometry::second_derivative_bound(piece) / 8 / (options_.tolerance_mm / 2);
    const double steps = std::max(std::sqrt(bend), geometry::length_of(piece) / kLongestStep);
    return std::clamp<std::size_t>(static_cast<std::size_t>(std::ceil(steps)), 1, kMostCuts);
  }

  // --- rewritten moves ------------------------------------------------------------------------

  void add_stretch(std::size_t index) {
    flush_copied();
    const auto [old_first, old_last] = old_stretches_[index];
    const auto [new_first, new_last] = new_stretches_[index];
    const auto old_motions = old_.cuts_in(old_first, old_last);
    const auto new_motions = new_.cuts_in(new_first, new_last);
    const geometry::Path before = old_.path_of(old_motions);
    const geometry::Path after = new_.path_of(new_motions);
    const bool band = options_.kind == geometry::ToleranceKind::kBand;
    const geometry::PathMatching matching =
        band ? geometry::match_in_band(before, after, options_.tolerance_mm)
             : geometry::match_paths(before, after, options_.tolerance_mm);
    // The same paths give the same matching. They are not the same where one of them is empty: a
    // stretch then names a block beside it.
    const auto& proved = verification_.stretches[index].comparison;
    if (before.empty() || after.empty() ||
        matching.comparison.bounds.at_most != proved.bounds.at_most) {
      ++result_.stretches_not_shown;
      return;
    }
    ++result_.stretches;
    result_.pairs += matching.pairs.size();
    add_pairs(matching.pairs, {old_motions, before}, {new_motions, after});
  }

  struct Moves {
    const std::vector<std::uint32_t>& motions;
    const geometry::Path& path;
  };

  void add_pairs(const std::vector<geometry::PlacePair>& pairs, const Moves& before,
                 const Moves& after) {
    const ChainCurvature old_curvature(before.path);
    const ChainCurvature new_curvature(after.path);
    const auto add = [&](const geometry::PlacePair& pair, PageStep step) {
      const std::uint32_t old_motion = before.motions[pair.piece_a];
      const std::uint32_t new_motion = after.motions[pair.piece_b];
      PageVertex v = vertex_at(pair.a, old_motion);
      v.offset = pair.b - pair.a;
      v.step = step;
      v.new_line = new_.line(new_motion);
      v.feed = old_.feeds[old_motion].value_or(0);
      v.curvature_before = old_curvature.at(pair.piece_a, pair.a);
      v.curvature_after = new_curvature.at(pair.piece_b, pair.b);
      v.speed_before = old_.speed_at(old_motion, share_of_piece(before.path[pair.piece_a], pair.a));
      v.speed_after = new_.speed_at(new_motion, share_of_piece(after.path[pair.piece_b], pair.b));
      result_.vertices.push_back(v);
    };
    for (std::size_t k = 0; k < pairs.size(); ++k) {
      if (k == 0) {
        add(pairs[k], PageStep::kNone);
        continue;
      }
      const auto parts = static_cast<std::size_t>(
          std::clamp(std::ceil((pairs[k].a - pairs[k - 1].a).norm() / kLongestStep), 1.0,
                     static_cast<double>(kMostCuts)));
      for (std::size_t part = 1; part < parts; ++part) {
        const double share = static_cast<double>(part) / static_cast<double>(parts);
        // The step into pair k runs on its pieces.
        add({pairs[k].piece_a, pairs[k].piece_b, (1 - share) * pairs[k - 1].a + share * pairs[k].a,
             (1 - share) * pairs[k - 1].b + share * pairs[k].b},
            PageStep::kRewritten);
      }
      add(pairs[k], PageStep::kRewritten);
    }
  }

  // --- all ------------------------------------------------------------------------------------

  [[nodiscard]] PageVertex vertex_at(const Point3& place, std::uint32_t old_motion) const {
    PageVertex v;
    v.place = place;
    v.old_line = old_.line(old_motion);
    v.run = run_at(v.old_line);
    return v;
  }

  [[nodiscard]] std::int32_t run_at(std::uint32_t line) const {
    const auto next = std::ranges::upper_bound(runs_, line, {}, &RunReport::first_line);
    if (next == runs_.begin() || (next - 1)->last_line < line) return -1;
    return static_cast<std::int32_t>(next - runs_.begin()) - 1;
  }

  // A chain goes on where it stands; elsewhere a new one begins.
  void start_at(const Point3& place, const PageVertex& next) {
    if (!result_.vertices.empty()) {
      const PageVertex& last = result_.vertices.back();
      if ((last.place - place).norm() <= geometry::kSamePlace && last.offset.isZero()) return;
    }
    PageVertex start = next;
    start.place = place;
    start.step = PageStep::kNone;
    result_.vertices.push_back(start);
  }

  void thin() {
    double fastest = 0;
    for (const PageVertex& v : result_.vertices) {
      fastest = std::max({fastest, v.speed_before, v.speed_after});
    }
    Thinning thinning{kDrawnWithin * options_.tolerance_mm, kSpeedWithin * fastest};
    result_.vertices = thinned(result_.vertices, thinning);
    constexpr int kMostRounds = 12;
    for (int i = 0; i < kMostRounds && result_.vertices.size() > options_.most_vertices; ++i) {
      thinning.error *= kCoarser;
      thinning.speed_error *= 2;
      result_.vertices = thinned(result_.vertices, thinning);
    }
    result_.drawn_within = thinning.error;
  }

  PageSide old_;
  PageSide new_;
  const Verification& verification_;
  std::span<const RunReport> runs_;
  PagePathOptions options_;
  std::vector<std::pair<std::uint32_t, std::uint32_t>> old_stretches_;
  std::vector<std::pair<std::uint32_t, std::uint32_t>> new_stretches_;
  bool same_copied_ = false;
  geometry::Path chain_;  // copied cuts that follow each other
  std::vector<std::pair<std::uint32_t, std::uint32_t>> chain_motions_;
  PagePath result_;
};

// --- fewer vertices that say the same --------------------------------------------------------

// As many vertices are left out in a row at the most: each step asks all of them again.
constexpr std::size_t kMostInARow = 64;

// Whether the vertices between two places of the list are on the straight way between them.
class StraightWay {
 public:
  StraightWay(const std::vector<PageVertex>& vertices, const Thinning& thinning)
      : vertices_(vertices), thinning_(thinning) {}

  [[nodiscard]] bool holds(std::size_t from, std::size_t to) const {
    const PageVertex& a = vertices_[from];
    const PageVertex& b = vertices_[to];
    const double whole = (b.place - a.place).norm();
    for (std::size_t i = from + 1; i < to; ++i) {
      const PageVertex& v = vertices_[i];
      const double share = whole > geometry::kSamePlace
                               ? (v.place - a.place).norm() / whole
                               : static_cast<double>(i - from) / static_cast<double>(to - from);
      if (share > 1 || !is_near(v, a, b, share)) return false;
    }
    return true;
  }

 private:
  [[nodiscard]] bool is_near(const PageVertex& v, const PageVertex& a, const PageVertex& b,
                             double share) const {
    const double rest = 1 - share;
    const auto near = [&](double value, double from, double to) {
      return std::abs(value - (rest * from + share * to)) <= thinning_.speed_error;
    };
    return (v.place - (rest * a.place + share * b.place)).norm() <= thinning_.error &&
           (v.offset - (rest * a.offset + share * b.offset)).norm() <= thinning_.error &&
           near(v.speed_before, a.speed_before, b.speed_before) &&
           near(v.speed_after, a.speed_after, b.speed_after);
  }

  const std::vector<PageVertex>& vertices_;
  const Thinning& thinning_;
};

// Whether the chain goes on behind the vertex as it came.
bool goes_on(const PageVertex& vertex, const PageVertex& next) {
  return vertex.step != PageStep::kNone && vertex.step == next.step && vertex.run == next.run &&
         vertex.feed == next.feed;
}

}  // namespace

PagePath page_path(const ReadProgram& before, const ReadProgram& after,
                   const Verification& verification, std::span<const RunReport> runs,
                   const PagePathOptions& options) {
  return PagePathBuilder(before, after, verification, runs, options).build();
}

std::vector<PageVertex> thinned(const std::vector<PageVertex>& vertices, const Thinning& thinning) {
  const StraightWay straight(vertices, thinning);
  std::vector<PageVertex> kept;
  if (vertices.empty()) return kept;
  kept.push_back(vertices.front());
  std::size_t from = 0;
  while (from + 1 < vertices.size()) {
    std::size_t to = from + 1;
    while (to + 1 < vertices.size() && to - from < kMostInARow &&
           goes_on(vertices[to], vertices[to + 1]) && straight.holds(from, to + 1)) {
      ++to;
    }
    kept.push_back(vertices[to]);
    from = to;
  }
  return kept;
}

namespace {

constexpr std::string_view kDigits =
    "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";

void append(std::int64_t number, std::string& bytes) {
  const auto shifted = static_cast<std::uint64_t>(number) << 1U;
  std::uint64_t rest = number < 0 ? ~shifted : shifted;
  while (rest > 0x7F) {
    bytes.push_back(static_cast<char>(0x80U | (rest & 0x7FU)));
    rest >>= 7U;
  }
  bytes.push_back(static_cast<char>(rest));
}

std::vector<std::int64_t> steps_of(const std::vector<std::int64_t>& numbers) {
  std::vector<std::int64_t> steps;
  steps.reserve(numbers.size());
  std::int64_t before = 0;
  for (const std::int64_t number : numbers) {
    steps.push_back(number - before);
    before = number;
  }
  return steps;
}

}  // namespace

std::string base64(std::string_view bytes) {
  std::string text;
  text.reserve((bytes.size() + 2) / 3 * 4);
  for (std::size_t i = 0; i < bytes.size(); i += 3) {
    const std::size_t count = std::min<std::size_t>(3, bytes.size() - i);
    std::uint32_t group = 0;
    for (std::size_t k = 0; k < 3; ++k) {
      const auto byte = k < count ? static_cast<unsigned char>(bytes[i + k]) : 0U;
      group = (group << 8U) | byte;
    }
    for (std::size_t k = 0; k < 4; ++k) {
      text.push_back(k <= count ? kDigits[(group >> (18U - 6U * k)) & 0x3FU] : '=');
    }
  }
  return text;
}

std::string packed(const std::vector<std::int64_t>& numbers) {
  std::string bytes;
  for (const std::int64_t number : numbers) append(number, bytes);
  return base64(bytes);
}

std::string packed_steps(const std::vector<std::int64_t>& numbers) {
  return packed(steps_of(numbers));
}

std::string packed_runs(const std::vector<std::int64_t>& numbers) {
  std::vector<std::int64_t> runs;
  for (std::size_t i = 0; i < numbers.size();) {
    std::size_t end = i;
    while (end < numbers.size() && numbers[end] == numbers[i]) ++end;
    runs.push_back(numbers[i]);
    runs.push_back(static_cast<std::int64_t>(end - i));
    i = end;
  }
  return packed(runs);
}

std::string packed_step_runs(const std::vector<std::int64_t>& numbers) {
  return packed_runs(steps_of(numbers));
}

}  // namespace batten::postproc
