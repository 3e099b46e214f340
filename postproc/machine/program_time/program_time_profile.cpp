#include "postproc/machine/program_time/program_time_profile.h"

#include <limits>
#include <stdexcept>

#include "postproc/machine/machine.h"
#include "postproc/machine/program_time/program_time_chains.h"

namespace batten::postproc {
namespace {

using geometry::Point3;
using geometry::Vector3;

// Places further apart than this, where one chain ends and the next begins, are a jump: the
// program's text does not say how the tool came there (mm). Printed places differ by less.
constexpr double kJump = 1e-3;

class Sampler {
 public:
  Sampler(const ProgramSteps& steps, const Machine& machine, FeedPlanner planner, double period,
          const std::function<bool(const ProfileSample&)>& use)
      : steps_(steps), machine_(machine), planner_(planner), period_(period), use_(use) {}

  void run(const RunChain& chain) {
    if (stopped_) return;
    if (chain.pieces.empty()) return wait(chain);
    if (const auto plan = plan_of(chain, planner_)) return run_plan(chain, *plan);
    const ChainMotion motion(chain.stretches);
    for (std::size_t i = 0; i < chain.stretches.places.size() && !stopped_; ++i) {
      run_stretch(chain, motion, i);
    }
    start_ += motion.duration();
  }

  // The sample after the end.
  void finish() {
    if (!stopped_ && !(samples_ == 0 && start_ == 0)) emit(place_);
  }

  [[nodiscard]] bool stopped() const { return stopped_; }

 private:
  [[nodiscard]] double next_time() const { return static_cast<double>(samples_) * period_; }

  void wait(const RunChain& chain) {
    line_ = line_of(chain.steps.front());
    const double end = start_ + chain.seconds;
    while (next_time() < end && !stopped_) emit(place_);
    start_ = end;
  }

  void run_plan(const RunChain& chain, const ChainPlan& plan) {
    const PlannedMotion motion(chain.pieces, machine_, plan.planner, chain.path, plan.density);
    begin_at_start_of(chain.pieces.front().piece);
    const double end = start_ + motion.duration();
    while (next_time() < end && !stopped_) {
      const PlannedPosition at = motion.position_at(next_time() - start_);
      line_ = line_of(chain.steps[at.piece]);
      emit(geometry::point_at(chain.pieces[at.piece].piece, at.t));
    }
    line_ = line_of(chain.steps.back());
    place_ = geometry::end_point(chain.pieces.back().piece);
    start_ = end;
  }

  void begin_at_start_of(const geometry::PathPiece& piece) {
    const Point3 first = geometry::start_point(piece);
    if (!moved_ || (first - place_).norm() > kJump) begin_at(first);
  }

  void run_stretch(const RunChain& chain, const ChainMotion& motion, std::size_t i) {
    const StretchPlace& place = chain.stretches.places[i];
    begin_at_start_of(place.path);
    const double end = start_ + motion.end_of(i);
    while (next_time() < end && !stopped_) {
      const double share = motion.share_at(i, next_time() - start_);
      line_ = line_of(chain.steps[piece_at(chain, place, share)]);
      emit(geometry::point_at(place.path, share));
    }
    line_ = line_of(chain.steps[place.last_piece]);
    place_ = geometry::end_point(place.path);
  }

  // Which of the pieces that share a stretch is run at this share of its way.
  static std::uint32_t piece_at(const RunChain& chain, const StretchPlace& place, double share) {
    if (place.first_piece == place.last_piece) return place.first_piece;
    if (place.is_corner) return share < 0.5 ? place.first_piece : place.last_piece;
    double way = share * chain.length_of(place);
    for (auto p = place.first_piece; p < place.last_piece; ++p) {
      way -= geometry::length_of(chain.pieces[p].piece);
      if (way <= 0) return p;
    }
    return place.last_piece;
  }

  [[nodiscard]] std::uint32_t line_of(std::size_t step) const { return steps_.steps[step].line; }

  void begin_at(const Point3& place) {
    moved_ = true;
    place_ = last_ = place;
    velocity_.setZero();
    acceleration_.setZero();
  }

  void emit(const Point3& place) {
    const Vector3 velocity = (place - last_) / period_;
    const Vector3 acceleration = (velocity - velocity_) / period_;
    ProfileSample sample;
    sample.time = next_time();
    sample.line = line_;
    sample.place = place;
    sample.feed = velocity.norm() * kMinute;
    sample.acceleration = acceleration;
    sample.jerk = (acceleration - acceleration_) / period_;
    last_ = place;
    velocity_ = velocity;
    acceleration_ = acceleration;
    ++samples_;
    stopped_ = !use_(sample);
  }

  const ProgramSteps& steps_;
  const Machine& machine_;
  FeedPlanner planner_;
  double period_;
  const std::function<bool(const ProfileSample&)>& use_;
  std::size_t samples_ = 0;
  double start_ = 0;  // s: of what is run now
  std::uint32_t line_ = 0;
  bool moved_ = false;
  bool stopped_ = false;
  Point3 place_ = Point3::Zero();  // where the stretch before ended
  Point3 last_ = Point3::Zero();   // of the sample before
  Vector3 velocity_ = Vector3::Zero();
  Vector3 acceleration_ = Vector3::Zero();
};

}  // namespace

bool sample_program(const ProgramSteps& steps, const Machine& machine, double period,
                    const std::function<bool(const ProfileSample&)>& use, FeedPlanner planner) {
  if (!(period > 0)) throw std::invalid_argument("sample_program: the period must be above 0");
  Sampler sampler(steps, machine, planner, period, use);
  const auto run = [&](const RunChain& chain) { sampler.run(chain); };
  ChainCutter cutter(machine, std::numeric_limits<std::size_t>::max());
  for (const ProgramStep& step : steps.steps) cutter.add(step, steps.controls, run);
  cutter.finish(run);
  sampler.finish();
  return !sampler.stopped();
}

}  // namespace batten::postproc
