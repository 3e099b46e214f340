#include "postproc/hosts/freecad_post.h"

#include <array>
#include <cstdlib>
#include <fstream>
#include <system_error>

#include "postproc/system/other_program.h"

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
