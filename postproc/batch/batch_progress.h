// How far a batch is, on one line of a terminal.
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>

namespace batten::postproc {

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
