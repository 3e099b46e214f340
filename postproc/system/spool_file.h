// Bytes that are too many to be held in memory and may not be seen by anybody yet: a file without a
// name in the folder for temporary files (TMPDIR), gone when it is closed.
#pragma once

#include <optional>
#include <string>
#include <string_view>

#include "gcode/text/source_text.h"
#include "postproc/system/output_file.h"

namespace batten::postproc {

class SpoolFile {
 public:
  // On failure returns nothing and sets `error`.
  [[nodiscard]] static std::optional<SpoolFile> make(std::string& error);

  SpoolFile(SpoolFile&& other) noexcept;
  SpoolFile(const SpoolFile&) = delete;
  SpoolFile& operator=(const SpoolFile&) = delete;
  SpoolFile& operator=(SpoolFile&&) = delete;
  ~SpoolFile();

  // False: the system refused, error() says why.
  [[nodiscard]] bool append(std::string_view bytes);
  // Nothing stands in it any more. False: the system refused.
  [[nodiscard]] bool restart();
  [[nodiscard]] const std::string& error() const { return error_; }

  // All bytes again, part by part; the other one as a text that is mapped, and stays when this
  // object is gone. Nothing, with error(), where that cannot be done.
  void write_to(const PartWriter& writer) const;
  [[nodiscard]] std::optional<gcode::SourceText> as_text(const std::string& name);

 private:
  explicit SpoolFile(int descriptor) : descriptor_(descriptor) {}

  int descriptor_;
  std::string error_;
};

}  // namespace batten::postproc
