#include "postproc/report/kept_report.h"

#include <fmt/format.h>

#include <algorithm>
#include <nlohmann/json.hpp>

#include "gcode/state/reason.h"
#include "postproc/text/words.h"

namespace batten::postproc {
namespace {

using gcode::reason::Explanation;

// The greatest ones; the JSON report has them all.
constexpr std::size_t kMostCauses = 3;

// From this share on it is said what can be done.
constexpr double kMuch = 0.05;

Explanation explanation_of(std::string_view id) {
  const auto all = gcode::reason::explanations();
  const auto found = std::ranges::find(all, id, &Explanation::id);
  return found != all.end() ? *found : Explanation{id, "", ""};
}

std::string share_text(const KeptCauses& kept, const CutMoves& part) {
  const double percent = 100 * kept.share(part);
  const std::string number = percent >= 0.05 ? fmt::format("{:.1f} %", percent)
                             : percent > 0   ? "less than 0.1 %"
                                             : "none";
  return fmt::format("{} of the cutting {}", number, kept.is_by_length() ? "length" : "moves");
}

}  // namespace

std::string cause_text(const KeptCauses& kept, const KeptCause& cause) {
  std::string place;
  if (cause.line > 0) {
    place = fmt::format("since line {} '{}'", cause.line, cause.text);
    if (cause.times > 1) place += fmt::format(" and {} more", cause.times - 1);
  } else {
    place = fmt::format("first in line {} '{}'", cause.first_line, cause.text);
  }
  return fmt::format("{}, {} ({})", share_text(kept, cause.cut), place, cause.reason);
}

std::string cause_in_brief(const KeptCauses& kept) {
  constexpr double kWorthAColumn = 0.1;
  if (kept.causes.empty()) return {};
  const KeptCause& greatest = kept.causes.front();
  const double share = kept.share(greatest.cut);
  if (share < kWorthAColumn) return {};
  return fmt::format("{:.0f} % {}, line {}", 100 * share, greatest.reason,
                     greatest.line > 0 ? greatest.line : greatest.first_line);
}

std::string why_nothing(const KeptCauses& kept) {
  if (kept.all.moves == 0) return "nothing to smooth: no cutting move in X, Y or Z was found";
  if (kept.causes.empty()) return "nothing to smooth";
  const KeptCause& greatest = kept.causes.front();
  return fmt::format("nothing to smooth: {}. {}", cause_text(kept, greatest),
                     explanation_of(greatest.reason).advice);
}

void add_causes(const KeptCauses& kept, std::string& lines) {
  const auto& causes = kept.causes;
  for (std::size_t i = 0; i < std::min(causes.size(), kMostCauses); ++i) {
    const KeptCause& cause = causes[i];
    const Explanation reason = explanation_of(cause.reason);
    lines += titled("", fmt::format("kept: {}, {}: {}", plural(cause.cut.moves, "move"),
                                    cause_text(kept, cause), reason.text));
    if (reason.can_be_allowed) {
      lines += titled("", fmt::format("      --allow {} lifts this rule", reason.id));
    }
    if (kept.share(cause.cut) >= kMuch && !reason.advice.starts_with("Nothing")) {
      lines += titled("", fmt::format("      {}", reason.advice));
    }
  }
  if (causes.size() <= kMostCauses) return;
  CutMoves rest;
  for (std::size_t i = kMostCauses; i < causes.size(); ++i) rest += causes[i].cut;
  lines += titled(
      "", fmt::format("kept: {}, {}, for {}: see --json", plural(rest.moves, "move"),
                      share_text(kept, rest), plural(causes.size() - kMostCauses, "other reason")));
}

Json kept_json(const KeptCauses& kept) {
  const auto json_of = [&](const KeptCause& cause) -> Json {
    const Explanation reason = explanation_of(cause.reason);
    return {{"id", cause.reason},
            {"line", cause.line},
            {"first_line", cause.first_line},
            {"block", cause.text},
            {"times", cause.times},
            {"moves", cause.cut.moves},
            {"moves_without_length", cause.cut.without_length},
            {"length_mm", cause.cut.length_mm},
            {"share", kept.share(cause.cut)},
            {"text", reason.text},
            {"advice", reason.advice},
            {"can_be_allowed", reason.can_be_allowed}};
  };
  return {{"moves", kept.all.moves},
          {"moves_without_length", kept.all.without_length},
          {"length_mm", kept.all.length_mm},
          {"causes", json_list(kept.causes, json_of)}};
}

}  // namespace batten::postproc
