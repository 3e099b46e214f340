#include "postproc/stream/explore.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <map>
#include <mutex>
#include <span>
#include <utility>
#include <vector>

#include "postproc/smooth/part_runs.h"
#include "postproc/smooth/selection/cost.h"
#include "postproc/stream/pipeline.h"
#include "postproc/stream/run_sample.h"

namespace batten::postproc {

namespace {

// Of the cost, what a larger tolerance has to win: as half a percent of the time does.
constexpr double kWorthMore = 0.005;
// Settings that are proved where the others are estimated: the best of them is recommended.
constexpr std::size_t kProved = 2;

void add_to(ExploredFigures& sum, const ExploredFigures& part) {
  sum.time_s += part.time_s;
  sum.blocks += part.blocks;
  sum.path += part.path;
  sum.rewritten = sum.rewritten || part.rewritten;
}

// The settings of one tolerance, looked at part by part.
class ToleranceSurvey {
 public:
  explicit ToleranceSurvey(std::span<const SmoothOptions> settings) {
    for (const SmoothOptions& options : settings) {
      settings_.push_back(options);
      settings_.back().quick = true;
    }
  }

  // Nothing in `rows` where the program is not understood.
  SmoothResult run(const gcode::SourceText& source, const Progress& progress,
                   std::vector<ExploredRow>& rows) {
    const ProgramSink sink = {[](std::string_view) { return true; },
                              [this] {
                                parts_.clear();
                                return true;
                              }};
    SmoothResult read =
        smooth_program(source, settings_.front(), sink, progress, {},
                       [this](const ProgramPart& part, const PartRuns& runs,
                              const ProgressCallback& tell) { return look_at(part, runs, tell); });
    for (std::size_t i = 0; read.understood && i < settings_.size(); ++i) {
      ExploredRow row{settings_[i], {}, {}};
      row.options.quick = false;
      for (const auto& [line, part] : parts_) {
        row.runs += part.runs;
        row.runs_looked_at += part.runs_looked_at;
        add_to(row.before, part.figures[i].first);
        add_to(row.after, part.figures[i].second);
      }
      const double elsewhere = read.program_before.seconds - row.before.time_s;
      for (ExploredFigures* figures : {&row.before, &row.after}) {
        figures->blocks = std::round(figures->blocks) + static_cast<double>(read.blocks_in);
        figures->time_s += elsewhere;
      }
      rows.push_back(std::move(row));
    }
    return read;
  }

 private:
  struct PartFigures {
    std::size_t runs = 0;
    std::size_t runs_looked_at = 0;
    // For each setting: before and after. Of blocks what they are more.
    std::vector<std::pair<ExploredFigures, ExploredFigures>> figures;
  };

  bool look_at(const ProgramPart& part, const PartRuns& runs, const ProgressCallback& tell) {
    if (runs.works.empty()) return true;
    const PartSample sample = sample_of_part(part, runs, settings_.front().tolerance_mm);
    RunMemos memos;
    std::vector<std::pair<ExploredFigures, ExploredFigures>> all;
    for (const SmoothOptions& options : settings_) {
      PartRuns own = sample.runs;
      const auto done = static_cast<double>(all.size());
      const auto tell_share = [&](double share) {
        return tell((done + share) / static_cast<double>(settings_.size()));
      };
      if (!smooth_runs(part, options, tell_share, own, &memos)) return false;
      auto& [before, after] = all.emplace_back();
      for (RunReport& run : report_runs(part, own, options.tolerance_mm, {}, false)) {
        const double times = sample.stands_for(run.first_line);
        const double more =
            static_cast<double>(run.blocks_out) - static_cast<double>(run.blocks_in);
        run.path_before.length_mm *= times;
        run.path_after.length_mm *= times;
        add_to(before, {times * run.time_before_s, 0, run.path_before});
        add_to(after, {times * run.time_after_s, times * more, run.path_after,
                       run.status == RunStatus::kRewritten});
      }
    }
    const std::scoped_lock lock(adding_);
    parts_.insert_or_assign(
        part.program.blocks.front().line,
        PartFigures{runs.works.size(), sample.runs.works.size(), std::move(all)});
    return true;
  }

  std::vector<SmoothOptions> settings_;
  std::mutex adding_;
  std::map<std::uint32_t, PartFigures> parts_;  // by first line
};

// Of a text that could not be proved nothing is written.
void set_proved(const SmoothResult& result, ExploredRow& row) {
  row.proved = true;
  row.before.at_feeds = result.program_before.at_feeds;
  row.before.path = result.path_before;
  if (!result.proved) {
    row.after = row.before;
    return;
  }
  row.after.time_s = result.program_after.seconds;
  row.after.at_feeds = result.program_after.at_feeds;
  row.after.blocks = static_cast<double>(result.blocks_out);
  row.after.path = result.path_after;
}

Figures as_figures(const ExploredFigures& f) {
  const double t = f.time_s;
  return {{t, t, t}, f.blocks, f.blocks, f.path.distance_mm, f.path.roughness};
}

}  // namespace

void mark_dominated(std::vector<ExploredRow>& rows) {
  for (ExploredRow& row : rows) {
    const auto four = row.after.four();
    row.dominated = std::ranges::any_of(rows, [&](const ExploredRow& other) {
      const auto others = other.after.four();
      return others != four && std::ranges::equal(others, four, std::ranges::less_equal{});
    });
  }
}

std::optional<std::size_t> recommended_row(const std::vector<ExploredRow>& rows, bool proved) {
  if (rows.empty()) return std::nullopt;
  const Prefer first = rows.front().options.prefer;
  const Prefer prefer = first == rows.back().options.prefer ? first : Prefer::kTime;
  std::optional<std::size_t> best;
  double least = 0;
  for (std::size_t i = 0; i < rows.size(); ++i) {
    CostScale scale{as_figures(rows[i].before), rows[i].before.time_s};
    scale.near = kCost.near * rows[i].options.tolerance_mm;
    if (!rows[i].after.rewritten || (proved && !rows[i].proved)) continue;
    const Figures after = as_figures(rows[i].after);
    if (objection_to(after, scale, prefer) != Objection::kNone) continue;
    const double cost = cost_of(after, scale, prefer);
    const bool larger = best && rows[i].options.tolerance_mm > rows[*best].options.tolerance_mm;
    if (best && cost >= least - (larger ? kWorthMore : 0)) continue;
    best = i;
    least = cost;
  }
  return best;
}

Exploration explore_program(const gcode::SourceText& source,
                            const std::vector<SmoothOptions>& settings, const Progress& progress) {
  Exploration found;
  double done = 0;
  double now = 1;  // settings at once; in the end one is smoothed
  const Progress share_of_all = [&](double share) {
    return !progress || progress((done + share * now) / static_cast<double>(settings.size() + 1));
  };
  for (auto rest = std::span(settings); !rest.empty();) {
    const auto end = std::ranges::find_if(rest, [&](const SmoothOptions& options) {
      return options.tolerance_mm != rest.front().tolerance_mm;
    });
    const auto count = static_cast<std::size_t>(end - rest.begin());
    now = static_cast<double>(count);
    found.read = ToleranceSurvey(rest.first(count)).run(source, share_of_all, found.rows);
    if (!found.read.understood) return {std::move(found.read), {}, {}};
    done += std::exchange(now, 1);
    rest = rest.subspan(count);
  }
  const ProgramSink nowhere = {[](std::string_view) { return true; }, [] { return true; }};
  std::vector<ExploredRow>& rows = found.rows;
  const bool estimated = std::ranges::any_of(
      rows, [](const ExploredRow& row) { return row.runs_looked_at < row.runs; });
  std::size_t good = 0;  // proved, and nothing speaks against them
  for (auto best = recommended_row(rows); best;
       best = recommended_row(rows, estimated && good >= kProved)) {
    ExploredRow& row = rows[*best];
    if (row.proved) {
      found.recommended = best;
      break;
    }
    SmoothOptions options = row.options;
    options.timed_feeds.assign(kExploredFeeds.begin(), kExploredFeeds.end());
    SmoothResult result = smooth_program(source, options, nowhere, share_of_all);
    if (!result.understood) return {std::move(result), {}, {}};
    set_proved(result, row);
    if (recommended_row({row})) ++good;
  }
  mark_dominated(found.rows);
  return found;
}

}  // namespace batten::postproc
