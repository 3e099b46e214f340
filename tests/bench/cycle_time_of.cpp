// Prints the predicted cutting time of a G-code file on LinuxCNC, for each path mode:
//   cycle_time_of FILE [--feed MM/MIN] [--vmax MM/S] [--amax MM/S2] [--machine NAME]
// Rapids are left out, as in the bench's "feed moves". One line per mode: mode, tab, seconds.
// Exit status 2: the file is not understood as a whole (splines, expressions ..).
#include <fmt/core.h>

#include <algorithm>
#include <cstdlib>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "gcode/diagnostic.h"
#include "gcode/interpreter.h"
#include "gcode/parser.h"
#include "postproc/machine/cycle_time.h"

namespace {

using namespace batten;
using postproc::ChainEnd;
using postproc::TimedPiece;

struct Arguments {
  std::string file;
  std::optional<double> feed;
  std::optional<double> max_velocity;
  std::optional<double> max_acceleration;
  std::string machine = "linuxcnc";
};

std::optional<Arguments> arguments_of(int count, char** words) {
  Arguments a;
  for (int i = 1; i < count; ++i) {
    const std::string_view word = words[i];
    if (!word.starts_with("--")) {
      a.file = word;
      continue;
    }
    if (++i == count) return std::nullopt;
    const char* value = words[i];
    if (word == "--feed") {
      a.feed = std::atof(value);
    } else if (word == "--vmax") {
      a.max_velocity = std::atof(value);
    } else if (word == "--amax") {
      a.max_acceleration = std::atof(value);
    } else if (word == "--machine") {
      a.machine = value;
    } else {
      return std::nullopt;
    }
  }
  return a.file.empty() ? std::nullopt : std::optional(a);
}

struct Chain {
  std::vector<TimedPiece> pieces;
  ChainEnd end = ChainEnd::kStop;
};

// M, S and T wait until the motion before them has ended.
bool waits_for_rest(const gcode::Program& program, const gcode::Block& block) {
  const auto words = program.words_of(block);
  return std::any_of(words.begin(), words.end(), [](const gcode::Word& w) {
    return w.letter == 'M' || w.letter == 'S' || w.letter == 'T';
  });
}

std::vector<Chain> chains_of(const gcode::Program& program, const gcode::Interpretation& meaning,
                             std::optional<double> feed) {
  std::vector<Chain> chains(1);
  const auto close = [&](ChainEnd end) {
    if (chains.back().pieces.empty()) return;
    chains.back().end = end;
    chains.emplace_back();
  };
  for (std::size_t i = 0; i < meaning.blocks.size(); ++i) {
    const gcode::BlockMeaning& block = meaning.blocks[i];
    if (block.motion < 0) {
      if (waits_for_rest(program, program.blocks[i])) close(ChainEnd::kEndOfMotion);
      continue;
    }
    const gcode::Motion& motion = meaning.motions[static_cast<std::size_t>(block.motion)];
    if (motion.kind == gcode::MotionKind::kRapid || !motion.start_known) {
      close(ChainEnd::kStop);
      continue;
    }
    const double programmed = meaning.states[block.state_after].feed.value_or(0);
    chains.back().pieces.push_back({motion.piece, feed.value_or(programmed)});
  }
  close(ChainEnd::kEndOfMotion);
  return chains;
}

struct Mode {
  const char* name;
  gcode::PathMode path;
  double blend_tolerance;
  double naive_cam_tolerance;
};

constexpr Mode kModes[] = {
    {"G61", gcode::PathMode::kExactPath, 0, 0},
    {"G64", gcode::PathMode::kBlending, 0, 0},
    {"G64 P0.01 Q0", gcode::PathMode::kBlending, 0.01, 0},
    {"G64 P0.01", gcode::PathMode::kBlending, 0.01, 0.01},
    {"G64 P0.05", gcode::PathMode::kBlending, 0.05, 0.05},
};

// Splines, canned cycles and probing move in ways that have no motion here.
bool moves_otherwise(const gcode::Program& program, const gcode::Interpretation& meaning,
                     std::size_t i) {
  const gcode::BlockMeaning& block = meaning.blocks[i];
  if (block.motion >= 0) return false;
  if (meaning.states[block.state_after].motion != gcode::MotionMode::kOther) return false;
  const auto words = program.words_of(program.blocks[i]);
  return std::any_of(words.begin(), words.end(),
                     [](const gcode::Word& w) { return w.letter >= 'X' && w.letter <= 'Z'; });
}

bool understood(const gcode::Program& program, const gcode::Interpretation& meaning) {
  for (std::size_t i = 0; i < meaning.blocks.size(); ++i) {
    const bool opaque = meaning.blocks[i].kind == gcode::BlockKind::kOpaque &&
                        program.blocks[i].opacity != gcode::Opacity::kProgramMark;
    if (!opaque && !moves_otherwise(program, meaning, i)) continue;
    fmt::print(stderr, "line {}: not understood\n", program.blocks[i].line);
    return false;
  }
  return true;
}

}  // namespace

int main(int argument_count, char** argument_words) {
  const auto arguments = arguments_of(argument_count, argument_words);
  if (!arguments) {
    fmt::print(stderr,
               "usage: cycle_time_of FILE [--feed F] [--vmax V] [--amax A] [--machine M]\n");
    return 1;
  }
  const postproc::Machine* known = postproc::find_machine(arguments->machine);
  std::string error;
  const auto source = gcode::SourceText::map_file(arguments->file, error);
  if (known == nullptr || !source) {
    fmt::print(stderr, "{}\n", known == nullptr ? "no such machine" : error);
    return 1;
  }
  gcode::Diagnostics found;
  const gcode::Program program = gcode::parse(*source, found);
  const gcode::Interpretation meaning = gcode::interpret(program, {}, found);
  if (!understood(program, meaning)) return 2;

  postproc::Machine machine = *known;
  machine.set_max_velocity(arguments->max_velocity.value_or(machine.max_velocity()));
  machine.set_max_acceleration(arguments->max_acceleration.value_or(machine.max_acceleration()));
  const std::vector<Chain> chains = chains_of(program, meaning, arguments->feed);
  for (const Mode& mode : kModes) {
    machine.blend_tolerance = mode.blend_tolerance;
    machine.naive_cam_tolerance = mode.naive_cam_tolerance;
    double seconds = 0;
    for (const Chain& chain : chains) {
      seconds += postproc::cutting_time(chain.pieces, machine, mode.path, chain.end);
    }
    fmt::print("{}\t{:.4f}\n", mode.name, seconds);
  }
  return 0;
}
