// Runs the built program as a user's shell would, in a folder of its own.
#pragma once

#include <gtest/gtest.h>
#include <sys/wait.h>

#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <string>

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

// A temporary folder to run commands in, removed at the end.
class BattenFolder {
 public:
  [[nodiscard]] std::filesystem::path file(const std::string& name) const {
    return folder_.path() / name;
  }

  void put(const std::string& name, const std::string& text) const { folder_.put(name, text); }

  [[nodiscard]] std::string text_of(const std::string& name) const {
    std::ifstream stream(file(name), std::ios::binary);
    return {std::istreambuf_iterator<char>(stream), {}};
  }

  [[nodiscard]] bool has(const std::string& name) const {
    return std::filesystem::exists(file(name));
  }

  // Any shell command in this folder; `batten` is the program under test.
  [[nodiscard]] ProcessResult shell(const std::string& command) const {
    const std::string line = "cd '" + folder_.path().string() +
                             "' && batten() { '" BATTEN_BINARY "' \"$@\"; }; { " + command +
                             "\n} >.out 2>.err";
    const int status = std::system(line.c_str());
    ProcessResult result;
    result.exit_code = WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status);
    result.out = text_of(".out");
    result.err = text_of(".err");
    std::filesystem::remove(file(".out"));
    std::filesystem::remove(file(".err"));
    return result;
  }

  [[nodiscard]] ProcessResult batten(const std::string& arguments) const {
    return shell("batten " + arguments);
  }

 private:
  ScratchFolder folder_;
};

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
