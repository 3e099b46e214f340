#include "postproc/machine/files/ini_file.h"

#include <fmt/format.h>

#include <algorithm>
#include <filesystem>

#include "gcode/text/source_text.h"

namespace batten::postproc {

namespace {

constexpr std::string_view kInclude = "#INCLUDE";

std::string_view without_blanks(std::string_view text) {
  constexpr std::string_view kBlanks = " \t\r";
  const std::size_t first = text.find_first_not_of(kBlanks);
  if (first == std::string_view::npos) return {};
  return text.substr(first, text.find_last_not_of(kBlanks) - first + 1);
}

class Reader {
 public:
  Reader(std::vector<IniEntry>& entries, std::vector<std::string>& sections,
         std::vector<std::string>& problems)
      : entries_(entries), sections_(sections), problems_(problems) {}

  void read(const std::string& file, bool may_include) {
    std::string error;
    const auto source = gcode::SourceText::map_file(file, error);
    if (!source) {
      problems_.push_back(error);
      return;
    }
    std::string_view rest = source->text();
    for (std::size_t number = 1; !rest.empty(); ++number) {
      const std::size_t end = rest.find('\n');
      read_line(rest.substr(0, end), file, number, may_include);
      if (end == std::string_view::npos) break;
      rest.remove_prefix(end + 1);
    }
  }

 private:
  void read_line(std::string_view line, const std::string& file, std::size_t number,
                 bool may_include) {
    const std::string_view text = without_blanks(line);
    if (may_include && text.starts_with(kInclude)) {
      include(without_blanks(text.substr(kInclude.size())), file, number);
      return;
    }
    if (text.empty() || text.front() == '#' || text.front() == ';') return;
    if (text.front() == '[') {
      section_ = std::string(text.substr(1, text.find(']') - 1));
      sections_.push_back(section_);
      return;
    }
    const std::size_t equals = text.find('=');
    if (equals == std::string_view::npos) return;
    const std::string_view value = without_blanks(text.substr(equals + 1));
    if (value.empty()) return;
    entries_.push_back({section_, std::string(without_blanks(text.substr(0, equals))),
                        std::string(value), file, number,
                        static_cast<std::size_t>(value.data() - line.data()) + 1});
  }

  void include(std::string_view name, const std::string& by, std::size_t line) {
    const std::filesystem::path file = std::filesystem::path(by).parent_path() / name;
    std::error_code error;
    if (name.empty() || !std::filesystem::is_regular_file(file, error)) {
      problems_.push_back(fmt::format("{}:{}: #INCLUDE: there is no file '{}'", by, line, name));
      return;
    }
    read(file.string(), false);
  }

  std::vector<IniEntry>& entries_;
  std::vector<std::string>& sections_;
  std::vector<std::string>& problems_;
  std::string section_;
};

}  // namespace

std::optional<IniFile> IniFile::read(const std::string& file, std::vector<std::string>& problems) {
  const std::size_t problems_before = problems.size();
  IniFile ini;
  Reader(ini.entries_, ini.sections_, problems).read(file, true);
  if (problems.size() > problems_before) return std::nullopt;
  return ini;
}

const IniEntry* IniFile::find(std::string_view section, std::string_view key) const {
  const auto found = std::ranges::find_if(entries_, [&](const IniEntry& entry) {
    return entry.section == section && entry.key == key;
  });
  return found == entries_.end() ? nullptr : &*found;
}

bool IniFile::has_section(std::string_view section) const {
  return std::ranges::find(sections_, section) != sections_.end();
}

}  // namespace batten::postproc
