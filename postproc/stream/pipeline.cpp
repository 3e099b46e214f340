#include "postproc/stream/pipeline.h"

#include <oneapi/tbb/parallel_pipeline.h>
#include <oneapi/tbb/task_arena.h>

#include <algorithm>
#include <atomic>
#include <cstddef>
#include <cstdint>
#include <iterator>
#include <limits>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "gcode/interpreter/interpreter.h"
#include "gcode/reading/parser.h"
#include "gcode/reading/source_kind.h"
#include "gcode/state/reason.h"
#include "postproc/convert/conversion.h"
#include "postproc/profile/target_profile.h"
#include "postproc/runs/section.h"
#include "postproc/smooth/part_runs.h"
#include "postproc/stream/added_lines.h"
#include "postproc/stream/part_crossings.h"
#include "postproc/stream/provenance.h"
#include "postproc/stream/translated_smoothing.h"
#include "postproc/stream/window.h"
#include "postproc/system/parallel_for.h"

namespace batten::postproc {

namespace {

// Parts of the progress: the first pass only reads.
constexpr double kAfterPrescan = 0.15;

// How far the work is, told by many threads.
class SharedProgress {
 public:
  SharedProgress(const Progress& progress, std::size_t bytes)
      : progress_(progress), bytes_(static_cast<double>(bytes)) {}

  bool report_prescan(double part) { return !progress_ || progress_(part * kAfterPrescan); }

  void begin(const std::vector<WindowPlace>& windows) {
    windows_ = &windows;
    shares_.assign(windows.size(), 0);
  }

  // Of a window; what is done once more counts once.
  bool tell(std::size_t window, double share) {
    const std::scoped_lock lock(telling_);
    const WindowPlace& place = (*windows_)[window];
    const double gained = std::max(0.0, share - shares_[window]);
    shares_[window] += gained;
    done_bytes_ += gained * (place.end - place.begin);
    const double part = std::min(1.0, done_bytes_ / bytes_);
    return !progress_ || progress_(kAfterPrescan + part * (1 - kAfterPrescan));
  }

 private:
  const Progress& progress_;
  double bytes_;
  const std::vector<WindowPlace>* windows_ = nullptr;
  std::vector<double> shares_;
  double done_bytes_ = 0;
  std::mutex telling_;
};

// Windows that are made before the one before them is proved must guess how its new text leaves the
// control: as the old one does, but for words that only the new text has said so far.
class StartGuess {
 public:
  void learn(const TextBefore& old_behind, const TextBefore& known) {
    const std::scoped_lock lock(learning_);
    words_said_ = known.control.state.set_by_word & ~old_behind.control.state.set_by_word;
    for (std::size_t i = 0; i < events_.size(); ++i) {
      const bool more = old_behind.events.set_by_word[i] == kNone;
      events_[i] = more ? known.events.set_by_word[i] : kNone;
    }
  }

  // Nothing that stands before the first window says that the program was smoothed; before the
  // others most often something does.
  [[nodiscard]] NewTextBefore guess(const TextBefore& old_before, bool first) {
    const std::scoped_lock lock(learning_);
    NewTextBefore before{old_before, !first};
    before.known.control.state.set_by_word |= words_said_;
    for (std::size_t i = 0; i < events_.size(); ++i) {
      auto& said = before.known.events.set_by_word[i];
      if (said == kNone) said = events_[i];
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
          const Progress& progress, std::vector<LineRange>* copied)
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
  }

  std::optional<SmoothResult> run(const WindowLimits& limits) {
    if (!options_.words.empty()) return std::nullopt;
    if (is_to_be_translated(source_, options_)) return std::nullopt;
    gcode::Diagnostics of_language;
    const auto language = language_read(source_, options_, of_language);
    if (language != gcode::Language::kRs274) return std::nullopt;
    const ProgressCallback report_prescan = [this](double part) {
      return progress_.report_prescan(part);
    };
    PrescanReport facts = prescan(source_, options_, limits, report_prescan);
    if (facts.outcome == PrescanOutcome::kWhole) return std::nullopt;
    collected_.result.diagnostics = std::move(facts.found);
    collected_.result.blocks_in = facts.blocks;
    collected_.result.units = facts.units;
    if (facts.outcome == PrescanOutcome::kStopped) return std::move(collected_.result);
    setting_.was_smoothed =
        facts.was_smoothed && !is_allowed(gcode::reason::kAlreadySmoothed, options_);
    setting_.long_runs = limits.long_runs;
    windows_ = std::move(facts.windows);
    known_.known.control.lathe.settle();
    near_ = std::make_shared<const std::vector<SelfProximity>>(std::move(facts.near));
    setting_.facts.near = near_;
    if (copied_ != nullptr) setting_.facts.copied = *copied_;
    crossings_.emplace(*near_, options_.tolerance_mm);
    progress_.begin(windows_);
    const int threads = threads_at_once(options_.threads);
    oneapi::tbb::task_arena(threads).execute([&] { go_through(threads); });
    if (outcome_ == WindowOutcome::kNeedsWhole) return std::nullopt;
    if (outcome_ == WindowOutcome::kStopped) return std::move(collected_.result);
    if (parts_cross()) return std::nullopt;
    collected_.finish();
    collected_.result.proved = true;
    return std::move(collected_.result);
  }

 private:
  struct Numbered {
    std::size_t window = 0;
    WindowDone done;
  };

  // Texts that wait for the ones before them take little room beside windows that are worked on.
  void go_through(int threads) {
    using oneapi::tbb::filter_mode;
    using oneapi::tbb::make_filter;
    const std::size_t at_once = threads > 1 ? 2 * static_cast<std::size_t>(threads) : 1;
    std::size_t next = 0;
    const auto give = [&](oneapi::tbb::flow_control& flow) -> std::size_t {
      if (next >= windows_.size() || outcome_ != WindowOutcome::kDone) flow.stop();
      return next++;
    };
    const auto work = [&](std::size_t window) {
      const Guess guess = [&](const TextBefore& old) { return guess_.guess(old, window == 0); };
      return std::make_shared<Numbered>(Numbered{window, smooth(window, guess)});
    };
    const auto append = [&](const std::shared_ptr<Numbered>& made) {
      if (outcome_ == WindowOutcome::kDone) outcome_ = take(made->window, std::move(made->done));
    };
    oneapi::tbb::parallel_pipeline(
        at_once,
        make_filter<void, std::size_t>(filter_mode::serial_in_order, give) &
            make_filter<std::size_t, std::shared_ptr<Numbered>>(filter_mode::parallel, work) &
            make_filter<std::shared_ptr<Numbered>, void>(filter_mode::serial_in_order, append));
  }

  WindowDone smooth(std::size_t window, const Guess& before) {
    const ProgressCallback tell = [this, window](double share) {
      return outcome_ == WindowOutcome::kDone && progress_.tell(window, share);
    };
    return smooth_window(setting_, windows_[window], before, tell);
  }

  // One after the other, in order. What was made for another begin than the window has is made
  // anew: nothing that was guessed is believed.
  WindowOutcome take(std::size_t window, WindowDone made) {
    if (made.outcome == WindowOutcome::kStopped) return made.outcome;
    if (!was_made_for_its_begin(made)) {
      made = smooth(window, [this](const TextBefore&) { return known_; });
    }
    if (made.outcome != WindowOutcome::kDone) return made.outcome;
    const WindowPlace& place = windows_[window];
    const std::string_view bytes =
        made.unchanged ? source_.text({place.begin, place.end}) : std::string_view(made.text);
    collected_.result.bytes_handed_on += bytes.size();
    if (!sink_(bytes)) return WindowOutcome::kStopped;
    if (made.unchanged)
      source_.release_pages({place.begin, place.end});  // they were read once more
    const bool says_smoothed = known_.says_smoothed || !made.unchanged;
    known_ = std::move(made.behind);
    known_.says_smoothed = says_smoothed;
    guess_.learn(made.old_behind, known_.known);
    crossings_->take(std::move(made.near_edges));
    crossings_->look_up_to(made.last_line);
    collected_.take(std::move(made));
    return WindowOutcome::kDone;
  }

  // Where nothing is rewritten nothing is said of it.
  [[nodiscard]] bool was_made_for_its_begin(const WindowDone& made) const {
    NewTextBefore begin = known_;
    if (made.unchanged && made.outcome == WindowOutcome::kDone) {
      begin.says_smoothed = made.before.says_smoothed;
    }
    return same_before(made.before, begin);
  }

  // Whether parts of long runs cross each other where they did not.
  bool parts_cross() {
    const std::vector<LineRange> found = crossings_->found();
    if (found.empty()) return false;
    if (copied_ != nullptr) *copied_ = more_to_copy(*copied_, found, *near_);
    return true;
  }

  const gcode::SourceText& source_;
  const SmoothOptions& options_;
  SmoothOptions for_windows_;
  const TextSink& sink_;
  SharedProgress progress_;
  std::vector<LineRange>* copied_;
  WindowSetting setting_;
  std::shared_ptr<const std::vector<SelfProximity>> near_;
  std::optional<PartCrossings> crossings_;
  std::vector<WindowPlace> windows_;
  std::atomic<WindowOutcome> outcome_ = WindowOutcome::kDone;
  StartGuess guess_;
  NewTextBefore known_;  // behind the windows that were taken
  CollectedResult collected_;
};

}  // namespace

std::optional<SmoothResult> smooth_in_windows(const gcode::SourceText& source,
                                              const SmoothOptions& options, const TextSink& sink,
                                              const Progress& progress, const WindowLimits& limits,
                                              std::vector<LineRange>* copied) {
  return Windows(source, options, sink, progress, copied).run(limits);
}

namespace {

// Part of the progress: reading is quick.
constexpr double kAfterReading = 0.1;

constexpr std::uint32_t kLastLine = std::numeric_limits<std::uint32_t>::max();

// A program as one window.
class WholeProgram {
 public:
  WholeProgram(const gcode::SourceText& source, const SmoothOptions& options,
               const Progress& progress, const LongRunLimits& long_runs)
      : source_(source),
        options_(options),
        progress_(progress),
        part_{{source, {}, {}, {}, {}}, {}},
        setting_{source, options, {}, long_runs, false, {}} {}

  SmoothResult run() {
    read();
    if (gcode::has_error(collected_.result.diagnostics) || !tell(kAfterReading)) return refused();
    PartRuns runs = find_runs(part_, options_, setting_.long_runs);
    if (!runs.works.empty() && !fits_target()) return refused();
    const ProgressCallback tell_share = [this](double share) {
      return tell(kAfterReading + share * (1 - kAfterReading));
    };
    while (true) {
      WindowDone done = smooth_part(setting_, part_, std::move(runs), additions_, tell_share);
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
    const auto language = language_read(source_, options_, collected_.result.diagnostics);
    if (!language) return;
    part_.program =
        gcode::parse(source_, reading_of(options_, *language), collected_.result.diagnostics);
    gcode::tell_of_contradictions(part_.program, options_.source, collected_.result.diagnostics);
    setting_.read_options = read_options_of(options_);
    part_.meaning =
        gcode::interpret(part_.program, setting_.read_options, collected_.result.diagnostics);
    collected_.result.blocks_in = part_.program.blocks.size();
    for (const gcode::ModalState& state : part_.meaning.states) {
      if (collected_.result.units == gcode::Units::kUnknown) collected_.result.units = state.units;
    }
    setting_.was_smoothed =
        was_smoothed(part_.program) && !is_allowed(gcode::reason::kAlreadySmoothed, options_);
    tell_of_other_meanings(part_.program, *options_.target, collected_.result.diagnostics);
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

  // What is copied must say on the target what it said where it came from.
  bool fits_target() {
    if (!is_of_another_family(part_.program, *options_.target)) return true;
    const auto tell = options_.convert ? &tell_what_cannot_be_said : &tell_of_other_family;
    tell(part_.program, *options_.target, collected_.result.diagnostics);
    return !gcode::has_error(collected_.result.diagnostics);
  }

  // Whether parts of long runs cross each other where they did not: then more is to be copied.
  bool copy_where_parts_cross(WindowDone& done) {
    PartCrossings crossings(*done.near, options_.tolerance_mm);
    crossings.take(std::move(done.near_edges));
    crossings.look_up_to(kLastLine);
    const std::vector<LineRange> found = crossings.found();
    if (found.empty()) return false;
    std::vector<LineRange>& copied = setting_.facts.copied;
    const std::size_t lines = lines_in(copied);
    copied = more_to_copy(copied, found, *done.near);
    return lines_in(copied) > lines;
  }

  SmoothResult finished(WindowDone done) {
    SmoothResult& result = collected_.result;
    result.text = done.unchanged ? std::string(source_.text()) : std::move(done.text);
    result.proved = done.proved;
    collected_.take(std::move(done));
    collected_.finish();
    return std::move(result);
  }

  const gcode::SourceText& source_;
  const SmoothOptions& options_;
  const Progress& progress_;
  ProgramPart part_;
  WindowSetting setting_;
  Additions additions_;
  CollectedResult collected_;
};

}  // namespace

SmoothResult smooth_program(const gcode::SourceText& source, const SmoothOptions& options,
                            const Progress& progress, const LongRunLimits& long_runs) {
  if (!is_to_be_translated(source, options)) {
    return WholeProgram(source, options, progress, long_runs).run();
  }
  return smooth_translated(source, options,
                           [&](const gcode::SourceText& text, const SmoothOptions& of_target) {
                             return smooth_program(text, of_target, progress, long_runs);
                           });
}

SmoothResult smooth_program(const gcode::SourceText& source, const SmoothOptions& options,
                            const ProgramSink& sink, const Progress& progress,
                            const StreamLimits& limits) {
  std::vector<LineRange> copied;
  bool in_windows = source.text().size() >= limits.bytes_for_windows;
  while (in_windows) {
    const std::size_t lines = lines_in(copied);
    auto result = smooth_in_windows(source, options, sink.take, progress, limits.windows, &copied);
    if (result) return std::move(*result);
    if (!sink.restart()) return {};
    in_windows = lines_in(copied) > lines;  // each round copies more, so the loop ends
  }
  SmoothResult result = smooth_program(source, options, progress, limits.windows.long_runs);
  const std::string text = std::move(result.text);
  result.text.clear();
  result.bytes_handed_on = text.size();
  if (result.understood && !sink.take(text)) result.understood = false;
  return result;
}

}  // namespace batten::postproc
