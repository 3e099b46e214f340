// What a batch has done: one record per program, written last, so that a record says that all the
// rest of its program is on the disk. No shared file, so runs on several machines and killed runs
// cannot spoil it.
//
//   OUT/part.nc                                   the new program
//   OUT/batten-batch/reports/part.nc.json         what `batten smooth --json` would say of it
//   OUT/batten-batch/manifest/part.nc.json        the record
//
// The bytes of a record depend on the program and the settings only: no times, no machine, no path
// outside the tree.
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <string_view>

namespace batten::postproc {

enum class ProgramStatus {
  kSmoothed,       // written, with rewritten runs
  kUnchanged,      // written, the same bytes
  kNotUnderstood,  // not written
  kNotProved,      // not written
  kFailed,         // a file error or an internal one, never in a record: it is tried again
  kNotDone,        // not reached: interrupted, or an earlier failure under --fail-fast
};
[[nodiscard]] std::string_view name_of(ProgramStatus status);

// What a program, or all written programs of a batch together, had and came to.
struct ProgramFigures {
  std::size_t bytes_in = 0;
  std::size_t bytes_out = 0;
  std::size_t blocks_in = 0;
  std::size_t blocks_out = 0;
  double time_before_s = 0;  // cutting runs, predicted for the machine of the settings
  double time_after_s = 0;
  double deviation_mm = 0;  // proved bound
};

// take("bytes_in", figures.bytes_in) and so on, by the names that they have in JSON.
template <typename Figures, typename Take>
void each_figure(Figures& figures, const Take& take) {
  take("bytes_in", figures.bytes_in);
  take("bytes_out", figures.bytes_out);
  take("blocks_in", figures.blocks_in);
  take("blocks_out", figures.blocks_out);
  take("time_before_s", figures.time_before_s);
  take("time_after_s", figures.time_after_s);
  take("deviation_mm", figures.deviation_mm);
}

struct ProgramRecord : ProgramFigures {
  std::string program;  // path in the tree
  ProgramStatus status = ProgramStatus::kNotDone;
  int exit_code = 0;    // of postproc/system/exit_code.h
  std::string message;  // why it was not written; empty otherwise
  std::string input_sha256;
  std::string settings_sha256;
  std::string output_sha256;  // empty: no program was written
  std::string report_sha256;
  std::size_t runs_rewritten = 0;
  std::size_t runs_kept = 0;
};

[[nodiscard]] std::string record_text(const ProgramRecord& record);

// Nothing when the text is no record.
[[nodiscard]] std::optional<ProgramRecord> read_record(std::string_view text);

// Where the files of a program lie.
struct ProgramPlaces {
  std::filesystem::path output;
  std::filesystem::path report;
  std::filesystem::path record;
};
[[nodiscard]] ProgramPlaces places_of(const std::filesystem::path& output_tree,
                                      const std::string& program);

}  // namespace batten::postproc
