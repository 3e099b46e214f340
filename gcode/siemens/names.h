// What the words of several letters of a Siemens block do to the control: SOFT, COMPCAD, TRAORI,
// ROT, CYCLE832(..), G641 .. Which of them leave path and state alone: docs/controllers/siemens.md.
#pragma once

#include <string>
#include <string_view>
#include <unordered_set>

#include "gcode/state/block_words.h"
#include "gcode/state/modal_state.h"
#include "gcode/state/own_words.h"

namespace batten::gcode {

// Variables that a Siemens program declares for itself, in upper case: DEF REAL A, B = 5, C[3]. To
// set one changes nothing but what words in which it is will say.
using SiemensVariables = std::unordered_set<std::string>;

// `declaration` is what stands behind DEF: the type, then the names with their first values.
void add_declared_names(std::string_view declaration, SiemensVariables& variables);

struct NamedEffect {
  bool understood = true;    // false: a name is not known; it could have changed anything
  bool takes_axes = false;   // X, Y, Z belong to a name (TRANS X10), not to a motion
  bool loses_place = false;  // where the tool is after the block is not known
  bool unit_word = false;
  const OwnWord* own = nullptr;  // a G word that the user vouches for
  std::string_view barrier;      // why the block is copied
};

// `text` is a block of ParseStatus::kNamedWords, `words` its words of one letter. Applies what is
// known to the state. `variables` are those that the program has declared so far; DEF adds to them.
[[nodiscard]] NamedEffect apply_names(std::string_view text, const BlockWords& words,
                                      SiemensVariables& variables, ControlState& state);

// `name` in upper case. Others could do anything.
[[nodiscard]] bool is_known_siemens_name(std::string_view name);

// Whether a line of a text in whatever language has a known name of two letters or more outside of
// comments, strings and brackets (< > too), or CR, AC or IC: MSG, TRANS, CYCLE832, FNORM ..; or
// a code that it alone has (G642), or the name of a tool (T="MILL"). Names that a program of plain
// words gets by Batten (POLY with PO and PL, BSPLINE with SD and PW) do not count.
[[nodiscard]] bool has_siemens_name(std::string_view line);

}  // namespace batten::gcode
