// Violations of the order and the contents of events, in words.
#pragma once

#include <span>
#include <string_view>
#include <vector>

#include "postproc/proof/program_events.h"
#include "postproc/proof/verification.h"

namespace batten::postproc {

struct EventSpan {
  std::span<const ProgramEvent> events;
  const ReadProgram* read = nullptr;
};

struct GapReport {
  std::vector<Violation> violations;
  bool only_words = true;  // neither rapids nor blocks that may move stand in the gap
};

// Events between two that are the same in both programs: changed where both have one of a kind,
// else lost or added.
[[nodiscard]] GapReport report_events_between(const EventSpan& lost, const EventSpan& added);

// A lost and an added event that say the same become one that was moved.
void merge_moved_events(std::vector<Violation>& violations);

[[nodiscard]] Violation rapid_violation(const ProgramEvent& before, const ReadProgram& old_program,
                                        const ProgramEvent& after, const ReadProgram& new_program);

// The event stands at another place of the path, at least `moved_mm` away.
[[nodiscard]] Violation moved_event_violation(const ProgramEvent& before,
                                              const ReadProgram& old_program,
                                              const ProgramEvent& after,
                                              const ReadProgram& new_program, double moved_mm);

[[nodiscard]] Violation state_violation(std::string_view item, const ProgramEvent& before,
                                        const ReadProgram& old_program, const ProgramEvent& after,
                                        const ReadProgram& new_program);
[[nodiscard]] Violation end_state_violation(std::string_view item, const ReadProgram& old_program,
                                            const ReadProgram& new_program);

// The programs have so little in common that the rest was not compared.
[[nodiscard]] Violation too_many_differences(const EventSpan& before, std::size_t next_before,
                                             const EventSpan& after, std::size_t next_after);

}  // namespace batten::postproc
