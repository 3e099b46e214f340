#include "postproc/smooth/part_runs.h"

#include <algorithm>
#include <atomic>
#include <iterator>
#include <mutex>
#include <numeric>
#include <string>
#include <utility>
#include <variant>

#include "gcode/state/reason.h"
#include "gcode/text/line_cursor.h"
#include "gcode/writer/block_numbers.h"
#include "postproc/runs/band_notes.h"
#include "postproc/runs/run_cutting.h"
#include "postproc/runs/run_grouping.h"
#include "postproc/runs/run_path.h"
#include "postproc/smooth/boundary_timing.h"
#include "postproc/smooth/growth.h"
#include "postproc/smooth/like_runs.h"
#include "postproc/smooth/repeated_runs.h"
#include "postproc/smooth/run_smoother.h"
#include "postproc/smooth/selection/candidate_bounds.h"
#include "postproc/smooth/selection/selection.h"
#include "postproc/system/parallel_for.h"

namespace batten::postproc {

namespace {

// Of the blocks that there were: more lines than these for a long run are little.
constexpr double kMostBlocks = 0.7;

// Pieces of a long run that tell whether it is better cut: so few that little is lost where it is
// not. Where they take more blocks than this part of those that there were, cuts cost next to none.
struct SampledPieces {
  std::size_t pieces = 3;
  std::size_t of_pieces = 20;  // at least
  double blocks = 0.35;
};
constexpr SampledPieces kSampled;

RunContext context_of(const gcode::Program& program, const gcode::Interpretation& meaning,
                      const Section& section) {
  const auto state_after = [&](std::uint32_t block) -> const gcode::ModalState& {
    return meaning.states[meaning.blocks[block].state_after];
  };
  const gcode::Block& first = program.blocks[section.first_block];
  return {program,
          section.first_block == 0 ? meaning.states[0] : state_after(section.first_block - 1),
          state_after(section.last_block),
          gcode::written_line_end(program.source.text({first.span.end, first.end})),
          section.last_block - section.first_block + 1,
          program.blocks[section.last_block].end - first.span.begin,
          number_room(program, section.first_block, section.last_block)};
}

// Long runs with arcs, which long_run_cuts leaves: cut as wholes, and timed from rest to rest,
// which is a stop too much for many points.
std::vector<Section> with_long_runs_cut(std::vector<Section> sections,
                                        const gcode::Interpretation& meaning,
                                        const LongRunLimits& limits) {
  std::vector<Section> cut;
  cut.reserve(sections.size());
  for (Section& section : sections) {
    const Run* run = std::get_if<Run>(&section.content);
    if (run == nullptr || run->points.size() <= limits.whole_at_most) {
      cut.push_back(std::move(section));
      continue;
    }
    for (RunPiece& piece :
         cut_run(section, meaning, {.shortest = limits.shortest, .longest = limits.longest})) {
      cut.push_back(std::move(piece.section));
    }
  }
  return cut;
}

// Blocks at which sections that are copied begin or end, but where runs are cut anyway.
std::vector<std::uint32_t> cuts_about(std::span<const LineRange> copied,
                                      const gcode::Program& program,
                                      const std::vector<std::uint32_t>& cuts) {
  std::vector<std::uint32_t> blocks;
  if (program.blocks.empty()) return blocks;
  const std::uint32_t first = program.blocks.front().line;
  const std::uint32_t last = program.blocks.back().line;
  for (const LineRange& range : copied) {
    for (const std::uint32_t line : {range.first, range.last + 1}) {
      if (line <= first || line > last) continue;
      if (!std::ranges::binary_search(cuts, line - first)) blocks.push_back(line - first);
    }
  }
  blocks.erase(std::unique(blocks.begin(), blocks.end()), blocks.end());
  return blocks;
}

class PartSmoother {
 public:
  PartSmoother(const ProgramPart& part, const SmoothOptions& options,
               const ProgressCallback& progress, PartRuns& runs, RunMemos* memos)
      : part_(part), options_(options), progress_(progress), runs_(runs), memos_(memos) {
    for (const RunState& work : runs_.works) points_ += run_of(work).points.size();
  }

  // False: the work was stopped.
  bool run() {
    if (options_.method != Method::kNone && memos_ == nullptr) {
      note_bands();  // they warn of what new paths may do
    }
    const std::vector<bool> are_better_cut = better_cut();
    cut_runs([&](std::size_t i) { return are_better_cut[i]; });
    std::vector<std::size_t> whole;
    for (std::size_t i = 0; i < runs_.works.size(); ++i) {
      const RunState& work = runs_.works[i];
      if (!work.cut_run && work.selection.reason.empty()) whole.push_back(i);
    }
    if (!smooth_works(whole) || !cut_what_disappoints(0)) return false;
    revert_growth_of(part_, options_, runs_);
    return true;
  }

  // Replaces runs that would be kept as a whole by pieces: their parts differ. These are smoothed,
  // as are those of runs that were cut before, from this one on. False: the work was stopped.
  bool cut_what_disappoints(std::size_t cut_before) {
    cut_runs([this](std::size_t i) { return disappoints(runs_.works[i]); });
    std::vector<std::size_t> pieces;
    for (std::size_t i = 0; i < runs_.works.size(); ++i) {
      if (runs_.works[i].cut_run && *runs_.works[i].cut_run >= cut_before) pieces.push_back(i);
    }
    if (!smooth_works(pieces)) return false;
    for (std::size_t i = cut_before; i < runs_.cut_runs.size(); ++i) {
      revert_costly_pieces(runs_.cut_runs[i], runs_.works, options_);
    }
    return true;
  }

 private:
  [[nodiscard]] const Run& run_of(const RunState& work) const {
    return std::get<Run>(runs_.sections[work.section].content);
  }

  void note_bands() {
    std::vector<gcode::Diagnostics> notes(runs_.works.size());
    parallel_for(options_.threads, runs_.works.size(), [&](std::size_t i) {
      notes[i] = band_notes(part_.program, part_.meaning, runs_.sections[runs_.works[i].section],
                            tolerance_of(run_of(runs_.works[i]), options_.tolerance_mm));
    });
    runs_.notes = std::move(notes);
  }

  // Those first that others repeat, or none.
  bool smooth_works(const std::vector<std::size_t>& works) {
    std::vector<std::size_t> firsts(works.size());
    std::iota(firsts.begin(), firsts.end(), std::size_t{0});
    if (options_.share_work && memos_ == nullptr)
      firsts = firsts_of_shapes(in_context(works), options_);
    std::vector<bool> is_repeated(works.size());
    std::vector<std::size_t> shapes;
    std::vector<std::size_t> repeats;
    for (std::size_t i = 0; i < works.size(); ++i) {
      (firsts[i] == i ? shapes : repeats).push_back(i);
      if (firsts[i] != i) is_repeated[firsts[i]] = true;
    }
    std::atomic<bool> stopped = false;
    const auto smooth = [&](std::size_t i, const FormRecord* record) {
      if (stopped) return;
      RunState& work = runs_.works[works[i]];
      RunMemo* memo = memos_ != nullptr ? &memos_->of(runs_.sections[work.section]) : nullptr;
      const auto scope = is_repeated[i] ? CandidateScope::kToRepeat : CandidateScope::kToChoose;
      work.smoothed = smooth_run(run_of(work), work.context, options_, scope, memo, record);
      if (!is_repeated[i]) choose_for(work);
      if (!has_smoothed(work)) stopped = true;
    };
    std::vector<LikeRuns> kinds = kinds_of(works, shapes);
    std::vector<std::size_t> in_full;
    std::vector<std::pair<std::size_t, const LikeRuns*>> others;
    for (const LikeRuns& kind : kinds) {
      in_full.insert(in_full.end(), kind.in_full.begin(), kind.in_full.end());
      for (const std::size_t i : kind.others) others.emplace_back(i, &kind);
    }
    parallel_for(options_.threads, in_full.size(),
                 [&](std::size_t i) { smooth(in_full[i], nullptr); });
    const auto state_of = [&](std::size_t i) -> const RunState& { return runs_.works[works[i]]; };
    for (LikeRuns& kind : kinds) kind.learn(state_of, options_);
    parallel_for(options_.threads, others.size(), [&](std::size_t i) {
      const auto& [other, kind] = others[i];
      smooth(other, &kind->record);
      RunState& work = runs_.works[works[other]];
      work.outlook.others =
          kind->outlook_of_block.others * work.smoothed.facts.scale.original.blocks;
    });
    parallel_for(options_.threads, repeats.size(), [&](std::size_t i) {
      if (stopped) return;
      RunState& work = runs_.works[works[repeats[i]]];
      const RunState& first = runs_.works[works[firsts[repeats[i]]]];
      const auto offset = offset_of_repeat(in_context(first), in_context(work), options_);
      auto smoothed =
          smooth_repeat(run_of(work), work.context, options_, first.smoothed, offset.value());
      work.smoothed =
          smoothed ? std::move(*smoothed)
                   : smooth_run(run_of(work), work.context, options_, CandidateScope::kToChoose);
      choose_for(work);
      if (!has_smoothed(work)) stopped = true;
    });
    for (const std::size_t i : shapes) {
      if (is_repeated[i]) choose_for(runs_.works[works[i]]);
    }
    return !stopped;
  }

  // Of `works` those that `shapes` lists: all in full where a method is asked for.
  [[nodiscard]] std::vector<LikeRuns> kinds_of(const std::vector<std::size_t>& works,
                                               const std::vector<std::size_t>& shapes) const {
    const bool named = options_.method != Method::kBest;
    if (named || !options_.share_work) return {{.in_full = shapes}};
    return like_runs(shapes, [&](std::size_t i) {
      return is_run_of_corners(run_of(runs_.works[works[i]]), options_.tolerance_mm);
    });
  }

  void choose_for(RunState& work) {
    work.selection = choose(work.smoothed, options_);
    if (memos_ == nullptr && options_.method != Method::kNone) {
      work.outlook = outlook_of(work.smoothed, options_);
      work.outlook.at_feeds_s = time_at_feeds(run_of(work), *options_.machine);
    }
    work.drop_what_is_not_written();
  }

  // False: the work is to stop.
  bool has_smoothed(const RunState& work) {
    const std::scoped_lock lock(reporting_);
    smoothed_points_ += run_of(work).points.size();
    return progress_(
        std::min(1.0, static_cast<double>(smoothed_points_) / static_cast<double>(2 * points_)));
  }

  [[nodiscard]] RunInContext in_context(const RunState& work) const {
    return {&run_of(work), &work.context};
  }

  [[nodiscard]] std::vector<RunInContext> in_context(const std::vector<std::size_t>& works) const {
    std::vector<RunInContext> runs;
    runs.reserve(works.size());
    for (const std::size_t work : works) runs.push_back(in_context(runs_.works[work]));
    return runs;
  }

  // Whether parts of it may do better: no form but its own vertices will do, and these are not half
  // as far off; or of a long run lines alone, which are most of the blocks that there were.
  [[nodiscard]] bool has_little(const RunState& work) const {
    const Candidate* chosen = work.chosen();
    if (chosen == nullptr || chosen->form != Form::kLines) return false;
    const Figures& before = work.smoothed.facts.scale.original;
    if (chosen->has_vertices) {
      return chosen->figures.distance > kCost.half_as_far * before.distance;
    }
    return options_.output == Form::kAuto && is_long(run_of(work)) &&
           chosen->figures.blocks > kMostBlocks * before.blocks;
  }

  // Whether something speaks against forms of the run as a whole that may be true of a part of it
  // only.
  [[nodiscard]] bool disappoints(const RunState& work) const {
    const std::string_view kept = work.selection.reason;
    return has_little(work) || is_rejected_by_proof(work) || kept == gcode::reason::kNoGain ||
           kept == gcode::reason::kSlower || kept == gcode::reason::kLarger ||
           kept == gcode::reason::kFarther || kept == gcode::reason::kNoFit;
  }

  // For each work whether it is a long run of which some pieces take many blocks, too: then it is
  // cut at once, since as a whole it would hardly take fewer.
  [[nodiscard]] std::vector<bool> better_cut() const {
    std::vector<bool> is_better(runs_.works.size());
    if (options_.output != Form::kAuto || options_.method != Method::kBest || memos_ != nullptr) {
      return is_better;
    }
    std::vector<std::pair<std::size_t, RunPiece>> samples;
    for (std::size_t i = 0; i < runs_.works.size(); ++i) {
      const RunState& work = runs_.works[i];
      if (!work.selection.reason.empty() || !is_long(run_of(work))) continue;
      std::vector<RunPiece> pieces = cut_run(runs_.sections[work.section], part_.meaning, {});
      if (pieces.size() < kSampled.of_pieces) continue;
      for (std::size_t k = 0; k < kSampled.pieces; ++k) {
        const std::size_t place = (2 * k + 1) * pieces.size() / (2 * kSampled.pieces);
        samples.emplace_back(i, std::move(pieces[place]));
      }
    }
    std::vector<double> more(samples.size());  // blocks, than a run has that is no better cut
    parallel_for(options_.threads, samples.size(), [&](std::size_t i) {
      const auto& [work, piece] = samples[i];
      RunState state = state_of(piece, run_of(runs_.works[work]));
      const Run& run = std::get<Run>(piece.section.content);
      state.smoothed = smooth_run(run, state.context, options_);
      state.selection = choose(state.smoothed, options_);
      const double before = state.smoothed.facts.scale.original.blocks;
      const Candidate* chosen = state.chosen();
      more[i] = (chosen != nullptr ? chosen->figures.blocks : before) - kSampled.blocks * before;
    });
    std::vector<double> of_work(runs_.works.size());
    for (std::size_t i = 0; i < samples.size(); ++i) of_work[samples[i].first] += more[i];
    for (std::size_t i = 0; i < of_work.size(); ++i) is_better[i] = of_work[i] > 0;
    return is_better;
  }

  void cut_runs(const std::function<bool(std::size_t)>& is_cut) {
    std::vector<Section> sections;
    std::vector<RunState> works;
    std::size_t next = 0;
    for (std::size_t i = 0; i < runs_.sections.size(); ++i) {
      RunState* work = nullptr;
      if (next < runs_.works.size() && runs_.works[next].section == i) work = &runs_.works[next++];
      if (work != nullptr && !work->cut_run && is_cut(next - 1) &&
          add_pieces(*work, sections, works)) {
        continue;
      }
      if (work != nullptr) {
        if (work->cut_run && work->first == 0) {
          runs_.cut_runs[*work->cut_run].first_work = works.size();
        }
        work->section = sections.size();
        works.push_back(std::move(*work));
      }
      sections.push_back(std::move(runs_.sections[i]));
    }
    runs_.sections = std::move(sections);
    runs_.works = std::move(works);
  }

  // Of a piece of `whole`.
  [[nodiscard]] RunState state_of(const RunPiece& piece, const Run& whole) const {
    RunState state{0, context_of(part_.program, part_.meaning, piece.section)};
    state.context.moves_of_program = runs_.moves;
    state.first = piece.first;
    state.last = piece.last;
    state.surround(whole);
    return state;
  }

  bool add_pieces(RunState& work, std::vector<Section>& sections, std::vector<RunState>& works) {
    std::vector<RunPiece> pieces = cut_run(runs_.sections[work.section], part_.meaning, {});
    if (pieces.size() < 2) return false;
    CutRun cut;
    cut.path = work.context.after.path;
    if (work.smoothed.facts.length > 0) {
      cut.facts = work.smoothed.facts;
      const Selection forms = choose(work.smoothed, options_, Among::kFormsAlone);
      cut.reason = work.reject_reason.empty() ? forms.reason : work.reject_reason;
      cut.outlook = std::move(work.outlook);
    }
    cut.first_work = works.size();
    cut.pieces = pieces.size();
    cut.run = std::move(std::get<Run>(runs_.sections[work.section].content));
    for (RunPiece& piece : pieces) {
      RunState part = state_of(piece, cut.run);
      part.section = sections.size();
      part.cut_run = runs_.cut_runs.size();
      works.push_back(std::move(part));
      sections.push_back(std::move(piece.section));
    }
    runs_.cut_runs.push_back(std::move(cut));
    return true;
  }

  const ProgramPart& part_;
  const SmoothOptions& options_;
  const ProgressCallback& progress_;
  PartRuns& runs_;
  RunMemos* memos_;
  std::mutex reporting_;
  std::size_t points_ = 0;           // of all runs
  std::size_t smoothed_points_ = 0;  // pieces count again
};

}  // namespace

bool is_allowed(std::string_view reason, const SmoothOptions& options) {
  return std::ranges::find(options.allowed, reason) != options.allowed.end();
}

GroupingOptions grouping_of(const SmoothOptions& options) {
  GroupingOptions grouping;
  if (is_of_corners(options.method)) grouping.min_motions = 2;  // a corner alone
  grouping.tolerance_mm = options.tolerance_mm;
  for (const std::string& id : options.allowed) grouping.allowed.push_back(id);
  return grouping;
}

LongRunLimits asked_of(LongRunLimits limits, const SmoothOptions& options) {
  limits.rewritten = options.method != Method::kNone;
  return limits;
}

PartRuns find_runs(const ProgramPart& part, const SmoothOptions& options,
                   const LongRunLimits& limits, const LongRunFacts& facts) {
  const GroupingOptions grouping = grouping_of(options);
  PartRuns runs;
  runs.near = facts.near;
  if (!part.window) {
    LongRuns found =
        find_long_runs(part.program, part.meaning, asked_of(limits, options), grouping);
    runs.cuts = std::move(found.cuts);
    runs.near = std::make_shared<const std::vector<SelfProximity>>(std::move(found.near));
  }
  runs.copied_cuts = cuts_about(facts.copied, part.program, runs.cuts);
  std::vector<std::uint32_t> all_cuts;
  std::ranges::merge(runs.cuts, runs.copied_cuts, std::back_inserter(all_cuts));
  runs.sections = group_runs(part.program, part.meaning, grouping, all_cuts);
  runs.sections = with_long_runs_cut(std::move(runs.sections), part.meaning, limits);
  for (std::size_t i = 0; i < runs.sections.size(); ++i) {
    if (!std::holds_alternative<Run>(runs.sections[i].content)) continue;
    runs.works.push_back({i, context_of(part.program, part.meaning, runs.sections[i])});
    const std::uint32_t line = part.program.blocks[runs.sections[i].first_block].line;
    if (holds(facts.copied, line)) {
      runs.works.back().selection.reason = gcode::reason::kCrossesItself;
    }
  }
  for (const RunState& work : runs.works) {
    runs.moves += motion_count(std::get<Run>(runs.sections[work.section].content));
  }
  for (RunState& work : runs.works) work.context.moves_of_program = runs.moves;
  time_at_boundaries(part, options, {runs.cuts, runs.copied_cuts}, runs.sections, runs.works);
  return runs;
}

void keep_as_smoothed(PartRuns& runs) {
  for (RunState& work : runs.works) work.selection.reason = gcode::reason::kAlreadySmoothed;
}

RunMemo& RunMemos::of(const Section& section) {
  const std::scoped_lock lock(looking_);
  return memos_[{section.first_block, section.last_block}];
}

void revert_growth_of(const ProgramPart& part, const SmoothOptions& options, PartRuns& runs) {
  if (part.window && !runs.beside) return;
  revert_growth(runs.works, runs.cut_runs, options, runs.beside);
}

bool smooth_runs(const ProgramPart& part, const SmoothOptions& options,
                 const ProgressCallback& progress, PartRuns& runs, RunMemos* memos) {
  return PartSmoother(part, options, progress, runs, memos).run();
}

bool cut_rejected_runs(const ProgramPart& part, const SmoothOptions& options,
                       const ProgressCallback& progress, PartRuns& runs) {
  return PartSmoother(part, options, progress, runs, nullptr)
      .cut_what_disappoints(runs.cut_runs.size());
}

}  // namespace batten::postproc
