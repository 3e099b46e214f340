#include "geometry/fitting/bspline_fit.h"

#include <algorithm>
#include <iterator>
#include <optional>
#include <stdexcept>
#include <string>
#include <utility>

namespace batten::geometry {

namespace {

// Every pin, and the middle of every zone: a zone may grow later, but keeps its middle.
std::vector<double> borders_of(const FitProblem& problem) {
  std::vector<double> borders;
  borders.reserve(problem.pins.size() + problem.zones.size());
  for (const Pin& pin : problem.pins) borders.push_back(pin.parameter);
  for (const StraightZone& zone : problem.zones) borders.push_back(0.5 * (zone.from + zone.to));
  std::sort(borders.begin(), borders.end());
  return borders;
}

// The pin or the place in a zone that parts a problem at u; nothing when there is none any more.
std::optional<Pin> border_at(const FitProblem& problem, double u) {
  const auto pin = std::lower_bound(problem.pins.begin(), problem.pins.end(), u,
                                    [](const Pin& p, double v) { return p.parameter < v; });
  if (pin != problem.pins.end() && pin->parameter == u) return *pin;
  const auto after =
      std::upper_bound(problem.zones.begin(), problem.zones.end(), u,
                       [](double v, const StraightZone& zone) { return v < zone.from; });
  if (after == problem.zones.begin()) return std::nullopt;
  const StraightZone& zone = *std::prev(after);
  if (!(zone.from < u && u < zone.to)) return std::nullopt;
  const double part = (u - zone.from) / (zone.to - zone.from);
  return Pin{u, zone.start + part * (zone.end - zone.start)};
}

// Walks along a problem and cuts off one part after the other.
class SplineCutter {
 public:
  explicit SplineCutter(const FitProblem& problem) : whole_(problem) {}

  FitProblem cut(const Pin& from, const Pin& to) {
    FitProblem part;
    const auto take_while = [](const auto& list, std::size_t& next, auto& taken, auto&& fits) {
      while (next < list.size() && fits(list[next])) taken.push_back(list[next++]);
    };
    while (sample_ < whole_.samples.size() && whole_.samples[sample_].parameter <= from.parameter) {
      ++sample_;
    }
    take_while(whole_.samples, sample_, part.samples,
               [&](const FitSample& s) { return s.parameter < to.parameter; });
    add_zones(from, to, part);
    part.pins.push_back(from);
    while (pin_ < whole_.pins.size() && whole_.pins[pin_].parameter <= from.parameter) ++pin_;
    take_while(whole_.pins, pin_, part.pins,
               [&](const Pin& p) { return p.parameter < to.parameter; });
    part.pins.push_back(to);
    part.breakpoints.push_back(from.parameter);
    while (break_ < whole_.breakpoints.size() && whole_.breakpoints[break_] <= from.parameter) {
      ++break_;
    }
    take_while(whole_.breakpoints, break_, part.breakpoints,
               [&](double u) { return u < to.parameter; });
    part.breakpoints.push_back(to.parameter);
    return part;
  }

 private:
  // Zones that go over a border are cut there.
  void add_zones(const Pin& from, const Pin& to, FitProblem& part) {
    while (zone_ < whole_.zones.size() && whole_.zones[zone_].to <= from.parameter) ++zone_;
    for (std::size_t i = zone_; i < whole_.zones.size(); ++i) {
      StraightZone zone = whole_.zones[i];
      if (zone.from >= to.parameter) break;
      if (zone.from < from.parameter) zone.from = from.parameter, zone.start = from.place;
      if (zone.to > to.parameter) zone.to = to.parameter, zone.end = to.place;
      part.zones.push_back(zone);
    }
  }

  const FitProblem& whole_;
  std::size_t sample_ = 0;
  std::size_t zone_ = 0;
  std::size_t pin_ = 0;
  std::size_t break_ = 0;
};

}  // namespace

PartedFit::PartedFit(const FitProblem& problem, const FitOptions& options) : options_(options) {
  start(problem);
}

void PartedFit::start(const FitProblem& problem) {
  if (problem.pins.size() < 2) {
    throw std::invalid_argument("fit_bspline: " + std::to_string(problem.pins.size()) +
                                " pins, expected 2 or more");
  }
  const auto is_break = [&](const Pin& pin) {
    return std::binary_search(problem.breakpoints.begin(), problem.breakpoints.end(),
                              pin.parameter);
  };
  if (!std::ranges::all_of(problem.pins, is_break)) {
    throw std::invalid_argument("fit_bspline: a pin is no breakpoint");
  }
  borders_ = borders_of(problem);
  parts_.clear();
  parts_.reserve(borders_.size() - 1);
  for (FitProblem& part : parted(problem)) parts_.emplace_back(std::move(part), options_);
  assemble(problem);
}

void PartedFit::refit(const FitProblem& problem, double closest) {
  std::vector<FitProblem> parts = parted(problem);
  if (parts.empty()) return start(problem);
  for (std::size_t i = 0; i < parts.size(); ++i) parts_[i].refit(std::move(parts[i]), closest);
  assemble(problem);
}

// Nothing when a border is none any more.
std::vector<FitProblem> PartedFit::parted(const FitProblem& problem) const {
  std::vector<FitProblem> parts;
  parts.reserve(borders_.size() - 1);
  SplineCutter cutter(problem);
  std::optional<Pin> from = border_at(problem, borders_.front());
  for (std::size_t i = 1; i < borders_.size(); ++i) {
    const std::optional<Pin> to = border_at(problem, borders_[i]);
    if (!from || !to) return {};
    parts.push_back(cutter.cut(*from, *to));
    from = to;
  }
  return parts;
}

// The knots of the parts in a row, but for borders within a zone, and their control points.
void PartedFit::assemble(const FitProblem& problem) {
  std::vector<double> breaks;
  for (const AdaptiveFit& part : parts_) {
    const std::vector<double>& own = part.spline().breaks;
    const bool joins = !breaks.empty() && breaks.back() == own.front();
    if (joins) breaks.pop_back();
    const bool in_zone =
        joins && !std::binary_search(
                     problem.pins.begin(), problem.pins.end(), Pin{own.front(), Point3::Zero()},
                     [](const Pin& a, const Pin& b) { return a.parameter < b.parameter; });
    breaks.insert(breaks.end(), own.begin() + (in_zone ? 1 : 0), own.end());
  }
  const bool same_spline = breaks == spline_.breaks &&
                           changed_places(pins_, problem.pins, zones_, problem.zones).empty();
  if (!same_spline) {
    spline_ = spline_on(std::move(breaks), problem.pins, problem.zones);
    pins_ = problem.pins;
    zones_ = problem.zones;
  }
  std::size_t next = 0;
  for (const AdaptiveFit& part : parts_) {
    const FitSpline& own = part.spline();
    for (std::size_t i = 0; i < own.size(); ++i) {
      if (own.fixed[i] != 0) continue;
      while (spline_.fixed[next] != 0) ++next;
      spline_.points[next++] = own.points[i];
    }
  }
}

BsplineCurve PartedFit::curve() const {
  constexpr int kCubic = 3;
  return {BsplineBasis(kCubic, spline_.knots), spline_.points};
}

std::vector<ParameterRange> PartedFit::moved() const {
  std::vector<ParameterRange> moved;
  for (const AdaptiveFit& part : parts_) {
    for (const ParameterRange& range : part.moved()) {
      if (!moved.empty() && range.from <= moved.back().to) {
        moved.back().to = range.to;
      } else {
        moved.push_back(range);
      }
    }
  }
  return moved;
}

std::vector<double> PartedFit::ratios(std::span<const FitSample> given) const {
  std::vector<double> ratios;
  ratios.reserve(given.size());
  for (std::size_t i = 0; i < parts_.size(); ++i) {
    const std::size_t begin = ratios.size();
    std::size_t end = begin;
    while (end < given.size() &&
           (i + 1 == parts_.size() || given[end].parameter < borders_[i + 1])) {
      ++end;
    }
    const std::vector<double> own = parts_[i].ratios(given.subspan(begin, end - begin));
    ratios.insert(ratios.end(), own.begin(), own.end());
  }
  return ratios;
}

BsplineFit fit_bspline(const FitProblem& problem, const FitOptions& options) {
  const PartedFit fit(problem, options);
  BsplineFit result{fit.curve(), fit.ratios(problem.samples), 0};
  for (const double ratio : result.ratios) result.worst_ratio = std::max(result.worst_ratio, ratio);
  return result;
}

}  // namespace batten::geometry
