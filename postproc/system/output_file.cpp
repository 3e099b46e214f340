#include "postproc/system/output_file.h"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <climits>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <system_error>
#include <utility>
#include <vector>

#include "postproc/system/interrupt.h"

namespace batten::postproc {

namespace fs = std::filesystem;

namespace {

// Bytes between two questions to `stop`: some milliseconds on a slow disk.
constexpr std::size_t kPartSize = std::size_t{1} << 20;

// As many links one after the other as Linux itself follows.
constexpr int kMostLinks = 40;

constexpr mode_t kPermissionBits = 07777;

WriteResult failed(const fs::path& file, std::string_view what, int error) {
  return {WriteStatus::kFailed,
          file.string() + ": " + std::string(what) + ": " + std::generic_category().message(error)};
}

// A file that is removed at the end of its life unless it was renamed to its target.
class HalfWrittenFile {
 public:
  explicit HalfWrittenFile(fs::path path) : path_(std::move(path)) {
    remove_when_killed(path_.c_str());
  }
  HalfWrittenFile(const HalfWrittenFile&) = delete;
  HalfWrittenFile& operator=(const HalfWrittenFile&) = delete;
  ~HalfWrittenFile() {
    if (!renamed_) ::unlink(path_.c_str());
    remove_when_killed("");
  }

  [[nodiscard]] const fs::path& path() const { return path_; }
  void is_renamed() { renamed_ = true; }

 private:
  fs::path path_;
  bool renamed_ = false;
};

fs::path follow_links(fs::path path) {
  for (int i = 0; i < kMostLinks; ++i) {
    std::error_code error;
    const fs::path next = fs::read_symlink(path, error);
    if (error) break;  // no link, or nothing there
    path = next.is_absolute() ? next : path.parent_path() / next;
  }
  return path;
}

fs::path folder_of(const fs::path& file) {
  return file.has_parent_path() ? file.parent_path() : fs::path(".");
}

// A name that is nearly as long as a name may be is cut.
fs::path half_written_path(const fs::path& target) {
  const std::string end = "." + std::to_string(::getpid()) + ".batten-part";
  return folder_of(target) /
         ("." + target.filename().string().substr(0, NAME_MAX - 1 - end.size()) + end);
}

bool begins_anew(int descriptor) {
  return ::ftruncate(descriptor, 0) == 0 && ::lseek(descriptor, 0, SEEK_SET) == 0;
}

WriteResult exists_already(const fs::path& target) {
  return {WriteStatus::kExists,
          target.string() + ": exists already and was left as it is; --force replaces it"};
}

WriteResult write_in_place(const fs::path& target, const WriteRequest& request) {
  const Descriptor file(::open(target.c_str(), O_WRONLY | O_CLOEXEC));
  // A pipe is opened when its reader has come; a signal ends the waiting.
  const int error = errno;
  if (!file.is_open() && error == EINTR && request.stop && request.stop()) {
    return {WriteStatus::kInterrupted, target.string() + ": interrupted"};
  }
  if (!file.is_open()) return failed(target, "cannot be opened for writing", error);
  return write_request_to_descriptor(file.number(), target.string(), request);
}

// Renames without replacing where that is asked, in one step where the file system can do so.
int rename_to_target(const fs::path& from, const fs::path& target, bool replace_existing) {
  if (replace_existing) return ::rename(from.c_str(), target.c_str());
  const int result =
      ::renameat2(AT_FDCWD, from.c_str(), AT_FDCWD, target.c_str(), RENAME_NOREPLACE);
  if (result == 0 || (errno != EINVAL && errno != ENOSYS)) return result;
  if (::access(target.c_str(), F_OK) == 0) {
    errno = EEXIST;
    return -1;
  }
  return ::rename(from.c_str(), target.c_str());
}

// The rename itself must reach the disk. Folders on some file systems cannot be flushed; the
// file is written then all the same.
void flush_folder(const fs::path& folder) {
  const Descriptor descriptor(::open(folder.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC));
  if (descriptor.is_open()) ::fsync(descriptor.number());
}

WriteResult write_beside_and_rename(const fs::path& target, const struct stat* existing,
                                    const WriteRequest& request) {
  const fs::path beside = half_written_path(target);
  Descriptor file(::open(beside.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC, 0666));
  if (!file.is_open()) {
    return failed(target, "a new file cannot be made in " + folder_of(target).string(), errno);
  }
  HalfWrittenFile half_written(beside);

  if (existing != nullptr) {
    // Owner first: changing it clears permission bits. Only root may give files away; the file
    // then is the user's own.
    if (::fchown(file.number(), existing->st_uid, existing->st_gid) != 0) errno = 0;
    if (::fchmod(file.number(), existing->st_mode & kPermissionBits) != 0) {
      return failed(target, "its permissions cannot be kept", errno);
    }
  }
  WriteResult result = write_request_to_descriptor(file.number(), target.string(), request);
  if (result.status != WriteStatus::kWritten) return result;
  if (::fsync(file.number()) != 0) return failed(target, "cannot be flushed to the disk", errno);
  if (!file.close_now()) return failed(target, "cannot be closed", errno);
  if (request.stop && request.stop()) {
    return {WriteStatus::kInterrupted, target.string() + ": interrupted, nothing was written"};
  }
  if (std::string objection = request.objection ? request.objection() : ""; !objection.empty()) {
    return {WriteStatus::kFailed, std::move(objection)};
  }
  if (rename_to_target(half_written.path(), target, request.replace_existing) != 0) {
    if (errno == EEXIST) return exists_already(target);
    return failed(target, "cannot be replaced", errno);
  }
  half_written.is_renamed();
  flush_folder(folder_of(target));
  return result;
}

}  // namespace

fs::path default_output_path(const fs::path& input) {
  fs::path name = input.stem();
  name += ".smooth";
  name += input.extension();
  return input.parent_path() / name;
}

bool same_file(const fs::path& one, const fs::path& other) {
  std::error_code error;
  if (fs::equivalent(one, other, error)) return true;
  const fs::path first = fs::weakly_canonical(follow_links(one), error);
  if (error) return false;
  const fs::path second = fs::weakly_canonical(follow_links(other), error);
  return !error && first == second;
}

WriteResult write_file(const WriteRequest& request) {
  const fs::path target = follow_links(request.target);
  struct stat existing = {};
  const bool exists = ::stat(target.c_str(), &existing) == 0;
  if (!exists && errno != ENOENT) return failed(target, "cannot be written", errno);
  if (exists && S_ISDIR(existing.st_mode)) return failed(target, "cannot be written", EISDIR);
  if (exists && !S_ISREG(existing.st_mode)) return write_in_place(target, request);
  if (exists && !request.replace_existing) return exists_already(target);
  return write_beside_and_rename(target, exists ? &existing : nullptr, request);
}

WriteResult write_request_to_descriptor(int descriptor, std::string_view name,
                                        const WriteRequest& request) {
  if (!request.parts) return write_to_descriptor(descriptor, name, request.bytes, request.stop);
  WriteResult result;
  const auto write = [&](std::string_view part) {
    if (result.status == WriteStatus::kWritten) {
      result = write_to_descriptor(descriptor, name, part, request.stop);
    }
    return result.status == WriteStatus::kWritten;
  };
  const auto restart = [&] {
    return result.status == WriteStatus::kWritten && begins_anew(descriptor);
  };
  request.parts({write, restart});
  return result;
}

WriteResult write_to_descriptor(int descriptor, std::string_view name, std::string_view bytes,
                                const std::function<bool()>& stop) {
  while (!bytes.empty()) {
    if (stop && stop()) {
      return {WriteStatus::kInterrupted, std::string(name) + ": interrupted"};
    }
    const ssize_t written = ::write(descriptor, bytes.data(), std::min(bytes.size(), kPartSize));
    if (written < 0 && errno == EINTR) continue;
    if (written < 0) return failed(fs::path(name), "cannot be written", errno);
    bytes.remove_prefix(static_cast<std::size_t>(written));
  }
  return {};
}

bool Descriptor::close_now() {
  const int number = std::exchange(number_, -1);
  return number < 0 || ::close(number) == 0;
}

std::optional<SpoolFile> SpoolFile::make(std::string& error) {
  std::error_code no_folder;
  std::filesystem::path folder = std::filesystem::temp_directory_path(no_folder);
  if (no_folder) folder = "/tmp";
  std::string name = (folder / "batten-XXXXXX").string();
  Descriptor file(::mkostemp(name.data(), O_CLOEXEC));
  if (!file.is_open()) {
    error = failed(folder, "no temporary file can be made", errno).message;
    return std::nullopt;
  }
  ::unlink(name.c_str());
  return SpoolFile(std::move(file));
}

bool SpoolFile::append(std::string_view bytes) {
  const WriteResult result = write_to_descriptor(file_.number(), "temporary file", bytes);
  if (result.status == WriteStatus::kWritten) return true;
  error_ = result.message;
  return false;
}

bool SpoolFile::restart() {
  const bool empty = begins_anew(file_.number());
  if (!empty) error_ = std::string("a temporary file cannot be emptied: ") + std::strerror(errno);
  return empty;
}

void SpoolFile::write_to(const PartWriter& writer) const {
  std::vector<char> part(kPartSize);
  off_t at = 0;
  for (;;) {
    const ssize_t count = ::pread(file_.number(), part.data(), part.size(), at);
    if (count < 0 && errno == EINTR) continue;
    if (count <= 0 || !writer({part.data(), static_cast<std::size_t>(count)})) return;
    at += count;
  }
}

std::optional<gcode::SourceText> SpoolFile::as_text(const std::string& name) {
  const std::string path = "/proc/self/fd/" + std::to_string(file_.number());
  return gcode::SourceText::map_file(path, error_, name);
}

WatchedFile::WatchedFile(std::filesystem::path file) : path_(std::move(file)) {
  // Opening a pipe would be seen by its writer.
  struct stat status = {};
  if (::stat(path_.c_str(), &status) != 0 || !S_ISREG(status.st_mode)) return;
  file_ = Descriptor(::open(path_.c_str(), O_RDONLY | O_NONBLOCK | O_CLOEXEC));
  if (file_.is_open() && ::fstat(file_.number(), &before_) != 0) file_.close_now();
}

FileNow WatchedFile::now() const {
  if (!file_.is_open()) return FileNow::kSame;
  struct stat status = {};
  if (::fstat(file_.number(), &status) != 0 || status.st_size != before_.st_size ||
      status.st_mtim.tv_sec != before_.st_mtim.tv_sec ||
      status.st_mtim.tv_nsec != before_.st_mtim.tv_nsec) {
    return FileNow::kChanged;
  }
  const bool there = ::stat(path_.c_str(), &status) == 0 && status.st_dev == before_.st_dev &&
                     status.st_ino == before_.st_ino;
  return there ? FileNow::kSame : FileNow::kReplaced;
}

}  // namespace batten::postproc
