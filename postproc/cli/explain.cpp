#include "postproc/cli/explain.h"

#include <fmt/format.h>

#include <algorithm>

#include "gcode/state/reason.h"

namespace batten::postproc {
namespace {

// Columns of the text, a little less than a terminal of 80.
constexpr std::size_t kColumns = 78;

constexpr gcode::ExplainedDiagnostic kViolations[] = {
    {"distance", "error",
     "A section of cutting moves leaves the tolerance, both ways and in order. The message gives "
     "a distance that is certainly reached, the lines say where.",
     "The new program cuts something else there: do not run it."},
    {"wrong-side", "error",
     "With --side: a section of the new path comes over to the side that is not allowed, or could "
     "not be proved to stay on the other.",
     "A larger tolerance or more decimals: a tenth of the tolerance is allowed for rounding."},
    {"crosses-itself", "error",
     "A flat section meets itself where the old one does not: two parts of it are nearer to each "
     "other than twice the tolerance, and one came over to the other side.",
     "Take a smaller tolerance."},
    {"arc-refused", "error",
     "The target would refuse an arc of the new text, by its least radius or its check of the "
     "radii.",
     "While a program is smoothed: nothing, the run goes back to another form, in the end to its "
     "own blocks. From verify: do not run the new program."},
    {"line-refused", "error", "A line of the new text is longer than the target reads.",
     "Shorten it: comments and blanks count where the target counts them."},
    {"not-proved", "error",
     "The distance of a section could be bounded from both sides, but the tolerance lies between "
     "the bounds: paths that run over themselves many times within the tolerance, or a distance "
     "that equals it.",
     "Ask with another tolerance."},
    {"feed-changed", "error",
     "Another feed, or one that is missing or new in the order of feeds of a section.",
     "F was lost, or is on another block."},
    {"feed-moved", "error",
     "The path is right, but a feed begins or ends at another position on it, further off than "
     "the tolerance.",
     "F is on another block."},
    {"rapid-changed", "error",
     "A rapid ends at another position on an axis that it names, or starts or ends further off "
     "than the tolerance on one that it does not name.",
     "Look at the two lines: the rapid itself, or where the moves before it end."},
    {"rapid-lost", "error", "A rapid is in the old program only.", "Put it back."},
    {"rapid-added", "error", "A rapid is in the new program only.", "Take it out."},
    {"event-lost", "error",
     "A word that acts (M, S, T, H, D, a G word that sets a mode), a message, a dwell, or a block "
     "that has to be copied is in the old program only.",
     "Put it back."},
    {"event-added", "error", "Such a word or block is in the new program only.", "Take it out."},
    {"event-changed", "error",
     "At the same position are different words; other blanks count too in a block that is not "
     "understood.",
     "Look at the two lines."},
    {"event-moved", "error",
     "An event is at another position on the path, or has moved past other events.",
     "Look at the two lines: coolant or spindle would change at another position of the cut."},
    {"state-changed", "error",
     "Plane, units, a mode or the feed are different where a copied block depends on them, or "
     "only assumed where a word had set them.",
     "Look for a plane that was selected for arcs and not restored."},
    {"point-spelling", "error",
     "Nothing says for which control the programs are, and a number stands without a decimal "
     "point (X5, F100) that the old program writes with one (X5., F100.), or the other way round: "
     "some controls take X5 for 0.005 mm.",
     "Say --target or --source, or --decimals."},
    {"profile-words-open", "error",
     "Words of a profile before a run without those after it, or its header without its footer.",
     "Something was taken out by hand: put it back."},
    {"profile-words-around-event", "error",
     "Between the words before and after a run something acts that is no cutting move.",
     "The words were moved by hand: put them back."},
    {"profile-words-in-program", "error",
     "The old program has words of the profile itself, so none in the new one are taken for the "
     "profile's.",
     "Verify without the profile, or take them out of it."},
    {"too-many-differences", "error", "More than 50 places differ: the rest was not compared.",
     "The files do not belong together."},
};

// What the messages mean that do not come from reading a program: about its target, the words of
// its profile, the band around its runs, and what was written.
constexpr gcode::ExplainedDiagnostic kNotes[] = {
    // --- the program and its target ---
    {"other-family", "error",
     "Words that only other controls have, in a program in which something would be rewritten.",
     "Choose another target; --convert lists which blocks could not be said."},
    {"cannot-convert", "error",
     "With --convert: the block does not say the same on the target, or not for certain.",
     "Where the message names a choice (--source, --allow ..), take it if it is right for this "
     "program; else post the part again for this control."},
    {"word-means-other", "error",
     "A G word that the target takes for something else than the reader does: G21 mirrors on a "
     "Beckhoff control, G20 is unknown to Klipper. The program was not read as its control reads "
     "it.",
     "Choose the target that the program was made for, or post it again for this one."},
    // --- the words of a profile ---
    {"profile-words-in-program", "error",
     "The program has smoothing words itself that the profile would add: they would undo each "
     "other.",
     "Take them out of one of the two."},
    // --- the band around a run ---
    {"band-overlap", "note",
     "Two parts of a flat run are nearer to each other than twice the tolerance. The place is "
     "where they are nearest.",
     "Nothing, or a smaller tolerance where the wall between them matters."},
    {"band-cusp", "note",
     "A flat run bends with a radius below the tolerance. The place is the first such bend.",
     "Nothing, or a smaller tolerance where the bend matters."},
    // --- what was written ---
    {"missing-provenance", "note",
     "The target has no comment that all its controls take, so nothing in the new program says "
     "that it was smoothed. Batten would smooth it again, and the tolerances would add up.",
     "Keep the original, and smooth that. Where the control takes comments, a profile with its "
     "`comments` says so, and the program tells it."},
    {"curves-unverified", "warning",
     "The target's curve words were written, and what its control makes of them is not known for "
     "certain. The message says what is open.",
     "Run the program without a part, or on the vendor's simulator, and compare it with another "
     "form."},
    {"chords-for-steps", "note",
     "The equal steps of --linearize ilca are as short everywhere as the tightest place of the "
     "run asks for, and were too many. Its lines are chords, as --linearize chord lays them.",
     "Nothing, or a larger tolerance."},
};

// Broken between words, every line with the same indent.
std::string wrapped(std::string_view text, std::size_t indent) {
  std::string lines;
  std::string line;
  const auto flush = [&] {
    if (!line.empty()) lines += std::string(indent, ' ') + line + "\n";
    line.clear();
  };
  while (!text.empty()) {
    const std::size_t end = std::min(text.find(' '), text.size());
    const std::string_view word = text.substr(0, end);
    text.remove_prefix(std::min(end + 1, text.size()));
    if (indent + line.size() + 1 + word.size() > kColumns) flush();
    if (!line.empty()) line += ' ';
    line += word;
  }
  flush();
  return lines;
}

// Up to the end of the first sentence. A stop within brackets or an abbreviation ends none.
std::string_view first_sentence(std::string_view text) {
  int brackets = 0;
  for (std::size_t i = 0; i + 1 < text.size(); ++i) {
    if (text[i] == '(') ++brackets;
    if (text[i] == ')') --brackets;
    if (brackets == 0 && text[i] == '.' && text[i + 1] == ' ') return text.substr(0, i + 1);
  }
  return text;
}

struct Explained {
  std::string_view group;  // its title
  std::string_view id;
  std::string what;  // it is
  std::string_view text;
  std::string_view advice;
  bool can_be_allowed = false;
};

// Group after group.
std::vector<Explained> all_explained() {
  std::vector<Explained> all;
  for (const auto& each : gcode::reason::explanations()) {
    all.push_back({"Why blocks are kept as they are:", each.id, "why blocks are kept as they are",
                   each.text, each.advice, each.can_be_allowed});
  }
  using List = std::span<const gcode::ExplainedDiagnostic>;
  for (const List list : {gcode::explained_diagnostics(), List(kNotes)}) {
    for (const auto& each : list) {
      all.push_back({"\nMessages about a program:", each.id,
                     fmt::format("a message about a program ({})", each.severity), each.text,
                     each.advice});
    }
  }
  for (const auto& each : kViolations) {
    all.push_back({"\nViolations found by batten verify:", each.id,
                   "a violation found by batten verify", each.text, each.advice});
  }
  return all;
}

}  // namespace

std::span<const gcode::ExplainedDiagnostic> explained_violations() { return kViolations; }

std::vector<std::string_view> explained_ids() {
  std::vector<std::string_view> ids;
  for (const Explained& each : all_explained()) ids.push_back(each.id);
  std::ranges::sort(ids);
  ids.erase(std::unique(ids.begin(), ids.end()), ids.end());
  return ids;
}

std::string explanation_of(std::string_view id) {
  std::string text;
  for (const Explained& each : all_explained()) {
    if (each.id != id) continue;
    text += fmt::format("{}{}: {}\n{}  What to do:\n{}", text.empty() ? "" : "\n", id, each.what,
                        wrapped(each.text, 2), wrapped(each.advice, 4));
    if (each.can_be_allowed) {
      text += fmt::format("    batten smooth .. --allow {} lifts this rule.\n", id);
    }
  }
  return text;
}

std::string all_explanations() {
  std::string text;
  std::string_view group;
  for (const Explained& each : all_explained()) {
    if (each.group != group) text += fmt::format("{}\n", each.group);
    group = each.group;
    text += fmt::format("  {:<24} {}\n", each.id, first_sentence(each.text));
  }
  return text;
}

}  // namespace batten::postproc
