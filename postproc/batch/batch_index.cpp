#include "postproc/batch/batch_index.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cctype>
#include <cmath>
#include <vector>

#include "postproc/text/words.h"

namespace batten::postproc {
namespace {

constexpr std::string_view kHead = R"(<!doctype html>
<html lang="en">
<head>
<meta charset="utf-8">
<meta name="viewport" content="width=device-width, initial-scale=1">
<meta name="color-scheme" content="light dark">
<meta name="generator" content="Batten">
<meta http-equiv="Content-Security-Policy" content="default-src 'none'; style-src 'unsafe-inline'">
<style>
:root { --page: #f4f5f7; --card: #fff; --ink: #18202b; --soft: #576474; --line: #d8dde4; --accent: #0a64bf;
  --kept: #b06f00; --good: #17723f; --bad: #b3261e; }
@media (prefers-color-scheme: dark) { :root { --page: #0f1318; --card: #181e26; --ink: #e7ebf1; --soft: #9aa7b8;
  --line: #2d3641; --accent: #62aef7; --kept: #e0a23e; --good: #63cf92; --bad: #ff8a80; } }
* { box-sizing: border-box; }
body { margin: 0 auto; padding: 20px 24px 48px; max-width: 1400px; background: var(--page); color: var(--ink);
  font: 15px/1.45 system-ui, "Segoe UI", Roboto, "Liberation Sans", sans-serif; font-variant-numeric: tabular-nums; }
h1, h2, p, dl, ul { margin: 0; padding: 0; }
h1 { font-size: 22px; overflow-wrap: anywhere; }
h2 { font-size: 16px; overflow-wrap: anywhere; }
p, dt { color: var(--soft); font-size: 13px; }
a { color: var(--accent); }
:focus-visible { outline: 2px solid var(--accent); outline-offset: 2px; }
ul { list-style: none; display: grid; grid-template-columns: repeat(auto-fill, minmax(min(100%, 560px), 1fr)); gap: 12px; margin-top: 16px; }
li, .totals { background: var(--card); border: 1px solid var(--line); border-radius: 10px; padding: 12px 14px; min-width: 0; }
li { display: grid; grid-template-columns: minmax(0, 168px) minmax(0, 1fr); gap: 14px; }
li.bad { border-left: 4px solid var(--bad); }
li > div { min-width: 0; }
svg { display: block; width: 100%; height: auto; }
path { fill: none; stroke-width: 1.6; vector-effect: non-scaling-stroke; stroke: var(--accent); }
path.kept { stroke: var(--kept); }
dl { display: flex; flex-wrap: wrap; gap: 5px 20px; margin: 6px 0; }
dd { margin: 0; font-size: 14px; font-weight: 600; }
dd small { font-weight: 400; color: var(--soft); }
.smoothed { color: var(--good); }
.message { color: var(--bad); overflow-wrap: anywhere; }
.totals { margin-top: 14px; }
@media (max-width: 520px) { body { padding: 14px 12px 40px; } li { grid-template-columns: minmax(0, 1fr); } svg { max-width: 240px; } }
</style>
)";

std::string html(std::string_view text) {
  return escaped(text, {{'<', "&lt;"}, {'>', "&gt;"}, {'&', "&amp;"}, {'"', "&quot;"}});
}

// A path below the folder as an address: all but plain characters as their bytes.
std::string address(std::string_view path) {
  std::string text;
  for (const char c : path) {
    const auto byte = static_cast<unsigned char>(c);
    const bool plain = (std::isalnum(byte) != 0 && byte < 0x80) ||
                       std::string_view("/-_.~").find(c) != std::string_view::npos;
    text += plain ? std::string(1, c) : fmt::format("%{:02X}", byte);
  }
  return text;
}

std::string seconds_of(double time) {
  if (time < 120) return fmt::format("{:.2f} s", time);
  const auto whole = static_cast<long long>(std::llround(time));
  if (whole < 3600) return fmt::format("{} min {:02} s", whole / 60, whole % 60);
  return fmt::format("{} h {:02} min", whole / 3600, whole % 3600 / 60);
}

std::string fact(std::string_view name, std::string_view value, std::string_view more = {}) {
  return fmt::format("<div><dt>{}</dt><dd>{}{}</dd></div>\n", name, value,
                     more.empty() ? "" : fmt::format(" <small>{}</small>", more));
}

std::string change(double before, double after) {
  const double percent = before > 0 ? 100 * (after / before - 1) : 0;
  return std::abs(percent) < 0.5 ? "" : fmt::format("{:+.0f} %", percent);
}

std::string figures(const ProgramFigures& row, std::uint32_t line) {
  std::string text = "<dl>\n";
  const double before = row.time_before.seconds;
  const double after = row.time_after.seconds;
  text += fact("time", fmt::format("{} → {}", seconds_of(before), seconds_of(after)),
               change(before, after));
  text += fact("blocks", fmt::format("{} → {}", row.blocks_in, row.blocks_out),
               change(static_cast<double>(row.blocks_in), static_cast<double>(row.blocks_out)));
  text += fact("slow", fmt::format("{:.1f} → {:.1f} %", 100 * row.time_before.slow_share(),
                                   100 * row.time_after.slow_share()));
  text += fact("farthest off", fmt::format("{:.4f} mm", row.deviation_mm),
               line > 0 ? fmt::format("line {}", line) : "");
  return text + "</dl>\n";
}

std::string picture(const ProgramRecord& record) {
  if (record.picture.kept.empty() && record.picture.rewritten.empty()) return "<div></div>\n";
  std::string text =
      fmt::format("<svg viewBox=\"0 0 {} {}\" role=\"img\" aria-label=\"the tool path of {}\">",
                  PathPicture::kWidth, PathPicture::kHeight, html(record.program));
  if (!record.picture.kept.empty()) {
    text += fmt::format("<path class=\"kept\" d=\"{}\"/>", record.picture.kept);
  }
  if (!record.picture.rewritten.empty()) {
    text += fmt::format("<path d=\"{}\"/>", record.picture.rewritten);
  }
  return text + "</svg>\n";
}

bool has_output(const ProgramRecord& record) { return !record.output_sha256.empty(); }

std::string item(const ProgramRecord& record) {
  const std::string name = html(record.program);
  const std::string reports = "reports/" + address(record.program);
  const bool has_page = !record.page_sha256.empty();
  std::string text = fmt::format("<li{}>\n", has_output(record) ? "" : " class=\"bad\"");
  text += picture(record) + "<div>\n<h2>";
  text += has_page ? fmt::format("<a href=\"{}.html\">{}</a>", reports, name) : name;
  text += fmt::format("</h2>\n<p class=\"{}\">{}</p>\n",
                      record.status == ProgramStatus::kSmoothed ? "smoothed" : "plain",
                      name_of(record.status));
  if (!record.message.empty()) {
    text += fmt::format("<p class=\"message\">{}</p>\n", html(record.message));
  }
  if (has_output(record)) text += figures(record, record.deviation_line);
  std::vector<std::string> links;
  if (has_output(record)) {
    links.push_back(fmt::format("<a href=\"../{}\">program</a>", address(record.program)));
  }
  if (!record.report_sha256.empty()) {
    links.push_back(fmt::format("<a href=\"{}.json\">JSON</a>", reports));
  }
  text += fmt::format("<p>{}{}</p>\n</div>\n</li>\n",
                      has_output(record)
                          ? fmt::format("{} rewritten, {} kept · ",
                                        plural(record.runs_rewritten, "run"), record.runs_kept)
                          : "",
                      fmt::join(links, " · "));
  return text;
}

}  // namespace

std::string batch_index(std::span<const ProgramRecord> records, const std::string& input_tree,
                        const SmoothOptions& options) {
  const BatchTotals totals = totals_of(records);
  std::string text(kHead);
  text +=
      fmt::format("<title>{} - Batten</title>\n</head>\n<body>\n<p>Batten batch</p>\n<h1>{}</h1>\n",
                  html(input_tree), html(input_tree));
  text +=
      fmt::format("<p>for {}, machine {}, tolerance {:g} mm; times are predicted</p>\n",
                  html(options.target->name), html(options.machine->name), options.tolerance_mm);
  std::vector<std::string> counts;
  for (std::size_t i = 0; i < kStatuses; ++i) {
    if (totals.with_status[i] == 0) continue;
    counts.push_back(
        fmt::format("{} {}", totals.with_status[i], name_of(static_cast<ProgramStatus>(i))));
  }
  text +=
      fmt::format("<div class=\"totals\"><h2>{}: {}</h2>\n{}</div>\n<ul>\n",
                  plural(totals.programs, "program"), fmt::join(counts, ", "), figures(totals, 0));
  std::vector<const ProgramRecord*> order;
  for (const ProgramRecord& record : records) order.push_back(&record);
  std::stable_partition(order.begin(), order.end(),
                        [](const ProgramRecord* r) { return !has_output(*r); });
  for (const ProgramRecord* record : order) text += item(*record);
  return text + "</ul>\n</body>\n</html>\n";
}

}  // namespace batten::postproc
