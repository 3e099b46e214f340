// Other programs of the system that this one starts: FreeCAD, and what shows a page.
#pragma once

#include <chrono>
#include <optional>
#include <string>
#include <vector>

namespace batten::postproc {

[[nodiscard]] bool is_in_path(const std::string& program);

// Starts a program, a name in PATH or a path, with its arguments, and waits for its end. The exit
// status as waitpid tells it; nothing, with `error` set, where it cannot be started. What it prints
// is not kept. `patience`: one that takes longer is left to itself, with the status 0.
[[nodiscard]] std::optional<int> run_silently(
    const std::vector<std::string>& words, std::string& error,
    std::optional<std::chrono::milliseconds> patience = std::nullopt);

// Shows a file in what the user reads such files with (xdg-open). Empty; else why it is not shown.
[[nodiscard]] std::string show_file(const std::string& file);

// Why no file can be shown here; empty where one can.
[[nodiscard]] std::string objection_to_showing();

}  // namespace batten::postproc
