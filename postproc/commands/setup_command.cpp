#include <filesystem>
#include <nlohmann/json.hpp>
#include <system_error>

#include "postproc/commands/commands.h"
#include "postproc/commands/files.h"
#include "postproc/system/exit_code.h"
#include "postproc/text/json_values.h"

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
  if (code != 0) return code;
  say(command.file + ": written; batten smooth takes these options from now on");
  write_report(command.json_file, command.force, [&] {
    return json_text(as_report("setup", {{"file", command.file}, {"text", command.text}}));
  });
  return static_cast<int>(ExitCode::kDone);
}

}  // namespace batten::postproc
