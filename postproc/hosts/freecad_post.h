// The FreeCAD post script that this program carries, integrations/freecad/batten_post.py.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <string_view>

namespace batten::postproc {

inline constexpr std::string_view kFreecadPostName = "batten_post.py";

// The script as it is in the sources.
[[nodiscard]] std::string_view freecad_post_source();

// The script that calls `program`, a full path.
[[nodiscard]] std::string freecad_post_calling(const std::filesystem::path& program);

// Whether a file's text is such a script, of any version.
[[nodiscard]] bool is_freecad_post(std::string_view text);

struct FreecadAnswer {
  std::string version;           // "0.20.2"
  std::filesystem::path folder;  // of the user's macros, where FreeCAD looks for posts
};

// Asks the FreeCAD that `program` starts without a window (a name or a path). On failure returns
// nothing and sets `error`. FreeCAD needs some seconds.
[[nodiscard]] std::optional<FreecadAnswer> ask_freecad(const std::string& program,
                                                       std::string& error);

// What distributions call FreeCAD without a window, as far as it is in PATH; empty: none.
[[nodiscard]] std::string find_freecad();

}  // namespace batten::postproc
