#include "gcode/state/mode_words.h"

#include <algorithm>
#include <array>

namespace batten::gcode {
namespace {

template <auto kItem, auto kUnknown>
bool is_unknown(const ModalState& state) {
  return state.*kItem == kUnknown;
}
bool is_path_unknown(const ModalState& state) { return state.path.mode == PathMode::kUnknown; }
template <auto kItem>
constexpr auto kSwitch = &is_unknown<kItem, TriState::kUnknown>;

using Modal = ModalState;
constexpr std::array kModeWords = {
    ModeWords{&is_unknown<&Modal::units, Units::kUnknown>, "units", "G20 or G21", "G70 or G71", ""},
    ModeWords{&is_unknown<&Modal::plane, Plane::kUnknown>, "plane", "G17", "G17",
              "TOOL CALL with Z"},
    ModeWords{&is_unknown<&Modal::distance, DistanceMode::kUnknown>, "distance", "G90", "G90", ""},
    ModeWords{&is_unknown<&Modal::arc_distance, DistanceMode::kUnknown>, "centres of arcs", "G91.1",
              "", ""},
    ModeWords{&is_unknown<&Modal::feed_mode, FeedMode::kUnknown>, "feed mode", "G94", "G94",
              "M137"},
    ModeWords{&is_path_unknown, "path mode", "G64", "G64", ""},
    ModeWords{kSwitch<&Modal::cutter_compensation>, "cutter compensation", "G40", "G40", "R0"},
    ModeWords{kSwitch<&Modal::tool_center_point>, "tool centre point control", "G49", "TRAFOOF",
              "M129, M115, M145 and FUNCTION RESET TCPM"},
    ModeWords{kSwitch<&Modal::tilted_plane>, "tilted plane", "G69", "CYCLE800()", "PLANE RESET"},
    ModeWords{kSwitch<&Modal::scaling>, "scaling", "G50", "TRANS",
              "CYCL DEF 26.1 X1 Y1 Z1, then CYCL DEF 11.1 SCL 1"},
    ModeWords{kSwitch<&Modal::rotation>, "rotation", "G69", "TRANS", "CYCL DEF 10.1 ROT+0"},
    ModeWords{kSwitch<&Modal::mirror>, "mirroring", "G50.1", "TRANS", "CYCL DEF 8.1"},
    ModeWords{kSwitch<&Modal::polar>, "polar coordinates", "G15", "TRAFOOF", ""},
    ModeWords{kSwitch<&Modal::polar_interpolation>, "polar interpolation", "G13.1 or G113",
              "TRAFOOF", ""},
    ModeWords{kSwitch<&Modal::cylindrical>, "cylindrical coordinates", "G7.1 C0", "TRAFOOF", ""},
    ModeWords{kSwitch<&Modal::control_smoothing>, "smoothing by the control", "G5.1 Q0", "COMPOF",
              "M113", "--allow control-smoothing"},
    ModeWords{kSwitch<&Modal::modal_macro>, "modal macro", "G67", "MCALL",
              "CYCL DEF of a cycle that waits for its call"},
    ModeWords{kSwitch<&Modal::constant_surface_speed>, "constant surface speed", "G97", "G97", ""},
    ModeWords{kSwitch<&Modal::lathe_diameter>, "diameter mode", "G8", "DIAMOF", ""}};
// In the order of the bits of a ModeSet. The laser's, the last, is not asked for.
static_assert(kModeWords.size() == mode::kFirstSwitch + kModalSwitches.size() - 1);
static_assert(kModalSwitches.back().item == &Modal::laser_power_mode);

}  // namespace

std::span<const ModeWords> mode_words() { return kModeWords; }

}  // namespace batten::gcode
