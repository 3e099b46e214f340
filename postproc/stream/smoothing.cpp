#include "postproc/stream/smoothing.h"

#include <oneapi/tbb/parallel_pipeline.h>
#include <oneapi/tbb/task_arena.h>

#include <algorithm>
#include <atomic>
#include <cstdint>
#include <iterator>
#include <memory>
#include <mutex>
#include <optional>
#include <utility>
#include <vector>

#include "gcode/state/reason.h"
#include "postproc/convert/conversion.h"
#include "postproc/machine/program_time/program_time.h"
#include "postproc/profile/target_profile.h"
#include "postproc/runs/band_notes.h"
#include "postproc/smooth/forms/provenance.h"
#include "postproc/smooth/part_runs.h"
#include "postproc/stream/assembly.h"
#include "postproc/stream/part_crossings.h"
#include "postproc/stream/part_reader.h"
#include "postproc/system/parallel_for.h"

namespace batten::postproc {

namespace {

// Of the progress: reading is quick.
constexpr double kAfterReading = 0.15;

// The result of a program, collected window by window.
class CollectedResult {
 public:
  // What is known before the first window: of the text, and what reading it reports.
  explicit CollectedResult(const PrescanReport& facts) {
    result.diagnostics = facts.found;
    result.blocks_in = facts.blocks;
    result.units = facts.units;
  }

  SmoothResult result;

  // The figures, runs and notes of the next window; its text is the caller's.
  void take(WindowDone window) {
    const ProvedText& proof = window.proof;
    proved_ = proved_ && proof.proved;
    notes_.add(window.notes, result.diagnostics);
    result.blocks_out += proof.blocks;
    result.added_lines += proof.added_lines;
    result.outlook += window.outlook;
    result.corner_mm = std::max(result.corner_mm, proof.verification.corner_mm);
    if (proof.verification.deviation_mm > result.deviation_mm) {
      result.deviation_mm = proof.verification.deviation_mm;
      result.deviation_line = proof.verification.deviation_line;
    }
    add_stated(window.stated, result.stated);
    causes_.add(window.causes);
    if (window.scale && scale_) scale_->add(*window.scale);
    if (window.scale && !scale_) scale_ = window.scale;
    if (window.seams) (seams_ ? *seams_ : seams_.emplace()) += *window.seams;
    for (gcode::Diagnostic& note : window.notes_on_runs) {
      const bool noted = std::ranges::count(notes_on_runs_, note.id, &gcode::Diagnostic::id) > 0;
      if (!noted) notes_on_runs_.push_back(std::move(note));
    }
    for (RunReport& run : window.runs) {
      result.runs_before_s += run.time_before_s;
      result.runs_after_s += run.time_after_s;
      result.path_before += run.path_before;
      result.path_after += run.path_after;
      result.runs.push_back(std::move(run));
    }
  }

  // After the last window.
  SmoothResult finish() {
    notes_.tell_rest(result.diagnostics);
    if (seams_) std::ranges::move(seams_->diagnostics(), std::back_inserter(notes_on_runs_));
    std::ranges::move(notes_on_runs_, std::back_inserter(result.diagnostics));
    // Before the others: what is said of the whole program must not be lost among them.
    const gcode::Diagnostics of_scale = scale_ ? scale_->diagnostics() : gcode::Diagnostics();
    result.diagnostics.insert(result.diagnostics.begin(), of_scale.begin(), of_scale.end());
    result.kept = causes_.causes();
    result.understood = true;
    result.proved = proved_;
    return std::move(result);
  }

 private:
  BandNoteTally notes_;
  CauseTally causes_;
  std::optional<ToleranceScale> scale_;
  std::optional<SeamTally> seams_;
  bool proved_ = true;
  gcode::Diagnostics notes_on_runs_;  // one of each id
};

// How far the work is, reported by many threads.
class SharedProgress {
 public:
  SharedProgress(const Progress& progress, std::size_t bytes)
      : progress_(progress), bytes_(std::max(1.0, static_cast<double>(bytes))) {}

  bool report_reading(double part) { return !progress_ || progress_(part * kAfterReading); }

  void begin(std::size_t windows) {
    shares_.assign(windows, 0);
    done_bytes_ = 0;
  }

  // Of a window; what is done once more counts once.
  bool report(std::size_t window, const WindowPlace& place, double share) {
    const std::scoped_lock lock(reporting_);
    const double gained = std::max(0.0, share - shares_[window]);
    shares_[window] += gained;
    done_bytes_ += gained * (place.end - place.begin);
    const double part = std::min(1.0, done_bytes_ / bytes_);
    return !progress_ || progress_(kAfterReading + part * (1 - kAfterReading));
  }

 private:
  const Progress& progress_;
  double bytes_;
  std::vector<double> shares_;
  double done_bytes_ = 0;
  std::mutex reporting_;
};

// Windows that are made before the one before them is proved must guess how its new text leaves the
// control: as the old one does, but for words that only the new text has said so far.
class StartGuess {
 public:
  void learn(const TextBefore& old_after, const TextBefore& known) {
    const std::scoped_lock lock(learning_);
    words_said_ = known.control.state.set_by_word & ~old_after.control.state.set_by_word;
    for (std::size_t i = 0; i < events_.size(); ++i) {
      const bool more = old_after.events.set_by_word[i] == kNone;
      events_[i] = more ? known.events.set_by_word[i] : kNone;
    }
  }

  // Before a window that is not the first one most often something says that it was smoothed.
  [[nodiscard]] NewTextBefore guess(const TextBefore& old_before, bool first) {
    const std::scoped_lock lock(learning_);
    NewTextBefore before{old_before, !first};
    before.known.control.state.set_by_word |= words_said_;
    auto& said = before.known.events.set_by_word;
    for (std::size_t i = 0; i < events_.size(); ++i) {
      if (said[i] == kNone) said[i] = events_[i];
    }
    return before;
  }

 private:
  static constexpr gcode::Code kNone = -1;
  std::mutex learning_;
  std::uint32_t words_said_ = 0;
  decltype(EventsBefore::set_by_word) events_ = EventsBefore::nothing_set();
};

class Smoothing {
 public:
  Smoothing(const gcode::SourceText& source, const SmoothOptions& options, const ProgramSink& sink,
            const Progress& progress, const StreamLimits& limits, const PartSurvey& survey)
      : source_(source),
        options_(options),
        for_windows_(options),
        sink_(sink),
        progress_(progress, source.text().size()),
        limits_(limits),
        setting_{source, for_windows_, read_options_of(options), {}, limits.windows.long_runs} {
    for_windows_.threads = kThreadsOfCaller;
    setting_.survey = survey;
  }

  SmoothResult run() {
    if (!read()) return refused();
    while (true) {
      const WindowOutcome outcome = smooth_all();
      const bool worse = outcome == WindowOutcome::kDone && is_worse_in_windows(sums_);
      if (outcome == WindowOutcome::kDone && !worse && !copy_where_parts_cross()) return finished();
      if (outcome == WindowOutcome::kStopped || !sink_.restart()) return refused();
      const bool as_one = outcome == WindowOutcome::kNotProvedAlone || worse;
      if (as_one && !read_as_one_window()) return refused();
    }
  }

 private:
  using Made = std::shared_ptr<WindowDone>;

  bool read() {
    gcode::Diagnostics of_language;
    if (source_.text().size() < limits_.bytes_for_windows || !options_.words.empty() ||
        language_read(source_, options_, of_language) != gcode::Language::kRs274) {
      return read_as_one_window();
    }
    facts_ = prescan(source_, options_, limits_.windows,
                     [this](double part) { return progress_.report_reading(part); });
    if (facts_.outcome == PrescanOutcome::kWhole) return read_as_one_window();
    for_reading_of(facts_.units);
    setting_.facts.near =
        std::make_shared<const std::vector<SelfProximity>>(std::move(facts_.near));
    return facts_.outcome == PrescanOutcome::kWindows;
  }

  // False: not understood, or stopped.
  bool read_as_one_window() {
    facts_ = {};
    setting_.facts = {};
    gcode::Diagnostics& found = facts_.found;
    const auto language = language_read(source_, options_, found);
    if (!language) return false;
    gcode::ReadPart read = read_whole(
        source_, {options_.source, reading_of(options_, *language), setting_.read_options}, found);
    const auto part = std::make_shared<const ProgramPart>(
        ProgramPart{std::move(read.program), std::move(read.meaning)});
    setting_.whole = part;
    facts_.blocks = part->program.blocks.size();
    facts_.units = first_units(part->meaning);
    facts_.was_smoothed = was_smoothed(part->program);
    facts_.has_m6 = has_m6(part->program);
    for_reading_of(facts_.units);
    tell_of_other_meanings(part->program, *options_.target, found);
    tell_of_own_words(part->program);
    if (gcode::has_error(found) || !fits_target(*part)) return false;
    WindowPlace all;
    all.from.before.control = known_at_begin().known.control;
    all.end = static_cast<std::uint32_t>(source_.text().size());
    facts_.windows = {all};
    return progress_.report_reading(1);
  }

  void for_reading_of(gcode::Units units) {
    setting_.words = filled_in(options_.words, options_.tolerance_mm, units, *options_.target);
    setting_.was_smoothed =
        facts_.was_smoothed && !is_allowed(gcode::reason::kAlreadySmoothed, options_);
  }

  // The program's own smoothing words and those of the profile would undo each other. A program
  // that was smoothed before has both, and nothing is added to it.
  void tell_of_own_words(const gcode::Program& program) {
    const std::uint32_t line = line_with_words_of(program, setting_.words);
    if (line == 0 || setting_.was_smoothed) return;
    facts_.found.push_back(
        {gcode::Severity::kError, "profile-words-in-program", program.blocks[line - 1].span,
         "words that the profile would add; expected them in the program or in the profile"});
  }

  // What is copied must say on the target what it said on the control that it was made for.
  bool fits_target(const ProgramPart& part) {
    gcode::Diagnostics others;
    tell_of_other_family(part.program, *options_.target, others);
    if (others.empty() || find_runs(part, options_, setting_.long_runs).works.empty()) return true;
    if (options_.convert) {
      others.clear();
      tell_what_cannot_be_said(part.program, *options_.target, others);
    }
    std::ranges::move(others, std::back_inserter(facts_.found));
    return !gcode::has_error(facts_.found);
  }

  [[nodiscard]] NewTextBefore known_at_begin() const {
    NewTextBefore known{{gcode::ControlCarry(options_.units)}, false};
    known.known.control.lathe.settle();
    return known;
  }

  // Window by window, from the begin of the program on.
  WindowOutcome smooth_all() {
    collected_.emplace(facts_);
    sums_ = {};
    known_ = known_at_begin();
    guess_.emplace();
    crossings_.reset();
    old_time_.emplace(options_, facts_.has_m6);
    new_time_.reset();
    outcome_ = WindowOutcome::kDone;
    progress_.begin(facts_.windows.size());
    const int threads = threads_at_once(options_.threads);
    oneapi::tbb::task_arena(threads).execute([&] { go_through(threads); });
    return outcome_;
  }

  // Texts that wait for the ones before them take little room beside windows that are worked on.
  void go_through(int threads) {
    using oneapi::tbb::filter_mode;
    using oneapi::tbb::make_filter;
    const std::size_t at_once = threads > 1 ? 2 * static_cast<std::size_t>(threads) : 1;
    std::size_t next = 0;
    std::size_t next_taken = 0;
    const auto give = [&](oneapi::tbb::flow_control& flow) -> std::size_t {
      if (next >= facts_.windows.size() || outcome_ != WindowOutcome::kDone) flow.stop();
      return next++;
    };
    const auto work = [&](std::size_t window) {
      const Guess guess = [&](const TextBefore& old) { return guess_->guess(old, window == 0); };
      return std::make_shared<WindowDone>(smooth(window, guess));
    };
    const auto append = [&](const Made& made) {
      if (outcome_ == WindowOutcome::kDone) outcome_ = take(next_taken++, std::move(*made));
    };
    oneapi::tbb::parallel_pipeline(
        at_once, make_filter<void, std::size_t>(filter_mode::serial_in_order, give) &
                     make_filter<std::size_t, Made>(filter_mode::parallel, work) &
                     make_filter<Made, void>(filter_mode::serial_in_order, append));
  }

  WindowDone smooth(std::size_t window, const Guess& before,
                    const std::optional<PartSums>& beside = {}) {
    const WindowPlace& place = facts_.windows[window];
    const auto tell = [&](double share) {
      return outcome_ == WindowOutcome::kDone && progress_.report(window, place, share);
    };
    return smooth_window(setting_, place, before, tell, beside);
  }

  // One after the other, in order. What was made for another begin than the window has is made
  // anew: nothing that was guessed is believed. So is a window with which those so far are larger
  // or farther off for too little.
  WindowOutcome take(std::size_t window, WindowDone made) {
    if (made.outcome == WindowOutcome::kStopped) return made.outcome;
    if (!was_made_for_its_begin(made)) {
      made = smooth(window, [this](const TextBefore&) { return known_; });
    }
    PartSums sums = sums_;
    sums += made.sums;
    const bool grows = made.outcome == WindowOutcome::kDone && made.sums.grow();
    if (limits_.mend_windows && grows && is_worse_in_windows(sums)) {
      made = smooth(
          window, [this](const TextBefore&) { return known_; }, sums_);
    }
    if (made.outcome != WindowOutcome::kDone) return made.outcome;
    const gcode::SourceSpan span{facts_.windows[window].begin, facts_.windows[window].end};
    const bool unchanged = made.proof.unchanged;
    const std::string_view bytes = unchanged ? source_.text(span) : made.proof.text;
    collected_->result.bytes_out += bytes.size();
    if (!sink_.take(bytes)) return WindowOutcome::kStopped;
    if (unchanged && !setting_.whole) source_.release_pages(span);  // they were read once more
    add_time(made);
    known_ = {std::move(made.after.known), known_.says_smoothed || !unchanged};
    guess_->learn(made.old_after, known_.known);
    if (!crossings_) crossings_.emplace(made.near, options_.tolerance_mm);
    crossings_->take(std::move(made.proof.near_edges));
    crossings_->look_up_to(made.last_line);
    sums_ += made.sums;
    collected_->take(std::move(made));
    return WindowOutcome::kDone;
  }

  // One time is both up to the first window that is rewritten.
  void add_time(const WindowDone& made) {
    if (!new_time_ && !made.proof.unchanged) new_time_.emplace(*old_time_);
    old_time_->add(made.part->program, made.part->meaning);
    if (!new_time_) return;
    if (made.proof.read) {
      new_time_->add(made.proof.read->program, made.proof.read->meaning);
    } else {
      new_time_->add(made.part->program, made.part->meaning);
    }
  }

  // Where nothing is rewritten nothing is said of it.
  [[nodiscard]] bool was_made_for_its_begin(const WindowDone& made) const {
    NewTextBefore begin = known_;
    if (made.proof.unchanged && made.outcome == WindowOutcome::kDone) {
      begin.says_smoothed = made.before.says_smoothed;
    }
    return same_before(made.before, begin);
  }

  // The whole reverts what is not worth it by itself.
  [[nodiscard]] bool is_worse_in_windows(const PartSums& sums) const {
    return !setting_.whole && is_worse(sums, options_);
  }

  // Whether parts of long runs cross each other where they did not: then more is to be copied.
  bool copy_where_parts_cross() {
    const std::vector<LineRange> found =
        crossings_ ? crossings_->found() : std::vector<LineRange>{};
    if (found.empty()) return false;
    std::vector<LineRange>& copied = setting_.facts.copied;
    const std::size_t lines = lines_in(copied);
    copied = more_to_copy(copied, found, crossings_->near());
    return lines_in(copied) > lines;  // each round copies more, so the rounds end
  }

  SmoothResult refused() { return CollectedResult(facts_).result; }

  SmoothResult finished() {
    SmoothResult& result = collected_->result;
    result.program_before = old_time_->finish();
    result.program_after = new_time_ ? new_time_->finish() : result.program_before;
    return collected_->finish();
  }

  const gcode::SourceText& source_;
  const SmoothOptions& options_;
  SmoothOptions for_windows_;
  const ProgramSink& sink_;
  SharedProgress progress_;
  const StreamLimits& limits_;
  WindowSetting setting_;
  PrescanReport facts_;
  // Of the windows that were taken.
  std::atomic<WindowOutcome> outcome_ = WindowOutcome::kDone;
  NewTextBefore known_;  // after them
  PartSums sums_;
  std::optional<StartGuess> guess_;
  std::optional<PartCrossings> crossings_;
  std::optional<ProgramTimers> old_time_;
  std::optional<ProgramTimers> new_time_;
  std::optional<CollectedResult> collected_;
};

}  // namespace

SmoothResult smooth_windows(const gcode::SourceText& source, const SmoothOptions& options,
                            const ProgramSink& sink, const Progress& progress,
                            const StreamLimits& limits, const PartSurvey& survey) {
  return Smoothing(source, options, sink, progress, limits, survey).run();
}

}  // namespace batten::postproc
