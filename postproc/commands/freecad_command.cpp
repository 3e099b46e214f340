#include <fmt/format.h>

#include <filesystem>
#include <fstream>
#include <iterator>
#include <nlohmann/json.hpp>
#include <system_error>

#include "postproc/commands/commands.h"
#include "postproc/commands/files.h"
#include "postproc/hosts/freecad_post.h"
#include "postproc/system/exit_code.h"
#include "postproc/system/interrupt.h"
#include "postproc/text/json_values.h"

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

// Whether a post is there that is not ours.
bool is_foreign(const fs::path& post) {
  std::ifstream there(post, std::ios::binary);
  const std::string text(std::istreambuf_iterator<char>(there), {});
  return there.is_open() && !is_freecad_post(text);
}

// `became`: of the post.
int end(const FreecadCommand& command, const fs::path& post, std::string_view became) {
  write_report(command.json_file, command.force, [&] {
    return json_text(as_report("freecad", {{"file", post.string()}, {"became", became}}));
  });
  return static_cast<int>(ExitCode::kDone);
}

int install(const fs::path& post, const FreecadCommand& command) {
  std::error_code error;
  const fs::path program = fs::read_symlink("/proc/self/exe", error);
  const int code = write_result(post.string(), freecad_post_calling(program),
                                command.force || !is_foreign(post));
  if (code != 0) return code;
  say_lines(fmt::format(
      "{} written; it calls {}\n"
      "In FreeCAD, choose the post \"batten\" in the output page of a job, with arguments such as\n"
      "  --target linuxcnc --tolerance 0.01 -- --no-header\n",
      post.string(), program.string()));
  return end(command, post, "written");
}

int uninstall(const fs::path& post, const FreecadCommand& command) {
  if (!command.force && is_foreign(post)) {
    say(post.string() + ": is not Batten's, so it stays; --force removes it");
    return static_cast<int>(ExitCode::kFileError);
  }
  std::error_code error;
  const bool removed = fs::remove(post, error);
  if (error) {
    say(post.string() + ": cannot be removed: " + error.message());
    return static_cast<int>(ExitCode::kFileError);
  }
  say_lines(post.string() + (removed ? " removed\n" : " is not there; nothing to remove\n"));
  return end(command, post, removed ? "removed" : "absent");
}

}  // namespace

int run(const FreecadCommand& command) {
  const auto folder = folder_for(command);
  if (interrupted()) return end_interrupted();
  if (!folder) return static_cast<int>(ExitCode::kFileError);
  const fs::path post = *folder / kFreecadPostName;
  return command.uninstall ? uninstall(post, command) : install(post, command);
}

}  // namespace batten::postproc
