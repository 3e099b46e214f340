#include "geometry/arcs/arc_spline.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <functional>
#include <limits>
#include <numeric>
#include <utility>

#include "geometry/arcs/plane_band.h"
#include "geometry/basic/point.h"
#include "geometry/basic/require.h"
#include "geometry/basic/rounding.h"

namespace batten::geometry {
namespace {

// How much is looked at. Half of it all gives some percent more arcs.
struct Effort {
  std::size_t width;  // chains that are followed at once
  int of_one_place;   // and of them, so many of one place, so that they are not all alike
  // Where an arc ends, as a part of its farthest reach: at the very end it leans on the edge of
  // the band, and the next one has no room.
  std::span<const double> parts;
  // The arcs to one end, by their place in the range of curvatures.
  std::span<const double> in_range;
  // `PlaneBand::reach` looks at each so many-th sample: what lies between them closes a fan by
  // little more, and an arc that is taken is held against all of them in the end.
  std::size_t stride = 1;
};

constexpr std::array kBriefParts = {1.0, 0.9, 0.75, 0.5};
constexpr std::array kBriefInRange = {0.1, 0.5, 0.9};
constexpr std::array kQuickParts = {1.0, 0.93, 0.84, 0.74, 0.6, 0.4};
constexpr std::array kQuickInRange = {0.05, 0.3, 0.5, 0.7, 0.95};
constexpr std::array kManyParts = {1.0, 0.95, 0.9, 0.84, 0.77, 0.7, 0.6, 0.5, 0.35};
constexpr std::array kManyInRange = {0.03, 0.15, 0.3, 0.42, 0.5, 0.58, 0.7, 0.85, 0.97};

// In the order of ArcEffort.
constexpr Effort kEfforts[] = {{5, 2, kBriefParts, kBriefInRange, 4},
                               {8, 2, kQuickParts, kQuickInRange},
                               {12, 3, kManyParts, kManyInRange}};

// Directions in which a chain may start, about the given one, radians.
constexpr std::array kStarts = {0.0,   1e-4, -1e-4, 3e-4, -3e-4, 1e-3, -1e-3, 3e-3,
                                -3e-3, 0.01, -0.01, 0.03, -0.03, 0.1,  -0.1};

// Where a pair of arcs meets: see biarc_joint.
constexpr std::array kBalances = {1.0, 0.7, 1.4, 0.5, 2.0, 0.3, 3.0};

constexpr ArcSplineTuning kSpline = kArcSplineTuning;

// A place where a chain may go on.
struct Stop {
  BandEntry entry;
  std::ptrdiff_t before = -1;  // the node from which an arc arrives here
  std::size_t reach = 0;       // of the next arc; 0: not judged yet
  double score = 0;            // of a stop that is not judged: a bound that it is below
};

struct Node : Stop {
  PlaneArc arc;       // that arrives here
  bool kink = false;  // the chain turns here
};

// The best stops of a level so far, no more of one place than are followed.
class LeadingStops {
 public:
  LeadingStops(std::size_t most, std::ptrdiff_t of_one_place)
      : most_(most), of_one_place_(of_one_place) {}

  void clear() { leads_.clear(); }

  [[nodiscard]] bool takes(const Stop& stop) const {
    return leads_.size() < most_ || stop.score > leads_.back().score;
  }

  // `index`: by which the caller knows it. Of equal ones the first stays first.
  void add(const Stop& stop, std::size_t index) {
    const auto same = [&](const Lead& lead) { return lead.place == stop.entry.next; };
    const auto after =
        std::ranges::find_if(leads_, [&](const Lead& lead) { return lead.score < stop.score; });
    if (std::count_if(leads_.begin(), after, same) >= of_one_place_) return;
    leads_.insert(after, {stop.score, stop.reach, stop.entry.next, index});
    if (std::ranges::count_if(leads_, same) > of_one_place_) {
      leads_.erase(std::next(std::find_if(leads_.rbegin(), leads_.rend(), same)).base());
    }
    if (leads_.size() > most_) leads_.pop_back();
  }

  // A stop that reaches less far is none of them.
  [[nodiscard]] std::size_t least_reach() const {
    return leads_.size() < most_ ? 0 : leads_.back().reach;
  }

  struct Lead {
    double score;
    std::size_t reach;
    std::size_t place;
    std::size_t index;
  };

  // The best first.
  [[nodiscard]] const std::vector<Lead>& leads() const { return leads_; }

 private:
  std::size_t most_;
  std::ptrdiff_t of_one_place_;
  std::vector<Lead> leads_;
};

double angle_between(const Vector2& from, const Vector2& to) {
  return std::atan2(cross(from, to), from.dot(to));
}

class Search {
 public:
  // Chains that cost more than `at_most` arcs are not looked for.
  Search(std::span<const Point2> points, const ArcSplineOptions& options, std::size_t at_most)
      : options_(options),
        effort_(kEfforts[static_cast<std::size_t>(options.effort)]),
        band_(points, {options.tolerance, options.outside, 1 / options.min_radius,
                       options.max_sweep, effort_.stride}),
        count_(band_.samples().size()),
        leading_(effort_.width, effort_.of_one_place),
        best_arcs_(at_most + 1) {
    if (options.end_angle) end_along_ = unit_vector(*options.end_angle);
  }

  std::optional<ArcSpline> run() {
    add_starts();
    std::size_t improved = 0;  // the level that saw farther than the ones before it
    double farthest = -1;
    for (std::size_t arcs = 0; arcs < levels_.size() && arcs < best_arcs_; ++arcs) {
      const std::vector<std::size_t> level = best_of_level(arcs);
      if (!level.empty() && nodes_[level.front()].score > farthest) {
        farthest = nodes_[level.front()].score;
        improved = arcs;
      }
      if (arcs > improved + kSpline.kink_costs + kSpline.patience) break;
      grow(level, arcs);
    }
    return chain();
  }

 private:
  void grow(const std::vector<std::size_t>& level, std::size_t arcs) {
    for (const std::size_t i : level) finish(i, arcs);
    // A chain that goes on from here has two arcs more at the least: no better than the best.
    if (arcs + 2 >= best_arcs_) return;
    found_.clear();
    leading_.clear();
    for (const std::size_t i : level) {
      spread(i);
      if (options_.kinks) turn_at_corner(i, arcs);
    }
    follow(arcs + 1);
    if (options_.kinks && levels_.size() <= arcs + 1 && !best_) turn_where_stuck(level, arcs);
  }

  void add_to(std::size_t arcs, Node node) {
    if (levels_.size() <= arcs) levels_.resize(arcs + 1);
    levels_[arcs].push_back(std::move(node));
  }

  // How good a place is to go on from: how far the next arc gets.
  void judge(Stop& stop) const {
    const ArcReach reach = band_.reach(stop.entry);
    const auto& samples = band_.samples();
    stop.reach = reach.end;
    stop.score = samples[reach.end - 1].station;
    if (reach.end < count_) {
      const double step = samples[reach.end].station - stop.score;
      stop.score += 0.5 * step * std::min(1.0, reach.margin / options_.tolerance);
    }
  }

  // Judges it where it may be one of the leading ones.
  void consider(Stop stop) {
    if (may_lead(stop)) {
      judge(stop);
      leading_.add(stop, found_.size());
    } else {
      stop.score = band_.samples()[leading_.least_reach() - 1].station;
    }
    found_.push_back(stop);
  }

  // The same where arcs are not run as they are: then a nearer one may be better, or the only one.
  // Most do not hold; those are left out at once.
  void consider_run(const Stop& stop, double curvature) {
    const BandEntry& entry = nodes_[static_cast<std::size_t>(stop.before)].entry;
    const PlaneArc arc = node_of(stop).arc;
    if (arc.is_line()) return consider_held(stop, arc, {options_.tolerance, options_.tolerance});
    const double length = arc.length();
    const double from = station_of(entry);
    const ArcRunning::Run run = options_.running.run_of(arc, length, from, from + length);
    const double part = run.good_part(std::min(options_.outside, options_.tolerance));
    if (part < 1) {
      if (const auto nearer = nearer_stop(stop, curvature, part * length)) {
        if (may_lead(*nearer)) {
          const PlaneArc shorter = node_of(*nearer).arc;
          consider_held(*nearer, shorter, sides_of(shorter, from));
        }
      }
    }
    consider_held(stop, arc, run.sides_within(options_.tolerance));
  }

  void consider_held(Stop stop, const PlaneArc& arc, const ArcSides& sides) {
    if (!sides.any() || !may_lead(stop)) return;
    judge(stop);
    if (!leading_.takes(stop)) return;
    const BandEntry& entry = nodes_[static_cast<std::size_t>(stop.before)].entry;
    const auto passed = band_.passed(entry, arc, sides);
    if (!passed || *passed < entry.next) return;
    leading_.add(stop, found_.size());
    found_.push_back(stop);
  }

  [[nodiscard]] bool may_lead(const Stop& stop) const {
    const std::size_t least = leading_.least_reach();
    return least < count_ && band_.may_reach(stop.entry, least);
  }

  void add_starts() {
    const Point2 start = band_.samples().front().place;
    for (const double off : kStarts) {
      Node node;
      const double angle = options_.start_angle.value_or(options_.direction + off);
      node.entry = {start, unit_vector(angle), 1};
      node.arc = {start, start};  // none arrives at a start
      judge(node);
      add_to(0, node);
      if (options_.start_angle) break;
    }
  }

  // The farthest-seeing nodes, that are followed; the others are gone.
  std::vector<std::size_t> best_of_level(std::size_t arcs) {
    std::vector<Node> level = std::exchange(levels_[arcs], {});
    std::ranges::stable_sort(level, std::greater<>(), &Node::score);
    if (level.size() > effort_.width) level.resize(effort_.width);
    std::vector<std::size_t> followed;
    for (Node& node : level) {
      followed.push_back(nodes_.size());
      nodes_.push_back(std::move(node));
    }
    return followed;
  }

  [[nodiscard]] Point2 rounded(const Point2& p) const {
    if (!(options_.grid > 0)) return p;
    return {std::round(p.x() / options_.grid) * options_.grid,
            std::round(p.y() / options_.grid) * options_.grid};
  }

  // The stop there, for the arc that leaves node `from` along its tangent: a line where that is
  // flatter than any arc may be.
  [[nodiscard]] Stop stop_at(std::size_t from, const Point2& end, std::size_t next) const {
    const BandEntry& entry = nodes_[from].entry;
    const Vector2 chord = end - entry.place;
    const bool flat = is_flat(entry.along, chord);
    return {{end, flat ? chord.normalized() : mirrored(entry.along, chord), next},
            static_cast<std::ptrdiff_t>(from)};
  }

  [[nodiscard]] bool is_flat(const Vector2& along, const Vector2& chord) const {
    return 2 * options_.max_radius * std::abs(cross(along, chord)) <= chord.squaredNorm();
  }

  [[nodiscard]] Node node_of(const Stop& stop) const {
    const BandEntry& from = nodes_[static_cast<std::size_t>(stop.before)].entry;
    Node node;
    node.Stop::operator=(stop);
    node.arc = arc_leaving(from.place, from.along, stop.entry.place, options_.max_radius);
    return node;
  }

  [[nodiscard]] Node node_to(std::size_t from, const Point2& end, std::size_t next) const {
    return node_of(stop_at(from, end, next));
  }

  // The point beside sample j on the arc of this curvature.
  static Point2 place_on(const BandEntry& entry, double curvature, const Point2& sample) {
    const Vector2 left(-entry.along.y(), entry.along.x());
    const Vector2 way = sample - entry.place;
    if (curvature == 0) return entry.place + way.dot(entry.along) * entry.along;
    const double radius = 1 / curvature;
    const Point2 center = entry.place + radius * left;
    const Vector2 out = sample - center;
    return center + std::abs(radius) / std::max(out.norm(), kSamePlace) * out;
  }

  [[nodiscard]] std::optional<Stop> stop_on(std::size_t from, double curvature,
                                            std::size_t sample) const {
    const BandEntry& entry = nodes_[from].entry;
    const Point2 end = rounded(place_on(entry, curvature, band_.samples()[sample].place));
    const Vector2 chord = end - entry.place;
    const double least = 2 * options_.grid + kSamePlace;
    if (chord.squaredNorm() <= least * least) return std::nullopt;
    // A flat arc that is written as a line would make a kink of half its sweep.
    if (curvature != 0 && is_flat(entry.along, chord)) return std::nullopt;
    return stop_at(from, end, sample + 1);
  }

  [[nodiscard]] double station_of(const BandEntry& entry) const {
    return band_.samples()[entry.next - 1].station;
  }

  // A stop that is nearer: so long is its arc.
  [[nodiscard]] std::optional<Stop> nearer_stop(const Stop& stop, double curvature,
                                                double length) const {
    const BandEntry& entry = nodes_[static_cast<std::size_t>(stop.before)].entry;
    const double turn = length * curvature;
    const Vector2 left(-entry.along.y(), entry.along.x());
    const Point2 end = rounded(entry.place + std::sin(turn) / curvature * entry.along +
                               (1 - std::cos(turn)) / curvature * left);
    const Vector2 chord = end - entry.place;
    if (chord.norm() <= 2 * options_.grid + kSamePlace || is_flat(entry.along, chord)) {
      return std::nullopt;
    }
    const std::size_t last = sample_at(station_of(entry) + length, entry.next, stop.entry.next - 1);
    return stop_at(static_cast<std::size_t>(stop.before), end, last + 1);
  }

  // Every arc from node i that is worth a look.
  void spread(std::size_t i) {
    const ArcFan fan = band_.fan(nodes_[i].entry);
    const auto& samples = band_.samples();
    const std::size_t next = nodes_[i].entry.next;
    if (fan.empty()) return;
    const double start = samples[next - 1].station;
    const double reach = samples[next + fan.size() - 1].station - start;
    std::size_t last = count_;
    for (const double part : effort_.parts) {
      const std::size_t j = sample_at(start + part * reach, next, next + fan.size() - 1);
      if (j == last || j + 1 == count_) continue;
      last = j;
      const CurvatureRange& range = fan[j - next];
      const auto add = [&](double curvature) {
        auto stop = stop_on(i, curvature, j);
        if (!stop) return;
        options_.running.error ? consider_run(*stop, curvature) : consider(*stop);
      };
      if (range.low < 0 && range.high > 0) add(0);
      for (const double place : effort_.in_range) {
        const double curvature = range.low + place * (range.high - range.low);
        if (std::abs(curvature) * options_.max_radius > 1) add(curvature);
      }
    }
  }

  // The last sample in [low, high] at or before a station.
  [[nodiscard]] std::size_t sample_at(double station, std::size_t low, std::size_t high) const {
    const auto& samples = band_.samples();
    const auto begin = samples.begin() + static_cast<std::ptrdiff_t>(low);
    const auto end = samples.begin() + static_cast<std::ptrdiff_t>(high) + 1;
    const auto after = std::upper_bound(
        begin, end, station + kSamePlace,
        [](double s, const PlaneBand::Sample& sample) { return s < sample.station; });
    return after == begin ? low : static_cast<std::size_t>(after - samples.begin()) - 1;
  }

  // Keeps the best of the found ones that hold.
  void follow(std::size_t arcs) {
    std::vector<Node> kept;
    for (const LeadingStops::Lead& lead : leading_.leads()) {
      auto node = held(found_[lead.index]);
      if (!node) return follow_all(arcs);  // another one of that place takes its turn
      kept.push_back(std::move(*node));
    }
    for (Node& node : kept) add_to(arcs, std::move(node));
  }

  // The same, one after the other, those too that were not judged.
  void follow_all(std::size_t arcs) {
    const auto is_after = [&](std::size_t a, std::size_t b) {
      return found_[a].score < found_[b].score || (found_[a].score == found_[b].score && a > b);
    };
    std::vector<std::size_t> order(found_.size());  // a heap, the best one first
    std::iota(order.begin(), order.end(), 0);
    std::ranges::make_heap(order, is_after);
    std::vector<std::size_t> places;  // of those that are kept
    while (!order.empty() && places.size() < effort_.width) {
      std::ranges::pop_heap(order, is_after);
      Stop& stop = found_[order.back()];
      if (stop.reach == 0) {
        judge(stop);
        std::ranges::push_heap(order, is_after);
        continue;
      }
      order.pop_back();
      if (std::ranges::count(places, stop.entry.next) == effort_.of_one_place) continue;
      auto node = held(stop);
      if (!node) continue;
      places.push_back(stop.entry.next);
      add_to(arcs, std::move(*node));
    }
  }

  // With the arc that arrives there, where it holds.
  [[nodiscard]] std::optional<Node> held(const Stop& stop) const {
    Node node = node_of(stop);
    const BandEntry& from = nodes_[static_cast<std::size_t>(node.before)].entry;
    const auto passed = passes(from, node.arc);
    if (!passed || *passed < from.next) return std::nullopt;
    node.entry.next = *passed;
    return node;
  }

  void offer(Node node, std::size_t arcs) {
    if (arcs >= best_arcs_) return;
    best_arcs_ = arcs;
    best_ = nodes_.size();
    nodes_.push_back(std::move(node));
  }

  // One arc or two from node i to the end.
  void finish(std::size_t i, std::size_t arcs) {
    if (arcs + 1 >= best_arcs_) return;
    const auto& samples = band_.samples();
    const BandEntry entry = nodes_[i].entry;
    const Point2 end = samples.back().place;
    if ((end - entry.place).norm() <= kSamePlace) return;
    if (nodes_[i].reach == count_ && finish_with_one(i, entry, end, arcs)) return;
    if (!end_along_ || arcs + 2 >= best_arcs_) return;
    const double reached = samples[nodes_[i].reach - 1].station;
    const double left = samples.back().station - reached;
    if (left > kSpline.two_reach * (reached - samples[entry.next - 1].station)) return;
    finish_with_two(i, entry, end, arcs);
  }

  bool finish_with_one(std::size_t i, const BandEntry& entry, const Point2& end, std::size_t arcs) {
    const Node node = node_to(i, end, count_);
    if (!allowed(node.arc)) return false;
    const double sharp = kSpline.same_turn + 2 * options_.grid / node.arc.length();
    const auto turns = [&](const Vector2& from, const Vector2& to) {
      return std::abs(angle_between(from, to)) > sharp;
    };
    if (node.arc.is_line() && turns(entry.along, end - entry.place)) return false;
    if (end_along_ && turns(node.entry.along, *end_along_)) return false;
    if (passes(entry, node.arc) != count_) return false;
    offer(node, arcs + 1);
    return true;
  }

  void finish_with_two(std::size_t i, const BandEntry& entry, const Point2& end, std::size_t arcs) {
    for (const double balance : kBalances) {
      const auto joint = biarc_joint(entry.place, entry.along, end, *end_along_, balance);
      if (!joint) continue;
      const Point2 middle = rounded(joint->place);
      Node first = node_to(i, middle, 0);
      if (!allowed(first.arc)) continue;
      const auto next = passes(entry, first.arc);
      if (!next || *next == count_) continue;
      first.entry.next = *next;
      Node second;
      second.arc = arc_arriving(middle, end, *end_along_, options_.max_radius);
      if (!allowed(second.arc) || passes(first.entry, second.arc) != count_) continue;
      second.entry = {end, *end_along_, count_};
      second.before = static_cast<std::ptrdiff_t>(nodes_.size());
      nodes_.push_back(first);
      offer(second, arcs + 2);
      return;
    }
  }

  [[nodiscard]] std::optional<std::size_t> passes(const BandEntry& entry,
                                                  const PlaneArc& arc) const {
    return band_.passed(entry, arc, sides_of(arc, station_of(entry)));
  }

  // Of an arc that starts beside this station.
  [[nodiscard]] ArcSides sides_of(const PlaneArc& arc, double from) const {
    const double length = arc.length();
    return options_.running.sides_of(arc, length, options_.tolerance, from, from + length);
  }

  [[nodiscard]] bool allowed(const PlaneArc& arc) const {
    return arc.length() > kSamePlace && std::abs(arc.sweep) <= options_.max_sweep &&
           (arc.is_line() || arc.radius >= options_.min_radius);
  }

  // Where a corner of the polyline is among the last samples that arcs from node i pass,
  // or the first that they do not, the chain may turn as sharply as it.
  void turn_at_corner(std::size_t i, std::size_t arcs) {
    const auto& samples = band_.samples();
    const ArcFan fan = band_.fan(nodes_[i].entry);
    const std::size_t next = nodes_[i].entry.next;
    const std::size_t end = next + fan.size();
    for (std::size_t c = std::max(next, end - std::min(end, kSpline.corner_back)); c < end; ++c) {
      if (c + 1 >= count_ || std::abs(samples[c].turn) < kSpline.kink_turn) continue;
      const CurvatureRange& range = fan[c - next];
      add_turns(stop_on(i, range.middle(), c), c, arcs);
      add_turns(stop_on(i, nearest_in(range, i, c), c), c, arcs);
      return;
    }
  }

  // No arc goes on from any node of a level: turn at the farthest place that one reaches.
  void turn_where_stuck(const std::vector<std::size_t>& level, std::size_t arcs) {
    for (const std::size_t i : level) {
      const ArcFan fan = band_.fan(nodes_[i].entry);
      const std::size_t next = nodes_[i].entry.next;
      for (std::size_t j = next + fan.size(); j-- > next;) {
        if (j + 1 >= count_) continue;
        if (add_turns(stop_on(i, fan[j - next].middle(), j), j, arcs)) break;
      }
    }
  }

  // The curvature in the range with which an arc from node i passes nearest to the sample.
  [[nodiscard]] double nearest_in(const CurvatureRange& range, std::size_t i,
                                  std::size_t sample) const {
    const BandEntry& entry = nodes_[i].entry;
    const Vector2 way = band_.samples()[sample].place - entry.place;
    const double through = 2 * cross(entry.along, way) / way.squaredNorm();
    const double margin = kSpline.range_margin * (range.high - range.low);
    return std::clamp(through, range.low + margin, range.high - margin);
  }

  // The chain goes on from the stop in directions about that of the edge after the sample.
  bool add_turns(const std::optional<Stop>& stop, std::size_t sample, std::size_t arcs) {
    if (!stop) return false;
    Node node = node_of(*stop);
    if (!allowed(node.arc)) return false;
    const BandEntry& from = nodes_[static_cast<std::size_t>(node.before)].entry;
    const auto passed = passes(from, node.arc);
    if (!passed || *passed >= count_ || *passed <= from.next) return false;
    node.kink = true;
    const Vector2& edge_way = band_.samples()[sample + 1].edge_way;
    for (const double off : kStarts) {
      const Vector2 along = unit_vector(std::atan2(edge_way.y(), edge_way.x()) + off);
      node.entry = {node.arc.end, along, *passed};
      judge(node);
      add_to(arcs + 1 + kSpline.kink_costs, node);
    }
    return true;
  }

  [[nodiscard]] std::optional<ArcSpline> chain() const {
    if (!best_) return std::nullopt;
    ArcSpline spline;
    const auto& samples = band_.samples();
    for (const Node* node = &nodes_[*best_]; node->before >= 0;
         node = &nodes_[static_cast<std::size_t>(node->before)]) {
      spline.pieces.push_back({node->arc, samples[node->entry.next - 1].station});
      if (node->kink) ++spline.kinks;
    }
    std::reverse(spline.pieces.begin(), spline.pieces.end());
    return spline;
  }

  const ArcSplineOptions& options_;
  const Effort& effort_;
  PlaneBand band_;
  std::size_t count_;
  std::optional<Vector2> end_along_;
  std::vector<Node> nodes_;
  std::vector<Stop> found_;                // from the nodes of a level
  LeadingStops leading_;                   // of those
  std::vector<std::vector<Node>> levels_;  // to be followed, by the number of arcs so far
  std::size_t best_arcs_;                  // what the best chain so far costs
  std::optional<std::size_t> best_;        // its last node
};

void check(const ArcSplineOptions& options) {
  require(options.tolerance > 0, "fit_arc_spline: tolerance", options.tolerance, "> 0");
  require(options.min_radius > 0, "fit_arc_spline: min_radius", options.min_radius, "> 0");
  require(options.max_radius > options.min_radius, "fit_arc_spline: max_radius", options.max_radius,
          "above min_radius");
  require(options.max_sweep > 0 && options.max_sweep < kPi, "fit_arc_spline: max_sweep",
          options.max_sweep, "above 0 and below pi");
}

std::size_t cost_of(const ArcSpline& spline) {
  return spline.pieces.size() + kSpline.kink_costs * static_cast<std::size_t>(spline.kinks);
}

// With as many arcs, how much nearer can the chain be?
ArcSpline drawn_near(std::span<const Point2> points, const ArcSplineOptions& options,
                     ArcSpline found) {
  ArcSplineOptions nearer = options;
  for (int round = 0; round < kSpline.nearer_rounds; ++round) {
    nearer.tolerance *= kSpline.nearer;
    auto next = Search(points, nearer, cost_of(found)).run();
    if (!next) break;
    found = std::move(*next);
  }
  return found;
}

}  // namespace

std::optional<ArcSpline> fit_arc_spline(std::span<const Point2> points,
                                        const ArcSplineOptions& options) {
  check(options);
  auto found = Search(points, options, options.at_most).run();
  if (found && found->pieces.size() <= kSpline.few) {
    return drawn_near(points, options, std::move(*found));
  }
  return found;
}

}  // namespace batten::geometry
