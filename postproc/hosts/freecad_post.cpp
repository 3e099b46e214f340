#include "postproc/hosts/freecad_post.h"

#include <fcntl.h>
#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstdlib>
#include <fstream>
#include <system_error>
#include <vector>

namespace batten::postproc {

namespace fs = std::filesystem;

namespace {

constexpr std::string_view kMark =
    "A FreeCAD post-processor: runs one of FreeCAD's own posts, then";
constexpr std::string_view kUnset = "\nBATTEN = \"\"\n";

// Run by FreeCAD. The answer goes into a file, since FreeCAD prints much else; the place is the
// one that its own search for posts begins with. It ends at once, for the console that FreeCAD
// would open now.
constexpr std::string_view kQuestion = R"(import os
import FreeCAD
place = FreeCAD.ParamGet("User parameter:BaseApp/Preferences/Macro").GetString("MacroPath", "")
if not place:
    place = FreeCAD.getUserMacroDir()
answer = os.environ["BATTEN_ANSWER"]
with open(answer + ".part", "w", encoding="utf-8", errors="surrogateescape") as file:
    file.write(".".join(FreeCAD.Version()[:3]).replace(" ", "") + "\n" + place + "\n")
os.replace(answer + ".part", answer)
os._exit(0)
)";

// A folder for the question and the answer, removed at the end.
class ScratchFolder {
 public:
  ScratchFolder() {
    std::string name = (fs::temp_directory_path() / "batten-freecad-XXXXXX").string();
    if (::mkdtemp(name.data()) != nullptr) path_ = name;
  }
  ScratchFolder(const ScratchFolder&) = delete;
  ScratchFolder& operator=(const ScratchFolder&) = delete;
  ~ScratchFolder() {
    std::error_code error;
    if (!path_.empty()) fs::remove_all(path_, error);
  }
  [[nodiscard]] const fs::path& path() const { return path_; }

 private:
  fs::path path_;
};

// As a Python string literal. Other bytes than these are taken as they are.
std::string python_string(const std::string& text) {
  std::string literal = "\"";
  for (const char c : text) {
    if (c == '\\' || c == '"') literal += '\\';
    literal += c;
  }
  return literal + "\"";
}

// The exit status as waitpid tells it, or an error. Nothing that the program prints is kept.
std::optional<int> run_silently(const std::vector<std::string>& words, std::string& error) {
  std::vector<std::string> copies = words;
  std::vector<char*> arguments;
  arguments.reserve(copies.size() + 1);
  for (std::string& word : copies) arguments.push_back(word.data());
  arguments.push_back(nullptr);
  posix_spawn_file_actions_t actions;
  posix_spawn_file_actions_init(&actions);
  posix_spawn_file_actions_addopen(&actions, STDIN_FILENO, "/dev/null", O_RDONLY, 0);
  posix_spawn_file_actions_addopen(&actions, STDOUT_FILENO, "/dev/null", O_WRONLY, 0);
  posix_spawn_file_actions_addopen(&actions, STDERR_FILENO, "/dev/null", O_WRONLY, 0);
  pid_t process = 0;
  const int failure =
      ::posix_spawnp(&process, arguments[0], &actions, nullptr, arguments.data(), environ);
  posix_spawn_file_actions_destroy(&actions);
  if (failure != 0) {
    error = words.front() + ": cannot be started: " + std::generic_category().message(failure);
    return std::nullopt;
  }
  int status = 0;
  while (::waitpid(process, &status, 0) < 0 && errno == EINTR) {
  }
  return status;
}

std::optional<FreecadAnswer> read_answer(const fs::path& file) {
  std::ifstream stream(file, std::ios::binary);
  FreecadAnswer answer;
  std::string folder;
  if (!std::getline(stream, answer.version) || !std::getline(stream, folder) || folder.empty()) {
    return std::nullopt;
  }
  answer.folder = fs::path(folder).lexically_normal();
  return answer;
}

bool is_in_path(const std::string& program) {
  const char* path = std::getenv("PATH");
  std::string_view rest = path != nullptr ? path : "";
  while (!rest.empty()) {
    const std::string_view folder = rest.substr(0, rest.find(':'));
    rest.remove_prefix(std::min(rest.size(), folder.size() + 1));
    if (::access((fs::path(folder) / program).c_str(), X_OK) == 0) return true;
  }
  return false;
}

}  // namespace

std::string freecad_post_calling(const fs::path& program) {
  std::string text(freecad_post_source());
  const std::size_t place = text.find(kUnset);
  return text.replace(place, kUnset.size(), "\nBATTEN = " + python_string(program.string()) + "\n");
}

bool is_freecad_post(std::string_view text) { return text.find(kMark) != std::string_view::npos; }

std::optional<FreecadAnswer> ask_freecad(const std::string& program, std::string& error) {
  const ScratchFolder scratch;
  const fs::path question = scratch.path() / "question.py";
  const fs::path answer = scratch.path() / "answer";
  std::ofstream(question, std::ios::binary) << kQuestion;
  ::setenv("BATTEN_ANSWER", answer.c_str(), 1);
  const auto status = run_silently({program, question.string()}, error);
  ::unsetenv("BATTEN_ANSWER");
  if (!status) return std::nullopt;
  auto found = read_answer(answer);
  if (!found) error = program + ": did not say where its macros are; name the folder with --folder";
  return found;
}

std::string find_freecad() {
  constexpr std::array<const char*, 4> kNames = {"freecadcmd", "FreeCADCmd", "freecad.cmd",
                                                 "freecadcmd-python3"};
  for (const char* name : kNames) {
    if (is_in_path(name)) return name;
  }
  return "";
}

}  // namespace batten::postproc
