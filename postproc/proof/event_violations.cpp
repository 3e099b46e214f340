#include "postproc/proof/event_violations.h"

#include <fmt/format.h>

#include <algorithm>
#include <string>
#include <utility>

namespace batten::postproc {
namespace {

// More of one gap say nothing new.
constexpr std::size_t kMostPerGap = 20;

std::string describe(const EventAt& at) {
  const ProgramEvent& event = at.event;
  if (event.motion < 0) return event.text;
  const auto& motion = at.read.interpretation->motions[static_cast<std::size_t>(event.motion)];
  const geometry::Point3 end = motion.piece.end();
  const std::string what = event.kind == EventKind::kRapid ? "rapid" : event.text;
  return fmt::format("{} to X{:.6g} Y{:.6g} Z{:.6g} mm", what, end.x(), end.y(), end.z());
}

ViolationKind kind_of(const EventAt& at) {
  return at.event.kind == EventKind::kRapid ? ViolationKind::kRapid : ViolationKind::kEvent;
}

// "rapid-lost", "event-changed" ..
std::string id_of(const EventAt& at, const char* what) {
  return (at.event.kind == EventKind::kRapid ? "rapid-" : "event-") + std::string(what);
}

Violation lost(const EventAt& at) {
  return {kind_of(at), id_of(at, "lost"), at.line(), 0, 0, describe(at)};
}

Violation added(const EventAt& at) {
  return {kind_of(at), id_of(at, "added"), 0, at.line(), 0, describe(at)};
}

Violation changed(const EventAt& before, const EventAt& after) {
  return {kind_of(before),
          id_of(before, "changed"),
          before.line(),
          after.line(),
          0,
          fmt::format("found {}, expected {}", describe(after), describe(before))};
}

bool moves(const EventSpan& span) {
  return std::ranges::any_of(span.events,
                             [](const ProgramEvent& e) { return e.kind != EventKind::kWord; });
}

bool is_lost(const Violation& violation) {
  return violation.id == "event-lost" || violation.id == "rapid-lost";
}

bool is_added(const Violation& violation) {
  return violation.id == "event-added" || violation.id == "rapid-added";
}

}  // namespace

GapReport report_events_between(const EventSpan& before, const EventSpan& after) {
  GapReport gap;
  gap.only_words = !moves(before) && !moves(after);
  const bool one_to_one =
      before.events.size() == after.events.size() &&
      std::ranges::equal(before.events, after.events, {}, &ProgramEvent::kind, &ProgramEvent::kind);
  for (std::size_t i = 0; i < before.events.size() && i < kMostPerGap; ++i) {
    const EventAt old{before.events[i], *before.read};
    gap.violations.push_back(one_to_one ? changed(old, {after.events[i], *after.read}) : lost(old));
  }
  for (std::size_t i = 0; !one_to_one && i < after.events.size() && i < kMostPerGap; ++i) {
    gap.violations.push_back(added({after.events[i], *after.read}));
  }
  return gap;
}

void merge_moved_events(std::vector<Violation>& violations) {
  for (std::size_t i = 0; i < violations.size(); ++i) {
    if (!is_lost(violations[i])) continue;
    const auto twin = std::ranges::find_if(violations, [&](const Violation& other) {
      return is_added(other) && other.kind == violations[i].kind &&
             other.message == violations[i].message;
    });
    if (twin == violations.end()) continue;
    violations[i].id = "event-moved";
    violations[i].new_line = twin->new_line;
    violations[i].message += ": moved past other events";
    const auto at = static_cast<std::size_t>(twin - violations.begin());
    violations.erase(twin);
    if (at < i) --i;
  }
}

Violation rapid_violation(const EventAt& before, const EventAt& after) {
  return {ViolationKind::kRapid,
          "rapid-changed",
          before.line(),
          after.line(),
          0,
          fmt::format("{} starts or ends at another position; expected {}", describe(after),
                      describe(before))};
}

Violation moved_event_violation(const EventAt& before, const EventAt& after, double moved_mm) {
  return {ViolationKind::kEvent,
          "event-moved",
          before.line(),
          after.line(),
          moved_mm,
          fmt::format("{}: the path is the same, but it is at another position on it",
                      describe(before))};
}

Violation state_violation(std::string_view item, const EventAt& before, const EventAt& after) {
  return {ViolationKind::kState,
          "state-changed",
          before.line(),
          after.line(),
          0,
          fmt::format("another {} than before at {}", item, describe(before))};
}

Violation end_state_violation(std::string_view item, const ReadProgram& before,
                              const ReadProgram& after) {
  const auto last_line = [](const ReadProgram& read) {
    return read.program->blocks.empty() ? 0 : read.program->blocks.back().line;
  };
  return {ViolationKind::kState,
          "state-changed",
          last_line(before),
          last_line(after),
          0,
          fmt::format("another {} than before at the end of the program", item)};
}

Violation too_many_differences(const EventSpan& before, const EventSpan& after) {
  const auto line = [](const EventSpan& span) {
    return span.events.empty() ? 0U : EventAt{span.events.front(), *span.read}.line();
  };
  return {ViolationKind::kEvent,
          "too-many-differences",
          line(before),
          line(after),
          0,
          "the rest of the programs was not compared"};
}

}  // namespace batten::postproc
