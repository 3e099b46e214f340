// Runs the built program as a user's shell would, in a folder of its own.
#pragma once

#include <fcntl.h>
#include <gtest/gtest.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cerrno>
#include <csignal>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <functional>
#include <string>
#include <vector>

#include "tests/support/places.h"
#include "tests/support/scratch_folder.h"

namespace batten {

inline bool contains(const std::string& text, const std::string& part) {
  return text.find(part) != std::string::npos;
}

struct ProcessResult {
  int exit_code = -1;
  std::string out;
  std::string err;
};

// What was run ended with this code and said these words on standard error.
inline ProcessResult expect_exit(ProcessResult result, int code,
                                 const std::vector<std::string>& said = {},
                                 int line = __builtin_LINE()) {
  const testing::ScopedTrace trace("called in", line, result.err);
  EXPECT_EQ(result.exit_code, code);
  for (const std::string& part : said) EXPECT_TRUE(contains(result.err, part)) << part;
  return result;
}

// A JSON report is left for the test that compares all of them with docs/report.schema.json.
inline void keep_if_report(const std::string& text) {
  if (!text.starts_with("{\n  \"schema\": ")) return;
  std::filesystem::create_directories(BATTEN_KEPT_REPORTS);
  const std::string name = std::to_string(std::hash<std::string>()(text)) + ".json";
  std::ofstream(std::filesystem::path(BATTEN_KEPT_REPORTS) / name, std::ios::binary) << text;
}

// Arguments that end a command with 1 and these words.
struct WrongUsage {
  const char* name;
  const char* arguments;
  const char* message;
};

// A temporary folder to run commands in, removed at the end.
class BattenFolder {
 public:
  [[nodiscard]] std::filesystem::path file(const std::string& name) const {
    return folder_.path() / name;
  }

  void put(const std::string& name, const std::string& text) const { folder_.put(name, text); }

  [[nodiscard]] std::string text_of(const std::string& name) const {
    return text_of_file(file(name));
  }

  [[nodiscard]] bool has(const std::string& name) const {
    return std::filesystem::exists(file(name));
  }

  // Any shell command in this folder; `batten` is the program under test. The home is an empty one.
  [[nodiscard]] ProcessResult shell(const std::string& command) const {
    const std::string line =
        "cd '" + folder_.path().string() +
        "' && unset BATTEN_CONFIG XDG_CONFIG_HOME && export HOME=\"$PWD/.home\"" +
        " && batten() { '" BATTEN_BINARY "' \"$@\"; }; { " + command + "\n} >.out 2>.err";
    const int status = std::system(line.c_str());
    ProcessResult result;
    result.exit_code = WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status);
    result.out = text_of(".out");
    result.err = text_of(".err");
    std::filesystem::remove(file(".out"));
    std::filesystem::remove(file(".err"));
    keep_reports(result);
    return result;
  }

  [[nodiscard]] ProcessResult batten(const std::string& arguments) const {
    return shell("batten " + arguments);
  }

 private:
  // Those on standard output and in files of the folder.
  void keep_reports(const ProcessResult& result) const {
    namespace fs = std::filesystem;
    keep_if_report(result.out);
    std::error_code error;
    for (fs::recursive_directory_iterator at(folder_.path(), error), end; !error && at != end;
         at.increment(error)) {
      if (at->path().extension() != ".json" || !at->is_regular_file(error)) continue;
      keep_if_report(text_of_file(at->path()));
    }
  }

  ScratchFolder folder_;
};

// The program at work in a folder, its messages in the file `err` there.
class Started {
 public:
  Started(const BattenFolder& folder, std::vector<std::string> arguments) {
    arguments.insert(arguments.begin(), BATTEN_BINARY);
    std::vector<char*> words;
    for (std::string& argument : arguments) words.push_back(argument.data());
    words.push_back(nullptr);
    const std::string place = folder.file(".").string();
    pid_ = ::fork();
    if (pid_ != 0) return;
    const int err = ::chdir(place.c_str()) == 0
                        ? ::open("err", O_WRONLY | O_CREAT | O_TRUNC | O_CLOEXEC, 0644)
                        : -1;
    if (err >= 0 && ::dup2(err, STDERR_FILENO) >= 0) ::execv(BATTEN_BINARY, words.data());
    ::_exit(127);
  }

  void send(int signal_number) const { ::kill(pid_, signal_number); }

  // As waitpid has it.
  [[nodiscard]] int wait() const {
    int status = 0;
    while (::waitpid(pid_, &status, 0) < 0 && errno == EINTR) {
    }
    return status;
  }

  [[nodiscard]] bool is_running() const {
    siginfo_t info{};
    return ::waitid(P_PID, static_cast<id_t>(pid_), &info, WEXITED | WNOHANG | WNOWAIT) == 0 &&
           info.si_pid == 0;
  }

 private:
  pid_t pid_ = -1;
};

// Files that a finished program never leaves.
inline std::vector<std::filesystem::path> half_written_in(const std::filesystem::path& folder) {
  std::vector<std::filesystem::path> found;
  for (const auto& entry : std::filesystem::recursive_directory_iterator(folder)) {
    if (entry.path().filename().string().ends_with(".batten-part")) found.push_back(entry.path());
  }
  return found;
}

// A wave in 0.2 mm steps: one run that any target can make smoother.
inline std::string wave_program() {
  std::string text = "G21 G90 G17\nG0 X0 Y0 Z5\nG1 Z-1 F300\nG1 X0.2 Y0.1 F2000\n";
  for (int i = 2; i <= 120; ++i) {
    const int y = i % 40 < 20 ? i % 20 : 20 - i % 20;  // a zig-zag of 2 mm, corners at its tips
    text += "X" + std::to_string(i / 5) + "." + std::to_string(i % 5 * 2) + " Y" +
            std::to_string(y / 10) + "." + std::to_string(y % 10) + "\n";
  }
  return text + "G0 Z5\nM2\n";
}

}  // namespace batten
