#include "postproc/smooth/kept_neighbours.h"

#include <algorithm>
#include <cstddef>
#include <utility>

#include "geometry/path/path.h"
#include "postproc/runs/run_path.h"
#include "postproc/smooth/methods/curve_request.h"
#include "postproc/smooth/selection/run_times.h"

namespace batten::postproc {

namespace {

using Moves = std::vector<TimedPiece>;

// mm: on so much of the way a move of this feed (mm/min) comes to its speed from rest or back under
// any of the models, which brake with half of the acceleration where they blend, and has its full
// room for a bend.
double way_to_speed(double feed, const Machine& machine) {
  const double speed = std::min(feed / kMinute, machine.max_velocity());
  const double acceleration = machine.max_acceleration();
  return 4 * speed * (speed / acceleration + acceleration / machine.max_jerk());
}

// Those next to an end of the run on so much of the way (mm), or a little more.
Moves first_of(Moves moves, double way) {
  std::size_t count = 0;
  while (count < moves.size() && way > 0) way -= geometry::length_of(moves[count++].piece);
  moves.resize(count);
  return moves;
}

Moves last_of(Moves moves, double way) {
  auto first = moves.end();
  while (first != moves.begin() && way > 0) way -= geometry::length_of((--first)->piece);
  moves.erase(moves.begin(), first);
  return moves;
}

Moves joined(Moves moves, const Moves& rest) {
  moves.insert(moves.end(), rest.begin(), rest.end());
  return moves;
}

// A move, and one of another feed (mm/min) in its direction, each on so much of the way (mm).
Moves straight_on(const TimedPiece& move, double feed, double way) {
  const geometry::Vector3 step = way * geometry::direction_at(move.piece, 1);
  const geometry::Point3 from = geometry::Point3::Zero();
  return {{geometry::Line{from, from + step}, move.feed},
          {geometry::Line{from + step, from + 2 * step}, feed}};
}

}  // namespace

void put_between(Moves lead, Moves tail, const Run& run, const Machine& machine,
                 RunContext& context) {
  if (lead.empty() && tail.empty()) return;
  double feed = greatest_feed(run);
  if (!lead.empty()) feed = std::max(feed, lead.back().feed);
  if (!tail.empty()) feed = std::max(feed, tail.front().feed);
  const double way = way_to_speed(feed, machine);
  const Moves moves = timed_pieces(run, 0, run.points.size() - 1);
  context.lead = last_of(std::move(lead), way);
  context.tail = first_of(std::move(tail), way);
  context.of_neighbours.emplace();
  const auto time_of = [&](const Moves& chain) {
    return times_of(chain, machine, context.after.path, kNoPlan);
  };
  const auto saved = [&](const Moves& one, const Moves& other, const Times& together) {
    return time_of(one).programmed + time_of(other).programmed - together.programmed;
  };
  // `near`: of the `kept` moves, next to the run, whose feed there is `feed_there`.
  const auto add = [&](const Moves& kept, const Moves& of_run, const Moves& chain,
                       const TimedPiece& near, double feed_there) {
    const Times together = time_of(chain);
    context.of_neighbours->add(together, 1).add(time_of(of_run), -1);
    // No form saves more there than if the moves went straight on.
    const Moves straight = straight_on(near, feed_there, way);
    const double most = saved({straight.front()}, {straight.back()}, time_of(straight));
    context.may_win += std::max(0.0, most - saved(kept, of_run, together));
  };
  if (!context.lead.empty()) {
    const Moves begin = first_of(moves, way);
    add(context.lead, begin, joined(context.lead, begin), context.lead.back(), moves.front().feed);
  }
  if (!context.tail.empty()) {
    const Moves end = last_of(moves, way);
    add(context.tail, end, joined(end, context.tail), context.tail.front(), moves.back().feed);
  }
}

}  // namespace batten::postproc
