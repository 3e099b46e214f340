// The racing line through one corner: how fast a machine can take it on a given room.
#pragma once

#include <optional>
#include <vector>

#include "geometry/fitting/band_curve.h"
#include "geometry/fitting/corners/corner_blend.h"
#include "geometry/fitting/corners/time_optimal_corner.h"

namespace batten::geometry {

class TimeOptimalLine {
 public:
  // Both must outlive it.
  TimeOptimalLine(const CornerFrame& frame, const TimeOptimalOptions& options);

  [[nodiscard]] bool has_room() const;

  // The fastest curve on `room` times the room that the machine needs to change its speed and to
  // swing from side to side, or on the shares of the legs, whichever is less.
  [[nodiscard]] std::optional<TimeOptimalBlend> fastest(double room) const;

 private:
  struct Leg {
    Vector3 away;   // unit, from the vertex
    double share;   // mm
    double needed;  // mm
    double jerk;    // mm/s^3 that the axes give along the leg
    double speed;   // mm/s that feed and axes give along the leg
  };
  // A curve whose time is given, and what the machine lacks for it.
  struct Timed {
    std::vector<Point3> points;
    double time = 0;
    double load = 0;
    bool inside = false;
  };
  struct Joint {
    Leg leg;
    double room;   // mm from the vertex
    double speed;  // mm/s along the leg
  };

  [[nodiscard]] Leg leg_of(const Vector3& away, double share) const;
  [[nodiscard]] Joint joint_of(const Leg& leg, double room) const;
  [[nodiscard]] std::vector<double> breakpoints(const Joint& in, const Joint& out,
                                                double lost) const;
  [[nodiscard]] BandProblem problem(const Joint& in, const Joint& out, double lost,
                                    double tolerance) const;
  void add_band(BandProblem& made, const std::vector<double>& breaks, double tolerance) const;
  void add_limits(BandProblem& made) const;
  [[nodiscard]] Timed solved(const Joint& in, const Joint& out, double lost, double tolerance,
                             const std::vector<Point3>& start) const;
  [[nodiscard]] std::optional<Timed> quickest(const Joint& in, const Joint& out,
                                              double tolerance) const;

  const CornerFrame& frame_;
  const TimeOptimalOptions& options_;
  Leg before_;
  Leg after_;
};

}  // namespace batten::geometry
