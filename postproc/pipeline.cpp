#include "postproc/pipeline.h"

#include <oneapi/tbb/parallel_for.h>
#include <oneapi/tbb/task_arena.h>

#include <algorithm>
#include <atomic>
#include <mutex>
#include <utility>
#include <variant>

#include "gcode/interpreter.h"
#include "gcode/parser.h"
#include "gcode/reason.h"
#include "postproc/provenance.h"
#include "postproc/run_choice.h"
#include "postproc/run_grouping.h"
#include "postproc/smoothing.h"

namespace batten::postproc {

namespace {

// Parts of the progress: reading is quick, proving costs about as much as smoothing.
constexpr double kAfterReading = 0.1;
constexpr double kAfterSmoothing = 0.7;

// A section that may be rewritten, and what became of it.
struct RunWork {
  std::size_t section = 0;
  RunContext context;
  SmoothedRun smoothed;
  Choosing choosing;
  std::size_t tried = 0;       // candidates that were not proved
  std::string_view went_back;  // why none of them is left

  [[nodiscard]] const Candidate* chosen() const {
    if (tried >= choosing.order.size()) return nullptr;
    return &smoothed.candidates[choosing.order[tried]];
  }
};

class Smoothing {
 public:
  Smoothing(const gcode::SourceText& source, const SmoothOptions& options, const Progress& progress)
      : source_(source), options_(options), progress_(progress) {}

  SmoothResult run() {
    read();
    result_.understood = !gcode::has_error(result_.diagnostics);
    if (!result_.understood || !tell(kAfterReading)) return refused();
    prepare_runs();
    if (!smooth_runs()) return refused();
    if (!prove()) return refused();
    report();
    return std::move(result_);
  }

 private:
  bool tell(double part) { return !progress_ || progress_(part); }

  SmoothResult refused() {
    result_.understood = false;
    result_.text.clear();
    return std::move(result_);
  }

  void read() {
    program_ = gcode::parse(source_, result_.diagnostics);
    read_options_.units = options_.units;
    meaning_ = gcode::interpret(program_, read_options_, result_.diagnostics);
    result_.blocks_in = program_.blocks.size();
    for (const gcode::ModalState& state : meaning_.states) {
      if (result_.units == gcode::Units::kUnknown) result_.units = state.units;
    }
  }

  [[nodiscard]] static std::string_view bytes_of(const gcode::Program& program,
                                                 const Section& section) {
    const std::uint32_t begin = program.blocks[section.first_block].span.begin;
    return program.source.text({begin, program.blocks[section.last_block].end});
  }

  [[nodiscard]] std::string_view bytes_of(const Section& section) const {
    return bytes_of(program_, section);
  }

  [[nodiscard]] static RunContext context_of(const gcode::Program& program,
                                             const gcode::Interpretation& meaning,
                                             const Section& section) {
    const auto state_after = [&](std::uint32_t block) -> const gcode::ModalState& {
      return meaning.states[meaning.blocks[block].state_after];
    };
    const gcode::Block& first = program.blocks[section.first_block];
    return {program,
            section.first_block == 0 ? meaning.states[0] : state_after(section.first_block - 1),
            state_after(section.last_block),
            program.source.text({first.span.end, first.end}),
            section.last_block - section.first_block + 1,
            bytes_of(program, section).size()};
  }

  [[nodiscard]] bool is_allowed(std::string_view id) const {
    return std::ranges::find(options_.allowed, id) != options_.allowed.end();
  }

  [[nodiscard]] GroupingOptions grouping() const {
    GroupingOptions grouping;
    grouping.min_motions = options_.min_motions;
    for (const std::string& id : options_.allowed) grouping.allowed.push_back(id);
    return grouping;
  }

  // Items do not look at each other: any number of threads gives the same bytes.
  template <typename Function>
  void in_parallel(std::size_t count, const Function& function) const {
    oneapi::tbb::task_arena arena(options_.threads > 0 ? options_.threads
                                                       : oneapi::tbb::task_arena::automatic);
    arena.execute([&] { oneapi::tbb::parallel_for(std::size_t{0}, count, function); });
  }

  void prepare_runs() {
    sections_ = group_runs(program_, meaning_, grouping());
    for (std::size_t i = 0; i < sections_.size(); ++i) {
      if (!std::holds_alternative<Run>(sections_[i].content)) continue;
      work_.push_back({i, context_of(program_, meaning_, sections_[i]), {}, {}, 0, {}});
    }
  }

  [[nodiscard]] const Run& run_of(const RunWork& work) const {
    return std::get<Run>(sections_[work.section].content);
  }

  bool smooth_runs() {
    std::size_t points = 0;
    for (const RunWork& work : work_) points += run_of(work).points.size();
    std::atomic<std::size_t> done = 0;
    std::atomic<bool> stopped = false;
    std::mutex telling;
    const bool again = was_smoothed(program_) && !is_allowed(gcode::reason::kAlreadySmoothed);
    const auto one = [&](std::size_t i) {
      if (stopped) return;
      RunWork& work = work_[i];
      if (again) {
        work.choosing.reason = gcode::reason::kAlreadySmoothed;
        return;
      }
      work.smoothed = smooth_run(run_of(work), work.context, options_);
      work.choosing = choose(work.smoothed, work.context, options_);
      done += run_of(work).points.size();
      const double part = static_cast<double>(done) / static_cast<double>(points);
      const std::scoped_lock lock(telling);
      if (!tell(kAfterReading + part * (kAfterSmoothing - kAfterReading))) stopped = true;
    };
    in_parallel(work_.size(), one);
    return !stopped;
  }

  // The first rewritten run carries the comment that the program was smoothed.
  [[nodiscard]] std::string assemble() const {
    std::string text;
    text.reserve(source_.text().size());
    std::string told = provenance_comment(*options_.target, options_.tolerance_mm);
    std::size_t next = 0;
    for (std::size_t i = 0; i < sections_.size(); ++i) {
      const Candidate* chosen = nullptr;
      if (next < work_.size() && work_[next].section == i) {
        chosen = work_[next].chosen();
        if (chosen != nullptr && !told.empty()) {
          text += std::exchange(told, {});
          text += work_[next].context.line_end;
        }
        ++next;
      }
      text += chosen != nullptr ? std::string_view(chosen->text.text) : bytes_of(sections_[i]);
    }
    return text;
  }

  // Proves the text itself, read back as a control would read it. A run that does not hold its
  // tolerance tries its next candidate and in the end goes back to its original blocks, so each
  // round leaves fewer candidates and the loop ends.
  bool prove() {
    while (true) {
      std::string text = assemble();
      const gcode::SourceText written(source_.name(), text);
      gcode::Diagnostics ignored;
      const gcode::Program program = gcode::parse(written, ignored);
      const gcode::Interpretation meaning = gcode::interpret(program, read_options_, ignored);
      Verification verification =
          verify({&program_, &meaning_}, {&program, &meaning}, options_.tolerance_mm);
      result_.text = std::move(text);
      result_.blocks_out = program.blocks.size();
      if (!tell(kAfterSmoothing)) return false;
      if (!verification.proved() && take_back(verification)) continue;
      result_.proved = verification.proved();
      result_.deviation_mm = verification.deviation_mm;
      result_.deviation_line = verification.deviation_line;
      verification_ = std::move(verification);
      return true;
    }
  }

  // The rewritten run that holds a line of the input; the nearest rewritten one before it where
  // the line stands behind a run, for a breach may be noticed late.
  RunWork* rewritten_run_at(std::uint32_t line) {
    RunWork* found = nullptr;
    for (RunWork& work : work_) {
      if (program_.blocks[sections_[work.section].first_block].line > line) break;
      if (work.chosen() != nullptr) found = &work;
    }
    return found;
  }

  // Returns whether any run gave way.
  bool take_back(const Verification& verification) {
    std::vector<RunWork*> runs;
    for (const Breach& breach : verification.breaches) {
      if (RunWork* work = rewritten_run_at(breach.old_line)) runs.push_back(work);
    }
    if (runs.empty()) {
      // A breach that belongs to no run: believe none of them.
      for (RunWork& work : work_) {
        if (work.chosen() != nullptr) runs.push_back(&work);
      }
    }
    return give_way(std::move(runs), gcode::reason::kNotProved);
  }

  static bool give_way(std::vector<RunWork*> runs, std::string_view why) {
    std::sort(runs.begin(), runs.end());
    runs.erase(std::unique(runs.begin(), runs.end()), runs.end());
    for (RunWork* work : runs) {
      ++work->tried;
      if (work->chosen() == nullptr) work->went_back = why;
    }
    return !runs.empty();
  }

  void report() {
    std::size_t next = 0;
    for (std::size_t i = 0; i < sections_.size(); ++i) {
      if (next < work_.size() && work_[next].section == i) {
        result_.runs.push_back(report_of(work_[next++]));
      } else {
        report_kept_motions(sections_[i]);
      }
    }
  }

  [[nodiscard]] RunReport report_of(const RunWork& work) const {
    const Section& section = sections_[work.section];
    const Candidate* chosen = work.chosen();
    const RunFacts& facts = work.smoothed.facts;
    RunReport r = report_of_blocks(section);
    r.points = run_of(work).points.size();
    r.blocks_in = work.context.blocks;
    r.blocks_out = chosen != nullptr ? chosen->text.blocks : work.context.blocks;
    r.noise_mm = facts.noise;
    r.max_curvature_before = facts.max_curvature;
    r.max_curvature_after = chosen != nullptr ? facts.fair_curvature : facts.max_curvature;
    r.time_before_s = facts.times.as_set;
    r.time_after_s = chosen != nullptr ? chosen->times.as_set : facts.times.as_set;
    if (chosen == nullptr) {
      r.reason = work.went_back.empty() ? work.choosing.reason : work.went_back;
      return r;
    }
    r.status = RunStatus::kRewritten;
    r.method = chosen->method;
    r.form = chosen->form;
    r.proved = result_.proved;
    for (const Stretch& stretch : verification_.stretches) {
      if (stretch.old_last_block < section.first_block) continue;
      if (stretch.old_first_block > section.last_block) continue;
      r.deviation_mm = std::max(r.deviation_mm, stretch.comparison.bounds.at_most);
    }
    return r;
  }

  [[nodiscard]] RunReport report_of_blocks(const Section& section) const {
    RunReport r;
    r.first_line = program_.blocks[section.first_block].line;
    r.last_line = program_.blocks[section.last_block].line;
    r.proved = true;  // copied bytes are proved by being the same
    return r;
  }

  // Verbatim sections appear in the report when they hold motions that a user may have wanted
  // smoothed: chains of straight cutting moves.
  void report_kept_motions(const Section& section) {
    std::size_t lines = 0;
    for (std::uint32_t b = section.first_block; b <= section.last_block; ++b) {
      const std::int32_t motion = meaning_.blocks[b].motion;
      if (motion >= 0 && meaning_.motions[motion].kind == gcode::MotionKind::kLine) ++lines;
    }
    if (lines == 0) return;
    RunReport r = report_of_blocks(section);
    r.points = lines + 1;
    r.blocks_in = section.last_block - section.first_block + 1;
    r.blocks_out = r.blocks_in;
    r.reason = std::get<Verbatim>(section.content).reason;
    result_.runs.push_back(r);
  }

  const gcode::SourceText& source_;
  const SmoothOptions& options_;
  const Progress& progress_;
  SmoothResult result_;
  gcode::ReadOptions read_options_;
  gcode::Program program_{source_, {}, {}, {}};
  gcode::Interpretation meaning_;
  std::vector<Section> sections_;
  std::vector<RunWork> work_;
  Verification verification_;
};

}  // namespace

SmoothResult smooth_program(const gcode::SourceText& source, const SmoothOptions& options,
                            const Progress& progress) {
  SmoothResult result = Smoothing(source, options, progress).run();
  for (const RunReport& run : result.runs) {
    result.time_before_s += run.time_before_s;
    result.time_after_s += run.time_after_s;
  }
  return result;
}

}  // namespace batten::postproc
