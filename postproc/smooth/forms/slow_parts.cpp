#include "postproc/smooth/forms/slow_parts.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <utility>
#include <variant>

#include "geometry/basic/operations.h"
#include "postproc/machine/models/velocity_profile.h"
#include "postproc/runs/run_path.h"
#include "postproc/smooth/methods/curve_request.h"

namespace batten::postproc {
namespace {

using geometry::Point3;

std::vector<TimedPiece> timed(std::span<const PlannedMove> moves) {
  std::vector<TimedPiece> pieces;
  pieces.reserve(moves.size());
  for (const PlannedMove& move : moves) pieces.push_back({move.piece, move.feed});
  return pieces;
}

// s, of each piece of a chain from rest to rest, more than at its feed.
std::vector<double> lost_times(const std::vector<TimedPiece>& chain, const Machine& machine,
                               const gcode::PathControl& path) {
  std::vector<std::size_t> moving;  // of the chain: the pieces that have a length
  for (std::size_t i = 0; i < chain.size(); ++i) {
    if (geometry::length_of(chain[i].piece) > geometry::kSamePlace) moving.push_back(i);
  }
  const std::vector<TimedPiece> pieces = with_length_and_feed(chain, machine);
  geometry::count_operations(10 * pieces.size());
  const StretchChain stretches =
      stretches_of(pieces, machine, path, ChainEnd::kStop, WithPositions::kYes);
  const std::vector<double> speeds = joint_velocities(stretches.stretches, stretches.rules);
  std::vector<double> lost(chain.size());
  for (std::size_t i = 0; i < stretches.stretches.size(); ++i) {
    const VelocityStretch& stretch = stretches.stretches[i];
    const StretchPlace& place = stretches.places[i];
    const double time = stretch_time(stretch, speeds[i], speeds[i + 1], stretches.rules);
    const double count = place.last_piece - place.first_piece + 1.0;
    for (std::size_t k = place.first_piece; k <= place.last_piece; ++k) {
      lost[moving[k]] += (time - stretch.length / (pieces[k].feed / 60)) / count;
    }
  }
  return lost;
}

double end_of(const OutputPlan& plan, std::size_t move, const geometry::BsplineCurve& curve) {
  return move + 1 < plan.moves.size() ? plan.moves[move + 1].start : curve.last();
}

// The sum up to a parameter, linear between the places that have one.
double sum_at(double parameter, const std::vector<double>& places,
              const std::vector<double>& sums) {
  const auto after = std::ranges::upper_bound(places, parameter);
  if (after == places.begin()) return 0;
  if (after == places.end()) return sums.back();
  const auto i = static_cast<std::size_t>(after - places.begin()) - 1;
  const double part = (parameter - places[i]) / (places[i + 1] - places[i]);
  return sums[i] + part * (sums[i + 1] - sums[i]);
}

bool is_arc(const PlannedMove& move) { return std::holds_alternative<geometry::Arc>(move.piece); }

// A move that goes on to the parameter `end`, cut at two parameters in between.
OutputPlan cut_in_three(const PlannedMove& move, double end, double first, double second) {
  const auto part = [&](double parameter) { return (parameter - move.start) / (end - move.start); };
  OutputPlan cut;
  cut.moves = {{geometry::sub_piece(move.piece, 0, part(first)), move.feed, {}, move.start},
               {geometry::sub_piece(move.piece, part(first), part(second)), move.feed, {}, first},
               {geometry::sub_piece(move.piece, part(second), 1), move.feed, {}, second}};
  return cut;
}

OutputPlan without_comments(OutputPlan plan) {
  plan.comments_after.clear();
  for (PlannedMove& move : plan.moves) move.comments_before.clear();
  return plan;
}

}  // namespace

SlowParts::SlowParts(const Run& run, const geometry::SmoothCurve& fair, const Machine& machine,
                     const gcode::PathControl& path)
    : run_(run), fair_(fair), machine_(machine), path_(path), lost_before_(1, 0.0) {
  for (const double lost : lost_times(timed_pieces(run, 0, run.points.size() - 1), machine, path)) {
    lost_before_.push_back(lost_before_.back() + lost);
  }
}

std::vector<double> SlowParts::lost(const OutputPlan& plan) const {
  const auto& at = fair_.vertex_parameters;
  std::vector<double> lost = lost_times(timed(plan.moves), machine_, path_);
  for (std::size_t i = 0; i < lost.size(); ++i) {
    lost[i] -= sum_at(end_of(plan, i, fair_.curve), at, lost_before_) -
               sum_at(plan.moves[i].start, at, lost_before_);
  }
  return lost;
}

// In one plan.
class SlowParts::Search {
 public:
  Search(const SlowParts& parts, const OutputPlan& plan) : parts_(parts), plan_(plan) {}

  [[nodiscard]] bool is_slow(std::size_t move, double lost) const {
    const PlannedMove& m = plan_.moves[move];
    return lost > kSlowParts.slow * geometry::length_of(m.piece) / (m.feed / 60);
  }

  // The part, or a wider one that does not begin before `begin`; nothing where the plan is faster.
  // Timed from rest some moves before the part to rest some behind it.
  [[nodiscard]] std::optional<SlowPart> fastest(SlowPart part, std::size_t begin) const {
    const std::size_t first = part.first - std::min(part.first, kSlowParts.timed_beside);
    const std::size_t end = std::min(part.last + 1 + kSlowParts.timed_beside, plan_.moves.size());
    const std::span<const PlannedMove> all(plan_.moves);
    const double time = time_of(all.subspan(first, end - first));
    std::optional<SlowPart> best;
    for (std::size_t i = 0; i <= kSlowParts.wider_by; ++i) {
      const auto before = all.subspan(first, part.first - first);
      const auto behind = all.subspan(part.last + 1, end - part.last - 1);
      std::vector<PlannedMove> moves(before.begin(), before.end());
      parts_.append_run(plan_, part, moves);
      moves.insert(moves.end(), behind.begin(), behind.end());
      part.won = time - time_of(moves);
      if (part.won > (best ? best->won : 0)) best = part;
      if (part.first > begin) --part.first;
      if (part.last + 1 < plan_.moves.size()) ++part.last;
    }
    return best;
  }

 private:
  [[nodiscard]] double time_of(std::span<const PlannedMove> moves) const {
    return TimedChain(timed(moves), parts_.machine_).time(parts_.path_, ChainEnd::kStop, kNoPlan);
  }

  const SlowParts& parts_;
  const OutputPlan& plan_;
};

std::vector<SlowPart> SlowParts::find(const OutputPlan& plan, std::span<const double> lost) const {
  const Search search(*this, plan);
  std::vector<SlowPart> all;
  for (std::size_t i = 0; i < lost.size(); ++i) {
    const std::size_t begin = all.empty() ? 0 : all.back().last + 1;
    if (i < begin || !search.is_slow(i, lost[i])) continue;
    SlowPart part{i, i};
    while (part.last + 1 < lost.size() && search.is_slow(part.last + 1, lost[part.last + 1])) {
      ++part.last;
    }
    if (const auto best = search.fastest(part, begin)) all.push_back(*best);
    i = part.last;
  }
  return all;
}

std::optional<OutputPlan> SlowParts::with_run(const OutputPlan& plan,
                                              std::span<const SlowPart> parts) const {
  if (parts.empty()) return std::nullopt;
  OutputPlan mixed = without_comments(plan);
  mixed.moves.clear();
  bool has_arc = false;
  auto part = parts.begin();
  for (std::size_t i = 0; i < plan.moves.size(); ++i) {
    if (part != parts.end() && part->first == i) {
      append_run(plan, *part, mixed.moves);
      i = part->last;
      ++part;
      continue;
    }
    const PlannedMove& move = plan.moves[i];
    has_arc = has_arc || is_arc(move);
    mixed.moves.push_back({move.piece, move.feed, {}, move.start});
  }
  if (plan.form == Form::kArcs && !has_arc) return std::nullopt;
  place_comments(run_, fair_, mixed);
  return mixed;
}

// mm, from rest.
double SlowParts::way_to_feed(double feed) const {
  return std::pow(feed / 60, 2) / (2 * limits_of(machine_, feed).acceleration.minCoeff());
}

bool SlowParts::begins_with_run(OutputPlan& plan) const {
  const PlannedMove& move = plan.moves.front();
  const double end = end_of(plan, 0, fair_.curve);
  const double way = way_to_feed(move.feed);
  if (!is_arc(move) || way > kSlowParts.of_arc * (end - move.start)) return false;
  const double first = move.start + way;
  const double second =
      first + std::min(kSlowParts.short_arc * way, kSlowParts.of_arc * (end - first));
  const OutputPlan cut = cut_in_three(move, end, first, second);
  std::vector<PlannedMove> moves;
  append_run(cut, {0, 0}, moves);
  moves.insert(moves.end(), cut.moves.begin() + 1, cut.moves.end());
  moves.insert(moves.end(), plan.moves.begin() + 1, plan.moves.end());
  plan.moves = std::move(moves);
  return true;
}

bool SlowParts::ends_with_run(OutputPlan& plan) const {
  const PlannedMove move = plan.moves.back();
  const double end = fair_.curve.last();
  const double way = way_to_feed(move.feed);
  if (!is_arc(move) || way > kSlowParts.of_arc * (end - move.start)) return false;
  const double second = end - way;
  const double first =
      second - std::min(kSlowParts.short_arc * way, kSlowParts.of_arc * (second - move.start));
  const OutputPlan cut = cut_in_three(move, end, first, second);
  plan.moves.back() = cut.moves[0];
  plan.moves.push_back(cut.moves[1]);
  append_run(cut, {2, 2}, plan.moves);
  return true;
}

std::optional<OutputPlan> SlowParts::with_run_at_ends(const OutputPlan& plan) const {
  OutputPlan mixed = without_comments(plan);
  const bool at_end = ends_with_run(mixed);
  if (!begins_with_run(mixed) && !at_end) return std::nullopt;
  place_comments(run_, fair_, mixed);
  return mixed;
}

// From where the part starts to where it ends, past the vertices between, at the feeds of its
// moves.
void SlowParts::append_run(const OutputPlan& plan, const SlowPart& part,
                           std::vector<PlannedMove>& moves) const {
  const auto& at = fair_.vertex_parameters;
  const double end = end_of(plan, part.last, fair_.curve);
  std::size_t move = part.first;
  double parameter = plan.moves[move].start;
  Point3 place = geometry::start_point(plan.moves[move].piece);
  const auto append = [&](const Point3& to, double next) {
    while (move < part.last && plan.moves[move + 1].start < (parameter + next) / 2) ++move;
    moves.push_back({geometry::Line{place, to}, plan.moves[move].feed, {}, parameter});
    place = to;
    parameter = next;
  };
  auto next = static_cast<std::size_t>(std::ranges::upper_bound(at, parameter) - at.begin());
  for (; next < at.size() && at[next] < end; ++next) append(run_.points[next], at[next]);
  append(geometry::end_point(plan.moves[part.last].piece), end);
}

std::vector<SlowPart> enough_of(std::vector<SlowPart> parts, double seconds) {
  std::ranges::stable_sort(parts, std::greater<>(), &SlowPart::won);
  double won = 0;
  std::size_t count = 0;
  while (count < parts.size() && won < seconds) won += parts[count++].won;
  parts.resize(count);
  std::ranges::sort(parts, {}, &SlowPart::first);
  return parts;
}

const std::vector<double>& MendedPlan::lost_by_moves() {
  if (!lost_) lost_ = parts_.lost(plan_);
  return *lost_;
}

double MendedPlan::lost() {
  double sum = 0;
  for (const double each : lost_by_moves()) sum += std::max(each, 0.0);
  return sum;
}

std::optional<OutputPlan> MendedPlan::with_run(RunInPlace where, double slower_by) {
  if (where == RunInPlace::kAtEnds) return parts_.with_run_at_ends(plan_);
  if (!slow_) slow_ = parts_.find(plan_, lost_by_moves());
  const bool all = where == RunInPlace::kEverywhere;
  return parts_.with_run(plan_, all ? *slow_ : enough_of(*slow_, slower_by));
}

}  // namespace batten::postproc
