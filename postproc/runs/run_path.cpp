#include "postproc/runs/run_path.h"

#include <algorithm>
#include <cmath>

#include "gcode/text/large_pages.h"

namespace batten::postproc {
namespace {

using geometry::Arc;
using geometry::Line;
using geometry::PathPiece;
using geometry::Point3;
using geometry::Vector3;

constexpr std::size_t kLeastChords = 4;

// An arc through the ends and the middle of a section of a curve whose curvature changes by k' per
// mm leaves it by k' (s^3 - s l^2 / 4) / 6, s from -l/2 to l/2: k' l^3 / 174 rms.
constexpr double kFromCurvature = 1.0 / 174;

// At its ends it is k' l^2 / 12 off in direction. Two arcs share the kink a between them: a l / 29.
constexpr double kFromKink = 6.0 / 174;

PathPiece part_of(const RunBend& bend, std::size_t first, std::size_t last) {
  if (first == bend.first && last == bend.last) return bend.piece;
  const auto steps = static_cast<double>(bend.last - bend.first);
  return geometry::sub_piece(bend.piece, static_cast<double>(first - bend.first) / steps,
                             static_cast<double>(last - bend.first) / steps);
}

// Towards the centre of curvature, 1/mm long.
Vector3 curvature_vector(const PathPiece& piece, double t) {
  const auto* arc = std::get_if<Arc>(&piece);
  if (arc == nullptr) return Vector3::Zero();
  Vector3 inwards = arc->center - geometry::point_at(piece, t);
  inwards -= inwards.dot(arc->axis) * arc->axis;
  const double radius = inwards.norm();
  return radius > 0 ? Vector3(geometry::curvature_at(piece, t) / radius * inwards)
                    : Vector3(Vector3::Zero());
}

// Calls `take(piece, first vertex)` for each motion in order.
template <class Take>
void for_each_motion(const Run& run, std::size_t at, std::size_t last, const Take& take) {
  auto bend = std::ranges::lower_bound(run.bends, at, {}, &RunBend::last);
  while (at < last) {
    const std::size_t first = at;
    while (bend != run.bends.end() && bend->last <= first) ++bend;
    if (bend == run.bends.end() || first < bend->first) {
      ++at;
      take(Line{run.points[first], run.points[at]}, first, nullptr);
    } else {
      at = std::min(bend->last, last);
      take(part_of(*bend, first, at), first, &*bend);
    }
  }
}

// A piece of a curve says itself how it bends; what stands beside it says nothing of how far an arc
// is off.
bool is_cubic(const PathPiece& piece) {
  return std::holds_alternative<geometry::CubicBezier>(piece);
}

// What two neighbouring motions say about the curve that they stand for.
struct JointSteps {
  double curvature = 0;  // 1/mm per mm: how fast it changes
  double kink = 0;       // radians
};

JointSteps steps_between(const PathPiece& before, const PathPiece& after) {
  const double length = 0.5 * (geometry::length_of(before) + geometry::length_of(after));
  return {(curvature_vector(after, 0) - curvature_vector(before, 1)).norm() / length,
          turn_between(before, after)};
}

// Of an arc of length l between two joints. A step of curvature on one side alone was meant: a line
// that runs into an arc.
double scatter_of(double l, const std::optional<JointSteps>& before,
                  const std::optional<JointSteps>& after) {
  if (!before && !after) return 0;
  const JointSteps& a = before ? *before : *after;
  const JointSteps& b = after ? *after : *before;
  return std::hypot(kFromCurvature * l * l * l * std::min(a.curvature, b.curvature),
                    kFromKink * l * 0.5 * (a.kink + b.kink));
}

}  // namespace

void append_bend(RunBend bend, std::size_t of_block, double max_chord_error, Run& run) {
  const PathPiece& piece = bend.piece;
  // Linear interpolation over 1/n of the piece is off by at most this over n^2.
  const double whole = geometry::second_derivative_bound(piece) / 8;
  const auto wanted = static_cast<std::size_t>(std::ceil(std::sqrt(whole / max_chord_error)));
  const bool straight = std::holds_alternative<Line>(piece);
  const std::size_t least = straight ? 1 : std::max<std::size_t>(1, kLeastChords / of_block);
  const std::size_t chords = std::max(wanted, least);
  bend.first = run.points.size() - 1;
  bend.last = bend.first + chords;
  for (std::size_t i = 1; i < chords; ++i) {
    run.points.push_back(
        geometry::point_at(piece, static_cast<double>(i) / static_cast<double>(chords)));
  }
  run.points.push_back(geometry::end_point(piece));
  run.bends.push_back(std::move(bend));
  run.chord_error = std::max(run.chord_error,
                             whole / (static_cast<double>(chords) * static_cast<double>(chords)));
}

std::vector<double> edge_feeds(const Run& run) {
  std::vector<double> feeds(run.points.size() - 1);
  auto change = run.feeds.begin();
  double feed = 0;
  for (std::size_t i = 0; i < feeds.size(); ++i) {
    for (; change != run.feeds.end() && change->vertex <= i; ++change) feed = change->feed;
    feeds[i] = feed;
  }
  return feeds;
}

std::size_t motion_count(const Run& run) {
  std::size_t count = run.points.size() - 1;
  for (const RunBend& bend : run.bends) count -= bend.last - bend.first - 1;
  return count;
}

std::vector<RunMotion> motions_between(const Run& run, std::size_t first, std::size_t last) {
  std::vector<RunMotion> motions;
  motions.reserve(last - first);
  for_each_motion(run, first, last, [&](const PathPiece& piece, std::size_t at, const RunBend*) {
    motions.push_back({piece, at});
  });
  return motions;
}

double turn_between(const PathPiece& before, const PathPiece& after) {
  const Vector3 a = geometry::direction_at(before, 1);
  const Vector3 b = geometry::direction_at(after, 0);
  return std::atan2(a.cross(b).norm(), a.dot(b));
}

double arc_scatter(const Run& run) {
  if (run.bends.empty()) return 0;
  const std::vector<RunMotion> motions = motions_between(run, 0, run.points.size() - 1);
  double squares = 0;
  double length = 0;
  std::optional<JointSteps> before;
  for (std::size_t i = 0; i < motions.size(); ++i) {
    const PathPiece& piece = motions[i].piece;
    std::optional<JointSteps> after;
    if (i + 1 < motions.size() && !is_cubic(piece) && !is_cubic(motions[i + 1].piece)) {
      after = steps_between(piece, motions[i + 1].piece);
    }
    const double l = geometry::length_of(piece);
    length += l;
    if (std::holds_alternative<Arc>(piece)) {
      const double off = scatter_of(l, before, after);
      squares += l * off * off;
    }
    before = after;
  }
  return length > 0 ? std::sqrt(squares / length) : 0;
}

std::vector<TimedPiece> timed_pieces(const Run& run, std::size_t first, std::size_t last) {
  std::vector<TimedPiece> pieces;
  std::size_t next = 0;
  auto speed = std::ranges::lower_bound(run.speed_words, first);
  double feed = 0;
  gcode::reserve_in_large_pages(pieces, last - first);
  const auto add = [&](const PathPiece& piece, std::size_t at, const RunBend* bend) {
    while (next < run.feeds.size() && run.feeds[next].vertex <= at) feed = run.feeds[next++].feed;
    pieces.push_back({piece, feed});
    if (bend != nullptr) {
      pieces.back().goes_on = bend->goes_on;
      pieces.back().arcs = bend->arcs;
    }
    if (speed == run.speed_words.end() || *speed != at) return;
    pieces.back().says_speed = true;
    ++speed;
  };
  for_each_motion(run, first, last, add);
  return pieces;
}

}  // namespace batten::postproc
