// Was a file written into while it was read?
//
// A program is mapped, not copied (gcode/text/source_text.h): whoever writes into the file changes
// the bytes that are being read, and what is made of them belongs to no program that ever was.
#pragma once

#include <sys/stat.h>

#include <filesystem>

namespace batten::postproc {

enum class FileNow {
  kSame,
  kReplaced,  // its bytes are as they were, but the name leads to another file or to none
  kChanged,   // it was written into: what was read may be of before, of after, or of both
};

// Holds the file open. To be made before the file is read and asked after the last byte of it was.
// Nothing that is no regular file (a pipe, a device, "-") is watched: it is always the same.
class WatchedFile {
 public:
  explicit WatchedFile(std::filesystem::path file);
  WatchedFile(const WatchedFile&) = delete;
  WatchedFile& operator=(const WatchedFile&) = delete;
  ~WatchedFile();

  // By its size, the time of its last change, and by what its name leads to.
  [[nodiscard]] FileNow now() const;
  [[nodiscard]] const std::filesystem::path& path() const { return path_; }

 private:
  std::filesystem::path path_;
  int descriptor_ = -1;
  struct stat before_ = {};
};

}  // namespace batten::postproc
