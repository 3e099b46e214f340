#include "postproc/batch/program_worker.h"

#include <fmt/format.h>

#include <algorithm>
#include <optional>
#include <system_error>
#include <utility>

#include "postproc/batch/content_hash.h"
#include "postproc/batch/program_tree.h"
#include "postproc/report/smooth_report.h"
#include "postproc/stream/pipeline.h"
#include "postproc/stream/smooth_result.h"
#include "postproc/system/exit_code.h"
#include "postproc/system/interrupt.h"
#include "postproc/system/output_file.h"

namespace batten::postproc {

namespace fs = std::filesystem;

namespace {

std::optional<std::string> bytes_of(const fs::path& file) {
  std::string error;
  const auto source = gcode::SourceText::map_file(file, error);
  if (!source) return std::nullopt;
  return std::string(source->text());
}

// Empty when there is no such file.
std::string hash_of(const fs::path& file) {
  const auto bytes = bytes_of(file);
  return bytes ? sha256(*bytes) : std::string();
}

ProgramStatus status_of(ExitCode verdict, bool same_bytes) {
  switch (verdict) {
    case ExitCode::kDone:
      return same_bytes ? ProgramStatus::kUnchanged : ProgramStatus::kSmoothed;
    case ExitCode::kNotUnderstood:
      return ProgramStatus::kNotUnderstood;
    case ExitCode::kNotProved:
      return ProgramStatus::kNotProved;
    case ExitCode::kUsage:
    case ExitCode::kFileError:
    case ExitCode::kInternalError:
      break;
  }
  return ProgramStatus::kFailed;
}

// The first error about the program itself says more than the verdict.
std::string message_of(ExitCode verdict, const SmoothResult& result,
                       const gcode::SourceText& source, bool strict) {
  if (verdict == ExitCode::kDone) return "";
  const auto error =
      std::ranges::find(result.diagnostics, gcode::Severity::kError, &gcode::Diagnostic::severity);
  if (error != result.diagnostics.end()) return gcode::to_text(*error, source);
  return std::string(complaint(verdict, strict));
}

class Worker {
 public:
  Worker(const BatchPlan& plan, const std::string& program)
      : plan_(plan), places_(places_of(plan.output_tree, program)) {
    record_.program = program;
    record_.settings_sha256 = plan.settings_sha256;
  }

  WorkerResult work() {
    const fs::path input = plan_.input_tree / record_.program;
    std::string error;
    const WatchedFile watched(input);
    const auto mapped = gcode::SourceText::map_file(input, error);
    if (!mapped) return failed(error);
    // Messages and reports name the program by its place in the tree.
    const gcode::SourceText source(record_.program, std::string(mapped->text()));
    if (watched.now() == FileNow::kChanged) {
      return failed(input.string() + ": was changed while it was read; nothing was written");
    }
    record_.input_sha256 = sha256(source.text());
    record_.bytes_in = source.text().size();
    if (const auto bytes = bytes_of(places_.record)) before_ = read_record(*bytes);
    output_sha256_ = hash_of(places_.output);
    if (is_done()) return {.record = *before_, .was_done = true};
    for (const fs::path& place : {places_.output, places_.report, places_.record}) {
      if (leads_into(place, plan_.input_tree)) {
        return failed(place.string() + ": leads into the input tree; nothing was written");
      }
    }
    return smooth(source);
  }

 private:
  [[nodiscard]] bool is_done() const {
    return before_ && before_->input_sha256 == record_.input_sha256 &&
           before_->settings_sha256 == record_.settings_sha256 &&
           before_->output_sha256 == output_sha256_ &&
           before_->report_sha256 == hash_of(places_.report);
  }

  WorkerResult smooth(const gcode::SourceText& source) {
    SmoothOptions options = plan_.options;
    options.threads = 1;
    const SmoothResult result =
        smooth_program(source, options, [](double) { return !interrupted(); });
    if (interrupted()) return {.record = record_};

    const ExitCode verdict = judge(result, source.text(), plan_.strict);
    record_.status = status_of(verdict, result.text == source.text());
    record_.exit_code = static_cast<int>(verdict);
    record_.message = message_of(verdict, result, source, plan_.strict);
    take_figures(result);
    const bool writes = verdict == ExitCode::kDone;
    const std::string report = json_report({.source = source,
                                            .options = options,
                                            .result = result,
                                            .output_file = writes ? record_.program : "",
                                            .strict = plan_.strict});
    record_.report_sha256 = sha256(report);
    if (writes) record_.output_sha256 = sha256(result.text);
    return write(result.text, report);
  }

  void take_figures(const SmoothResult& result) {
    record_.blocks_in = result.blocks_in;
    record_.blocks_out = result.blocks_out;
    record_.bytes_out = record_.exit_code == 0 ? result.text.size() : 0;
    const auto rewritten =
        std::ranges::count(result.runs, RunStatus::kRewritten, &RunReport::status);
    record_.runs_rewritten = static_cast<std::size_t>(rewritten);
    record_.runs_kept = result.runs.size() - record_.runs_rewritten;
    record_.time_before_s = result.time_before_s;
    record_.time_after_s = result.time_after_s;
    record_.deviation_mm = result.deviation_mm;
  }

  WorkerResult write(std::string_view text, std::string_view report) {
    const bool ours =
        !output_sha256_.empty() && before_ && before_->output_sha256 == output_sha256_;
    if (record_.exit_code == 0) {
      const bool there = record_.output_sha256 == output_sha256_;
      if (!there && !output_sha256_.empty() && !ours && !plan_.force) {
        return failed(places_.output.string() +
                      ": exists already, is not what this batch wrote, and was left as it is; "
                      "--force replaces it");
      }
      if (!put(places_.report, report, true)) return failed(error_);
      if (!there && !put(places_.output, text, ours || plan_.force)) return failed(error_);
    } else {
      if (!put(places_.report, report, true)) return failed(error_);
      if (ours && !remove_output()) return failed(error_);
    }
    if (!put(places_.record, record_text(record_), true)) return failed(error_);
    return {.record = record_};
  }

  bool put(const fs::path& file, std::string_view bytes, bool replace) {
    std::error_code error;
    fs::create_directories(file.parent_path(), error);
    if (error) {
      error_ = file.parent_path().string() + ": cannot be made: " + error.message();
      return false;
    }
    const WriteResult result = write_file(
        {.target = file, .bytes = bytes, .replace_existing = replace, .stop = interrupted});
    error_ = result.message;
    return result.status == WriteStatus::kWritten;
  }

  // It belongs to an older version of its source.
  bool remove_output() {
    std::error_code error;
    fs::remove(places_.output, error);
    if (error) error_ = places_.output.string() + ": cannot be removed: " + error.message();
    return !error;
  }

  [[nodiscard]] WorkerResult failed(const std::string& message) {
    if (interrupted()) {
      record_.status = ProgramStatus::kNotDone;
      record_.exit_code = 0;
      return {.record = record_};
    }
    record_.status = ProgramStatus::kFailed;
    record_.exit_code = static_cast<int>(ExitCode::kFileError);
    record_.message = message;
    return {.record = record_};
  }

  const BatchPlan& plan_;
  ProgramPlaces places_;
  ProgramRecord record_;                 // what is being made
  std::optional<ProgramRecord> before_;  // what an earlier run left
  std::string output_sha256_;            // of what stands in the new tree now; empty: nothing
  std::string error_;
};

}  // namespace

WorkerResult process_program(const BatchPlan& plan, const std::string& program) {
  return Worker(plan, program).work();
}

}  // namespace batten::postproc
