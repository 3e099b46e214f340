#include "postproc/system/watched_file.h"

#include <fcntl.h>
#include <unistd.h>

#include <utility>

namespace batten::postproc {

namespace {

bool same_time(const struct timespec& one, const struct timespec& other) {
  return one.tv_sec == other.tv_sec && one.tv_nsec == other.tv_nsec;
}

}  // namespace

WatchedFile::WatchedFile(std::filesystem::path file) : path_(std::move(file)) {
  // Opening a pipe would be seen by its writer.
  struct stat status = {};
  if (::stat(path_.c_str(), &status) != 0 || !S_ISREG(status.st_mode)) return;
  descriptor_ = ::open(path_.c_str(), O_RDONLY | O_NONBLOCK | O_CLOEXEC);
  if (descriptor_ >= 0 && ::fstat(descriptor_, &before_) != 0) {
    ::close(descriptor_);
    descriptor_ = -1;
  }
}

WatchedFile::~WatchedFile() {
  if (descriptor_ >= 0) ::close(descriptor_);
}

FileNow WatchedFile::now() const {
  if (descriptor_ < 0) return FileNow::kSame;
  struct stat status = {};
  if (::fstat(descriptor_, &status) != 0 || status.st_size != before_.st_size ||
      !same_time(status.st_mtim, before_.st_mtim)) {
    return FileNow::kChanged;
  }
  const bool there = ::stat(path_.c_str(), &status) == 0 && status.st_dev == before_.st_dev &&
                     status.st_ino == before_.st_ino;
  return there ? FileNow::kSame : FileNow::kReplaced;
}

}  // namespace batten::postproc
