// Prints how many lines two ways of laying them along a curve need:
//   linearize_table FILE ..
// For each program, smoothed within 0.01 mm for linuxcnc with --method fair --output lines
// --prefer size: lines in the runs that both ways rewrite, laid as chords and as minlink, what is
// saved, and whether both texts are proved.
#include <fmt/core.h>

#include <algorithm>
#include <cstdio>
#include <string>

#include "gcode/controls/built_in.h"
#include "gcode/text/source_text.h"
#include "postproc/stream/pipeline.h"

namespace {

using namespace batten;
using postproc::Linearize;

postproc::SmoothResult smoothed(const gcode::SourceText& source, Linearize linearize) {
  postproc::SmoothOptions options;
  options.target = gcode::find_control("linuxcnc");
  options.machine = postproc::find_machine("linuxcnc-fast");
  options.tolerance_mm = 0.01;
  options.method = postproc::Method::kFair;  // the same curves for both
  options.output = postproc::Form::kLines;
  options.prefer = postproc::Prefer::kSize;
  options.linearize = linearize;
  return smooth_program(source, options);
}

void print_program(const std::string& file) {
  std::string error;
  const auto source = gcode::SourceText::map_file(file, error);
  if (!source) {
    fmt::print("{}: {}\n", file, error);
    return;
  }
  const auto chords = smoothed(*source, Linearize::kChord);
  const auto links = smoothed(*source, Linearize::kMinLink);
  std::size_t before = 0;
  std::size_t as_chords = 0;
  std::size_t as_links = 0;
  for (const auto& run : chords.runs) {
    const auto same =
        std::ranges::find(links.runs, run.first_line, &postproc::RunReport::first_line);
    if (same == links.runs.end() || same->last_line != run.last_line) continue;
    if (run.status != postproc::RunStatus::kRewritten || same->status != run.status) continue;
    before += run.blocks_in;
    as_chords += run.blocks_out;
    as_links += same->blocks_out;
  }
  const double saved =
      as_chords > 0 ? 1 - static_cast<double>(as_links) / static_cast<double>(as_chords) : 0;
  const std::size_t slash = file.find_last_of('/');
  fmt::print("{:<44} {:>7} {:>7} {:>7} {:>6.1f} % {:>8} {:>8} {}\n",
             slash == std::string::npos ? file : file.substr(slash + 1), before, as_chords,
             as_links, 100 * saved, chords.text.size(), links.text.size(),
             chords.proved && links.proved ? "proved" : "NOT PROVED");
  std::fflush(stdout);
}

}  // namespace

int main(int argument_count, char** argument_words) {
  fmt::print("{:<44} {:>7} {:>7} {:>7} {:>8} {:>8} {:>8}\n", "program", "before", "chord",
             "minlink", "saved", "bytes", "bytes");
  for (int i = 1; i < argument_count; ++i) print_program(argument_words[i]);
  return 0;
}
