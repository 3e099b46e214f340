// A program text, parsed and interpreted, for tests.
#pragma once

#include <string>
#include <string_view>

#include "gcode/interpreter/interpreter.h"
#include "gcode/reading/parser.h"

namespace batten::tests {

struct Interpreted {
  explicit Interpreted(std::string text, gcode::Units units = gcode::Units::kUnknown)
      : program(gcode::parse(gcode::SourceText("test.nc", std::move(text)), found)),
        read(gcode::interpret(program, {units}, found)) {}

  Interpreted(std::string text, const gcode::ReadOptions& options)
      : program(gcode::parse(gcode::SourceText("test.nc", std::move(text)), found)),
        read(gcode::interpret(program, options, found)) {}

  // Lines count from 1.
  [[nodiscard]] const gcode::BlockMeaning& line(std::size_t number) const {
    return read.blocks.at(number - 1);
  }
  [[nodiscard]] const gcode::ModalState& state_after_line(std::size_t number) const {
    return read.states.at(line(number).state_after);
  }
  [[nodiscard]] const gcode::ModalState& last_state() const {
    return read.states.at(read.blocks.back().state_after);
  }
  [[nodiscard]] const gcode::Motion* motion_of_line(std::size_t number) const {
    const auto motion = line(number).motion;
    return motion < 0 ? nullptr : &read.motions.at(static_cast<std::size_t>(motion));
  }
  [[nodiscard]] bool has_diagnostic(std::string_view id) const {
    for (const gcode::Diagnostic& diagnostic : found) {
      if (diagnostic.id == id) {
        return true;
      }
    }
    return false;
  }

  gcode::Diagnostics found;
  gcode::Program program;
  gcode::Interpretation read;
};

}  // namespace batten::tests
