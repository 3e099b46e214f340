#include "gcode/reading/foreign_file.h"

#include <algorithm>

#include "gcode/text/characters.h"
#include "gcode/text/line_cursor.h"

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

// M2,5.0,3.0 · JZ,5 · MS,40,20 · CG,..: a letter, another character, a comma. No G-code has a comma
// behind a word that short, but before R, C and A.
bool is_shopbot(std::string_view line) {
  const char first = upper(char_at(line, 0));
  const char second = upper(char_at(line, 1));
  const bool moves =
      (first == 'M' || first == 'J') && "XYZAB2345S"sv.find(second) != std::string_view::npos;
  const bool arc = first == 'C' && second == 'G';
  const char value = char_at(line, 3);
  return (moves || arc) && char_at(line, 2) == ',' &&
         (is_digit(value) || value == '-' || value == '.' || value == ',');
}

// PD400,-20; · PU; · Z0,40,-12; · !MC1;
bool is_plotter(std::string_view line) {
  if (line.starts_with("!MC") || line.starts_with("PA;") || line.starts_with("PU;")) return true;
  const bool moves = line.starts_with("PD") || line.starts_with("PU");
  const std::string_view values = line.substr(moves ? 2 : line.starts_with('Z') ? 1 : line.size());
  return values.find(',') != std::string_view::npos &&
         values.find_first_not_of("0123456789-,;") == std::string_view::npos;
}

// Pairs of lines: a code and its value. 999 is a comment; 0 and SECTION begin the drawing.
bool is_drawing(std::string_view text) {
  LineCursor lines(text);
  const auto next = [&]() -> std::string_view {
    const auto line = lines.next();
    if (!line) return {};
    std::string_view bare =
        without_blanks_before(text.substr(line->begin, line->text_end - line->begin));
    while (!bare.empty() && is_blank(bare.back())) bare.remove_suffix(1);
    return bare;
  };
  std::string_view code = next();
  while (code == "999") {
    (void)next();
    code = next();
  }
  return code == "0" && next() == "SECTION";
}

bool is_gcode(std::string_view line) {
  const char first = upper(char_at(line, 0));
  return (first == 'G' || first == 'N') && is_digit(char_at(line, 1));
}

// What programs of machines with a language of their own are, by their lines.
std::string_view other_language_of(std::string_view text) {
  constexpr std::size_t kEnough = 3;
  std::size_t shopbot = 0;
  std::size_t plotter = 0;
  LineCursor lines(text);
  while (const auto bounds = lines.next()) {
    const std::string_view line =
        without_blanks_before(text.substr(bounds->begin, bounds->text_end - bounds->begin));
    if (is_gcode(line)) return {};
    if (is_shopbot(line)) ++shopbot;
    if (is_plotter(line)) ++plotter;
  }
  if (shopbot >= kEnough) return "in the language of ShopBot (OpenSBP); post it as G-code";
  if (plotter >= kEnough) return "in the language of plotters (RML, HPGL); post it as G-code";
  return {};
}

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
  return is_drawing(seen.substr(first)) ? "a drawing (DXF)" : other_language_of(seen);
}

}  // namespace batten::gcode
