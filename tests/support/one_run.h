// A program of one run, and what is made of that run.
#pragma once

#include <fmt/format.h>

#include <cmath>
#include <string>
#include <variant>
#include <vector>

#include "postproc/runs/run_grouping.h"
#include "postproc/smooth/run_smoother.h"
#include "postproc/smooth/selection/selection.h"
#include "tests/support/wavy_programs.h"

namespace batten::postproc {

// The only run of a program, smoothed.
class OneRun {
 public:
  explicit OneRun(const std::string& text) : text_(text), read_(text) {
    for (const Section& section : group_runs(read_.program, read_.meaning, {})) {
      if (std::holds_alternative<Run>(section.content)) sections_.push_back(section);
    }
  }

  [[nodiscard]] const Run& run() const { return std::get<Run>(sections_.at(0).content); }

  [[nodiscard]] RunContext context() const {
    const Section& section = sections_.at(0);
    const auto state_after = [&](std::uint32_t block) -> const gcode::ModalState& {
      return read_.meaning.states[read_.meaning.blocks[block].state_after];
    };
    return {read_.program,
            state_after(section.first_block - 1),
            state_after(section.last_block),
            "\n",
            section.last_block - section.first_block + 1,
            bytes(section)};
  }

  [[nodiscard]] SmoothedRun smooth(const SmoothOptions& options,
                                   CandidateScope scope = CandidateScope::kAll) const {
    return smooth_run(run(), context(), options, scope);
  }

  // What is written in its place.
  [[nodiscard]] static std::string chosen_of(const SmoothedRun& smoothed,
                                             const SmoothOptions& options) {
    const Selection selection = choose(smoothed, options);
    if (selection.order.empty()) return std::string(selection.reason);
    return smoothed.candidates[selection.order.front()].text.text;
  }

  // The program with the candidate in the place of the run.
  [[nodiscard]] std::string with(const Candidate& candidate) const {
    const Section& section = sections_.at(0);
    const std::uint32_t begin = read_.program.blocks[section.first_block].span.begin;
    return text_.substr(0, begin) + candidate.text.text + text_.substr(begin + bytes(section));
  }

 private:
  [[nodiscard]] std::size_t bytes(const Section& section) const {
    return read_.program.blocks[section.last_block].end -
           read_.program.blocks[section.first_block].span.begin;
  }

  std::string text_;
  ReadText read_;
  std::vector<Section> sections_;
};

// Half a circle of radius 10 mm in equal chords.
inline std::string circle_program(int chords, int decimals = 5) {
  constexpr double kPi = 3.141592653589793;
  std::string text = "G21 G90 G17\nG0 X10 Y0 Z0\nG1 Z-1 F300\nF3000\n";
  for (int i = 1; i <= chords; ++i) {
    const double angle = kPi * i / chords;
    text += fmt::format("G1 X{:.{}f} Y{:.{}f}\n", 10 * std::cos(angle), decimals,
                        10 * std::sin(angle), decimals);
  }
  return text + "G0 Z5\nM2\n";
}

}  // namespace batten::postproc
