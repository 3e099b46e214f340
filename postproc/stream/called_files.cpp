#include "postproc/stream/called_files.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <map>
#include <optional>
#include <set>
#include <system_error>
#include <utility>

#include "gcode/interpreter/called_programs.h"
#include "gcode/reading/foreign_file.h"
#include "gcode/reading/source_kind.h"
#include "gcode/siemens/flow.h"
#include "gcode/state/source_marks.h"
#include "gcode/text/characters.h"
#include "gcode/text/line_cursor.h"
#include "gcode/text/source_parts.h"
#include "postproc/convert/conversion.h"
#include "postproc/text/words.h"

namespace batten::postproc {

namespace fs = std::filesystem;
using gcode::Language;

namespace {

constexpr std::size_t kMostFiles = 100;
constexpr std::size_t kMostBytes = std::size_t{1} << 26;
constexpr std::size_t kMostEntries = 100000;  // of the folder

// Suffixes of numbered programs, beside that of the program that calls.
constexpr std::array<std::string_view, 13> kSuffixes = {"",     ".NC",    ".NGC", ".TAP", ".CNC",
                                                        ".NCC", ".EIA",   ".ISO", ".MIN", ".PIM",
                                                        ".ANC", ".GCODE", ".SUB"};

bool is_at(std::string_view line, std::size_t at, std::string_view word) {
  return line.size() - at >= word.size() && gcode::is_same_word(line.substr(at, word.size()), word);
}

// Does M98, M198, G65 or CALL stand in it? One look at each character, for all lines of a
// program.
bool names_call(std::string_view line) {
  for (std::size_t at = 0; at < line.size(); ++at) {
    switch (line[at]) {
      case 'M':
      case 'm':
        if (is_at(line, at, "M98") || is_at(line, at, "M198")) return true;
        break;
      case 'G':
      case 'g':
        if (is_at(line, at, "G65")) return true;
        break;
      case 'C':
      case 'c':
        if (is_at(line, at, "CALL")) return true;
        break;
      default:
        break;
    }
  }
  return false;
}

// Siemens: not N10 G1 X5, which nearly all lines are.
bool may_begin_with_name(std::string_view text) {
  std::size_t at = 0;
  if (gcode::upper(text[0]) == 'N' && gcode::is_digit(gcode::char_at(text, 1))) {
    at = gcode::after_blanks(text, std::min(text.find_first_not_of("0123456789", 1), text.size()));
  }
  const char first = gcode::char_at(text, at);
  const char second = gcode::char_at(text, at + 1);
  return !gcode::is_letter(first) || gcode::upper(first) == 'L' || gcode::is_letter(second) ||
         second == '_';
}

// Can the line be a call, or name a program that stands in the same file? Quick, for all lines.
bool may_say_program(std::string_view line, Language language) {
  const std::string_view text = gcode::without_blanks_before(line);
  if (text.empty()) return false;
  if (language == Language::kSiemens) {
    return may_begin_with_name(text) && !gcode::siemens_call(text).empty();
  }
  const bool begins_program = gcode::upper(text[0]) == 'O' || text[0] == ':';
  return begins_program || names_call(text);
}

std::string call_for_people(const std::string& name) {
  if (name.starts_with('P') && name.find_first_not_of("0123456789", 1) == std::string::npos) {
    return "O" + name.substr(1);
  }
  if (name.starts_with("O")) {
    std::string text = name;
    std::ranges::transform(text, text.begin(), [](char c) {
      return gcode::is_letter(c) ? static_cast<char>(c | 0x20) : c;
    });
    return text;
  }
  return name.starts_with("PGM ") ? "CALL " + name : name;
}

class CalledFileReader {
 public:
  CalledFileReader(const fs::path& program_file, const gcode::Reading& reading)
      : program_file_(program_file), reading_(reading) {}

  CalledFiles read(const gcode::SourceText& source) {
    std::set<std::string> within;
    std::vector<std::string> calls;
    gcode::for_each_part(source, [&](gcode::SourceSpan part) {
      gcode::LineCursor lines(source.text(part));
      while (const auto line = lines.next()) {
        const std::string_view text =
            source.text(part).substr(line->begin, line->text_end - line->begin);
        if (!may_say_program(text, reading_.language)) continue;
        gcode::Diagnostics ignored;
        const gcode::Program alone =
            gcode::parse(gcode::SourceText("", std::string(text)), reading_, ignored);
        note_calls(alone, calls);
        within.merge(names_within(alone));
      }
      return true;
    });
    for (const std::string& name : calls) look_for(name, within);
    drop_what_stands_elsewhere();
    if (!programs_.empty()) {
      all_.programs = std::make_shared<const gcode::Subprograms>(std::move(programs_));
    }
    return std::move(all_);
  }

 private:
  static std::set<std::string> names_within(const gcode::Program& program) {
    const auto names = gcode::programs_within(program);
    return {names.begin(), names.end()};
  }

  static void note_calls(const gcode::Program& program, std::vector<std::string>& calls) {
    for (const gcode::Block& block : program.blocks) {
      auto call = gcode::called_program(program, block);
      if (call && std::ranges::find(calls, call->name) == calls.end()) {
        calls.push_back(std::move(call->name));
      }
    }
  }

  // With those that it calls itself.
  void look_for(const std::string& name, const std::set<std::string>& within) {
    if (within.contains(name) || !seen_.insert(name).second) return;
    CalledFile& called = all_.files.emplace_back();
    const std::size_t index = all_.files.size() - 1;
    called.call = call_for_people(name);
    const std::vector<fs::path> files = files_named(name);
    if (files.empty()) {
      called.why_not = "no file of this name stands beside the program";
    } else if (files.size() > 1) {
      called.why_not = fmt::format("{} and {} may both be it", files[0].filename().string(),
                                   files[1].filename().string());
    } else {
      called.file = files[0].filename().string();
      std::string why = read_file(name, files[0], within);
      all_.files[index].why_not = std::move(why);
    }
  }

  // Why it is not known; empty where it is.
  std::string read_file(const std::string& name, const fs::path& file,
                        const std::set<std::string>& within) {
    std::error_code error;
    if (fs::equivalent(file, program_file_, error)) return "the program calls itself";
    if (all_.watched.size() >= kMostFiles) return "too many programs are called";
    std::string message;
    all_.watched.emplace_back(file);
    const auto mapped = gcode::SourceText::map_file(file, message);
    if (!mapped) return message;
    if (all_.bytes.size() + mapped->text().size() > kMostBytes) return "the programs are too long";
    // A copy: what is changed while it is used is found by `watched`.
    const gcode::SourceText source(file.filename().string(), std::string(mapped->text()));
    all_.bytes += fmt::format("\n{} {}\n", source.name(), source.text().size());
    all_.bytes += source.text();
    gcode::Diagnostics found;
    if (const std::string_view kind = gcode::foreign_kind_of(source.text()); !kind.empty()) {
      return fmt::format("it is {}", kind);
    }
    const bool is_other = std::ranges::any_of(
        gcode::language_marks(source),
        [this](const gcode::LanguageMark& mark) { return mark.language != reading_.language; });
    if (is_other) return "it is in another language";
    gcode::Program program = gcode::parse(source, reading_, found);
    if (gcode::has_error(found)) return found.front().message;
    gcode::LatheWatch lathe;
    lathe.see(program);
    if (lathe.is_lathe()) return "it is a program for a lathe";
    std::vector<std::string> calls;
    note_calls(program, calls);
    for (const std::string& each : names_within(program)) elsewhere_.emplace(each, name);
    std::string why;
    auto sub = gcode::as_subprogram(name, std::move(program), why);
    if (!sub) return why;
    programs_.push_back(std::move(*sub));
    for (const std::string& each : calls) look_for(each, within);
    return "";
  }

  // A name that another file defines, too, is that one or this one.
  void drop_what_stands_elsewhere() {
    std::erase_if(programs_, [this](const gcode::Subprogram& sub) {
      const auto [first, last] = elsewhere_.equal_range(sub.name);
      const bool drops = std::any_of(
          first, last, [&sub](const auto& defined) { return defined.second != sub.name; });
      const auto file = std::ranges::find(all_.files, call_for_people(sub.name), &CalledFile::call);
      if (drops && file != all_.files.end()) file->why_not = "another file holds this program, too";
      return drops;
    });
  }

  std::vector<fs::path> files_named(const std::string& name) {
    std::vector<fs::path> found;
    for (const auto& [stem, file] : entries()) {
      const std::string suffix = gcode::in_capitals(file.extension().string());
      if (is_file_of(name, stem, suffix)) found.push_back(file);
    }
    std::ranges::sort(found);
    return found;
  }

  [[nodiscard]] bool is_file_of(const std::string& name, const std::string& stem,
                                const std::string& suffix) const {
    const std::string own = gcode::in_capitals(program_file_.extension().string());
    switch (reading_.language) {
      case Language::kKlartext:
        return suffix == ".H" && "PGM " + stem == name;
      case Language::kSiemens:
        return (suffix == ".SPF" || suffix == ".MPF") && stem == name;
      default:
        break;
    }
    if (name.starts_with('O')) {
      const bool named = name == "O<" + stem + ">" || name == "O" + stem;
      return named && (suffix == ".NGC" || suffix == own);
    }
    std::string_view digits = stem;
    if (digits.starts_with('O')) digits.remove_prefix(1);
    if (digits.empty() || digits.find_first_not_of("0123456789") != std::string_view::npos) {
      return false;
    }
    digits.remove_prefix(std::min(digits.find_first_not_of('0'), digits.size() - 1));
    return name.substr(1) == digits &&
           (suffix == own || std::ranges::find(kSuffixes, suffix) != kSuffixes.end());
  }

  // Files of the folder by their names without suffix, in capitals.
  const std::multimap<std::string, fs::path>& entries() {
    if (entries_) return *entries_;
    entries_.emplace();
    std::error_code error;
    const fs::path folder =
        program_file_.has_parent_path() ? program_file_.parent_path() : fs::path(".");
    for (fs::directory_iterator at(folder, error), end; !error && at != end; at.increment(error)) {
      if (entries_->size() >= kMostEntries) break;
      if (!at->is_regular_file(error)) continue;
      entries_->emplace(gcode::in_capitals(at->path().stem().string()), at->path());
    }
    return *entries_;
  }

  const fs::path& program_file_;
  const gcode::Reading& reading_;
  CalledFiles all_;
  std::vector<gcode::Subprogram> programs_;
  std::set<std::string> seen_;
  std::multimap<std::string, std::string> elsewhere_;  // a program, and whose file holds it
  std::optional<std::multimap<std::string, fs::path>> entries_;
};

}  // namespace

CalledFiles read_called_files(const gcode::SourceText& source, const fs::path& program_file,
                              const gcode::Reading& reading) {
  if (program_file == "-" || program_file.empty()) return {};
  return CalledFileReader(program_file, reading).read(source);
}

CalledFiles read_called_files(const gcode::SourceText& source, const fs::path& program_file,
                              SmoothOptions& options) {
  if (is_to_be_translated(source, options)) return {};
  gcode::Diagnostics ignored;
  const auto language =
      gcode::source_language(source, options.source, options.target->language, ignored);
  if (!language) return {};
  CalledFiles called = read_called_files(source, program_file, reading_of(options, *language));
  options.subprograms = called.programs;
  return called;
}

std::string text_of(const std::vector<CalledFile>& files) {
  constexpr std::size_t kMostLines = 8;
  std::string lines;
  std::string_view title = "calls";
  for (const CalledFile& called : files) {
    if (&called - files.data() >= static_cast<std::ptrdiff_t>(kMostLines)) {
      lines += titled("", fmt::format("{} more, see --json", files.size() - kMostLines));
      break;
    }
    const std::string what =
        called.why_not.empty() ? called.file + " was read: what it leaves is known behind its calls"
        : called.file.empty()  ? called.why_not
                               : called.file + " says nothing: " + called.why_not;
    lines += titled(std::exchange(title, ""), fmt::format("{}: {}", called.call, what));
  }
  return lines;
}

}  // namespace batten::postproc
