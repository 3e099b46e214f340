// The keys of a profile, one row each: where the value lives, what is allowed, what it means.
#pragma once

#include <array>
#include <cstddef>
#include <span>
#include <string>
#include <string_view>
#include <variant>

#include "gcode/control/control.h"

namespace batten::postproc {

struct WholeNumberKey {
  int& (*place)(gcode::Control&);
  int least = 0;
  int most = 0;
};

struct LengthKey {  // bytes
  std::size_t& (*place)(gcode::Control&);
  std::size_t least = 0;
  std::size_t most = 0;
};

struct DecimalKey {
  double& (*place)(gcode::Control&);
  double least = 0;
  double most = 0;
};

struct FlagKey {
  bool& (*place)(gcode::Control&);
};

struct TextKey {
  std::string& (*place)(gcode::Control&);
};

// One of some names; `index` of the name and back.
struct NameKey {
  std::span<const std::string_view> names;
  std::size_t (*index)(const gcode::Control&);
  void (*set)(gcode::Control&, std::size_t index);
};

// A list of G17, G18, G19.
struct PlanesKey {
  std::array<bool, 3>& (*place)(gcode::Control&);
};

struct ProfileKey {
  std::string_view section;  // empty: at the top
  std::string_view name;
  std::string_view remark;  // unit and meaning
  std::variant<WholeNumberKey, LengthKey, DecimalKey, FlagKey, TextKey, NameKey, PlanesKey> value;
};

// In the order in which a profile shows them; keys of a section stand together.
[[nodiscard]] std::span<const ProfileKey> profile_keys();

inline constexpr std::array<std::string_view, 3> kPlaneNames = {"G17", "G18", "G19"};

}  // namespace batten::postproc
