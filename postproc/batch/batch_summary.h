// What a batch has done: one record per program, written last, so that a record says that all the
// rest of its program is on the disk. No shared file, so runs on several machines and killed runs
// cannot spoil it.
//
//   OUT/part.nc                                   the new program
//   OUT/batten-batch/reports/part.nc.json         what `batten smooth --json` would say of it
//   OUT/batten-batch/reports/part.nc.html         its page, where pages are wanted
//   OUT/batten-batch/manifest/part.nc.json        the record
//
// The bytes of a record depend on the program and the settings only: no times, no machine, no path
// outside the tree. So do those of the table: a row per program, in the order of their names.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <span>
#include <string>
#include <string_view>

#include "postproc/report/path_picture.h"
#include "postproc/stream/smooth_result.h"
#include "postproc/text/json_values.h"

namespace batten::postproc {

enum class ProgramStatus {
  kSmoothed,       // written, with rewritten runs
  kUnchanged,      // written, the same bytes
  kNotUnderstood,  // not written
  kNotProved,      // not written
  kFailed,         // a file error or an internal one, never in a record: it is tried again
  kNotDone,        // not reached: interrupted, or an earlier failure under --fail-fast
};
inline constexpr std::size_t kStatuses = 6;
[[nodiscard]] std::string_view name_of(ProgramStatus status);

// What a program, or all written programs of a batch together, had and came to.
struct ProgramFigures {
  std::size_t bytes_in = 0;
  std::size_t bytes_out = 0;
  std::size_t blocks_in = 0;
  std::size_t blocks_out = 0;
  TimeFigures time_before;  // predicted for the machine of the settings
  TimeFigures time_after;
  PathFigures path_before;
  PathFigures path_after;
  double deviation_mm = 0;  // proved bound
};

// take("bytes_in", figures.bytes_in) and so on, by the names that they have in JSON.
template <typename Figures, typename Take>
void each_figure(Figures& figures, const Take& take) {
  take("bytes_in", figures.bytes_in);
  take("bytes_out", figures.bytes_out);
  take("blocks_in", figures.blocks_in);
  take("blocks_out", figures.blocks_out);
  take("time_before_s", figures.time_before.seconds);
  take("time_after_s", figures.time_after.seconds);
  take("cutting_before_s", figures.time_before.cutting_s);
  take("cutting_after_s", figures.time_after.cutting_s);
  take("slow_before_s", figures.time_before.slow_s);
  take("slow_after_s", figures.time_after.slow_s);
  take("length_before_mm", figures.path_before.length_mm);
  take("length_after_mm", figures.path_after.length_mm);
  take("distance_before_mm", figures.path_before.distance_mm);
  take("distance_after_mm", figures.path_after.distance_mm);
  take("roughness_before", figures.path_before.roughness);
  take("roughness_after", figures.path_after.roughness);
  take("deviation_mm", figures.deviation_mm);
}

struct ProgramRecord : ProgramFigures {
  std::string program;  // path in the tree
  ProgramStatus status = ProgramStatus::kNotDone;
  int exit_code = 0;     // of postproc/system/exit_code.h
  std::string message;   // why it was not written; empty otherwise
  std::string kept_for;  // what keeps most cutting moves (report/kept_report.h); empty: little does
  std::string input_sha256;
  std::string settings_sha256;
  std::string output_sha256;  // empty: no program was written
  std::string report_sha256;
  std::string page_sha256;  // empty: no page was written
  std::size_t runs_rewritten = 0;
  std::size_t runs_kept = 0;
  std::uint32_t deviation_line = 0;  // of the old program, where the deviation is greatest; 0: none
  PathPicture picture;
};

[[nodiscard]] Json json_of_record(const ProgramRecord& record);
[[nodiscard]] std::string record_text(const ProgramRecord& record);

// Nothing when the text is no record.
[[nodiscard]] std::optional<ProgramRecord> read_record(std::string_view text);

// Where the files of a program lie.
struct ProgramPlaces {
  std::filesystem::path output;
  std::filesystem::path report;
  std::filesystem::path page;
  std::filesystem::path record;
};
[[nodiscard]] ProgramPlaces places_of(const std::filesystem::path& output_tree,
                                      const std::string& program);

// The figures are those of the programs that were written: sums, and the greatest deviation.
struct BatchTotals : ProgramFigures {
  std::size_t programs = 0;
  std::array<std::size_t, kStatuses> with_status = {};  // by ProgramStatus
  int exit_code = 0;  // the worst of all programs, by postproc/system/exit_code.h
};

[[nodiscard]] BatchTotals totals_of(std::span<const ProgramRecord> records);

// For people; ends with the line of the totals.
[[nodiscard]] std::string summary_table(std::span<const ProgramRecord> records);

// RFC 4180 with a row of names, LF line ends.
[[nodiscard]] std::string summary_csv(std::span<const ProgramRecord> records);

[[nodiscard]] std::string summary_json(std::span<const ProgramRecord> records);

struct BatchCount {
  std::size_t programs = 0;       // of this run
  std::size_t programs_over = 0;  // done, failed, or found done
  std::uintmax_t bytes = 0;       // of the programs that were not found done
  std::uintmax_t bytes_over = 0;
  double seconds = 0;  // since the start
};

// How far a batch is, on one line of a terminal:
// "[#######-------------]  12 of 40 programs  1.2 MB/s  about 2 min left"
// Rate and time left are of the bytes of programs that had to be smoothed; left out until one is.
[[nodiscard]] std::string progress_line(const BatchCount& count);

// SHA-256 (FIPS 180-4), 64 digits, lower case: whether two files are the same, without keeping one.
[[nodiscard]] std::string sha256(std::string_view bytes);

}  // namespace batten::postproc
