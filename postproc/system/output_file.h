// Files are written whole or not at all.
//
// A file is written beside its target under a name of its own, flushed to the disk, and renamed
// over the target. Whoever reads the target, and whenever the program is killed, finds the old
// bytes or the new ones, never a part. Only a killed program (SIGKILL, power) leaves the other
// file behind: `.NAME.PID.batten-part` in the same folder, safe to remove (NAME is cut where the
// name would be too long).
#pragma once

#include <sys/stat.h>

#include <filesystem>
#include <functional>
#include <optional>
#include <string>
#include <string_view>
#include <utility>

#include "gcode/text/source_text.h"

namespace batten::postproc {

// "part.nc" -> "part.smooth.nc", "part" -> "part.smooth", ".nc" -> ".nc.smooth".
[[nodiscard]] std::filesystem::path default_output_path(const std::filesystem::path& input);

// One file, also under two names (links, "./"). False when either does not exist and the names
// lead to different places.
[[nodiscard]] bool same_file(const std::filesystem::path& one, const std::filesystem::path& other);

enum class WriteStatus {
  kWritten,
  kExists,       // the target exists and may not be replaced; it stays as it was
  kInterrupted,  // `stop` said so; the target stays as it was
  kFailed,       // the system refused; the target stays as it was
};

struct WriteResult {
  WriteStatus status = WriteStatus::kWritten;
  std::string message;  // empty when written; else the file's name and the reason
};

// A file while it is made part by part.
struct PartWriter {
  // Takes the next part; false: it could not be written, make no more.
  std::function<bool(std::string_view)> write;
  // The file begins anew. False where that cannot be: what was written was seen already.
  std::function<bool()> restart;

  bool operator()(std::string_view part) const { return write(part); }
};

struct WriteRequest {
  std::filesystem::path target;  // links are followed: the file they lead to is replaced
  std::string_view bytes = {};
  bool replace_existing = false;
  std::function<bool()> stop = {};  // asked between parts of the file; true: give up
  // For files too long to be held in memory: hands one part after the other to the writer, in
  // place of `bytes`.
  std::function<void(const PartWriter&)> parts = {};
  // Asked last of all, before a file takes its place: a message that is not empty is the reason why
  // it may not (kFailed).
  std::function<std::string()> objection = {};
};

// An existing target keeps its permissions (and its owner, where the system lets us). A target
// that is no regular file (/dev/null, a pipe) is written in place.
[[nodiscard]] WriteResult write_file(const WriteRequest& request);

// Writes to an open descriptor, all or with an error. `name` stands in messages.
[[nodiscard]] WriteResult write_to_descriptor(int descriptor, std::string_view name,
                                              std::string_view bytes,
                                              const std::function<bool()>& stop = {});

// The same for the bytes or the parts of a request.
[[nodiscard]] WriteResult write_request_to_descriptor(int descriptor, std::string_view name,
                                                      const WriteRequest& request);

// A descriptor that is closed at the end of its life.
class Descriptor {
 public:
  explicit Descriptor(int number = -1) : number_(number) {}
  Descriptor(const Descriptor&) = delete;
  Descriptor& operator=(const Descriptor&) = delete;
  Descriptor(Descriptor&& other) noexcept : number_(std::exchange(other.number_, -1)) {}
  Descriptor& operator=(Descriptor&& other) noexcept {
    std::swap(number_, other.number_);
    return *this;
  }
  ~Descriptor() { close_now(); }

  [[nodiscard]] bool is_open() const { return number_ >= 0; }
  [[nodiscard]] int number() const { return number_; }
  // False: the system refused. Some file systems report a full disk only here.
  bool close_now();

 private:
  int number_;
};

// Bytes that are too many to be held in memory and may not be seen by anybody yet: a file without a
// name in the folder for temporary files (TMPDIR), gone when it is closed.
class SpoolFile {
 public:
  // On failure returns nothing and sets `error`.
  [[nodiscard]] static std::optional<SpoolFile> make(std::string& error);

  // False: the system refused, error() says why.
  [[nodiscard]] bool append(std::string_view bytes);
  // Nothing is in it any more. False: the system refused.
  [[nodiscard]] bool restart();
  [[nodiscard]] const std::string& error() const { return error_; }

  // All bytes again, part by part; the other one as a text that is mapped, and stays when this
  // object is gone. Nothing, with error(), where that cannot be done.
  void write_to(const PartWriter& writer) const;
  [[nodiscard]] std::optional<gcode::SourceText> as_text(const std::string& name);

 private:
  explicit SpoolFile(Descriptor file) : file_(std::move(file)) {}

  Descriptor file_;
  std::string error_;
};

// Was a file written into while it was read?
//
// A program is mapped, not copied (gcode/text/source_text.h): whoever writes into the file changes
// the bytes that are being read, and what is made of them belongs to no program that ever was.

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

  // By its size, the time of its last change, and by what its name leads to.
  [[nodiscard]] FileNow now() const;
  [[nodiscard]] const std::filesystem::path& path() const { return path_; }

 private:
  std::filesystem::path path_;
  Descriptor file_;
  struct stat before_ = {};
};

}  // namespace batten::postproc
