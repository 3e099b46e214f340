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
#include "gcode/source_kind.h"
#include "postproc/added_lines.h"
#include "postproc/assembly.h"
#include "postproc/band_notes.h"
#include "postproc/conversion.h"
#include "postproc/curve_caution.h"
#include "postproc/joined_times.h"
#include "postproc/provenance.h"
#include "postproc/run_choice.h"
#include "postproc/run_cutting.h"
#include "postproc/run_grouping.h"
#include "postproc/run_path.h"
#include "postproc/run_work.h"
#include "postproc/smoothing.h"
#include "postproc/target_words.h"

namespace batten::postproc {

namespace {

// Parts of the progress: reading is quick, proving costs about as much as smoothing.
constexpr double kAfterReading = 0.1;
constexpr double kAfterSmoothing = 0.7;

// Runs are cut where they would be kept as a whole: their parts differ. Runs of more points than
// this are cut at once, which bounds the memory; every cut costs a joint that is not smooth.
constexpr std::size_t kWholeAtMost = 200000;

// Neighbours of a piece that are timed with it: the machine looks ahead over as many blocks to
// stop, at most.
constexpr std::size_t kNeighbours = 100;

class Smoothing {
 public:
  Smoothing(const gcode::SourceText& source, const SmoothOptions& options, const Progress& progress)
      : source_(source), options_(options), progress_(progress) {}

  SmoothResult run() {
    read();
    result_.understood = !gcode::has_error(result_.diagnostics);
    if (!result_.understood || !tell(kAfterReading)) return refused();
    prepare_runs();
    if (!work_.empty() && !fits_target()) return refused();
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
    const auto language = language_read(source_, options_, result_.diagnostics);
    if (!language) return;
    program_ = gcode::parse(source_, *language, result_.diagnostics);
    gcode::tell_of_contradictions(program_, options_.source, result_.diagnostics);
    read_options_.units = options_.units;
    read_options_.curves = options_.target->curves();
    meaning_ = gcode::interpret(program_, read_options_, result_.diagnostics);
    result_.blocks_in = program_.blocks.size();
    for (const gcode::ModalState& state : meaning_.states) {
      if (result_.units == gcode::Units::kUnknown) result_.units = state.units;
    }
    tell_of_other_meanings(program_, *options_.target, result_.diagnostics);
    tell_of_own_words();
  }

  // The program's own smoothing words and those of the profile would undo each other. A program
  // that was smoothed before has both, and nothing is added to it.
  void tell_of_own_words() {
    additions_.comment = provenance_comment(*options_.target, options_.tolerance_mm);
    additions_.words =
        filled_in(options_.words, options_.tolerance_mm, result_.units, *options_.target);
    const std::uint32_t line = line_with_words_of(program_, additions_.words);
    if (line == 0 || (was_smoothed(program_) && !is_allowed(gcode::reason::kAlreadySmoothed))) {
      return;
    }
    result_.diagnostics.push_back(
        {gcode::Severity::kError, "profile-words-in-program", program_.blocks[line - 1].span,
         "words that the profile would add; expected them in the program or in the profile"});
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
            bytes_of(program, section).size(),
            number_room(program, section.first_block, section.last_block)};
  }

  [[nodiscard]] bool is_allowed(std::string_view id) const {
    return std::ranges::find(options_.allowed, id) != options_.allowed.end();
  }

  [[nodiscard]] GroupingOptions grouping() const {
    GroupingOptions grouping;
    grouping.min_motions = options_.min_motions;
    grouping.tolerance_mm = options_.tolerance_mm;
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
      work_.push_back({i, context_of(program_, meaning_, sections_[i])});
    }
  }

  // What is copied must say on the target what it said where it came from.
  bool fits_target() {
    if (!is_of_another_family(program_, *options_.target)) return true;
    const auto tell = options_.convert ? &tell_what_cannot_be_said : &tell_of_other_family;
    tell(program_, *options_.target, result_.diagnostics);
    return !gcode::has_error(result_.diagnostics);
  }

  [[nodiscard]] const Run& run_of(const RunWork& work) const {
    return std::get<Run>(sections_[work.section].content);
  }

  bool smooth_runs() {
    again_ = was_smoothed(program_) && !is_allowed(gcode::reason::kAlreadySmoothed);
    std::vector<std::size_t> whole;
    for (std::size_t i = 0; i < work_.size(); ++i) {
      if (again_) {
        work_[i].choosing.reason = gcode::reason::kAlreadySmoothed;
      } else if (run_of(work_[i]).points.size() <= kWholeAtMost) {
        whole.push_back(i);
      }
    }
    if (again_) return true;
    note_bands();
    for (const RunWork& work : work_) points_ += run_of(work).points.size();
    if (!smooth_works(whole)) return false;
    const std::vector<std::size_t> pieces = cut_runs();
    if (!smooth_works(pieces)) return false;
    for (CutRun& cut : cut_runs_) settle(cut, work_, options_);
    return true;
  }

  void note_bands() {
    std::vector<gcode::Diagnostics> notes(work_.size());
    in_parallel(work_.size(), [&](std::size_t i) {
      notes[i] = band_notes(program_, meaning_, sections_[work_[i].section], options_.tolerance_mm);
    });
    append_band_notes(notes, result_.diagnostics);
  }

  bool smooth_works(const std::vector<std::size_t>& works) {
    std::atomic<bool> stopped = false;
    std::mutex telling;
    const auto one = [&](std::size_t i) {
      if (stopped) return;
      RunWork& work = work_[works[i]];
      work.smoothed = smooth_run(run_of(work), work.context, options_);
      work.choosing = choose(work.smoothed, work.context, options_);
      const std::scoped_lock lock(telling);
      smoothed_points_ += run_of(work).points.size();
      const double part =
          std::min(1.0, static_cast<double>(smoothed_points_) / static_cast<double>(2 * points_));
      if (!tell(kAfterReading + part * (kAfterSmoothing - kAfterReading))) stopped = true;
    };
    in_parallel(works.size(), one);
    return !stopped;
  }

  // Puts pieces in the place of runs that are too long or that would be kept as a whole. Returns
  // the works that are new.
  std::vector<std::size_t> cut_runs() {
    std::vector<std::size_t> fresh;
    std::vector<Section> sections;
    std::vector<RunWork> works;
    std::size_t next = 0;
    for (std::size_t i = 0; i < sections_.size(); ++i) {
      const bool is_run = next < work_.size() && work_[next].section == i;
      if (!is_run || !add_pieces(work_[next], sections, works, fresh)) {
        if (is_run) {
          work_[next].section = sections.size();
          works.push_back(std::move(work_[next]));
        }
        sections.push_back(std::move(sections_[i]));
      }
      if (is_run) ++next;
    }
    sections_ = std::move(sections);
    work_ = std::move(works);
    return fresh;
  }

  bool add_pieces(RunWork& work, std::vector<Section>& sections, std::vector<RunWork>& works,
                  std::vector<std::size_t>& fresh) {
    const bool too_long = run_of(work).points.size() > kWholeAtMost;
    const std::string_view kept = work.choosing.reason;
    const bool disappoints = kept == gcode::reason::kNoGain || kept == gcode::reason::kSlower ||
                             kept == gcode::reason::kNoFit;
    if (!too_long && !disappoints) return false;
    std::vector<RunPiece> pieces = cut_run(sections_[work.section], meaning_, {});
    if (pieces.size() < 2) return false;
    CutRun cut;
    cut.path = work.context.after.path;
    if (!too_long) cut.facts = work.smoothed.facts;
    cut.reason = work.choosing.reason;
    cut.first_work = works.size();
    cut.pieces = pieces.size();
    cut.run = std::move(std::get<Run>(sections_[work.section].content));
    for (RunPiece& piece : pieces) {
      fresh.push_back(works.size());
      RunWork part{sections.size(), context_of(program_, meaning_, piece.section)};
      part.cut_run = cut_runs_.size();
      part.first = piece.first;
      part.last = piece.last;
      const std::size_t end = cut.run.points.size() - 1;
      part.context.lead = timed_pieces(
          cut.run, piece.first < kNeighbours ? 0 : piece.first - kNeighbours, piece.first);
      part.context.tail =
          timed_pieces(cut.run, piece.last, std::min(piece.last + kNeighbours, end));
      works.push_back(std::move(part));
      sections.push_back(std::move(piece.section));
    }
    cut_runs_.push_back(std::move(cut));
    return true;
  }

  // Proves the text itself, read back as a control would read it. A run that does not hold its
  // tolerance tries its next candidate and in the end goes back to its original blocks, so each
  // round leaves fewer candidates and the loop ends.
  bool prove() {
    while (true) {
      std::string text = assemble(program_, sections_, work_, additions_);
      const AddedLines added = take_added_lines(program_, text, additions_.words);
      const gcode::SourceText written(source_.name(), added.text);
      gcode::Diagnostics ignored;
      const gcode::Program program = gcode::parse(written, program_.language, ignored);
      const gcode::Interpretation meaning = gcode::interpret(program, read_options_, ignored);
      Verification verification =
          verify({&program_, &meaning_}, {&program, &meaning},
                 {options_.tolerance_mm, options_.tolerance_kind, options_.side});
      add_breaches(added, {&program, &meaning}, verification);
      result_.added_lines = added.lines;
      result_.text = std::move(text);
      result_.blocks_out = program.blocks.size();
      if (!tell(kAfterSmoothing)) return false;
      if (!verification.proved() && take_back(verification)) continue;
      result_.proved = verification.proved();
      result_.deviation_mm = verification.deviation_mm;
      result_.deviation_line = verification.deviation_line;
      result_.corner_mm = verification.corner_mm;
      verification_ = std::move(verification);
      return true;
    }
  }

  static void add_breaches(const AddedLines& added, const ReadProgram& read,
                           Verification& verification) {
    const auto add = [&](const std::vector<Breach>& breaches) {
      verification.breaches.insert(verification.breaches.end(), breaches.begin(), breaches.end());
    };
    add(added.breaches);
    add(events_in_brackets(read, added.brackets));
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
    std::vector<RunWork*> crossing;
    std::vector<RunWork*> over;
    for (const Breach& breach : verification.breaches) {
      const bool wrong_side = breach.kind == BreachKind::kSide;
      auto& list = breach.kind == BreachKind::kCrossing ? crossing : wrong_side ? over : runs;
      if (RunWork* work = rewritten_run_at(breach.old_line)) list.push_back(work);
    }
    if (give_way(std::move(crossing), gcode::reason::kCrossesItself)) return true;
    if (give_way(std::move(over), gcode::reason::kWrongSide)) return true;
    if (runs.empty()) {
      // A breach that belongs to no run: believe none of them.
      for (RunWork& work : work_) {
        if (work.chosen() != nullptr) runs.push_back(&work);
      }
    }
    return give_way(std::move(runs), gcode::reason::kNotProved);
  }

  bool give_way(std::vector<RunWork*> runs, std::string_view why) {
    std::sort(runs.begin(), runs.end());
    runs.erase(std::unique(runs.begin(), runs.end()), runs.end());
    for (RunWork* work : runs) {
      work->give_way(why);
      if (work->cut_run) settle(cut_runs_[*work->cut_run], work_, options_);
    }
    return !runs.empty();
  }

  void report() {
    std::size_t next = 0;
    for (std::size_t i = 0; i < sections_.size(); ++i) {
      if (next >= work_.size() || work_[next].section != i) {
        report_kept_motions(sections_[i]);
        continue;
      }
      const RunWork& work = work_[next++];
      if (work.cut_run) {
        report_piece(work);
      } else {
        result_.runs.push_back(report_of(work));
      }
    }
    if (auto told = curve_caution(result_.runs, program_, *options_.target)) {
      result_.diagnostics.push_back(std::move(*told));
    }
  }

  // Neighbouring pieces that are kept for one reason are one run of the report. Where the whole
  // run was tried and no piece of it is left, it is as if it had not been cut.
  void report_piece(const RunWork& work) {
    const CutRun& cut = cut_runs_[*work.cut_run];
    const auto first = work_.begin() + static_cast<std::ptrdiff_t>(cut.first_work);
    const auto last = first + static_cast<std::ptrdiff_t>(cut.pieces);
    const bool all_kept =
        std::all_of(first, last, [](const RunWork& w) { return w.chosen() == nullptr; });
    RunReport r = report_of(work);
    // The times of the pieces are those between their neighbours; they are shares of the run's.
    Times before;
    Times after;
    for (auto piece = first; piece != last; ++piece) {
      const Candidate* chosen = piece->chosen();
      before += piece->smoothed.facts.times;
      after += chosen != nullptr ? chosen->times : piece->smoothed.facts.times;
    }
    const double share_before = before.as_set > 0 ? cut.before.as_set / before.as_set : 1;
    const double share_after = after.as_set > 0 ? cut.after.as_set / after.as_set : 1;
    r.time_before_s *= share_before;
    r.time_after_s *= share_after;
    for (MethodTime& each : r.methods) {
      each.time_s *= r.status == RunStatus::kKept ? share_before : share_after;
    }
    if (all_kept && cut.facts) {
      r.reason = cut.reason;
      r.noise_mm = cut.facts->noise;
      r.max_curvature_before = cut.facts->max_curvature;
      r.max_curvature_after = r.max_curvature_before;
    }
    const bool goes_on = &work != &*first && result_.runs.back().status == RunStatus::kKept &&
                         r.status == RunStatus::kKept && result_.runs.back().reason == r.reason;
    if (!goes_on) {
      result_.runs.push_back(r);
      return;
    }
    RunReport& before_it = result_.runs.back();
    before_it.methods = joined_times({before_it.methods, before_it.time_before_s},
                                     {std::move(r.methods), r.time_before_s});
    before_it.last_line = r.last_line;
    before_it.points += r.points - 1;
    before_it.blocks_in += r.blocks_in;
    before_it.blocks_out += r.blocks_out;
    before_it.noise_mm = std::max(before_it.noise_mm, r.noise_mm);
    before_it.max_curvature_before =
        std::max(before_it.max_curvature_before, r.max_curvature_before);
    before_it.max_curvature_after = std::max(before_it.max_curvature_after, r.max_curvature_after);
    before_it.time_before_s += r.time_before_s;
    before_it.time_after_s += r.time_after_s;
  }

  [[nodiscard]] RunReport report_of(const RunWork& work) const {
    const Section& section = sections_[work.section];
    const Candidate* chosen = work.chosen();
    const RunFacts& facts = work.smoothed.facts;
    RunReport r = report_of_blocks(section);
    r.points = motion_count(run_of(work)) + 1;
    r.blocks_in = work.context.blocks;
    r.blocks_out = chosen != nullptr ? chosen->text.blocks : work.context.blocks;
    r.noise_mm = facts.noise;
    r.max_curvature_before = facts.max_curvature;
    r.max_curvature_after = chosen != nullptr ? chosen->max_curvature : facts.max_curvature;
    r.methods = method_times(work.smoothed);
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
  gcode::Program program_{source_, {}, {}, {}, {}};
  gcode::Interpretation meaning_;
  std::vector<Section> sections_;
  std::vector<RunWork> work_;
  std::vector<CutRun> cut_runs_;
  Additions additions_;
  bool again_ = false;               // the program was smoothed before
  std::size_t points_ = 0;           // of all runs
  std::size_t smoothed_points_ = 0;  // pieces count again
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
