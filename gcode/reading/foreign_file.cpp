#include "gcode/reading/foreign_file.h"

#include <algorithm>

#include "gcode/text/characters.h"

namespace batten::gcode {
namespace {

using namespace std::string_view_literals;

struct FileKind {
  std::string_view begin;
  std::string_view name;
};

constexpr FileKind kFileKinds[] = {
    {"\x7f"
     "ELF"sv,
     "a program for computers (ELF)"},
    {"MZ\x90"sv, "a program for computers (EXE)"},
    {"PK\x03\x04"sv, "a ZIP archive"},
    {"\x1f\x8b"sv, "compressed by gzip"},
    {"BZh9"sv, "compressed by bzip2"},
    {"\xfd"
     "7zXZ"sv,
     "compressed by xz"},
    {"\x28\xb5\x2f\xfd"sv, "compressed by zstd"},
    {"7z\xbc\xaf"sv, "a 7z archive"},
    {"%PDF-"sv, "a PDF document"},
    {"\x89PNG"sv, "a picture (PNG)"},
    {"\xff\xd8\xff"sv, "a picture (JPEG)"},
    {"GIF8"sv, "a picture (GIF)"},
    {"ISO-10303-21;"sv, "a STEP model"},
    {"\xff\xfe"sv, "text of 16 bits per character; save it as plain text (UTF-8)"},
    {"\xfe\xff"sv, "text of 16 bits per character; save it as plain text (UTF-8)"},
    {"<"sv, "HTML or XML"},
    {"{"sv, "JSON"}};

constexpr std::size_t kSeen = std::size_t{1} << 16;  // bytes
// Of random bytes one in nine is such a character; texts that were sent over a bad line have some.
constexpr std::size_t kMostControls = 100;  // one in so many

bool is_control(char c) {
  const auto byte = static_cast<unsigned char>(c);
  const bool of_tape = byte == 0 || (byte >= 17 && byte <= 20) || byte == 26;
  const bool of_lines = byte >= 9 && byte <= 13;
  return (byte < 32 || byte == 127) && !of_tape && !of_lines;
}

}  // namespace

std::string_view foreign_kind_of(std::string_view text) {
  const std::string_view seen = text.substr(0, kSeen);
  const std::size_t first = seen.find_first_not_of("\xef\xbb\xbf \t\r\n"sv);
  if (first == std::string_view::npos) return {};
  for (const FileKind& kind : kFileKinds) {
    if (seen.starts_with(kind.begin) || seen.substr(first).starts_with(kind.begin))
      return kind.name;
  }
  const auto controls = static_cast<std::size_t>(std::ranges::count_if(seen, is_control));
  if (controls * kMostControls > seen.size()) return "binary";
  const auto is_nul_or_blank = [](char c) {
    return c == '\0' || is_blank(c) || c == '\n' || c == '\r';
  };
  if (std::ranges::all_of(seen, is_nul_or_blank)) return "NULs only";
  return {};
}

}  // namespace batten::gcode
