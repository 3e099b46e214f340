#include "postproc/batch/batch_run.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/file.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <chrono>
#include <exception>
#include <nlohmann/json.hpp>
#include <numeric>
#include <system_error>
#include <thread>

#include "gcode/reading/dropped_words.h"
#include "gcode/text/characters.h"
#include "postproc/batch/batch_summary.h"
#include "postproc/batch/process_pool.h"
#include "postproc/report/html_report.h"
#include "postproc/report/kept_report.h"
#include "postproc/report/path_picture.h"
#include "postproc/report/smooth_report.h"
#include "postproc/stream/pipeline.h"
#include "postproc/stream/smooth_result.h"
#include "postproc/stream/unit_evidence.h"
#include "postproc/system/exit_code.h"
#include "postproc/system/interrupt.h"
#include "postproc/system/output_file.h"
#include "postproc/text/json_values.h"

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
  if (verdict == ExitCode::kNotUnderstood) return ProgramStatus::kNotUnderstood;
  if (verdict == ExitCode::kNotProved) return ProgramStatus::kNotProved;
  if (verdict != ExitCode::kDone) return ProgramStatus::kFailed;
  return same_bytes ? ProgramStatus::kUnchanged : ProgramStatus::kSmoothed;
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

struct WorkerResult {
  ProgramRecord record;
  bool was_done = false;  // by an earlier run; nothing was written now
};

// A program is done when its record has the same input and settings and its files still have the
// bytes that the record says. Otherwise it is smoothed, and written in the order report, page,
// program, record.
//
// A program in the new tree that no record explains and that is not what would be written now is
// left as it is, without `force`. When nothing may be written, a program that an earlier batch
// wrote is removed: it no longer belongs to its source. Nothing is written where a link leads into
// the input tree.
//
// The status is kFailed after file errors and kNotDone after an interrupt; these leave no record.
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
    SmoothOptions options = plan_.options;
    called_ = read_called_files(source, input, options);
    // What is known of the program depends on them.
    if (!called_.bytes.empty()) {
      record_.settings_sha256 = sha256(plan_.settings_sha256 + called_.bytes);
    }
    if (const auto bytes = bytes_of(places_.record)) before_ = read_record(*bytes);
    output_sha256_ = hash_of(places_.output);
    if (is_done()) return {.record = *before_, .was_done = true};
    for (const fs::path& place : {places_.output, places_.report, places_.page, places_.record}) {
      if (leads_into(place, plan_.input_tree)) {
        return failed(place.string() + ": leads into the input tree; nothing was written");
      }
    }
    return smooth(gcode::without_words(source, plan_.drop, dropped_), std::move(options));
  }

 private:
  [[nodiscard]] bool is_done() const {
    return before_ && before_->input_sha256 == record_.input_sha256 &&
           before_->settings_sha256 == record_.settings_sha256 &&
           before_->output_sha256 == output_sha256_ &&
           before_->report_sha256 == hash_of(places_.report) &&
           (!plan_.pages ||
            (!before_->page_sha256.empty() && before_->page_sha256 == hash_of(places_.page)));
  }

  WorkerResult smooth(const gcode::SourceText& source, SmoothOptions options) {
    options.threads = 1;
    SmoothResult result = smooth_program(source, options, [](double) { return !interrupted(); });
    if (interrupted()) return {.record = record_};
    for (const WatchedFile& file : called_.watched) {
      if (file.now() != FileNow::kChanged) continue;
      return failed(file.path().string() + ": was changed while it was read; nothing was written");
    }

    (void)tell_unit_evidence(source.text(), result.diagnostics);
    const ExitCode verdict = judge(result, source.text(), plan_.strict);
    record_.status = status_of(verdict, result.text == source.text());
    record_.exit_code = static_cast<int>(verdict);
    record_.message = message_of(verdict, result, source, plan_.strict);
    take_figures(result);
    const bool writes = verdict == ExitCode::kDone;
    const SmoothReport told{.source = source,
                            .options = options,
                            .result = result,
                            .output_file = writes ? record_.program : "",
                            .strict = plan_.strict,
                            .drop = plan_.drop,
                            .dropped = dropped_,
                            .called = called_.files};
    std::vector<std::string> messages;
    if (!record_.message.empty()) messages.push_back(record_.message);
    const std::string report = ended_report(json_report(told), record_.exit_code, messages);
    const std::string page = plan_.pages ? html_report(told, "") : "";
    record_.report_sha256 = sha256(report);
    if (plan_.pages) record_.page_sha256 = sha256(page);
    if (writes) record_.output_sha256 = sha256(result.text);
    record_.picture = path_picture(told);
    return write(result.text, report, page);
  }

  void take_figures(const SmoothResult& result) {
    record_.blocks_in = result.blocks_in;
    record_.blocks_out = result.blocks_out;
    record_.bytes_out = record_.exit_code == 0 ? result.text.size() : 0;
    const auto rewritten =
        std::ranges::count(result.runs, RunStatus::kRewritten, &RunReport::status);
    record_.runs_rewritten = static_cast<std::size_t>(rewritten);
    record_.runs_kept = result.runs.size() - record_.runs_rewritten;
    record_.time_before = result.program_before;
    record_.time_after = result.program_after;
    record_.path_before = result.path_before;
    record_.path_after = result.path_after;
    record_.deviation_mm = result.deviation_mm;
    record_.deviation_line = result.deviation_line;
    record_.kept_for = cause_in_brief(result.kept);
  }

  WorkerResult write(std::string_view text, std::string_view report, std::string_view page) {
    const bool ours =
        !output_sha256_.empty() && before_ && before_->output_sha256 == output_sha256_;
    const bool writes = record_.exit_code == 0 && record_.output_sha256 != output_sha256_;
    if (writes && !output_sha256_.empty() && !ours && !plan_.force) {
      return failed(places_.output.string() +
                    ": exists already, is not what this batch wrote, and was left as it is; "
                    "--force replaces it");
    }
    const bool done = put(places_.report, report, true) &&
                      (!plan_.pages || put(places_.page, page, true)) &&
                      (!writes || put(places_.output, text, ours || plan_.force)) &&
                      (record_.exit_code == 0 || !ours || remove_output()) &&
                      put(places_.record, record_text(record_), true);
    return done ? WorkerResult{.record = record_} : failed(error_);
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
  std::size_t dropped_ = 0;
  CalledFiles called_;
  ProgramRecord record_;                 // what is being made
  std::optional<ProgramRecord> before_;  // what an earlier run left
  std::string output_sha256_;            // of what is in the new tree now; empty: nothing
  std::string error_;
};

// --- all programs, several at a time -------------------------------------------------------------

// Often enough for a moving number on the screen and for Ctrl-C, too seldom to cost anything.
constexpr std::chrono::milliseconds kBetweenLooks{200};

ProgramRecord without_result(const std::string& program, const std::string& what) {
  ProgramRecord record;
  record.program = program;
  record.status = ProgramStatus::kFailed;
  record.exit_code = static_cast<int>(ExitCode::kInternalError);
  record.message = "internal error, nothing was written: " + what;
  return record;
}

std::string answer_of(const BatchPlan& plan, const std::string& program) {
  WorkerResult result;
  try {
    result = Worker(plan, program).work();
  } catch (const std::exception& error) {
    result.record = without_result(program, error.what());
  }
  return json_text({{"was_done", result.was_done}, {"record", json_of_record(result.record)}});
}

std::optional<WorkerResult> read_answer(const std::string& text) {
  const Json json = Json::parse(text, nullptr, false);
  if (json.is_discarded() || !json.contains("record")) return std::nullopt;
  auto record = read_record(json["record"].dump());
  if (!record) return std::nullopt;
  return WorkerResult{.record = std::move(*record), .was_done = json.value("was_done", false)};
}

std::vector<std::size_t> largest_first(const std::vector<TreeProgram>& programs) {
  std::vector<std::size_t> order(programs.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::ranges::stable_sort(
      order, [&](std::size_t a, std::size_t b) { return programs[a].bytes > programs[b].bytes; });
  return order;
}

class BatchRun {
 public:
  BatchRun(const BatchRequest& request, const BatchObserver& observer)
      : request_(request),
        observer_(observer),
        order_(largest_first(request.programs)),
        pool_(request.jobs, [&request](std::size_t job) {
          when_late(LateWork::kEnds);
          return answer_of(request.plan, request.programs[job].name);
        }) {
    for (const TreeProgram& program : request.programs) {
      result_.records.emplace_back().program = program.name;
      count_.bytes += program.bytes;
    }
    count_.programs = request.programs.size();
  }

  BatchResult run() {
    while (next_ < order_.size() || !pool_.is_idle()) {
      if (is_stopping() && !stopped_) {
        pool_.stop();
        stopped_ = true;
      }
      if (!stopped_) start_what_fits();
      if (stopped_ && pool_.is_idle()) break;
      if (const auto end = pool_.wait(kBetweenLooks)) {
        take(*end);
      } else {
        tell(nullptr);
      }
    }
    return std::move(result_);
  }

 private:
  [[nodiscard]] bool is_stopping() const {
    return interrupted() || (request_.fail_fast && failed_);
  }

  void start_what_fits() {
    while (next_ < order_.size() && pool_.has_room()) {
      if (!pool_.start(order_[next_])) {
        // Too many processes: wait for one of ours to end, or give this program up.
        if (!pool_.is_idle()) return;
        finish(order_[next_], without_result(name_of_job(order_[next_]), "no process can be made"),
               false);
      }
      ++next_;
    }
  }

  void take(const JobEnd& end) {
    auto result = read_answer(end.answer);
    if (!end.trouble.empty() || !result) {
      const std::string what = end.trouble.empty() ? "no answer" : end.trouble;
      result = WorkerResult{.record = without_result(name_of_job(end.job), "the process " + what)};
    }
    if (stopped_ && !end.trouble.empty()) {  // we have ended it
      result->record.status = ProgramStatus::kNotDone;
      result->record.exit_code = 0;
      result->record.message.clear();
    }
    result->record.program = name_of_job(end.job);  // its bytes, which JSON need not keep
    finish(end.job, std::move(result->record), result->was_done);
  }

  void finish(std::size_t job, ProgramRecord record, bool was_done) {
    const std::uintmax_t bytes = request_.programs[job].bytes;
    ++count_.programs_over;
    if (was_done) {
      ++result_.were_done;
      count_.bytes -= bytes;
    } else {
      count_.bytes_over += bytes;
    }
    failed_ = failed_ || record.exit_code != 0;
    result_.records[job] = std::move(record);
    tell(&result_.records[job]);
  }

  void tell(const ProgramRecord* ended) {
    count_.seconds = std::chrono::duration<double>(Clock::now() - start_).count();
    if (observer_) observer_(count_, ended);
  }

  [[nodiscard]] const std::string& name_of_job(std::size_t job) const {
    return request_.programs[job].name;
  }

  using Clock = std::chrono::steady_clock;

  const BatchRequest& request_;
  const BatchObserver& observer_;
  std::vector<std::size_t> order_;
  std::size_t next_ = 0;
  ProcessPool pool_;
  BatchResult result_;
  BatchCount count_;
  Clock::time_point start_ = Clock::now();
  bool failed_ = false;
  bool stopped_ = false;
};

}  // namespace

BatchResult run_batch(const BatchRequest& request, const BatchObserver& observer) {
  return BatchRun(request, observer).run();
}

BatchLock::BatchLock(const std::filesystem::path& folder, const Shard& shard) {
  const bool whole_tree = shard.count == 1;
  take(folder / "lock", whole_tree ? LOCK_EX : LOCK_SH);
  if (whole_tree || !problem_.empty()) return;
  take(folder / fmt::format("lock-{}-of-{}", shard.index, shard.count), LOCK_EX);
}

BatchLock::~BatchLock() {
  for (const int descriptor : descriptors_) ::close(descriptor);
}

void BatchLock::take(const std::filesystem::path& file, int operation) {
  const int descriptor = ::open(file.c_str(), O_RDWR | O_CREAT | O_CLOEXEC, 0666);
  if (descriptor < 0) {
    problem_ = file.string() + ": cannot be made: " + std::generic_category().message(errno);
    return;
  }
  descriptors_.push_back(descriptor);
  // The processes of a run that was killed end with it, but on a busy machine not at once.
  constexpr int kTries = 20;
  constexpr std::chrono::milliseconds kBetweenTries{100};
  for (int i = 0; i < kTries; ++i) {
    if (::flock(descriptor, operation | LOCK_NB) == 0 || errno != EWOULDBLOCK) return;
    std::this_thread::sleep_for(kBetweenTries);
  }
  problem_ = file.string() + ": another run of this batch is at work on these programs";
}

std::optional<std::string> intended_name(std::string_view half_written) {
  constexpr std::string_view kEnd = ".batten-part";
  // The point before the name and the one of the ending are two.
  if (half_written.size() <= kEnd.size()) return std::nullopt;
  if (!half_written.starts_with('.') || !half_written.ends_with(kEnd)) return std::nullopt;
  half_written.remove_prefix(1);
  half_written.remove_suffix(kEnd.size());
  const std::size_t dot = half_written.rfind('.');  // before the number of the process
  if (dot == std::string_view::npos || dot == 0 || dot + 1 == half_written.size()) {
    return std::nullopt;
  }
  if (!std::ranges::all_of(half_written.substr(dot + 1), gcode::is_digit)) return std::nullopt;
  return std::string(half_written.substr(0, dot));
}

std::size_t remove_half_written(const fs::path& root, const std::set<fs::path>& targets) {
  std::error_code error;
  std::size_t removed = 0;
  for (fs::recursive_directory_iterator at(root, error), end; !error && at != end;
       at.increment(error)) {
    const auto name = intended_name(at->path().filename().string());
    if (!name || !targets.contains(at->path().parent_path() / *name)) continue;
    std::error_code remove_error;
    if (fs::remove(at->path(), remove_error)) ++removed;
  }
  return removed;
}

}  // namespace batten::postproc
