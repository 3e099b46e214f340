// The bytes of a program, and the line and column of each.
#pragma once

#include <cstdint>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <string_view>

namespace batten::gcode {

// A range of bytes of the source: [begin, end[.
struct SourceSpan {
  std::uint32_t begin = 0;
  std::uint32_t end = 0;
  [[nodiscard]] std::uint32_t size() const { return end - begin; }
};

// Line and column count from 1; the column counts bytes.
struct SourcePlace {
  std::uint32_t line = 1;
  std::uint32_t column = 1;
};

// The whole text, unchanged: any bytes, any line ends. Cheap to copy (shares the bytes).
class SourceText {
 public:
  // `name`: for messages, a file name, or "<stdin>".
  SourceText(std::string name, std::string text);

  // Maps the file read-only. On failure returns nothing and sets `error` to a message with
  // the file name and the reason of the operating system. Files above 4 GiB are refused.
  // `name`: for messages; empty: that of the file.
  [[nodiscard]] static std::optional<SourceText> map_file(const std::filesystem::path& file,
                                                          std::string& error,
                                                          std::string name = {});

  [[nodiscard]] const std::string& name() const;
  [[nodiscard]] std::string_view text() const;
  [[nodiscard]] std::string_view text(SourceSpan span) const;

  // These bytes will not be read for a while: a mapped file then takes no memory for them. They may
  // be read again, which costs time only.
  void release_pages(SourceSpan span) const;

  // Logarithmic in the number of lines. A line ends after LF, or after a CR that no LF follows.
  [[nodiscard]] SourcePlace place_of(std::uint32_t offset) const;

 private:
  struct Bytes;
  std::shared_ptr<const Bytes> bytes_;
};

}  // namespace batten::gcode
