#include "gcode/reading/target_marks.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <optional>

#include "gcode/controls/built_in.h"
#include "gcode/reading/parser.h"
#include "gcode/reading/source_kind.h"
#include "gcode/text/characters.h"

namespace batten::gcode {
namespace {

constexpr std::size_t kHead = std::size_t{1} << 16;  // bytes

using Names = std::array<std::string_view, 3>;

// A post of FreeCAD by the name that it writes into the header.
struct PostRow {
  std::string_view post;
  bool is_certain;  // the first target, that is
  Names targets;
};
constexpr std::array kPosts = {
    PostRow{"LINUXCNC_POST", true, {"linuxcnc"}},
    PostRow{"GRBL_POST", true, {"grbl"}},
    PostRow{"JTECH_POST", true, {"grbl"}},
    PostRow{"MARLIN_POST", true, {"marlin"}},
    PostRow{"RRF_POST", true, {"reprapfirmware"}},
    PostRow{"SMOOTHIE_POST", true, {"smoothieware"}},
    PostRow{"MACH3_MACH4_POST", true, {"mach3"}},  // mach4 takes the same
    PostRow{"UCCNC_POST", true, {"uccnc"}},
    PostRow{"CENTROID_POST", true, {"centroid"}},
    // Used for many controls of this kind.
    PostRow{"FANUC_POST", false, {"fanuc", "haas", "mazak"}},
    PostRow{"PHILIPS_POST", false, {"fanuc", "haas", "mazak"}},
    PostRow{"DYNAPATH_POST", false, {"fanuc", "haas", "mazak"}},
    PostRow{"KINETICNCBEAMICON2_POST", false, {"linuxcnc", "edingcnc", "mach3"}},
};

// Words that only some controls have, from the rarest on.
struct MarkRow {
  SourceMark mark;
  Names likely;
};
constexpr std::array kMarks = {
    MarkRow{SourceMark::kHaasSmoothness, {"haas"}},
    MarkRow{SourceMark::kSuperNurbs, {"okuma"}},
    MarkRow{SourceMark::kHashCommand, {"beckhoff", "fagor"}},
    MarkRow{SourceMark::kHeaterWords, {"marlin", "klipper", "reprapfirmware"}},
    MarkRow{SourceMark::kUniformNurbs, {"linuxcnc", "planetcnc"}},
    MarkRow{SourceMark::kSubWords, {"linuxcnc", "grblhal", "fluidnc"}},
    MarkRow{SourceMark::kNamedParameters, {"linuxcnc", "grblhal", "fluidnc"}},
    MarkRow{SourceMark::kBlendTolerance, {"linuxcnc", "edingcnc", "planetcnc"}},
    MarkRow{SourceMark::kHighSpeedMode, {"fanuc", "mitsubishi", "syntec"}},
    MarkRow{SourceMark::kMacroFlow, {"fanuc", "haas", "mazak"}},
    MarkRow{SourceMark::kDollarLine, {"grbl", "grblhal", "fluidnc"}},
};

// The end of a file's name, where nothing in it speaks for a control.
struct SuffixRow {
  std::string_view suffix;
  Names likely;
};
constexpr std::array kSuffixes = {
    SuffixRow{".NGC", {"linuxcnc"}},       SuffixRow{".MPF", {"siemens"}},
    SuffixRow{".SPF", {"siemens"}},        SuffixRow{".H", {"heidenhain"}},
    SuffixRow{".MIN", {"okuma"}},          SuffixRow{".EIA", {"mazak"}},
    SuffixRow{".TAP", {"mach3", "mach4"}},
};

constexpr Names kOfTape = {"fanuc", "haas", "mazak"};  // % and a program's number
constexpr Names kOfRouters = {"grbl", "linuxcnc", "mach3"};

void add(const Names& names, std::vector<std::string_view>& likely) {
  for (const std::string_view name : names) {
    const bool full = likely.size() == names.size();
    if (!full && !name.empty() && std::ranges::count(likely, name) == 0) likely.push_back(name);
  }
}

// A text in capitals has the word, with nothing of a word on either side.
bool has_word(std::string_view text, std::string_view word) {
  for (std::size_t at = text.find(word); at != std::string_view::npos;
       at = text.find(word, at + 1)) {
    const bool begins = at == 0 || !is_name_character(text[at - 1]);
    if (begins && !is_name_character(char_at(text, at + word.size()))) return true;
  }
  return false;
}

std::string quoted(std::string_view line) {
  constexpr std::size_t kMost = 60;
  std::string text(line.substr(0, kMost));
  std::ranges::replace_if(
      text, [](char c) { return static_cast<unsigned char>(c) < ' '; }, ' ');
  return text;
}

// The text of a comment of its own line in capitals, and nothing for others.
std::string comment_in(const Program& program, const Block& block) {
  if (block.comment_count == 0) return {};
  return in_capitals(program.source.text(program.comments_of(block).front().span));
}

void look_at_comments(const Program& program, TargetMarks& found) {
  constexpr std::string_view kPost = "POST PROCESSOR:";
  for (const Block& block : program.blocks) {
    const std::string comment = comment_in(program, block);
    if (comment.find(kPost) != std::string::npos) {
      // Newer posts of the same name begin with REFACTORED_.
      const std::string name = comment.substr(comment.find(kPost) + kPost.size());
      for (const PostRow& row : kPosts) {
        if (!has_word(name, row.post) && !has_word(name, fmt::format("REFACTORED_{}", row.post))) {
          continue;
        }
        found.evidence =
            fmt::format("line {} says {}", block.line, quoted(program.source.text(block.span)));
        if (row.is_certain) found.target = row.targets.front();
        add(row.targets, found.likely);
        return;
      }
    }
    for (const Control& control : controls()) {
      if (!found.likely.empty() || comment.empty()) break;
      if (!has_word(comment, in_capitals(control.name))) continue;
      found.evidence =
          fmt::format("line {} says {}", block.line, quoted(program.source.text(block.span)));
      found.likely.push_back(control.name);
    }
  }
}

}  // namespace

TargetMarks target_marks(const SourceText& source) {
  std::string_view text = source.text().substr(0, kHead);
  if (text.size() < source.text().size()) text = text.substr(0, text.rfind('\n') + 1);
  const SourceText head(source.name(), std::string(text));
  TargetMarks found;
  if (const auto marks = language_marks(head); !marks.empty()) {
    const bool klartext = marks.front().language == Language::kKlartext;
    found.evidence = fmt::format("line {} has {}", head.place_of(marks.front().where.begin).line,
                                 marks.front().evidence);
    found.likely = klartext ? std::vector<std::string_view>{"heidenhain", "itnc530"}
                            : std::vector<std::string_view>{"siemens"};
    if (marks.size() == 1) found.target = found.likely.front();
    return found;
  }
  Diagnostics ignored;
  const Program program = parse(head, ignored);
  look_at_comments(program, found);
  if (!found.target.empty()) return found;
  const auto all = source_marks(program);
  for (const MarkRow& row : kMarks) {
    const auto mark = std::ranges::find(all, row.mark, &FoundMark::mark);
    if (mark == all.end()) continue;
    if (found.evidence.empty()) {
      found.evidence =
          fmt::format("line {} has {}", head.place_of(mark->where.begin).line, describe(row.mark));
    }
    add(row.likely, found.likely);
  }
  const std::string name = in_capitals(source.name());
  for (const SuffixRow& row : kSuffixes) {
    if (name.ends_with(row.suffix)) add(row.likely, found.likely);
  }
  const bool of_tape = std::ranges::any_of(program.blocks, [](const Block& block) {
    return block.opacity == ParseStatus::kProgramMark;
  });
  add(of_tape ? kOfTape : kOfRouters, found.likely);
  return found;
}

}  // namespace batten::gcode
