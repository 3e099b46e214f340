#include "postproc/system/other_program.h"

#include <fcntl.h>
#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstdlib>
#include <filesystem>
#include <string_view>
#include <system_error>
#include <thread>

namespace batten::postproc {
namespace {

constexpr const char* kShows = "xdg-open";

// A browser that was not open may keep xdg-open until it is closed.
constexpr std::chrono::milliseconds kLongestStart(3000);
constexpr std::chrono::milliseconds kBetweenLooks(20);

int wait_for(pid_t process, std::optional<std::chrono::milliseconds> patience) {
  int status = 0;
  if (!patience) {
    while (::waitpid(process, &status, 0) < 0 && errno == EINTR) {
    }
    return status;
  }
  const auto end = std::chrono::steady_clock::now() + *patience;
  while (::waitpid(process, &status, WNOHANG) == 0) {
    if (std::chrono::steady_clock::now() >= end) return 0;
    std::this_thread::sleep_for(kBetweenLooks);
  }
  return status;
}

}  // namespace

bool is_in_path(const std::string& program) {
  const char* path = std::getenv("PATH");
  std::string_view rest = path != nullptr ? path : "";
  while (!rest.empty()) {
    const std::string_view folder = rest.substr(0, rest.find(':'));
    rest.remove_prefix(std::min(rest.size(), folder.size() + 1));
    const std::filesystem::path file = std::filesystem::path(folder) / program;
    if (::access(file.c_str(), X_OK) == 0) return true;
  }
  return false;
}

std::optional<int> run_silently(const std::vector<std::string>& words, std::string& error,
                                std::optional<std::chrono::milliseconds> patience) {
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
  posix_spawnattr_t attributes;
  posix_spawnattr_init(&attributes);
  // What is left to itself is not ended with this program's terminal.
  if (patience) posix_spawnattr_setflags(&attributes, POSIX_SPAWN_SETSID);
  pid_t process = 0;
  const int failure =
      ::posix_spawnp(&process, arguments[0], &actions, &attributes, arguments.data(), environ);
  posix_spawnattr_destroy(&attributes);
  posix_spawn_file_actions_destroy(&actions);
  if (failure != 0) {
    error = words.front() + ": cannot be started: " + std::generic_category().message(failure);
    return std::nullopt;
  }
  return wait_for(process, patience);
}

std::string objection_to_showing() {
  if (is_in_path(kShows)) return "";
  return std::string("--open: there is no ") + kShows +
         " here to show the page with (package xdg-utils); write it with --report FILE.html and "
         "open that in a browser";
}

std::string show_file(const std::string& file) {
  std::string error;
  const auto status = run_silently({kShows, file}, error, kLongestStart);
  if (status && *status != 0) error = std::string(kShows) + " could not show it";
  if (error.empty()) return "";
  return file + ": written, but not shown: " + error + "; open it in a browser";
}

}  // namespace batten::postproc
