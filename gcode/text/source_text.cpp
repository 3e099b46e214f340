#include "gcode/text/source_text.h"

#include <fcntl.h>
#include <sys/mman.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstring>
#include <limits>
#include <mutex>
#include <stdexcept>
#include <utility>

#include "gcode/text/line_cursor.h"

namespace batten::gcode {
namespace {

// Bytes: Linux maps 64 KiB about the page that is asked for, or what the disk gives at once.
constexpr std::size_t kReadAround = std::size_t{1} << 20;

// Positions are 32 bit numbers, and the one after the last byte is one too.
constexpr std::size_t kMostBytes = std::numeric_limits<std::uint32_t>::max();

std::string system_message(const std::string& name) { return name + ": " + std::strerror(errno); }

std::string too_large(const std::string& name) {
  return name + ": larger than 4 GiB, which is the most that one program may be";
}

// Pipes and devices have no size and cannot be mapped. False on an error or above 4 GiB,
// with `error` set. A signal with a handler is an error: who waits for a pipe can be ended.
bool read_all(int descriptor, const std::string& name, std::string& text, std::string& error) {
  std::array<char, 1 << 16> part{};
  for (;;) {
    const ssize_t count = ::read(descriptor, part.data(), part.size());
    if (count == 0) return true;
    if (count < 0) {
      error = system_message(name);
      return false;
    }
    text.append(part.data(), static_cast<std::size_t>(count));
    if (text.size() > kMostBytes) {
      error = too_large(name);
      return false;
    }
  }
}

// Lines between two that the table of lines knows: the table of a long text stays small.
constexpr std::size_t kLinesApart = 64;

// The begins of the lines 1, 1 + kLinesApart ..
std::vector<std::uint32_t> line_begins(std::string_view text) {
  std::vector<std::uint32_t> begins = {0};
  std::size_t ends = 0;
  LineCursor lines(text);
  while (const auto line = lines.next()) {
    if (line->end > line->text_end && ++ends % kLinesApart == 0) begins.push_back(line->end);
  }
  return begins;
}

}  // namespace

struct SourceText::Bytes {
  // Made when a position is first asked for: most programs have nothing to complain about.
  const std::vector<std::uint32_t>& lines() const {
    std::call_once(lines_made, [this] { line_table = line_begins(text); });
    return line_table;
  }

  std::string name;
  std::string owned;
  std::shared_ptr<char> mapped;  // the file, if it is
  std::string_view text;         // of either
  mutable std::once_flag lines_made;
  mutable std::vector<std::uint32_t> line_table;
};

SourceText::SourceText(std::string name, std::string text) {
  if (text.size() > kMostBytes) throw std::length_error(too_large(name));
  const auto bytes = std::make_shared<Bytes>();
  bytes->name = std::move(name);
  bytes->owned = std::move(text);
  bytes->text = bytes->owned;
  bytes_ = bytes;
}

std::optional<SourceText> SourceText::map_file(const std::filesystem::path& file,
                                               std::string& error, std::string name) {
  if (name.empty()) name = file.string();
  const int descriptor = ::open(file.c_str(), O_RDONLY | O_CLOEXEC);
  struct stat status {};
  if (descriptor < 0) {
    error = system_message(name);
    return std::nullopt;
  }
  const std::shared_ptr<void> closes(nullptr, [descriptor](void*) { ::close(descriptor); });
  if (::fstat(descriptor, &status) != 0) {
    error = system_message(name);
    return std::nullopt;
  }
  if (!S_ISREG(status.st_mode) || status.st_size == 0) {
    std::string text;
    if (!read_all(descriptor, name, text, error)) return std::nullopt;
    return SourceText(std::move(name), std::move(text));
  }
  const auto size = static_cast<std::size_t>(status.st_size);
  if (size > kMostBytes) {
    error = too_large(name);
    return std::nullopt;
  }
  void* const address = ::mmap(nullptr, size, PROT_READ, MAP_PRIVATE, descriptor, 0);
  if (address == MAP_FAILED) {
    error = system_message(name);
    return std::nullopt;
  }
  SourceText source(std::move(name), std::string());
  const auto bytes = std::make_shared<Bytes>();
  bytes->name = source.name();
  bytes->mapped = {static_cast<char*>(address), [size](char* begin) { ::munmap(begin, size); }};
  bytes->text = {bytes->mapped.get(), size};
  source.bytes_ = bytes;
  return source;
}

const std::string& SourceText::name() const { return bytes_->name; }

std::string_view SourceText::text() const { return bytes_->text; }

std::string_view SourceText::text(SourceSpan span) const {
  return bytes_->text.substr(span.begin, span.size());
}

void SourceText::release_pages(SourceSpan span) const {
  if (bytes_->mapped == nullptr) return;
  // A mapping begins with a page. Who reads the first byte of a span is given pages before it too.
  const auto page = static_cast<std::size_t>(::sysconf(_SC_PAGESIZE));
  const std::size_t begin =
      (span.begin - std::min<std::size_t>(span.begin, kReadAround)) / page * page;
  const std::size_t end = std::min<std::size_t>(span.end, bytes_->text.size()) / page * page;
  // What the system does with the advice changes no byte.
  if (begin < end) (void)::madvise(bytes_->mapped.get() + begin, end - begin, MADV_DONTNEED);
}

SourcePlace SourceText::place_of(std::uint32_t offset) const {
  const std::vector<std::uint32_t>& begins = bytes_->lines();
  const auto after = std::upper_bound(begins.begin(), begins.end(), offset);
  auto line = static_cast<std::uint32_t>((after - begins.begin() - 1) * kLinesApart + 1);
  std::uint32_t begin = *(after - 1);
  LineCursor lines(bytes_->text, begin);
  for (auto next = lines.next(); next && next->end > next->text_end && next->end <= offset;
       next = lines.next()) {
    begin = next->end;
    ++line;
  }
  return {line, offset - begin + 1};
}

}  // namespace batten::gcode
