// What keeps the cutting moves of a program from being rewritten, with the block that caused it and
// what it costs.
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "gcode/state/motion.h"
#include "gcode/text/program.h"
#include "postproc/runs/run_grouping.h"
#include "postproc/runs/section.h"

namespace batten::postproc {

// Cutting moves are lines and arcs that are not rapid, and blocks with X, Y or Z that may be such
// moves but are not followed: these have no length.
struct CutMoves {
  std::size_t moves = 0;
  std::size_t without_length = 0;  // of them
  double length_mm = 0;            // of the others

  CutMoves& operator+=(const CutMoves& other);
};

// All that is kept for one reason.
struct KeptCause {
  std::string_view reason;  // gcode::reason
  std::uint32_t line = 0;   // of the block behind which it held for the first time; 0: none, it
                            // lies in the moves themselves, or held from the beginning
  std::uint32_t first_line = 0;  // of the first move
  std::string text;              // of that block, for people
  std::size_t times = 0;         // that it began
  std::uint32_t last_from = 0;   // as `line`, of the last move
  CutMoves cut;
};

struct KeptCauses {
  CutMoves all;                   // of the program
  std::vector<KeptCause> causes;  // of what is kept; the greatest share first
  bool any_run = false;           // one was found, whether it is rewritten or not

  // Of the cutting length; of the moves, where the length of some is not known. 0..1.
  [[nodiscard]] double share(const CutMoves& part) const;
  [[nodiscard]] bool is_by_length() const { return all.without_length == 0 && all.length_mm > 0; }
};

// Adds up the parts of a program, in order.
class CauseTally {
 public:
  // The sections of a part, which cover it. `rejected`: for each of them, why its run is not
  // rewritten; empty where it is. Left out, all runs count as rewritten.
  void add(const gcode::Program& part, const gcode::Interpretation& read,
           const std::vector<Section>& sections, const GroupingOptions& options,
           const std::vector<std::string_view>& rejected = {});
  // What was added up elsewhere, of the part behind.
  void add(const CauseTally& behind);

  [[nodiscard]] KeptCauses causes() const;

 private:
  // Where something began that keeps moves.
  struct Since {
    std::uint32_t line = 0;
    std::string text;
  };

  KeptCause& cause_of(std::string_view reason);
  [[nodiscard]] const Since* since(std::string_view reason) const;
  void begin(KeptCause& cause, const Since& move) const;
  void go_on(KeptCause& cause) const;

  KeptCauses kept_;  // in the order in which they were found
  bool begun_ = false;
  std::string_view state_;  // at the end of what was added, if nothing may be rewritten in it
  Since state_since_;       // the block that made it so; line 0: not in what was added
  Since place_since_;       // the last block behind which the tool may be elsewhere
};

}  // namespace batten::postproc
