#include "postproc/system/spool_file.h"

#include <fcntl.h>
#include <unistd.h>

#include <cerrno>
#include <cstdlib>
#include <filesystem>
#include <system_error>
#include <utility>
#include <vector>

namespace batten::postproc {

namespace {

constexpr std::size_t kPartBytes = std::size_t{1} << 20;

std::string reason(int error) { return std::generic_category().message(error); }

}  // namespace

std::optional<SpoolFile> SpoolFile::make(std::string& error) {
  std::error_code no_folder;
  std::filesystem::path folder = std::filesystem::temp_directory_path(no_folder);
  if (no_folder) folder = "/tmp";
  std::string name = (folder / "batten-XXXXXX").string();
  const int descriptor = ::mkostemp(name.data(), O_CLOEXEC);
  if (descriptor < 0) {
    error = folder.string() + ": no temporary file can be made: " + reason(errno);
    return std::nullopt;
  }
  ::unlink(name.c_str());
  return SpoolFile(descriptor);
}

SpoolFile::SpoolFile(SpoolFile&& other) noexcept
    : descriptor_(std::exchange(other.descriptor_, -1)), error_(std::move(other.error_)) {}

SpoolFile::~SpoolFile() {
  if (descriptor_ >= 0) ::close(descriptor_);
}

bool SpoolFile::append(std::string_view bytes) {
  const WriteResult result = write_to_descriptor(descriptor_, "temporary file", bytes);
  if (result.status == WriteStatus::kWritten) return true;
  error_ = result.message;
  return false;
}

bool SpoolFile::restart() {
  const bool empty = ::ftruncate(descriptor_, 0) == 0 && ::lseek(descriptor_, 0, SEEK_SET) == 0;
  if (!empty) error_ = std::string("a temporary file cannot be emptied: ") + std::strerror(errno);
  return empty;
}

void SpoolFile::write_to(const PartWriter& writer) const {
  std::vector<char> part(kPartBytes);
  off_t at = 0;
  for (;;) {
    const ssize_t count = ::pread(descriptor_, part.data(), part.size(), at);
    if (count < 0 && errno == EINTR) continue;
    if (count <= 0 || !writer({part.data(), static_cast<std::size_t>(count)})) return;
    at += count;
  }
}

std::optional<gcode::SourceText> SpoolFile::as_text(const std::string& name) {
  const std::string path = "/proc/self/fd/" + std::to_string(descriptor_);
  return gcode::SourceText::map_file(path, error_, name);
}

}  // namespace batten::postproc
