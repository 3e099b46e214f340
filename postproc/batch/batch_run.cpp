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
#include <optional>
#include <string>
#include <system_error>
#include <thread>

#include "gcode/text/characters.h"
#include "postproc/batch/process_pool.h"
#include "postproc/system/exit_code.h"
#include "postproc/system/interrupt.h"
#include "postproc/text/json_values.h"

namespace batten::postproc {

namespace {

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
    result = process_program(plan, program);
  } catch (const std::exception& error) {
    result.record = without_result(program, error.what());
  }
  return json_text(
      {{"was_done", result.was_done}, {"record", Json::parse(record_text(result.record))}});
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

namespace {

// The processes of a run that was killed end with it, but on a busy machine not at once.
constexpr int kTries = 20;
constexpr std::chrono::milliseconds kBetweenTries{100};

// False when somebody else holds it.
bool lock_file(int descriptor, int operation) {
  for (int i = 0; i < kTries; ++i) {
    if (::flock(descriptor, operation | LOCK_NB) == 0 || errno != EWOULDBLOCK) return true;
    std::this_thread::sleep_for(kBetweenTries);
  }
  return false;
}

}  // namespace

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
  if (!lock_file(descriptor, operation)) {
    problem_ = file.string() + ": another run of this batch is at work on these programs";
  }
}

namespace fs = std::filesystem;

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
  for (const char c : half_written.substr(dot + 1)) {
    if (!gcode::is_digit(c)) return std::nullopt;
  }
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
