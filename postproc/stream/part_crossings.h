// Do the parts of a long run cross each other where they did not before? Each is proved for itself;
// here the new text of those sections that are near to other parts (postproc/runs/run_cutting.h)
// is looked at together. Holds these sections, and nothing of the rest.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <utility>
#include <vector>

#include "gcode/interpreter/interpreter.h"
#include "gcode/text/program.h"
#include "geometry/band/self_proximity.h"
#include "postproc/proof/program_events.h"
#include "postproc/runs/run_cutting.h"
#include "postproc/runs/section.h"
#include "postproc/smooth/part_runs.h"

namespace batten::postproc {

// Of one long run, of the sections that are near to other parts of it.
struct NearEdges {
  std::size_t run = 0;  // index of its SelfProximity
  std::vector<geometry::PartEdge> before;
  std::vector<geometry::PartEdge> after;
};

// New text that was proved, and where the sections begin in it.
struct WrittenSections {
  ReadProgram read;
  std::span<const std::uint32_t> begins;  // blocks
};

// What the sections hold of each long run, in order. `written`: nothing where no byte differs.
[[nodiscard]] std::vector<NearEdges> near_edges_of(const ReadProgram& old,
                                                   std::span<const Section> sections,
                                                   const std::optional<WrittenSections>& written,
                                                   std::span<const SelfProximity> near,
                                                   double tolerance_mm);

// Gathers a program's windows, one after the other.
class PartCrossings {
 public:
  PartCrossings(NearParts near, double tolerance_mm)
      : near_(std::move(near)), tolerance_(tolerance_mm) {}

  void take(std::vector<NearEdges> edges);
  // All of the runs that end up to this line was taken: their crossings are found, and their edges
  // not held any longer.
  void look_up_to(std::uint32_t line);
  // The sections about crossings, of both paths: where these are copied nothing crosses that did
  // not. As `joined` gives them; none where nothing crosses.
  [[nodiscard]] std::vector<LineRange> found() const { return joined(found_, {}); }
  [[nodiscard]] std::span<const SelfProximity> near() const { return *near_; }

  // Above this nothing is said of a run: most of it is near to itself.
  static constexpr std::size_t kMostEdges = std::size_t{1} << 20;

 private:
  struct Held {
    NearEdges edges;
    bool too_many = false;
  };

  NearParts near_;
  double tolerance_;
  std::vector<Held> held_;
  std::vector<LineRange> found_;
};

// `copied` and `found` as `joined` gives them; where all that is found is copied already, the whole
// of its long runs, too.
[[nodiscard]] std::vector<LineRange> more_to_copy(const std::vector<LineRange>& copied,
                                                  const std::vector<LineRange>& found,
                                                  std::span<const SelfProximity> near);

}  // namespace batten::postproc
