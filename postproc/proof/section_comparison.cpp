#include "postproc/proof/section_comparison.h"

#include <fmt/format.h>

#include <algorithm>
#include <iterator>
#include <string>
#include <utility>

#include "postproc/proof/part_comparison.h"
#include "postproc/proof/path_part.h"

namespace batten::postproc {
namespace {

using geometry::PathComparison;
using geometry::Verdict;

std::string feed_text(const Cut& cut) {
  return cut.feed ? fmt::format("{:.6g} mm/min{}", *cut.feed,
                                cut.feed_without_point ? " without a decimal point" : "")
                  : std::string("none known");
}

class SectionComparer {
 public:
  SectionComparer(const SectionSide& before, const SectionSide& after, const Promise& promise)
      : before_(before), after_(after), promise_(promise) {}

  SectionComparison run() {
    const std::vector<PathPart> old_parts = parts_of_one_feed(before_);
    const std::vector<PathPart> new_parts = parts_of_one_feed(after_);
    const bool one_side_only = old_parts.empty() || new_parts.empty();
    if (one_side_only || !same_feeds(old_parts, new_parts)) {
      compare_part({all_of(before_), all_of(after_)});
      return std::move(result_);
    }
    for (std::size_t i = 0; i < old_parts.size(); ++i) compare_part({old_parts[i], new_parts[i]});
    if (old_parts.size() > 1 && std::ranges::any_of(result_.violations, is_of_distance)) {
      look_for_moved_feed();
    }
    return std::move(result_);
  }

 private:
  static bool is_of_distance(const Violation& violation) {
    return violation.kind == ViolationKind::kDistance ||
           violation.kind == ViolationKind::kNotProved;
  }

  bool same_feeds(const std::vector<PathPart>& old_parts, const std::vector<PathPart>& new_parts) {
    const std::size_t both = std::min(old_parts.size(), new_parts.size());
    const auto violate = [this](std::uint32_t old_line, std::uint32_t new_line,
                                const std::string& message) {
      result_.violations.push_back(
          {ViolationKind::kFeed, "feed-changed", old_line, new_line, 0, message});
      return false;
    };
    for (std::size_t i = 0; i < both; ++i) {
      const Cut& old_feed = old_parts[i].cut(0);
      const Cut& new_feed = new_parts[i].cut(0);
      if (same_feed(old_feed, new_feed)) continue;
      return violate(old_parts[i].line(0), new_parts[i].line(0),
                     fmt::format("feed {}, expected {}", feed_text(new_feed), feed_text(old_feed)));
    }
    const auto end_line = [](const PathPart& part) { return part.line(part.size()); };
    if (old_parts.size() > both) {
      const PathPart& lost = old_parts[both];
      return violate(lost.line(0), end_line(new_parts.back()),
                     fmt::format("feed {} is missing", feed_text(lost.cut(0))));
    }
    if (new_parts.size() > both) {
      const PathPart& added = new_parts[both];
      return violate(end_line(old_parts.back()), added.line(0),
                     fmt::format("feed {} was not there", feed_text(added.cut(0))));
    }
    return true;
  }

  void compare_part(const PathPartPair& pair) {
    SectionComparison found = compared_in_parts(pair);
    std::ranges::move(found.sections, std::back_inserter(result_.sections));
    std::ranges::move(found.violations, std::back_inserter(result_.violations));
  }

  // A path that keeps the least tolerance of its parts keeps that of each.
  [[nodiscard]] SectionComparison compared_in_parts(const PathPartPair& pair) const {
    const double promised = promise_.tolerance_mm;
    const double least = least_tolerance(pair.before, promised);
    // Of a side the corner where a path is cut would be in none of its parts.
    const bool any_change = !before_.read->interpretation->stated.empty();
    if (!any_change || promise_.side != geometry::Side::kBoth) return compared_within(least, pair);
    const auto old_parts = parts_of_one_tolerance(pair.before, promised);
    if (old_parts.size() < 2) return compared_within(least, pair);
    const auto new_parts = parts_of_one_tolerance(pair.after, promised);
    const bool says_the_same = std::ranges::equal(
        old_parts, new_parts, {}, &ToleratedPart::tolerance_mm, &ToleratedPart::tolerance_mm);
    if (!says_the_same) return compared_within(least, pair);
    SectionComparison all = compared_apart(old_parts, new_parts);
    // The new path of one part may cross that of another.
    if (all.violations.empty()) {
      all.violations = crossing_violations(pair, without_same_ends(pair), promised);
    }
    if (all.violations.empty()) return all;
    SectionComparison whole = compared_within(least, pair);
    // Where the new program says it elsewhere on the path its parts are no help to who reads this.
    const double of_whole = greatest_deviation(whole.violations);
    const bool is_nearer = of_whole > 0 && of_whole < greatest_deviation(all.violations);
    return whole.violations.empty() || is_nearer ? whole : all;
  }

  // mm; 0 where nothing is known to break the tolerance.
  static double greatest_deviation(const std::vector<Violation>& violations) {
    double greatest = 0;
    for (const Violation& each : violations) greatest = std::max(greatest, each.deviation_mm);
    return greatest;
  }

  [[nodiscard]] SectionComparison compared_apart(
      const std::vector<ToleratedPart>& old_parts,
      const std::vector<ToleratedPart>& new_parts) const {
    SectionComparison all;
    for (std::size_t i = 0; i < old_parts.size(); ++i) {
      SectionComparison part =
          compared_within(old_parts[i].tolerance_mm, {old_parts[i].part, new_parts[i].part});
      std::ranges::move(part.sections, std::back_inserter(all.sections));
      std::ranges::move(part.violations, std::back_inserter(all.violations));
    }
    return all;
  }

  [[nodiscard]] SectionComparison compared_within(double tolerance_mm,
                                                  const PathPartPair& pair) const {
    Promise promise = promise_;
    promise.tolerance_mm = tolerance_mm;
    return postproc::compare_part(pair, promise);
  }

  // Parts that break the tolerance of a path that keeps it: a feed begins at another place.
  void look_for_moved_feed() {
    const PathComparison whole = compare_whole_path(before_, after_, promise_);
    if (whole.verdict != Verdict::kProved) return;
    const double least = least_tolerance(all_of(before_), promise_.tolerance_mm);
    for (Violation& violation : result_.violations) {
      if (!is_of_distance(violation)) continue;
      violation.kind = ViolationKind::kFeed;
      violation.id = "feed-moved";
      violation.message = fmt::format(
          "the path is the same within {:.6g} mm, but a feed begins or ends at another position",
          least);
    }
  }

  const SectionSide& before_;
  const SectionSide& after_;
  const Promise& promise_;
  SectionComparison result_;
};

}  // namespace

SectionComparison compare_section(const SectionSide& before, const SectionSide& after,
                                  const Promise& promise) {
  return SectionComparer(before, after, promise).run();
}

geometry::PathComparison compare_whole_path(const SectionSide& before, const SectionSide& after,
                                            const Promise& promise) {
  Promise least = promise;
  least.tolerance_mm = least_tolerance(all_of(before), promise.tolerance_mm);
  return compare_distance({all_of(before), all_of(after)}, least).paths;
}

std::optional<std::vector<MatchedPart>> match_section(const SectionSide& before,
                                                      const SectionSide& after,
                                                      double tolerance_mm) {
  std::vector<PathPart> old_parts = parts_of_one_feed(before);
  std::vector<PathPart> new_parts = parts_of_one_feed(after);
  if (old_parts.empty() && new_parts.empty()) return std::vector<MatchedPart>{};
  if (old_parts.empty()) old_parts.push_back(all_of(before));
  if (new_parts.empty()) new_parts.push_back(all_of(after));
  if (old_parts.size() != new_parts.size()) return {};
  std::vector<MatchedPart> matched;
  for (std::size_t i = 0; i < old_parts.size(); ++i) {
    const PathPart& old_part = old_parts[i];
    const PathPart& new_part = new_parts[i];
    const bool both = old_part.size() > 0 && new_part.size() > 0;
    if (both && !same_feed(old_part.cut(0), new_part.cut(0))) return {};
    MatchedPart part{old_part.path(), new_part.path(), {}};
    part.matching = geometry::match_paths(part.before, part.after, tolerance_mm);
    if (part.matching.comparison.verdict != Verdict::kProved) return {};
    matched.push_back(std::move(part));
  }
  return matched;
}

}  // namespace batten::postproc
