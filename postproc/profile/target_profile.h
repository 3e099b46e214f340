// A control as the user has it, from a TOML file: it starts as one of the built-in targets and
// changes what the machine builder changed. `batten targets --show NAME` prints one with every key.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "gcode/control/control.h"
#include "gcode/text/diagnostic.h"
#include "gcode/text/program.h"
#include "postproc/options/own_words.h"
#include "postproc/options/profile_words.h"

namespace batten::postproc {

struct TargetProfile {
  std::string file;
  gcode::Control adapted;  // the built-in one with the values of the profile
  bool says_chords = false;  // how the control cuts arcs, which no machine then says
  ProfileWords words;
  OwnWordList own_words;
};

// Adds a sentence to `problems` for everything that is wrong, each with file, line and column, what
// stands there and what may, and then returns nothing. `target`: the built-in target that the user
// named beside the file; nullptr: the file names it by based-on.
[[nodiscard]] std::shared_ptr<const TargetProfile> read_target_profile(
    const std::string& file, const gcode::Control* target, std::vector<std::string>& problems);

// The file that leaves this target as it is: every key with its value, its unit and what it means.
// The control's own smoothing words stand in it as remarks.
[[nodiscard]] std::string profile_text(const gcode::Control& target);

// An error "word-means-other" for the first use of each G word that the target takes for something
// else than the reader does (G21 mirrors on some): such a program was not read as its control reads
// it.
void tell_of_other_meanings(const gcode::Program& program, const gcode::Control& target,
                            gcode::Diagnostics& found);

}  // namespace batten::postproc
