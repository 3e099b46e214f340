#include "postproc/stream/pipeline.h"

#include <fmt/format.h>
#include <oneapi/tbb/parallel_pipeline.h>
#include <oneapi/tbb/task_arena.h>

#include <algorithm>
#include <atomic>
#include <cstdint>
#include <iterator>
#include <memory>
#include <mutex>
#include <string>
#include <utility>

#include "gcode/interpreter/interpreter.h"
#include "gcode/reading/parser.h"
#include "gcode/state/reason.h"
#include "gcode/writer/block_numbers.h"
#include "postproc/convert/conversion.h"
#include "postproc/convert/program_operations.h"
#include "postproc/convert/translation.h"
#include "postproc/machine/program_time/program_time.h"
#include "postproc/profile/target_profile.h"
#include "postproc/proof/verification.h"
#include "postproc/runs/band_notes.h"
#include "postproc/smooth/part_runs.h"
#include "postproc/stream/assembly.h"
#include "postproc/stream/part_crossings.h"
#include "postproc/stream/part_reader.h"
#include "postproc/stream/window.h"
#include "postproc/system/parallel_for.h"

namespace batten::postproc {

namespace {

// Shares of the progress: reading is quick.
constexpr double kAfterPrescan = 0.15;
constexpr double kAfterReading = 0.1;

// The result of a program, collected window by window.
class CollectedResult {
 public:
  // What is known before the first window: of the text, and what reading it reports.
  SmoothResult result;

  // The figures, runs and notes of the next window; its text is the caller's.
  void take(WindowDone window) {
    const ProvedText& proof = window.proof;
    notes_.add(window.notes, result.diagnostics);
    result.blocks_out += proof.blocks;
    result.added_lines += proof.added_lines;
    result.outlook += window.outlook;
    result.corner_mm = std::max(result.corner_mm, proof.verification.corner_mm);
    if (proof.verification.deviation_mm > result.deviation_mm) {
      result.deviation_mm = proof.verification.deviation_mm;
      result.deviation_line = proof.verification.deviation_line;
    }
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
    std::ranges::move(notes_on_runs_, std::back_inserter(result.diagnostics));
    result.understood = true;
    return std::move(result);
  }

 private:
  BandNoteTally notes_;
  gcode::Diagnostics notes_on_runs_;  // one of each id
};

// How far the work is, reported by many threads.
class SharedProgress {
 public:
  SharedProgress(const Progress& progress, std::size_t bytes)
      : progress_(progress), bytes_(static_cast<double>(bytes)) {}

  bool report_prescan(double part) { return !progress_ || progress_(part * kAfterPrescan); }

  void begin(std::size_t windows) { shares_.assign(windows, 0); }

  // Of a window; what is done once more counts once.
  bool report(std::size_t window, const WindowPlace& place, double share) {
    const std::scoped_lock lock(reporting_);
    const double gained = std::max(0.0, share - shares_[window]);
    shares_[window] += gained;
    done_bytes_ += gained * (place.end - place.begin);
    const double part = std::min(1.0, done_bytes_ / bytes_);
    return !progress_ || progress_(kAfterPrescan + part * (1 - kAfterPrescan));
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

class Windows {
 public:
  Windows(const gcode::SourceText& source, const SmoothOptions& options, const TextSink& sink,
          const Progress& progress, std::vector<LineRange>* copied, const PartSurvey& survey)
      : source_(source),
        options_(options),
        for_windows_(options),
        sink_(sink),
        progress_(progress, source.text().size()),
        copied_(copied),
        setting_{source, for_windows_, {}, {}, false},
        known_{{gcode::ControlCarry(options.units)}, false} {
    for_windows_.threads = kThreadsOfCaller;
    setting_.read_options = read_options_of(options);
    setting_.survey = survey;
  }

  std::optional<SmoothResult> run(const WindowLimits& limits) {
    if (!options_.words.empty()) return std::nullopt;
    if (is_to_be_translated(source_, options_)) return std::nullopt;
    gcode::Diagnostics of_language;
    const auto language = language_read(source_, options_, of_language);
    if (language != gcode::Language::kRs274) return std::nullopt;
    PrescanReport facts = prescan(source_, options_, limits,
                                  [this](double part) { return progress_.report_prescan(part); });
    if (facts.outcome == PrescanOutcome::kWhole) return std::nullopt;
    collected_.result.diagnostics = std::move(facts.found);
    collected_.result.blocks_in = facts.blocks;
    collected_.result.units = facts.units;
    if (facts.outcome == PrescanOutcome::kStopped) return std::move(collected_.result);
    setting_.was_smoothed =
        facts.was_smoothed && !is_allowed(gcode::reason::kAlreadySmoothed, options_);
    setting_.long_runs = limits.long_runs;
    windows_ = std::move(facts.windows);
    StepOptions steps = step_options_of(options_);
    steps.has_m6 = facts.has_m6;
    old_time_.emplace(*options_.machine, steps);
    known_.known.control.lathe.settle();
    setting_.facts.near = std::make_shared<const std::vector<SelfProximity>>(std::move(facts.near));
    if (copied_ != nullptr) setting_.facts.copied = *copied_;
    crossings_.emplace(*setting_.facts.near, options_.tolerance_mm);
    progress_.begin(windows_.size());
    const int threads = threads_at_once(options_.threads);
    oneapi::tbb::task_arena(threads).execute([&] { go_through(threads); });
    if (outcome_ == WindowOutcome::kNeedsWhole) return std::nullopt;
    if (outcome_ == WindowOutcome::kStopped) return std::move(collected_.result);
    // Whether parts of long runs cross each other where they did not.
    if (const std::vector<LineRange> found = crossings_->found(); !found.empty()) {
      if (copied_ != nullptr) *copied_ = more_to_copy(*copied_, found, *setting_.facts.near);
      return std::nullopt;
    }
    SmoothResult& result = collected_.result;
    result.program_before = figures_of(old_time_->finish());
    result.program_after = new_time_ ? figures_of(new_time_->finish()) : result.program_before;
    result.proved = true;
    return collected_.finish();
  }

 private:
  using Made = std::shared_ptr<WindowDone>;

  // Texts that wait for the ones before them take little room beside windows that are worked on.
  void go_through(int threads) {
    using oneapi::tbb::filter_mode;
    using oneapi::tbb::make_filter;
    const std::size_t at_once = threads > 1 ? 2 * static_cast<std::size_t>(threads) : 1;
    std::size_t next = 0;
    std::size_t next_taken = 0;
    const auto give = [&](oneapi::tbb::flow_control& flow) -> std::size_t {
      if (next >= windows_.size() || outcome_ != WindowOutcome::kDone) flow.stop();
      return next++;
    };
    const auto work = [&](std::size_t window) {
      const Guess guess = [&](const TextBefore& old) { return guess_.guess(old, window == 0); };
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

  WindowDone smooth(std::size_t window, const Guess& before) {
    const WindowPlace& place = windows_[window];
    return smooth_window(setting_, place, before, [&](double share) {
      return outcome_ == WindowOutcome::kDone && progress_.report(window, place, share);
    });
  }

  // One after the other, in order. What was made for another begin than the window has is made
  // anew: nothing that was guessed is believed.
  WindowOutcome take(std::size_t window, WindowDone made) {
    if (made.outcome == WindowOutcome::kStopped) return made.outcome;
    if (!was_made_for_its_begin(made)) {
      made = smooth(window, [this](const TextBefore&) { return known_; });
    }
    if (made.outcome != WindowOutcome::kDone) return made.outcome;
    const gcode::SourceSpan span{windows_[window].begin, windows_[window].end};
    const bool unchanged = made.proof.unchanged;
    const std::string_view bytes = unchanged ? source_.text(span) : made.proof.text;
    collected_.result.bytes_handed_on += bytes.size();
    if (!sink_(bytes)) return WindowOutcome::kStopped;
    if (unchanged) source_.release_pages(span);  // they were read once more
    add_time(made);
    known_ = {std::move(made.after.known), known_.says_smoothed || !unchanged};
    guess_.learn(made.old_after, known_.known);
    crossings_->take(std::move(made.proof.near_edges));
    crossings_->look_up_to(made.last_line);
    collected_.take(std::move(made));
    return WindowOutcome::kDone;
  }

  // One time is both up to the first window that is rewritten.
  void add_time(const WindowDone& made) {
    if (!new_time_ && !made.proof.unchanged) new_time_.emplace(*old_time_);
    old_time_->add(made.old->program, made.old->meaning);
    if (!new_time_) return;
    const gcode::ReadPart& written = made.proof.read ? *made.proof.read : *made.old;
    new_time_->add(written.program, written.meaning);
  }

  // Where nothing is rewritten nothing is said of it.
  [[nodiscard]] bool was_made_for_its_begin(const WindowDone& made) const {
    NewTextBefore begin = known_;
    if (made.proof.unchanged && made.outcome == WindowOutcome::kDone) {
      begin.says_smoothed = made.before.says_smoothed;
    }
    return same_before(made.before, begin);
  }

  const gcode::SourceText& source_;
  const SmoothOptions& options_;
  SmoothOptions for_windows_;
  const TextSink& sink_;
  SharedProgress progress_;
  std::vector<LineRange>* copied_;
  WindowSetting setting_;
  std::optional<PartCrossings> crossings_;
  std::vector<WindowPlace> windows_;
  std::atomic<WindowOutcome> outcome_ = WindowOutcome::kDone;
  StartGuess guess_;
  NewTextBefore known_;  // after the windows that were taken
  std::optional<ProgramTimer> old_time_;
  std::optional<ProgramTimer> new_time_;
  CollectedResult collected_;
};

// A program as one window.
class WholeProgram {
 public:
  WholeProgram(const gcode::SourceText& source, const SmoothOptions& options,
               const Progress& progress, const LongRunLimits& long_runs, const PartSurvey& survey)
      : source_(source),
        options_(options),
        progress_(progress),
        part_{{source, {}, {}, {}, {}}, {}},
        setting_{source, options, {}, long_runs, false, {}, survey} {}

  SmoothResult run() {
    read();
    if (gcode::has_error(collected_.result.diagnostics) || !tell(kAfterReading)) return refused();
    PartRuns runs = find_runs(part_, options_, setting_.long_runs);
    if (!runs.works.empty() && !fits_target()) return refused();
    while (true) {
      WindowDone done = smooth_part(
          setting_, part_, std::move(runs), additions_,
          [this](double share) { return tell(kAfterReading + share * (1 - kAfterReading)); });
      if (done.outcome != WindowOutcome::kDone) return refused();
      if (!copy_where_parts_cross(done)) return finished(std::move(done));
      runs = find_runs(part_, options_, setting_.long_runs, setting_.facts);
    }
  }

 private:
  bool tell(double part) { return !progress_ || progress_(part); }

  SmoothResult refused() {
    collected_.result.understood = false;
    return std::move(collected_.result);
  }

  void read() {
    gcode::Diagnostics& found = collected_.result.diagnostics;
    const auto language = language_read(source_, options_, found);
    if (!language) return;
    setting_.read_options = read_options_of(options_);
    gcode::ReadPart read = read_whole(
        source_, {options_.source, reading_of(options_, *language), setting_.read_options}, found);
    part_.program = std::move(read.program);
    part_.meaning = std::move(read.meaning);
    collected_.result.blocks_in = part_.program.blocks.size();
    collected_.result.units = first_units(part_.meaning);
    setting_.was_smoothed =
        was_smoothed(part_.program) && !is_allowed(gcode::reason::kAlreadySmoothed, options_);
    tell_of_other_meanings(part_.program, *options_.target, found);
    tell_of_own_words();
  }

  // The program's own smoothing words and those of the profile would undo each other. A program
  // that was smoothed before has both, and nothing is added to it.
  void tell_of_own_words() {
    additions_.comment = provenance_comment(*options_.target, options_.tolerance_mm);
    additions_.words =
        filled_in(options_.words, options_.tolerance_mm, collected_.result.units, *options_.target);
    const std::uint32_t line = line_with_words_of(part_.program, additions_.words);
    if (line == 0 || setting_.was_smoothed) return;
    collected_.result.diagnostics.push_back(
        {gcode::Severity::kError, "profile-words-in-program", part_.program.blocks[line - 1].span,
         "words that the profile would add; expected them in the program or in the profile"});
  }

  // What is copied must say on the target what it said on the control that it was made for.
  bool fits_target() {
    if (!is_of_another_family(part_.program, *options_.target)) return true;
    const auto tell = options_.convert ? &tell_what_cannot_be_said : &tell_of_other_family;
    tell(part_.program, *options_.target, collected_.result.diagnostics);
    return !gcode::has_error(collected_.result.diagnostics);
  }

  // Whether parts of long runs cross each other where they did not: then more is to be copied.
  bool copy_where_parts_cross(WindowDone& done) {
    PartCrossings crossings(*done.near, options_.tolerance_mm);
    crossings.take(std::move(done.proof.near_edges));
    crossings.look_up_to(done.last_line);
    const std::vector<LineRange> found = crossings.found();
    if (found.empty()) return false;
    std::vector<LineRange>& copied = setting_.facts.copied;
    const std::size_t lines = lines_in(copied);
    copied = more_to_copy(copied, found, *done.near);
    return lines_in(copied) > lines;
  }

  SmoothResult finished(WindowDone done) {
    SmoothResult& result = collected_.result;
    ProvedText& proof = done.proof;
    result.text = proof.unchanged ? std::string(source_.text()) : std::move(proof.text);
    result.proved = proof.proved;
    result.program_before = time_of(part_.program, part_.meaning, options_);
    result.program_after = proof.unchanged ? result.program_before : time_of_text(result.text);
    collected_.take(std::move(done));
    return collected_.finish();
  }

  [[nodiscard]] TimeFigures time_of_text(const std::string& text) const {
    gcode::Diagnostics ignored;
    const gcode::Program program =
        gcode::parse({source_.name(), text}, reading_of(options_, part_.program.language), ignored);
    return time_of(program, gcode::interpret(program, setting_.read_options, ignored), options_);
  }

  const gcode::SourceText& source_;
  const SmoothOptions& options_;
  const Progress& progress_;
  ProgramPart part_;
  WindowSetting setting_;
  Additions additions_;
  CollectedResult collected_;
};

// A program for another control: said in the target's words, smoothed with what rounding to the
// target's digits has left of the tolerance, and proved against the source.
class TranslatedSmoothing {
 public:
  TranslatedSmoothing(const gcode::SourceText& source, const SmoothOptions& options,
                      const Progress& progress, const LongRunLimits& long_runs)
      : source_(source),
        options_(options),
        progress_(progress),
        long_runs_(long_runs),
        read_(read_whole(
            source,
            {options.source,
             reading_of(options,
                        language_to_translate(source, options).value_or(gcode::Language::kRs274)),
             {.units = options.units}},
            found_)) {}

  SmoothResult run() {
    if (gcode::has_error(found_) || !translate()) return finished({});
    SmoothResult result = smooth();
    if (!result.understood) return finished({});
    if (prove(result)) return finished(std::move(result));
    keep_all(result);
    if (prove(result)) return finished(std::move(result));
    found_.push_back(
        {gcode::Severity::kError, "cannot-convert", first_span(),
         fmt::format("the translation could not be proved against the program: {}", violation_)});
    return finished({});
  }

 private:
  [[nodiscard]] gcode::SourceSpan first_span() const {
    return read_.program.blocks.empty() ? gcode::SourceSpan{} : read_.program.blocks.front().span;
  }

  bool translate() {
    ProgramOperations operations = operations_of(read_.program, read_.meaning);
    const gcode::Control& target = *options_.target;
    const TranslationSource said{read_.program,
                                 read_.meaning,
                                 operations,
                                 is_allowed(gcode::reason::kWorkOffset, options_),
                                 is_allowed(gcode::reason::kToolLength, options_),
                                 is_allowed(gcode::reason::kBlankForm, options_)};
    const std::string name = program_name(source_.name());
    translation_ = target.language == gcode::Language::kKlartext
                       ? in_klartext(said, target, name)
                       : in_plain_words(said, target, name);
    std::vector<Obstacle> obstacles = std::move(operations.obstacles);
    std::ranges::move(translation_.obstacles, std::back_inserter(obstacles));
    if (!options_.words.empty()) {
      obstacles.push_back({first_span(),
                           "cannot be converted with a profile that adds words: convert it first, "
                           "then smooth it with the profile"});
    }
    std::ranges::stable_sort(obstacles, {}, [](const Obstacle& o) { return o.where.begin; });
    tell_obstacles(obstacles, read_.program, target, found_);
    return obstacles.empty();
  }

  SmoothResult smooth() {
    SmoothOptions options = options_;
    options.convert = false;
    options.units = gcode::Units::kUnknown;
    options.source = kind_of(options_.target->language);
    options.decimals = gcode::Decimals{};
    if (translation_.rounding_mm < options_.tolerance_mm) {
      options.tolerance_mm -= translation_.rounding_mm;
    } else {
      options.method = Method::kNone;
    }
    const gcode::SourceText text(source_.name(), translation_.text);
    SmoothResult result = smooth_program(text, options, progress_, long_runs_);
    refer_to_source(result, text);
    // The comment that the program was smoothed says the whole tolerance.
    const std::string said = provenance_comment(*options_.target, options.tolerance_mm);
    const std::size_t at = result.text.find(said);
    if (!said.empty() && at != std::string::npos) {
      result.text.replace(at, said.size(),
                          provenance_comment(*options_.target, options_.tolerance_mm));
    }
    return result;
  }

  // Of plain words: as the target reads them.
  static gcode::SourceKind kind_of(gcode::Language language) {
    const auto families = gcode::source_families();
    const auto family = std::ranges::find(families, language, &gcode::SourceFamily::language);
    const bool plain = language == gcode::Language::kRs274 || family == families.end();
    return plain ? gcode::SourceKind::kAuto : family->kind;
  }

  [[nodiscard]] std::uint32_t source_line(std::uint32_t line) const {
    const auto& lines = translation_.source_lines;
    if (line == 0 || lines.empty()) return 0;
    return lines[std::min<std::size_t>(line, lines.size()) - 1];
  }

  // Positions in the translation become those of the source.
  void refer_to_source(SmoothResult& result, const gcode::SourceText& text) {
    for (gcode::Diagnostic& each : result.diagnostics) {
      const auto before = text.text().substr(0, each.where.begin);
      const auto line = static_cast<std::uint32_t>(std::ranges::count(before, '\n')) + 1;
      const std::uint32_t mine = source_line(line);
      each.where = mine > 0 ? read_.program.blocks[mine - 1].span : first_span();
      found_.push_back(std::move(each));
    }
    for (RunReport& run : result.runs) {
      run.first_line = source_line(run.first_line);
      run.last_line = source_line(run.last_line);
    }
  }

  void keep_all(SmoothResult& result) const {
    result.text = translation_.text;
    for (RunReport& run : result.runs) {
      run.status = RunStatus::kKept;
      run.reason = gcode::reason::kNotProved;
      run.method = {};
      run.blocks_out = run.blocks_in;
      run.time_after_s = run.time_before_s;
      run.bytes_out = run.bytes_in;
      run.path_after = run.path_before;
      run.max_curvature_after = run.max_curvature_before;
      run.deviation_mm = 0;
    }
    result.runs_after_s = result.runs_before_s;
    result.path_after = result.path_before;
  }

  // The text with its block numbers, as it will be written.
  bool prove(SmoothResult& result) {
    const gcode::Language language = options_.target->language;
    std::string written =
        language == gcode::Language::kKlartext ? with_numbers(result.text, 0) : result.text;
    const gcode::SourceText text(source_.name(), written);
    gcode::Diagnostics found;
    const gcode::DwellForm dwells = options_.target->dwell_form;
    const gcode::Program program =
        gcode::parse(text, gcode::Reading{.language = language, .dwells = dwells}, found);
    const gcode::Interpretation meaning =
        gcode::interpret(program, {.curves = options_.target->curves}, found);
    const Verification verification =
        verify({&read_.program, &read_.meaning}, {&program, &meaning},
               {options_.tolerance_mm, options_.tolerance_kind, options_.side});
    if (!verification.proved() || gcode::has_error(found)) {
      if (!verification.violations.empty()) {
        const Violation& first = verification.violations.front();
        violation_ = fmt::format("{} at line {}: {}", first.id, first.old_line, first.message);
      }
      return false;
    }
    result.text = std::move(written);
    result.program_before = time_of(read_.program, read_.meaning, options_);
    result.program_after = time_of(program, meaning, options_);
    result.proved = true;
    result.blocks_out = program.blocks.size();
    result.deviation_mm = verification.deviation_mm;
    result.deviation_line = verification.deviation_line;
    result.corner_mm = verification.corner_mm;
    return true;
  }

  SmoothResult finished(SmoothResult result) {
    result.diagnostics = std::move(found_);
    result.blocks_in = read_.program.blocks.size();
    result.units = first_units(read_.meaning);
    return result;
  }

  const gcode::SourceText& source_;
  const SmoothOptions& options_;
  const Progress& progress_;
  const LongRunLimits& long_runs_;
  gcode::Diagnostics found_;
  gcode::ReadPart read_;
  Translation translation_;
  std::string violation_;
};

}  // namespace

std::optional<SmoothResult> smooth_in_windows(const gcode::SourceText& source,
                                              const SmoothOptions& options, const TextSink& sink,
                                              const Progress& progress, const WindowLimits& limits,
                                              std::vector<LineRange>* copied,
                                              const PartSurvey& survey) {
  return Windows(source, options, sink, progress, copied, survey).run(limits);
}

SmoothResult smooth_program(const gcode::SourceText& source, const SmoothOptions& options,
                            const Progress& progress, const LongRunLimits& long_runs,
                            const PartSurvey& survey) {
  if (is_to_be_translated(source, options)) {
    return TranslatedSmoothing(source, options, progress, long_runs).run();
  }
  return WholeProgram(source, options, progress, long_runs, survey).run();
}

SmoothResult smooth_program(const gcode::SourceText& source, const SmoothOptions& options,
                            const ProgramSink& sink, const Progress& progress,
                            const StreamLimits& limits, const PartSurvey& survey) {
  std::vector<LineRange> copied;
  bool in_windows = source.text().size() >= limits.bytes_for_windows;
  while (in_windows) {
    const std::size_t lines = lines_in(copied);
    auto result =
        smooth_in_windows(source, options, sink.take, progress, limits.windows, &copied, survey);
    if (result) return std::move(*result);
    if (!sink.restart()) return {};
    in_windows = lines_in(copied) > lines;  // each round copies more, so the loop ends
  }
  SmoothResult result = smooth_program(source, options, progress, limits.windows.long_runs, survey);
  const std::string text = std::move(result.text);
  result.text.clear();
  result.bytes_handed_on = text.size();
  if (result.understood && !sink.take(text)) result.understood = false;
  return result;
}

}  // namespace batten::postproc
