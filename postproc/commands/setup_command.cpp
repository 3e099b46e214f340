#include <filesystem>
#include <system_error>

#include "postproc/commands/commands.h"
#include "postproc/commands/files.h"
#include "postproc/system/exit_code.h"

namespace batten::postproc {

int run(const SetupCommand& command) {
  const auto folder = std::filesystem::path(command.file).parent_path();
  std::error_code error;
  if (!folder.empty()) std::filesystem::create_directories(folder, error);
  if (error) {
    say(folder.string() + ": cannot be made: " + error.message());
    return static_cast<int>(ExitCode::kFileError);
  }
  const int code = write_result(command.file, command.text, command.force);
  if (code == 0) say(command.file + ": written; batten smooth takes these options from now on");
  return code;
}

}  // namespace batten::postproc
