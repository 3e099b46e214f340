#include "postproc/report/smooth_report.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <nlohmann/json.hpp>

#include "gcode/state/modal_state.h"
#include "gcode/state/reason.h"
#include "postproc/report/kept_report.h"
#include "postproc/report/own_words_report.h"
#include "postproc/text/words.h"

namespace batten::postproc {

namespace {

// Why runs were kept, counted.
struct ReasonCount {
  gcode::reason::Explanation reason = {};
  std::size_t runs = 0;
  std::size_t blocks = 0;
};

// One entry per reason of the kept runs: the most blocks first, then by id.
std::vector<ReasonCount> count_reasons(std::span<const RunReport> runs) {
  std::map<std::string_view, ReasonCount> by_id;
  for (const RunReport& run : runs) {
    if (run.status != RunStatus::kKept) continue;
    ReasonCount& count = by_id[run.reason];
    ++count.runs;
    count.blocks += run.blocks_in;
  }
  std::vector<ReasonCount> counts;
  for (auto& [id, count] : by_id) {
    const auto explanations = gcode::reason::explanations();
    const auto found = std::ranges::find(explanations, id, &gcode::reason::Explanation::id);
    if (found != explanations.end()) count.reason = *found;
    count.reason.id = id;
    counts.push_back(count);
  }
  std::ranges::stable_sort(counts, std::ranges::greater{}, &ReasonCount::blocks);
  return counts;
}

Json json_of(const SmoothOptions& options, bool strict) {
  // An option that is added does not compile here: say it below, and where the library is to have
  // it, in Options of api/include/batten/batten.h and `inner` of api/batten.cpp.
  const auto& [target, machine, tolerance_mm, tolerance_inch, one_tolerance, tolerance_kind, side,
               units, source, decimals, method, output, prefer, guo_lambda, seam, linearize,
               keep_corners_deg, allowed, own_words, subprograms, keep_expressions, convert, words,
               profile, threads, share_work, timed_feeds, quick] = options;
  Json json = {
      {"target", target->name}, {"machine", machine->name}, {"tolerance_mm", tolerance_mm}};
  if (tolerance_inch) json["tolerance_inch"] = *tolerance_inch;
  json["one_tolerance"] = one_tolerance;
  json["tolerance_kind"] = name_of(tolerance_kind);
  json["side"] = name_of(side);
  json["method"] = name_of(method);
  json["output"] = name_of(output);
  json["prefer"] = name_of(prefer);
  if (guo_lambda != 0) json["guo_lambda"] = guo_lambda;
  if (seam != geometry::Seam::kCorner) json["seam"] = name_of(seam);
  json["linearize"] = name_of(linearize_of(options));
  json["units"] = name_of(units);
  json["decimals"] = text_of(decimals);
  json["keep_corners_deg"] = keep_corners_deg ? Json(*keep_corners_deg) : Json(nullptr);
  json["allow"] = allowed;
  json["words"] = own_words_json(own_words);
  json["keep_expressions"] = keep_expressions;
  json["strict"] = strict;
  return json;
}

Json json_of(const PathFigures& path) {
  return {{"length_mm", path.length_mm},
          {"distance_mm", path.distance_mm},
          {"roughness", path.roughness}};
}

Json json_of(const RunReport& run) {
  const bool rewritten = run.status == RunStatus::kRewritten;
  const auto method = [](const MethodTime& each) -> Json {
    return {{"method", each.method}, {"time_s", each.time_s}};
  };
  return {{"first_line", run.first_line},
          {"last_line", run.last_line},
          {"points", run.points},
          {"tolerance_mm", run.tolerance_mm},
          {"status", rewritten ? "rewritten" : "kept"},
          {"reason", run.reason},
          {"method", run.method},
          {"methods", json_list(run.methods, method)},
          {"form", rewritten ? name_of(run.form) : ""},
          {"blocks_in", run.blocks_in},
          {"computed_blocks", run.computed_blocks},
          {"blocks_out", run.blocks_out},
          {"deviation_mm", run.deviation_mm},
          {"proved", run.proved},
          {"cut_short", run.is_cut_short},
          {"noise_mm", run.noise_mm},
          {"coarse_part", run.coarse_part},
          {"max_curvature_before", run.max_curvature_before},
          {"max_curvature_after", run.max_curvature_after},
          {"bytes_in", run.bytes_in},
          {"bytes_out", run.bytes_out},
          {"path_before", json_of(run.path_before)},
          {"path_after", json_of(run.path_after)},
          {"time_before_s", run.time_before_s},
          {"time_after_s", run.time_after_s}};
}

Json json_of(const StatedFrom& from) {
  return {{"line", from.line},
          {"tolerance_mm", from.tolerance_mm ? Json(*from.tolerance_mm) : Json(nullptr)}};
}

Json json_of(const ReasonCount& count) {
  const gcode::reason::Explanation& reason = count.reason;
  return {{"id", reason.id},         {"runs", count.runs},
          {"blocks", count.blocks},  {"text", reason.text},
          {"advice", reason.advice}, {"can_be_allowed", reason.can_be_allowed}};
}

Json profile_json(const SmoothReport& report) {
  const ProfileWords& words = report.options.words;
  return {{"file", report.options.profile}, {"lines_added", report.result.added_lines},
          {"header", words.header},         {"footer", words.footer},
          {"before_run", words.before_run}, {"after_run", words.after_run}};
}

Json origins_json(const SmoothReport& report) {
  Json json = Json::object();
  for (const auto& [option, origin] : report.origins) json[option] = origin;
  return json;
}

std::string change(std::size_t before, std::size_t after) {
  if (before == after) return fmt::format("{}, unchanged", before);
  const double percent = 100 * (static_cast<double>(after) / static_cast<double>(before) - 1);
  return fmt::format("{} -> {}  ({:+.0f} %)", before, after, percent);
}

std::string seconds(double time) {
  if (time < 120) return fmt::format("{:.2f} s", time);
  const auto whole = static_cast<long long>(std::llround(time));
  if (whole < 3600) return fmt::format("{} min {:02} s", whole / 60, whole % 60);
  return fmt::format("{} h {:02} min", whole / 3600, whole % 3600 / 60);
}

std::string length(double mm, gcode::Units units) {
  if (units != gcode::Units::kInch) return fmt::format("{:.4f} mm", mm);
  return fmt::format("{:.4f} mm ({:.5f} in)", mm, mm / gcode::millimetres_per(gcode::Units::kInch));
}

std::string times(const SmoothResult& result, const Machine& machine) {
  const double before = result.program_before.seconds;
  const double after = result.program_after.seconds;
  if (before <= 0) return "none: nothing moves or waits";
  std::string text =
      fmt::format("{} -> {}  (machine {}", seconds(before), seconds(after), machine.name);
  // Less than half a percent is not worth a claim: the model is not that good.
  const double ratio = after > 0 ? before / after : 1;
  if (ratio > 1.995) {
    text += fmt::format(", {:.1f} times as fast", ratio);
  } else if (std::abs(ratio - 1) > 0.005) {
    text += fmt::format(", {:+.1f} %", 100 * (1 / ratio - 1));
  }
  return text + ")";
}

void add_runs(const SmoothResult& result, std::string& lines) {
  if (result.runs.empty()) {
    const bool of_a_lathe = std::ranges::any_of(
        result.diagnostics,
        [](const gcode::Diagnostic& each) { return each.id == gcode::reason::kLatheProgram; });
    lines += titled(
        "runs", of_a_lathe ? "none: the program is one for a lathe (lathe-program)" : "none found");
    add_causes(result.kept, lines);
    return;
  }
  const auto rewritten = static_cast<std::size_t>(
      std::ranges::count(result.runs, RunStatus::kRewritten, &RunReport::status));
  lines += titled("runs",
                  fmt::format("{} rewritten, {} kept", rewritten, result.runs.size() - rewritten));
  add_causes(result.kept, lines);
}

// "in 2 parts (lines 12, 40)"
std::string parts_text(const std::vector<std::uint32_t>& lines) {
  constexpr std::size_t kMost = 4;
  const std::size_t shown = std::min(lines.size(), kMost);
  return fmt::format(
      "in {} ({} {}{})", plural(lines.size(), "part"), lines.size() == 1 ? "line" : "lines",
      fmt::join(lines.begin(), lines.begin() + static_cast<std::ptrdiff_t>(shown), ", "),
      lines.size() > kMost ? ", .." : "");
}

// What the program says of how exact its parts have to be. Nothing where it says nothing.
void add_tolerances(const SmoothReport& report, std::string& lines) {
  const double users = report.options.tolerance_mm;
  std::map<double, std::vector<std::uint32_t>> less;  // lines of parts, by their tolerance
  std::vector<std::uint32_t> in_vain;
  for (const StatedFrom& from : report.result.stated) {
    if (!from.tolerance_mm) continue;
    (*from.tolerance_mm < users ? less[*from.tolerance_mm] : in_vain).push_back(from.line);
  }
  std::string text;
  for (const auto& [mm, of_parts] : less) {
    text += fmt::format("; {:g} mm {}", mm, parts_text(of_parts));
  }
  if (!text.empty()) {
    lines += titled("tolerance", fmt::format("{:g} mm{}, as the program says", users, text));
  }
  if (in_vain.empty()) return;
  lines +=
      titled(text.empty() ? "tolerance" : "",
             fmt::format("{}what the program says {} is no less",
                         text.empty() ? fmt::format("{:g} mm; ", users) : "", parts_text(in_vain)));
}

// What can no longer be turned by variables.
void add_expressions(const SmoothResult& result, std::string& lines) {
  std::size_t blocks = 0;
  for (const RunReport& run : result.runs) blocks += run.computed_blocks;
  if (blocks == 0) return;
  lines += titled("expressions",
                  fmt::format("{} with expressions of variables became numbers: other values of",
                              plural(blocks, "block")));
  lines += titled("", "the variables no longer change them (--keep-expressions leaves them)");
}

// Which methods won where several were tried, and by how much. Nothing where none were.
void add_methods(const SmoothResult& result, std::string& lines) {
  std::vector<std::pair<std::string_view, std::size_t>> wins;
  double lead = 0;
  for (const RunReport& run : result.runs) {
    if (run.status != RunStatus::kRewritten || run.methods.size() < 2) continue;
    lead += lead_of(run.method, run.time_after_s, run.methods);
    const auto known = std::ranges::find(wins, run.method, &decltype(wins)::value_type::first);
    if (known == wins.end()) {
      wins.emplace_back(run.method, 1);
    } else {
      ++known->second;
    }
  }
  if (wins.empty()) return;
  std::string text;
  for (const auto& [method, runs] : wins) {
    text += fmt::format("{}{} in {}", text.empty() ? "" : ", ", method, plural(runs, "run"));
  }
  lines += titled("methods", fmt::format("{}: {:.2f} s {} than by the next best ones", text,
                                         std::abs(lead), lead < 0 ? "more" : "less"));
}

void add_proof(const SmoothReport& report, bool rewritten, std::string& lines) {
  const SmoothResult& result = report.result;
  if (!rewritten) {
    lines += titled("deviation", "none: every block is as it was");
    return;
  }
  const std::string place =
      result.deviation_line > 0 ? fmt::format(", near line {}", result.deviation_line) : "";
  lines += titled("deviation",
                  fmt::format("at most {}{}; allowed {}", length(result.deviation_mm, result.units),
                              place, length(report.options.tolerance_mm, result.units)));
  if (result.corner_mm > 0) {
    lines += titled("corners", fmt::format("at most {} from the new path",
                                           length(result.corner_mm, result.units)));
  }
  const bool band = report.options.tolerance_kind == geometry::ToleranceKind::kBand;
  lines +=
      titled("proof", result.proved
                          ? "the new text was read again: every rewritten run keeps the tolerance,"
                          : "NOT PROVED: the new text could not be shown to keep the tolerance");
  if (result.proved) {
    lines +=
        titled("", fmt::format("{}; everything else is the same, byte for byte",
                               band ? "in order, in the band reading" : "both ways and in order"));
  }
}

void add_profile(const SmoothReport& report, std::string& lines) {
  if (report.options.profile.empty()) return;
  const ProfileWords& words = report.options.words;
  lines += titled("profile", fmt::format("{}: {} added", report.options.profile,
                                         plural(report.result.added_lines, "line")));
  if (report.result.added_lines == 0) return;
  for (const auto& [place, added] :
       {std::pair("header", &words.header), std::pair("before runs", &words.before_run),
        std::pair("after runs", &words.after_run), std::pair("footer", &words.footer)}) {
    for (const std::string& line : *added) lines += titled("", fmt::format("{}: {}", place, line));
  }
  lines += titled(
      "", "what these words do on the control is not known here: where it smooths by itself,");
  lines +=
      titled("", "its own tolerance adds to the deviation; verify needs --profile to accept them");
}

}  // namespace

Json smooth_json(const SmoothReport& report) {
  const SmoothResult& result = report.result;
  const auto item = [](const auto& each) { return json_of(each); };
  Json json = {{"options", json_of(report.options, report.strict)},
               {"options_from", origins_json(report)},
               {"input",
                {{"file", report.source.name()},
                 {"bytes", report.source.text().size()},
                 {"blocks", result.blocks_in},
                 {"units", name_of(result.units)}}},
               {"output",
                {{"file", report.output_file},
                 {"bytes", result.bytes_out},
                 {"blocks", result.blocks_out},
                 {"target", report.options.target->name}}},
               {"machine",
                {{"name", report.options.machine->name},
                 {"model", name_of(report.options.machine->model)},
                 {"description", report.options.machine->description}}},
               {"stated_tolerances", json_list(result.stated, item)},
               {"runs", json_list(result.runs, item)},
               {"reasons", json_list(count_reasons(result.runs), item)},
               {"kept", kept_json(result.kept)},
               {"deviation_mm", result.deviation_mm},
               {"deviation_line", result.deviation_line},
               {"corner_mm", result.corner_mm},
               {"time_before_s", result.program_before.seconds},
               {"time_after_s", result.program_after.seconds},
               {"cutting_before_s", result.program_before.cutting_s},
               {"cutting_after_s", result.program_after.cutting_s},
               {"slow_share_before", result.program_before.slow_share()},
               {"slow_share_after", result.program_after.slow_share()},
               {"path_before", json_of(result.path_before)},
               {"path_after", json_of(result.path_after)},
               {"proved", result.proved},
               {"understood", result.understood},
               {"diagnostics", diagnostics_json(result.diagnostics, report.source)}};
  if (!report.options.profile.empty()) json["profile"] = profile_json(report);
  if (!report.drop.empty()) json["dropped"] = {{"names", report.drop}, {"words", report.dropped}};
  if (!report.called.empty()) json["called"] = called_json(report.called);
  return as_report("smooth", json);
}

std::string json_report(const SmoothReport& report) { return json_text(smooth_json(report)); }

namespace {

// Nothing of what is printed as zero.
std::string percent_text(double before, double after) {
  constexpr double kPrintedAsZero = 5e-5;
  const double percent = before >= kPrintedAsZero ? 100 * (after / before - 1) : 0;
  return std::abs(percent) < 0.5 ? "" : fmt::format(", {:+.0f} %", percent);
}

// Of the runs that were tried. docs/algorithms/choice.md.
std::string path_lines(const PathFigures& before, const PathFigures& after) {
  return titled("distance",
                fmt::format("{:.4f} -> {:.4f} mm  (rms, from the path that was meant{})",
                            before.distance_mm, after.distance_mm,
                            percent_text(before.distance_mm, after.distance_mm))) +
         titled("roughness",
                fmt::format("{:.3f} -> {:.3f}  (turns at joints, rad/sqrt(mm){})", before.roughness,
                            after.roughness, percent_text(before.roughness, after.roughness)));
}

// Where little was found: what other options would have given of the candidates that were made; or
// that the program is good.
void add_outlook(const SmoothReport& report, std::string& lines) {
  const SmoothResult& result = report.result;
  const Outlook& outlook = result.outlook;
  const double length = result.path_before.length_mm;
  const auto blocks_in = static_cast<double>(result.blocks_in);
  const Eigen::Array3d before(result.program_before.seconds, blocks_in,
                              result.path_before.distance_mm);
  const Eigen::Array3d now(result.program_after.seconds, static_cast<double>(result.blocks_out),
                           result.path_after.distance_mm);
  const Eigen::Array3d clearly(kCost.clearly_faster, kCost.clearly_smaller, kCost.clearly_nearer);
  if (!(length > 0) || (now.head(2) <= clearly.head(2) * before.head(2)).any()) return;
  std::string said;
  for (int row = 0; row < outlook.others.rows(); ++row) {
    const SmoothOptions options = other_options(report.options, row);
    const bool form = options.output != report.options.output;
    if (!form && options.prefer == report.options.prefer) continue;  // what was written
    Eigen::Array3d other = outlook.others.row(row).transpose();
    other[2] = std::sqrt(std::max(0.0, before[2] * before[2] + other[2] / length));
    other.head(2) += before.head(2);
    const bool slower = other[0] > (1 + kCost.longer) * now[0];
    if (slower || !(other <= clearly * now).any()) continue;
    std::string changes = changes_text({now.data(), 3}, {other.data(), 3});
    if (changes == said) continue;
    lines += titled("found",
                    fmt::format("--{} {}{}", form ? "output" : "prefer",
                                form ? name_of(options.output) : name_of(options.prefer), changes));
    said = std::move(changes);
  }
  const bool at_feeds = kCost.clearly_faster * result.runs_before_s <= outlook.at_feeds_s;
  if (!said.empty()) {
    lines += titled("", "by the forms that were made; batten explore looks for more");
  } else if (at_feeds && outlook.better == 0) {
    lines += titled("found", "the program is good here: at its feeds, and no form clearly better");
  }
}

// What a rule costs that the user may lift.
void add_lifted(const SmoothReport& report, std::string& lines) {
  if (report.lifted == nullptr) return;
  const SmoothResult& now = report.result;
  const SmoothResult& other = report.lifted->result;
  if (!other.understood || !other.proved) return;
  const double before[] = {now.program_after.seconds, static_cast<double>(now.blocks_out)};
  const double after[] = {other.program_after.seconds, static_cast<double>(other.blocks_out)};
  const std::string changes = changes_text(before, after);
  if (after[0] > kCost.clearly_faster * before[0] && after[1] > kCost.clearly_smaller * before[1]) {
    return;
  }
  lines += titled("found", fmt::format("--allow {}{}", report.lifted->id, changes));
}

}  // namespace

std::string_view rule_worth_lifting(const SmoothResult& result) {
  constexpr double kMuchKept = 0.2;
  for (const KeptCause& cause : result.kept.causes) {
    if (result.kept.share(cause.cut) < kMuchKept) break;
    const auto all = gcode::reason::explanations();
    const auto reason = std::ranges::find(all, cause.reason, &gcode::reason::Explanation::id);
    // Tolerances would add up.
    if (reason == all.end() || reason->id == gcode::reason::kAlreadySmoothed) continue;
    if (reason->can_be_allowed) return reason->id;
  }
  return {};
}

std::vector<std::string> texts_of_origins(
    std::span<const std::pair<std::string, std::string>> origins) {
  std::map<std::string_view, std::vector<std::string_view>> by_origin;
  for (const auto& [option, origin] : origins) by_origin[origin].push_back(option);
  std::vector<std::string> texts;
  texts.reserve(by_origin.size());
  for (const auto& [origin, options] : by_origin) {
    texts.push_back(fmt::format("{}: {}", fmt::join(options, ", "), origin));
  }
  return texts;
}

std::string changes_text(std::span<const double> before, std::span<const double> after) {
  static constexpr std::string_view kChanges[][2] = {
      {"less time", "more time"},
      {"fewer blocks", "more blocks"},
      {"nearer to the path", "farther from the path"},
      {"smoother", "rougher"}};
  std::string text;
  for (std::size_t i = 0; i < after.size(); ++i) {
    // Less than a millionth is no digit that is shown.
    const double percent = before[i] > 1e-6 ? 100 * (after[i] / before[i] - 1) : 0;
    if (std::abs(percent) < 0.5) continue;
    text += fmt::format("{} {:.0f} % {}", text.empty() ? ":" : ",", std::abs(percent),
                        kChanges[i][percent > 0 ? 1 : 0]);
  }
  return text;
}

std::string summary_text(const SmoothReport& report) {
  const SmoothResult& result = report.result;
  std::string lines =
      fmt::format("{} -> {}, for {}", report.source.name(),
                  report.output_file.empty() ? "nothing written" : report.output_file,
                  report.options.target->name);
  const bool in_vain = result.understood && !result.kept.any_run;
  lines += in_vain ? fmt::format(": {}\n", why_nothing(result.kept)) : "\n";
  for (const std::string& text : texts_of_origins(report.origins)) lines += titled("options", text);
  if (!report.drop.empty()) {
    lines += titled("dropped",
                    fmt::format("{} ({}); verify needs the same --drop",
                                plural(report.dropped, "word"), fmt::join(report.drop, ", ")));
  }
  lines += titled("blocks", change(result.blocks_in, result.blocks_out));
  lines += titled("bytes", change(report.source.text().size(), result.bytes_out));
  if (result.path_before.length_mm > 0) lines += path_lines(result.path_before, result.path_after);
  add_tolerances(report, lines);
  add_runs(result, lines);
  add_expressions(result, lines);
  lines += titled("time", times(result, *report.options.machine));
  if (result.program_before.cutting_s > 0) {
    lines += titled("slow", fmt::format("{:.1f} -> {:.1f} % of the cutting time is below half of "
                                        "the programmed feed",
                                        100 * result.program_before.slow_share(),
                                        100 * result.program_after.slow_share()));
  }
  add_methods(result, lines);
  add_outlook(report, lines);
  add_lifted(report, lines);
  const bool rewritten =
      std::ranges::count(result.runs, RunStatus::kRewritten, &RunReport::status) > 0;
  add_proof(report, rewritten, lines);
  lines += text_of(report.called);
  lines += own_words_text(report.options.own_words);
  add_profile(report, lines);
  return lines;
}

}  // namespace batten::postproc
