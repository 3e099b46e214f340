#include "postproc/report/page_path.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <numeric>
#include <utility>

#include "geometry/basic/rounding.h"
#include "geometry/distance/band_comparison.h"
#include "geometry/distance/path_distance.h"
#include "postproc/machine/models/cycle_time.h"
#include "postproc/machine/models/jerk_motion.h"
#include "postproc/machine/models/velocity_profile.h"

namespace batten::postproc {
namespace {

using geometry::PathPiece;
using geometry::Point3;

// One of the two programs, and what is known along its motions.
struct PageSide {
  PageSide(const ReadProgram& program, const Machine* machine)
      : read(program), events(list_events(program)) {
    if (machine != nullptr) speeds.emplace(read, events, *machine);
    feeds.resize(read.interpretation->motions.size());
    for (const Cut& cut : events.cuts) feeds[cut.motion] = cut.feed.value_or(0);
  }

  [[nodiscard]] const gcode::Motion& motion(std::size_t i) const {
    return read.interpretation->motions[i];
  }
  [[nodiscard]] double speed_at(std::uint32_t m, double share) const {
    return speeds ? speeds->at(m, share) : 0;
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
  std::optional<ProgramSpeeds> speeds;       // nothing: not predicted
  std::vector<std::optional<double>> feeds;  // of the motions that are cuts
};

// The motions that are in no section: those of the one program are those of the other, in order.
std::vector<std::uint32_t> copied_motions(
    const PageSide& side, const std::vector<std::pair<std::uint32_t, std::uint32_t>>& sections) {
  std::vector<std::uint32_t> copied;
  std::size_t next = 0;
  for (std::uint32_t i = 0; i < side.feeds.size(); ++i) {
    const std::uint32_t block = side.motion(i).block;
    while (next < sections.size() && sections[next].second < block) ++next;
    const bool inside = next < sections.size() && sections[next].first <= block;
    if (!inside || !side.is_cut(i)) copied.push_back(i);
  }
  return copied;
}

class PagePathBuilder {
 public:
  PagePathBuilder(const ReadProgram& before, const ReadProgram& after,
                  const Verification& verification, std::span<const PageLines> rows,
                  const PagePathOptions& options)
      : old_(before, options.machine),
        new_(after, options.machine),
        verification_(verification),
        rows_(rows),
        options_(options) {
    for (const ComparedSection& s : verification.sections) {
      old_sections_.emplace_back(s.old_first_block, s.old_last_block);
      new_sections_.emplace_back(s.new_first_block, s.new_last_block);
    }
  }

  PagePath build() {
    const auto old_copied = copied_motions(old_, old_sections_);
    const auto new_copied = copied_motions(new_, new_sections_);
    same_copied_ = old_copied.size() == new_copied.size();
    std::size_t section = 0;
    for (std::size_t k = 0; k < old_copied.size(); ++k) {
      const std::uint32_t block = old_.motion(old_copied[k]).block;
      while (section < old_sections_.size() && old_sections_[section].first < block) {
        add_section(section++);
      }
      add_copied(old_copied[k], same_copied_ ? new_copied[k] : 0);
    }
    while (section < old_sections_.size()) add_section(section++);
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
    const double steps =
        std::max(std::sqrt(bend), geometry::length_of(piece) / kPageTuning.longest_step);
    return std::clamp<std::size_t>(static_cast<std::size_t>(std::ceil(steps)), 1,
                                   kPageTuning.most_cuts);
  }

  // --- rewritten moves ------------------------------------------------------------------------

  void add_section(std::size_t index) {
    flush_copied();
    const auto [old_first, old_last] = old_sections_[index];
    const auto [new_first, new_last] = new_sections_[index];
    const auto old_motions = old_.cuts_in(old_first, old_last);
    const auto new_motions = new_.cuts_in(new_first, new_last);
    const geometry::Path before = old_.path_of(old_motions);
    const geometry::Path after = new_.path_of(new_motions);
    const bool band = options_.kind == geometry::ToleranceKind::kBand;
    const geometry::PathMatching matching =
        band ? geometry::match_in_band(before, after, options_.tolerance_mm)
             : geometry::match_paths(before, after, options_.tolerance_mm);
    // The same paths give the same matching, but for long ones, which are proved part by part. They
    // are not the same where one of them is empty: a section then names a block beside it.
    constexpr double kNear = 0.02;  // of the tolerance: as far as bounds are from the truth
    const auto& proved = verification_.sections[index].comparison;
    const double apart = matching.comparison.bounds.at_most - proved.bounds.at_most;
    if (before.empty() || after.empty() ||
        !(std::abs(apart) <= kNear * verification_.sections[index].tolerance_mm)) {
      ++result_.sections_not_shown;
      return;
    }
    ++result_.sections;
    result_.pairs += matching.pairs.size();
    add_pairs(matching.pairs, {old_motions, before}, {new_motions, after});
    add_region(before, after, verification_.sections[index].tolerance_mm,
               options_.most_region_edges, result_.region);
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
          std::clamp(std::ceil((pairs[k].a - pairs[k - 1].a).norm() / kPageTuning.longest_step),
                     1.0, static_cast<double>(kPageTuning.most_cuts)));
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
    const auto next = std::ranges::upper_bound(rows_, line, {}, &PageLines::first_line);
    if (next == rows_.begin() || (next - 1)->last_line < line) return -1;
    return static_cast<std::int32_t>(next - rows_.begin()) - 1;
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
    Thinning thinning{kPageTuning.drawn_within * options_.tolerance_mm,
                      kPageTuning.speed_within * fastest_of(result_.vertices)};
    result_.vertices = thinned(result_.vertices, thinning);
    for (int i = 0; i < kPageTuning.most_rounds && result_.vertices.size() > options_.most_vertices;
         ++i) {
      thinning.error *= kPageTuning.coarser;
      thinning.speed_error *= 2;
      result_.vertices = thinned(result_.vertices, thinning);
    }
    result_.drawn_within = thinning.error;
  }

  PageSide old_;
  PageSide new_;
  const Verification& verification_;
  std::span<const PageLines> rows_;
  PagePathOptions options_;
  std::vector<std::pair<std::uint32_t, std::uint32_t>> old_sections_;
  std::vector<std::pair<std::uint32_t, std::uint32_t>> new_sections_;
  bool same_copied_ = false;
  geometry::Path chain_;  // copied cuts that follow each other
  std::vector<std::pair<std::uint32_t, std::uint32_t>> chain_motions_;
  PagePath result_;
};

// --- fewer vertices that say the same --------------------------------------------------------

// Whether the vertices between two of the list are on the straight way from the one to the other.
bool is_straight(const std::vector<PageVertex>& vertices, std::size_t from, std::size_t to,
                 const Thinning& thinning) {
  const PageVertex& a = vertices[from];
  const PageVertex& b = vertices[to];
  const double whole = (b.place - a.place).norm();
  for (std::size_t i = from + 1; i < to; ++i) {
    const PageVertex& v = vertices[i];
    const double share = whole > geometry::kSamePlace
                             ? (v.place - a.place).norm() / whole
                             : static_cast<double>(i - from) / static_cast<double>(to - from);
    const double rest = 1 - share;
    const auto differs = [&](double PageVertex::*speed) {
      return !(std::abs(v.*speed - (rest * a.*speed + share * b.*speed)) <= thinning.speed_error);
    };
    const bool is_near = (v.place - (rest * a.place + share * b.place)).norm() <= thinning.error &&
                         (v.offset - (rest * a.offset + share * b.offset)).norm() <= thinning.error;
    if (share > 1 || !is_near || differs(&PageVertex::speed_before) ||
        differs(&PageVertex::speed_after)) {
      return false;
    }
  }
  return true;
}

// Whether the chain goes on after the vertex as it came.
bool goes_on(const PageVertex& vertex, const PageVertex& next) {
  return vertex.step != PageStep::kNone && vertex.step == next.step && vertex.run == next.run &&
         vertex.feed == next.feed;
}

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

double between(double share, double from, double to) { return (1 - share) * from + share * to; }

// A control that joins lines and rounds corners runs a shorter way than the programmed one. Both
// are counted from the start of the chain, and meet at anchors.
class Ways {
 public:
  // `ends`: mm, programmed way at the end of each piece.
  Ways(const StretchChain& chain, const std::vector<double>& ends) {
    double planned = 0;
    for (std::size_t i = 0; i < chain.stretches.size(); ++i) {
      const StretchPlace& place = chain.places[i];
      const double length = chain.stretches[i].length;
      const bool last = i + 1 == chain.stretches.size();
      if (place.is_corner && place.last_piece > place.first_piece) {
        anchors_.push_back({planned + length / 2, ends[place.first_piece]});
      } else if (!last && chain.places[i + 1].first_piece > place.last_piece) {
        anchors_.push_back({planned + length, ends[place.last_piece]});
      }
      planned += length;
    }
    anchors_.push_back({planned, ends.back()});
  }

  // For planned ways that do not fall from call to call.
  [[nodiscard]] double programmed(double planned) {
    while (next_ + 1 < anchors_.size() && anchors_[next_].planned < planned) ++next_;
    const Anchor& a = anchors_[next_ - 1];
    const Anchor& b = anchors_[next_];
    const double whole = b.planned - a.planned;
    const double share = whole > 0 ? std::clamp((planned - a.planned) / whole, 0.0, 1.0) : 1;
    return between(share, a.programmed, b.programmed);
  }

 private:
  struct Anchor {
    double planned = 0;
    double programmed = 0;
  };

  std::vector<Anchor> anchors_ = {{0, 0}};
  std::size_t next_ = 1;
};

// Calls `use(way, speed)` in the order of the planned way: where speeds change their course.
template <typename Use>
void for_each_speed(const StretchChain& chain, const Use& use) {
  const std::vector<double> joints = joint_velocities(chain.stretches, chain.rules);
  std::optional<JerkMotion> with_jerk;
  if (has_jerk_limit(chain.stretches)) with_jerk.emplace(chain.stretches, joints, chain.rules);
  double way = 0;
  for (std::size_t i = 0; i < chain.stretches.size(); ++i) {
    const VelocityStretch& s = chain.stretches[i];
    if (with_jerk) {
      // S-curves bend within a stretch: parts of the same time lie closest where it is slowest.
      constexpr int kParts = 32;
      const double from = with_jerk->time_at(way);
      const double to = with_jerk->time_at(way + s.length);
      for (int k = 0; k <= kParts; ++k) {
        const double time = between(double(k) / kParts, from, to);
        use(with_jerk->way_at(time), with_jerk->velocity_at(time));
      }
    } else {
      use(way, joints[i]);
      if (!is_even_ramp(s, joints[i], joints[i + 1], chain.rules)) {
        const double peak = peak_velocity(s, joints[i], joints[i + 1]);
        const double up = std::min(speeding_up_way(s, joints[i], peak), s.length);
        const double down = std::min(speeding_up_way(s, joints[i + 1], peak), s.length);
        use(way + up, peak);
        use(way + std::max(up, s.length - down), peak);
      }
      use(way + s.length, joints[i + 1]);
    }
    way += s.length;
  }
}

// 1/mm, of the circle through three places; 0 where two of them are one.
double circle_through(const Point3& a, const Point3& b, const Point3& c) {
  const double sides = (b - a).norm() * (c - b).norm() * (c - a).norm();
  if (sides <= geometry::kSamePlace * geometry::kSamePlace * geometry::kSamePlace) return 0;
  return 2 * (b - a).cross(c - b).norm() / sides;
}

bool is_line(const PathPiece& piece) { return std::holds_alternative<geometry::Line>(piece); }

double at_joint(const PathPiece& before, const PathPiece& after) {
  if (is_line(before) && is_line(after)) {
    return circle_through(geometry::start_point(before), geometry::end_point(before),
                          geometry::end_point(after));
  }
  return std::max(geometry::curvature_at(before, 1), geometry::curvature_at(after, 0));
}

}  // namespace

PagePath page_path(const ReadProgram& before, const ReadProgram& after,
                   const Verification& verification, std::span<const PageLines> rows,
                   const PagePathOptions& options) {
  return PagePathBuilder(before, after, verification, rows, options).build();
}

double fastest_of(const std::vector<PageVertex>& vertices) {
  double fastest = 0;
  for (const PageVertex& v : vertices) fastest = std::max({fastest, v.speed_before, v.speed_after});
  return fastest;
}

std::vector<PageVertex> thinned(const std::vector<PageVertex>& vertices, const Thinning& thinning) {
  std::vector<PageVertex> kept;
  if (vertices.empty()) return kept;
  kept.push_back(vertices.front());
  std::size_t from = 0;
  while (from + 1 < vertices.size()) {
    std::size_t to = from + 1;
    while (to + 1 < vertices.size() && to - from < kPageTuning.most_in_a_row &&
           goes_on(vertices[to], vertices[to + 1]) &&
           is_straight(vertices, from, to + 1, thinning)) {
      ++to;
    }
    kept.push_back(vertices[to]);
    from = to;
  }
  return kept;
}

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

std::string packed(const Column& numbers) {
  std::string bytes;
  for (const std::int64_t number : numbers) append(number, bytes);
  return base64(bytes);
}

Column steps_of(const Column& numbers) {
  Column steps(numbers.size());
  std::adjacent_difference(numbers.begin(), numbers.end(), steps.begin());
  return steps;
}

std::string packed_runs(const Column& numbers) {
  Column runs;
  for (std::size_t i = 0; i < numbers.size();) {
    std::size_t end = i;
    while (end < numbers.size() && numbers[end] == numbers[i]) ++end;
    runs.push_back(numbers[i]);
    runs.push_back(static_cast<std::int64_t>(end - i));
    i = end;
  }
  return packed(runs);
}

ProgramSpeeds::ProgramSpeeds(const ReadProgram& read, const ProgramEvents& events,
                             const Machine& machine)
    : places_(read.interpretation->motions.size()) {
  for (std::size_t k = 0; k <= events.events.size(); ++k) {
    const Cut* cuts = events.cuts.data();
    add_chain(read, cuts + events.section_begin(k), cuts + events.cuts_before[k], machine);
  }
}

void ProgramSpeeds::add_chain(const ReadProgram& read, const Cut* begin, const Cut* end,
                              const Machine& machine) {
  const gcode::Interpretation& meaning = *read.interpretation;
  std::vector<TimedPiece> pieces;
  std::vector<double> ends;
  double way = 0;
  for (const Cut* cut = begin; cut != end; ++cut) {
    TimedPiece piece;
    piece.piece = meaning.motions[cut->motion].piece;
    piece.feed = cut->feed.value_or(0);
    const gcode::Block& block = read.program->blocks[meaning.motions[cut->motion].block];
    piece.says_speed = gcode::BlockWords(read.program->words_of(block)).has('S');
    const double length = geometry::length_of(piece.piece);
    if (length <= geometry::kSamePlace) continue;
    places_[cut->motion] = {chains_.size(), way, length};
    way += length;
    pieces.push_back(piece);
    ends.push_back(way);
  }
  if (pieces.empty()) return;
  const std::uint32_t block = meaning.motions[begin->motion].block;
  const gcode::PathControl& path = meaning.states[meaning.blocks[block].state_after].path;
  const StretchChain chain = stretches_of(with_length_and_feed(pieces, machine), machine, path,
                                          ChainEnd::kStop, WithPositions::kYes);
  Ways ways(chain, ends);
  std::vector<Sample> samples;
  for_each_speed(chain, [&](double planned, double speed) {
    samples.push_back({ways.programmed(planned), speed});
  });
  chains_.push_back(std::move(samples));
}

double ProgramSpeeds::at(std::uint32_t motion, double share) const {
  const Place& place = places_[motion];
  if (!(place.length > 0)) return 0;
  const std::vector<Sample>& samples = chains_[place.chain];
  const double way = place.way + share * place.length;
  const auto after = std::ranges::lower_bound(samples, way, {}, &Sample::way);
  if (after == samples.begin()) return samples.front().speed * kMinute;
  if (after == samples.end()) return samples.back().speed * kMinute;
  const Sample& a = *(after - 1);
  const double whole = after->way - a.way;
  // Between two speeds at one acceleration the square of the speed changes evenly with the way.
  const double part = whole > 0 ? (way - a.way) / whole : 1;
  return std::sqrt(between(part, a.speed * a.speed, after->speed * after->speed)) * kMinute;
}

ChainCurvature::ChainCurvature(std::span<const PathPiece> chain)
    : chain_(chain), at_joint_(chain.size() + 1, 0.0) {
  for (std::size_t i = 0; i + 1 < chain.size(); ++i) {
    at_joint_[i + 1] = at_joint(chain[i], chain[i + 1]);
  }
}

double ChainCurvature::at(std::size_t piece, const Point3& place) const {
  const double share = share_of_piece(chain_[piece], place);
  if (!is_line(chain_[piece])) return geometry::curvature_at(chain_[piece], share);
  return (1 - share) * at_joint_[piece] + share * at_joint_[piece + 1];
}

double share_of_piece(const PathPiece& piece, const Point3& place) {
  const double from_start = (place - geometry::start_point(piece)).norm();
  const double to_end = (geometry::end_point(piece) - place).norm();
  if (const auto* arc = std::get_if<geometry::Arc>(&piece)) {
    // By the angle: a full circle starts and ends in one place.
    const geometry::Vector3 from = arc->start - arc->center;
    const geometry::Vector3 to = place - arc->center;
    double angle = std::atan2(arc->axis.dot(from.cross(to)),
                              from.dot(to) - arc->axis.dot(from) * arc->axis.dot(to));
    if (arc->sweep < 0) angle = -angle;
    constexpr double kTurn = 2 * std::numbers::pi;
    const double sweep = std::abs(arc->sweep);
    // Places a little before the start or behind the end by rounding belong to that end.
    if (angle < 0 && angle + kTurn > sweep) angle = -angle < angle + kTurn - sweep ? 0 : sweep;
    if (angle < 0) angle += kTurn;
    return std::clamp(angle / sweep, 0.0, 1.0);
  }
  const double whole = from_start + to_end;
  return whole > 0 ? from_start / whole : 0;
}

}  // namespace batten::postproc
