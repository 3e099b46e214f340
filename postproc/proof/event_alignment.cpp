#include "postproc/proof/event_alignment.h"

#include <algorithm>
#include <cmath>
#include <optional>

#include "geometry/basic/rounding.h"

namespace batten::postproc {
namespace {

// How many events may be lost or added at one place and still be told one by one.
constexpr std::size_t kFurthest = 400;

// Places at which the lists may differ before the rest is given up. A person reads the first
// few; each costs up to kFurthest^2 comparisons.
constexpr std::size_t kMostDifferences = 50;

// mm: half a step of what is printed where the numbers of another language are not the source's:
// Klartext and Siemens words have 4 decimals of a millimetre, 5 of an inch, plain words 3 and 4.
constexpr double kPrintedAnew = 0.00013;
constexpr double kPrintedInPlainMillimetres = 0.0005 + 1e-6;
constexpr double kPrintedInPlainInches = 0.00127 + 1e-6;

double same_place_in(const gcode::Motion& motion, const ReadProgram& read) {
  if (read.program->language != gcode::Language::kRs274) return kPrintedAnew;
  const auto& block = read.interpretation->blocks[motion.block];
  const bool inch = read.interpretation->states[block.state_after].units == gcode::Units::kInch;
  return inch ? kPrintedInPlainInches : kPrintedInPlainMillimetres;
}

bool same_rapid(const gcode::Motion& before, const gcode::Motion& after, double same_place) {
  const geometry::Point3& old_end = before.piece.end();
  const geometry::Point3& new_end = after.piece.end();
  for (int axis = 0; axis < 3; ++axis) {
    const auto i = static_cast<std::size_t>(axis);
    const bool named = before.axes_named[i] || after.axes_named[i];
    if (named && std::abs(old_end[axis] - new_end[axis]) > same_place) return false;
  }
  return true;
}

const gcode::Motion& motion_of(const ProgramEvent& event, const ReadProgram& read) {
  return read.interpretation->motions[static_cast<std::size_t>(event.motion)];
}

class Aligner {
 public:
  Aligner(const ProgramEvents& before, const ReadProgram& old_program, const ProgramEvents& after,
          const ReadProgram& new_program)
      : before_(before), old_(old_program), after_(after), new_(new_program) {}

  EventAlignment run() {
    EventAlignment found;
    EventPair here;
    std::size_t differences = 0;
    while (here.before < before_.events.size() && here.after < after_.events.size()) {
      if (same(here)) {
        found.same.push_back(here);
        here = {here.before + 1, here.after + 1};
        continue;
      }
      const std::optional<EventPair> next = same_again_after(here);
      if (++differences > kMostDifferences || !next) {
        found.complete = differences <= kMostDifferences && at_end_within_reach(here);
        return found;
      }
      here = *next;
    }
    return found;
  }

 private:
  [[nodiscard]] bool same(const EventPair& pair) const {
    return same_event(before_.events[pair.before], old_, after_.events[pair.after], new_);
  }

  // Here and one further, where both programs go on.
  [[nodiscard]] bool same_twice(const EventPair& pair) const {
    if (!same(pair)) return false;
    const EventPair next{pair.before + 1, pair.after + 1};
    return next.before >= before_.events.size() || next.after >= after_.events.size() || same(next);
  }

  // The fewest events are left out in both together.
  [[nodiscard]] std::optional<EventPair> same_again_after(const EventPair& here) const {
    for (std::size_t sum = 1; sum <= kFurthest; ++sum) {
      for (std::size_t lost = 0; lost <= sum; ++lost) {
        const EventPair pair{here.before + lost, here.after + (sum - lost)};
        if (pair.before >= before_.events.size() || pair.after >= after_.events.size()) continue;
        if (same_twice(pair)) return pair;
      }
    }
    return {};
  }

  [[nodiscard]] bool at_end_within_reach(const EventPair& here) const {
    return before_.events.size() - here.before <= kFurthest &&
           after_.events.size() - here.after <= kFurthest;
  }

  const ProgramEvents& before_;
  const ReadProgram& old_;
  const ProgramEvents& after_;
  const ReadProgram& new_;
};

}  // namespace

bool same_event(const ProgramEvent& before, const ReadProgram& old_program,
                const ProgramEvent& after, const ReadProgram& new_program) {
  if (before.kind != after.kind || before.text != after.text) return false;
  if (before.motion < 0 || after.motion < 0) return before.motion == after.motion;
  const gcode::Motion& old_motion = motion_of(before, old_program);
  const gcode::Motion& new_motion = motion_of(after, new_program);
  const bool printed_anew = old_program.program->language != new_program.program->language;
  return same_rapid(old_motion, new_motion,
                    printed_anew ? same_place_in(new_motion, new_program) : geometry::kSamePlace);
}

EventAlignment align_events(const ProgramEvents& before, const ReadProgram& old_program,
                            const ProgramEvents& after, const ReadProgram& new_program) {
  return Aligner(before, old_program, after, new_program).run();
}

}  // namespace batten::postproc
