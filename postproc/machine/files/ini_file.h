// INI files as LinuxCNC reads them: [SECTION] lines, KEY = VALUE lines, comments from # or ; at the
// beginning of a line, and `#INCLUDE FILE` lines, whose files stand in their place (and include no
// further ones). Sections and keys keep their case; of two values the first counts.
#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace batten::postproc {

struct IniEntry {
  std::string section;
  std::string key;
  std::string value;  // without blanks around it
  std::string file;
  std::size_t line = 0;    // from 1
  std::size_t column = 0;  // of the value, from 1
};

class IniFile {
 public:
  // Adds to `problems` what could not be read, with file and line, and returns nothing then.
  [[nodiscard]] static std::optional<IniFile> read(const std::string& file,
                                                   std::vector<std::string>& problems);

  // Null when there is none.
  [[nodiscard]] const IniEntry* find(std::string_view section, std::string_view key) const;
  [[nodiscard]] bool has_section(std::string_view section) const;

 private:
  std::vector<IniEntry> entries_;
  std::vector<std::string> sections_;
};

}  // namespace batten::postproc
