// The table of a batch: a row per program, and what it comes to. In the order of the programs'
// names, and without anything that depends on how or in how many runs it was made.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>

#include "postproc/batch/manifest.h"

namespace batten::postproc {

// The figures are those of the programs that were written: sums, and the greatest deviation.
struct BatchTotals : ProgramFigures {
  std::size_t programs = 0;
  std::size_t smoothed = 0;
  std::size_t unchanged = 0;
  std::size_t not_understood = 0;
  std::size_t not_proved = 0;
  std::size_t failed = 0;
  std::size_t not_done = 0;
  int exit_code = 0;  // the worst of all programs, by postproc/system/exit_code.h
};

[[nodiscard]] BatchTotals totals_of(std::span<const ProgramRecord> records);

// For people; ends with the line of the totals.
[[nodiscard]] std::string summary_table(std::span<const ProgramRecord> records);

// RFC 4180 with a row of names, LF line ends.
[[nodiscard]] std::string summary_csv(std::span<const ProgramRecord> records);

[[nodiscard]] std::string summary_json(std::span<const ProgramRecord> records);

// How far a batch is, on one line of a terminal.

struct BatchCount {
  std::size_t programs = 0;       // of this run
  std::size_t programs_over = 0;  // done, failed, or found done
  std::uintmax_t bytes = 0;       // of the programs that were not found done
  std::uintmax_t bytes_over = 0;
  double seconds = 0;  // since the start
};

// "[#######-------------]  12 of 40 programs  1.2 MB/s  about 2 min left"
//
// Rate and time left are of the bytes of programs that had to be smoothed; they are left out until
// one is done.
[[nodiscard]] std::string progress_line(const BatchCount& count);

}  // namespace batten::postproc
