#include "postproc/report/page_speed.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
#include <utility>
#include <variant>

#include "geometry/basic/rounding.h"
#include "postproc/machine/machine.h"
#include "postproc/machine/models/cycle_time.h"
#include "postproc/machine/models/jerk_motion.h"
#include "postproc/machine/models/velocity_profile.h"

namespace batten::postproc {
namespace {

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

}  // namespace

ProgramSpeeds::ProgramSpeeds(const ReadProgram& read, const ProgramEvents& events,
                             const Machine& machine)
    : places_(read.interpretation->motions.size()) {
  for (std::size_t k = 0; k <= events.events.size(); ++k) {
    const Cut* cuts = events.cuts.data();
    add_chain(read, cuts + events.stretch_begin(k), cuts + events.cuts_before[k], machine);
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
    const double length = geometry::length_of(piece.piece);
    if (length <= geometry::kSamePlace) continue;
    places_[cut->motion] = {chains_.size(), way, length};
    way += length;
    pieces.push_back(piece);
    ends.push_back(way);
  }
  if (pieces.empty()) return;
  const std::uint32_t block = meaning.motions[begin->motion].block;
  const gcode::PathMode path = meaning.states[meaning.blocks[block].state_after].path;
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

namespace {

using geometry::Line;
using geometry::PathPiece;
using geometry::Point3;

// 1/mm, of the circle through three places; 0 where two of them are one.
double circle_through(const Point3& a, const Point3& b, const Point3& c) {
  const double sides = (b - a).norm() * (c - b).norm() * (c - a).norm();
  if (sides <= geometry::kSamePlace * geometry::kSamePlace * geometry::kSamePlace) return 0;
  return 2 * (b - a).cross(c - b).norm() / sides;
}

bool is_line(const PathPiece& piece) { return std::holds_alternative<Line>(piece); }

double at_joint(const PathPiece& before, const PathPiece& after) {
  if (is_line(before) && is_line(after)) {
    return circle_through(geometry::start_point(before), geometry::end_point(before),
                          geometry::end_point(after));
  }
  return std::max(geometry::curvature_at(before, 1), geometry::curvature_at(after, 0));
}

}  // namespace

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
    constexpr double kTurn = 2 * 3.14159265358979323846;
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
