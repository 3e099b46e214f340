#include "postproc/proof/event_violations.h"

#include <fmt/format.h>

#include <algorithm>
#include <string>
#include <utility>

namespace batten::postproc {
namespace {

// More of one gap say nothing new.
constexpr std::size_t kMostPerGap = 20;

std::uint32_t line_of(const ProgramEvent& event, const ReadProgram& read) {
  return read.program->blocks[event.block].line;
}

std::string describe(const ProgramEvent& event, const ReadProgram& read) {
  if (event.motion < 0) return event.text;
  const auto& motion = read.interpretation->motions[static_cast<std::size_t>(event.motion)];
  const geometry::Point3 end = motion.piece.end();
  const std::string what = event.kind == EventKind::kRapid ? "rapid" : event.text;
  return fmt::format("{} to X{:.6g} Y{:.6g} Z{:.6g} mm", what, end.x(), end.y(), end.z());
}

Violation make(ViolationKind kind, std::string id, std::uint32_t old_line, std::uint32_t new_line,
               std::string message) {
  Violation violation;
  violation.kind = kind;
  violation.id = std::move(id);
  violation.old_line = old_line;
  violation.new_line = new_line;
  violation.message = std::move(message);
  return violation;
}

Violation one_sided(const ProgramEvent& event, const ReadProgram& read, bool lost) {
  const bool rapid = event.kind == EventKind::kRapid;
  const std::uint32_t line = line_of(event, read);
  return make(rapid ? ViolationKind::kRapid : ViolationKind::kEvent,
              std::string(rapid ? "rapid-" : "event-") + (lost ? "lost" : "added"), lost ? line : 0,
              lost ? 0 : line, describe(event, read));
}

Violation changed(const ProgramEvent& before, const ReadProgram& old_program,
                  const ProgramEvent& after, const ReadProgram& new_program) {
  const bool rapid = before.kind == EventKind::kRapid;
  return make(rapid ? ViolationKind::kRapid : ViolationKind::kEvent,
              rapid ? "rapid-changed" : "event-changed", line_of(before, old_program),
              line_of(after, new_program),
              fmt::format("found {}, expected {}", describe(after, new_program),
                          describe(before, old_program)));
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

GapReport report_events_between(const EventSpan& lost, const EventSpan& added) {
  GapReport gap;
  gap.only_words = !moves(lost) && !moves(added);
  const bool one_to_one =
      lost.events.size() == added.events.size() &&
      std::ranges::equal(lost.events, added.events, {}, &ProgramEvent::kind, &ProgramEvent::kind);
  if (one_to_one) {
    for (std::size_t i = 0; i < lost.events.size() && i < kMostPerGap; ++i) {
      gap.violations.push_back(changed(lost.events[i], *lost.read, added.events[i], *added.read));
    }
    return gap;
  }
  for (std::size_t i = 0; i < lost.events.size() && i < kMostPerGap; ++i) {
    gap.violations.push_back(one_sided(lost.events[i], *lost.read, true));
  }
  for (std::size_t i = 0; i < added.events.size() && i < kMostPerGap; ++i) {
    gap.violations.push_back(one_sided(added.events[i], *added.read, false));
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

Violation rapid_violation(const ProgramEvent& before, const ReadProgram& old_program,
                          const ProgramEvent& after, const ReadProgram& new_program) {
  return make(ViolationKind::kRapid, "rapid-changed", line_of(before, old_program),
              line_of(after, new_program),
              fmt::format("{} starts or ends at another place; expected {}",
                          describe(after, new_program), describe(before, old_program)));
}

Violation moved_event_violation(const ProgramEvent& before, const ReadProgram& old_program,
                                const ProgramEvent& after, const ReadProgram& new_program,
                                double moved_mm) {
  Violation violation =
      make(ViolationKind::kEvent, "event-moved", line_of(before, old_program),
           line_of(after, new_program),
           fmt::format("{}: the path is the same, but it stands at another place of it",
                       describe(before, old_program)));
  violation.deviation_mm = moved_mm;
  return violation;
}

Violation state_violation(std::string_view item, const ProgramEvent& before,
                          const ReadProgram& old_program, const ProgramEvent& after,
                          const ReadProgram& new_program) {
  return make(ViolationKind::kState, "state-changed", line_of(before, old_program),
              line_of(after, new_program),
              fmt::format("another {} than before at {}", item, describe(before, old_program)));
}

Violation end_state_violation(std::string_view item, const ReadProgram& old_program,
                              const ReadProgram& new_program) {
  const auto last_line = [](const ReadProgram& read) {
    return read.program->blocks.empty() ? 0 : read.program->blocks.back().line;
  };
  return make(ViolationKind::kState, "state-changed", last_line(old_program),
              last_line(new_program),
              fmt::format("another {} than before at the end of the program", item));
}

Violation too_many_differences(const EventSpan& before, std::size_t next_before,
                               const EventSpan& after, std::size_t next_after) {
  const auto line = [](const EventSpan& span, std::size_t next) {
    return next < span.events.size() ? line_of(span.events[next], *span.read) : 0U;
  };
  return make(ViolationKind::kEvent, "too-many-differences", line(before, next_before),
              line(after, next_after), "the rest of the programs was not compared");
}

}  // namespace batten::postproc
