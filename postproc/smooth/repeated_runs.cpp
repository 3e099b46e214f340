#include "postproc/smooth/repeated_runs.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstdint>
#include <numeric>
#include <unordered_map>
#include <utility>
#include <variant>

#include "gcode/control/control.h"

namespace batten::postproc {
namespace {

using geometry::Point3;
using geometry::Vector3;

// mm: numbers of one step are the same, whatever was computed with them.
constexpr double kSameNumber = 1e-7;

bool is_same(double a, double b) { return std::abs(a - b) <= kSameNumber; }
bool is_same(const Point3& a, const Point3& b) {
  return (a - b).cwiseAbs().maxCoeff() <= kSameNumber;
}

void translate(geometry::PathPiece& piece, const Vector3& offset) {
  if (auto* line = std::get_if<geometry::Line>(&piece)) {
    line->start += offset;
    line->end += offset;
  } else if (auto* arc = std::get_if<geometry::Arc>(&piece)) {
    arc->start += offset;
    arc->end += offset;
    arc->center += offset;
  } else {
    for (Point3& control : std::get<geometry::CubicBezier>(piece).control) control += offset;
  }
}

bool is_same_piece(const PathPiece& a, const PathPiece& b, const Vector3& offset) {
  if (a.index() != b.index()) return false;
  if (const auto* arc = std::get_if<geometry::Arc>(&a)) {
    const auto& other = std::get<geometry::Arc>(b);
    return is_same(arc->center + offset, other.center) && arc->axis == other.axis &&
           is_same(arc->sweep, other.sweep);
  }
  const auto* cubic = std::get_if<geometry::CubicBezier>(&a);
  return cubic == nullptr ||
         std::ranges::equal(
             cubic->control, std::get<geometry::CubicBezier>(b).control,
             [&](const Point3& p, const Point3& q) { return is_same(p + offset, q); });
}

bool is_same_bend(const RunBend& a, const RunBend& b, const Vector3& offset) {
  return a.first == b.first && a.last == b.last && a.can_start == b.can_start &&
         is_same_piece(a.piece, b.piece, offset);
}

bool is_same_kind(const TimedPiece& a, const TimedPiece& b) {
  return a.feed == b.feed && a.rapid == b.rapid && a.says_speed == b.says_speed &&
         a.piece.index() == b.piece.index();
}

// Seen from one of their ends: 0 or 1.
bool is_same_from(double end, const TimedPiece& a, const TimedPiece& b, const Vector3& offset) {
  return is_same_kind(a, b) &&
         is_same(geometry::point_at(a.piece, end) + offset, geometry::point_at(b.piece, end)) &&
         is_same(geometry::direction_at(a.piece, end), geometry::direction_at(b.piece, end));
}

bool is_same_move(const TimedPiece& a, const TimedPiece& b, const Vector3& offset) {
  return is_same_kind(a, b) &&
         is_same(geometry::start_point(a.piece) + offset, geometry::start_point(b.piece)) &&
         is_same(geometry::point_at(a.piece, 0.5) + offset, geometry::point_at(b.piece, 0.5)) &&
         is_same(geometry::end_point(a.piece) + offset, geometry::end_point(b.piece));
}

// Of the moves beside an end of the run, in the order of the program. The one that is farthest from
// the run may be longer or shorter: a plunge to another depth begins elsewhere.
enum class Side { kLead, kTail };

bool are_same_moves(std::span<const TimedPiece> a, std::span<const TimedPiece> b, Side side,
                    const Vector3& offset) {
  if (a.size() != b.size()) return false;
  const std::size_t farthest = side == Side::kLead ? 0 : a.size() - 1;
  const double near_end = side == Side::kLead ? 1 : 0;
  for (std::size_t i = 0; i < a.size(); ++i) {
    if (i != farthest ? !is_same_move(a[i], b[i], offset)
                      : !is_same_from(near_end, a[i], b[i], offset)) {
      return false;
    }
  }
  return true;
}

// Which motion, feed and speed hold is said by the text anew where it has to be.
bool is_same_state(gcode::ModalState a, const gcode::ModalState& b) {
  a.motion = b.motion;
  a.feed = b.feed;
  a.spindle_speed = b.spindle_speed;
  a.stated = b.stated;  // compared as what the runs have to keep
  return a == b;
}

bool may_repeat(RunInContext each) { return each.run->comments.empty(); }

// The same for runs of one shape and tolerance: that of the vertices, seen from the first, in steps
// far above what numbers differ by and off the places where printed numbers lie.
std::uint64_t hash_of(const Run& run, double tolerance_mm) {
  constexpr double kStep = 1e-3;
  constexpr double kBetween = 0.3717;
  std::uint64_t hash = run.points.size();
  const auto add = [&hash](std::int64_t value) {
    hash = (hash ^ static_cast<std::uint64_t>(value)) * 0x9E3779B97F4A7C15U;
    hash ^= hash >> 32U;
  };
  add(std::bit_cast<std::int64_t>(tolerance_mm));
  for (const Point3& point : run.points) {
    const Vector3 from = point - run.points.front();
    for (const double part : from) {
      add(static_cast<std::int64_t>(std::floor(part / kStep + kBetween)));
    }
  }
  return hash;
}

}  // namespace

std::optional<Vector3> offset_of_repeat(RunInContext first, RunInContext run,
                                        const SmoothOptions& options) {
  const Run& a = *first.run;
  const Run& b = *run.run;
  const RunContext& before = *first.context;
  const RunContext& now = *run.context;
  if (!may_repeat(first) || !may_repeat(run) || a.points.size() != b.points.size() ||
      a.bends.size() != b.bends.size() || a.decimals != b.decimals || a.closed != b.closed ||
      tolerance_of(a, options.tolerance_mm) != tolerance_of(b, options.tolerance_mm) ||
      !is_same_state(before.before, now.before) || !is_same_state(before.after, now.after) ||
      before.numbers.first.has_value() != now.numbers.first.has_value()) {
    return std::nullopt;
  }
  const Vector3 offset = b.points.front() - a.points.front();
  const gcode::Units units = now.before.units;
  const double step = gcode::printed_step(place_format(*options.target, units), units);
  const auto is_step = [step](double part) {
    return std::abs(part - step * std::round(part / step)) <= kSameNumber;
  };
  const bool same = is_step(offset.x()) && is_step(offset.y()) && is_step(offset.z()) &&
                    std::ranges::equal(
                        a.points, b.points,
                        [&](const Point3& p, const Point3& q) { return is_same(p + offset, q); }) &&
                    std::ranges::equal(a.bends, b.bends,
                                       [&](const RunBend& p, const RunBend& q) {
                                         return is_same_bend(p, q, offset);
                                       }) &&
                    std::ranges::equal(a.feeds, b.feeds,
                                       [](const FeedFrom& p, const FeedFrom& q) {
                                         return p.vertex == q.vertex && p.feed == q.feed;
                                       }) &&
                    a.speed_words == b.speed_words &&
                    are_same_moves(before.lead, now.lead, Side::kLead, offset) &&
                    are_same_moves(before.tail, now.tail, Side::kTail, offset);
  return same ? std::optional(offset) : std::nullopt;
}

std::vector<std::size_t> firsts_of_shapes(std::span<const RunInContext> runs,
                                          const SmoothOptions& options) {
  std::vector<std::size_t> firsts(runs.size());
  std::iota(firsts.begin(), firsts.end(), std::size_t{0});
  std::unordered_map<std::uint64_t, std::size_t> first_with;
  for (std::size_t i = 0; i < runs.size(); ++i) {
    if (!may_repeat(runs[i])) continue;
    const Run& run = *runs[i].run;
    const std::uint64_t hash = hash_of(run, tolerance_of(run, options.tolerance_mm));
    const std::size_t first = first_with.try_emplace(hash, i).first->second;
    if (first != i && offset_of_repeat(runs[first], runs[i], options)) firsts[i] = first;
  }
  return firsts;
}

std::optional<OutputPlan> translated(OutputPlan plan, const Vector3& offset) {
  if (!plan.curves.empty()) return std::nullopt;
  for (PlannedMove& move : plan.moves) translate(move.piece, offset);
  return plan;
}

}  // namespace batten::postproc
