#include <fmt/format.h>

#include <filesystem>
#include <fstream>
#include <iterator>
#include <system_error>

#include "postproc/commands/commands.h"
#include "postproc/commands/files.h"
#include "postproc/hosts/freecad_post.h"
#include "postproc/system/exit_code.h"
#include "postproc/system/interrupt.h"

namespace batten::postproc {

namespace fs = std::filesystem;

namespace {

// Where FreeCAD looks for posts; nothing, and a message, when it cannot be found out.
std::optional<fs::path> folder_for(const FreecadCommand& command) {
  std::error_code error;
  if (!command.folder.empty()) {
    if (fs::is_directory(command.folder, error)) return command.folder;
    say(command.folder + ": is no folder");
    return std::nullopt;
  }
  const std::string program = command.freecad.empty() ? find_freecad() : command.freecad;
  if (program.empty()) {
    say("no FreeCAD was found in PATH; --freecad names the program without a window (FreeCADCmd), "
        "--folder the folder of your macros");
    return std::nullopt;
  }
  std::string trouble;
  const auto answer = ask_freecad(program, trouble);
  if (!answer) {
    say(trouble);
    return std::nullopt;
  }
  // FreeCAD makes this folder itself when the first macro is saved.
  fs::create_directories(answer->folder, error);
  if (error) {
    say(answer->folder.string() + ": cannot be made: " + error.message());
    return std::nullopt;
  }
  say_lines(fmt::format("FreeCAD {} keeps macros and posts in {}\n", answer->version,
                        answer->folder.string()));
  return answer->folder;
}

}  // namespace

int run(const FreecadCommand& command) {
  const auto folder = folder_for(command);
  if (interrupted()) return end_interrupted();
  if (!folder) return static_cast<int>(ExitCode::kFileError);
  std::error_code error;
  const fs::path program = fs::read_symlink("/proc/self/exe", error);
  const fs::path target = *folder / kFreecadPostName;
  std::ifstream there(target, std::ios::binary);
  const std::string text(std::istreambuf_iterator<char>(there), {});
  const bool replace = command.force || !there.is_open() || is_freecad_post(text);
  const int code = write_result(target.string(), freecad_post_calling(program), replace);
  if (code != 0) return code;
  say_lines(fmt::format(
      "{} written; it calls {}\n"
      "In FreeCAD, choose the post \"batten\" in the output page of a job, with arguments such as\n"
      "  --target linuxcnc --tolerance 0.01 -- --no-header\n",
      target.string(), program.string()));
  return static_cast<int>(ExitCode::kDone);
}

}  // namespace batten::postproc
