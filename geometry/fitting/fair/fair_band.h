// A fair curve along a chain of vertices, held inside its band; and room for the feed: where the
// curve is too tight for it, vertices may scatter more.
// Method: docs/algorithms/fair.md, sections Band, Staying inside and Need.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "geometry/basic/point.h"
#include "geometry/fitting/bspline_fit.h"
#include "geometry/fitting/bspline_fit_system.h"
#include "geometry/fitting/fair/fair_measure.h"
#include "geometry/fitting/fair/fair_problem.h"
#include "geometry/fitting/fair/path_features.h"

namespace batten::geometry {

// A value: a copy goes its own way.
class BandFit {
 public:
  // `points`: two or more, neighbours apart. `met`: vertices that the curve meets closely though
  // they are no corners. `rooms`: as FairOptions has them, for these points.
  BandFit(std::vector<Point3> points, const FairOptions& options, std::vector<std::size_t> met,
          std::vector<double> rooms);

  // The first fit. What depends on the curve can be asked for after it.
  void hold();

  // Expects the vertices to scatter more, by these factors (per vertex, 1 or more; infinite: only
  // the limit counts), and fits again where that differs from before.
  void loosen(std::vector<double> factors);

  // Asks for what `before` asked for in these stretches of vertices, and fits again. `before`: an
  // earlier fit of the same path.
  void take_back(const BandFit& before, std::span<const IndexRange> stretches);

  [[nodiscard]] const std::vector<Point3>& points() const { return points_; }
  [[nodiscard]] const PathFeatures& features() const { return features_; }
  [[nodiscard]] const std::vector<double>& loosened() const { return loosen_; }

  [[nodiscard]] BsplineCurve curve() const { return fit_->curve(); }
  [[nodiscard]] SplineWalk walk() const;
  [[nodiscard]] const std::vector<double>& parameters() const { return at_; }  // of the vertices

  // Per edge: greatest distance between it and the curve, mm, over its room.
  [[nodiscard]] const std::vector<double>& deviations() const { return off_; }

  // Whether the curve at a vertex is too tight for the feed.
  [[nodiscard]] bool is_tight(std::size_t vertex) const { return tight_[vertex] != 0; }

  // s: along the curve beside the edges between these vertices.
  [[nodiscard]] double time_beside(const IndexRange& vertices) const;

 private:
  [[nodiscard]] BandOptions band() const;
  void state();
  void find_denoised();
  void fit();
  void measure();
  [[nodiscard]] TravelLimits limits() const;
  [[nodiscard]] bool mend();
  [[nodiscard]] bool is_noisy(std::size_t edge) const;
  void keep_edges(std::size_t edge, std::size_t around);
  void hold_met();

  std::vector<Point3> points_;
  FairOptions options_;
  std::vector<std::size_t> met_;
  PathFeatures features_;
  std::vector<double> loosen_;        // per vertex
  std::vector<double> rooms_;         // per edge
  std::vector<EdgeRefinement> care_;  // per edge
  std::vector<Point3> meant_;         // per vertex, where noise takes much of the band; else empty
  FitProblem problem_;                // what is asked of the fit
  bool stated_ = false;               // and whether it is, but for what follows
  std::vector<std::size_t> altered_;  // vertices whose samples are asked for otherwise since then
  std::optional<PartedFit> fit_;
  std::vector<double> at_;
  std::vector<double> off_;
  std::vector<std::uint8_t> tight_;  // per vertex
};

// Widens the scatter where the curve is too tight for the feed, a few times, and keeps that where
// it saves time. Every stretch is judged for itself. Returns the number of rounds that anything
// was kept of.
[[nodiscard]] int widen_for_feed(BandFit& fit, const FairOptions& options);

}  // namespace batten::geometry
