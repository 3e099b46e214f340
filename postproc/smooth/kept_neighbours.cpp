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
  const double speed = feed / kMinute;
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

// An end of the run and the moves that stay beside it.
class Joint {
 public:
  Joint(const Moves& kept, const Moves& of_run, const Machine& machine,
        const gcode::PathControl& path)
      : kept_(kept), of_run_(of_run), machine_(machine), path_(path) {}

  // What the moves add to the time of the run alone. `chain`: both.
  [[nodiscard]] Times beside(const Moves& chain) const {
    return time_of(chain).add(time_of(of_run_), -1);
  }

  // s: what a form could win at the joint, of which the run wins `beside` already: no more than if
  // the moves went straight on into it, each on so much of the `way` (mm).
  [[nodiscard]] double may_win(const Times& beside, const TimedPiece& last, double feed,
                               double way) const {
    const geometry::Vector3 step = way * geometry::direction_at(last.piece, 1);
    const geometry::Point3 from = geometry::Point3::Zero();
    const Moves straight = {{geometry::Line{from, from + step}, last.feed},
                            {geometry::Line{from + step, from + 2 * step}, feed}};
    const double rests = seconds({straight.front()}) + seconds({straight.back()});
    const double wins = seconds(kept_) - beside.programmed;
    return std::max(0.0, rests - seconds(straight) - wins);
  }

 private:
  [[nodiscard]] Times time_of(const Moves& chain) const {
    return times_of(chain, machine_, path_, kNoPlan);
  }
  [[nodiscard]] double seconds(const Moves& chain) const {
    return TimedChain(chain, machine_).time(path_, ChainEnd::kStop, kNoPlan);
  }

  const Moves& kept_;
  const Moves& of_run_;
  const Machine& machine_;
  const gcode::PathControl& path_;
};

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
  const auto add = [&](const Moves& kept, const Moves& of_run, const Moves& chain,
                       const TimedPiece& near, double feed_of_run) {
    const Joint joint(kept, of_run, machine, context.after.path);
    const Times beside = joint.beside(chain);
    *context.of_neighbours += beside;
    context.may_win += joint.may_win(beside, near, feed_of_run, way);
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
