#include <fmt/format.h>

#include <nlohmann/json.hpp>

#include "gcode/control/control.h"
#include "gcode/controls/built_in.h"
#include "postproc/commands/commands.h"
#include "postproc/commands/files.h"
#include "postproc/profile/target_profile.h"
#include "postproc/system/exit_code.h"
#include "postproc/text/json_values.h"

namespace batten::postproc {

namespace {

struct Listing {
  std::string text;
  Json json = Json::array();
};

std::string planes_of(const gcode::Control& target) {
  std::string planes;
  const auto add = [&](gcode::Plane plane, std::string_view name) {
    if (!takes_arcs_in(target, plane)) return;
    if (!planes.empty()) planes += " ";
    planes += name;
  };
  add(gcode::Plane::kXY, "G17");
  add(gcode::Plane::kZX, "G18");
  add(gcode::Plane::kYZ, "G19");
  return planes.empty() ? "none" : planes;
}

Listing list_targets() {
  Listing listing;
  listing.text = fmt::format("{:<15} {:>8} {:>8} {:>5}  {:<12} {:<8} {:<12} {}\n", "target",
                             "mm places", "inch pl.", "line", "arcs in", "helices", "machine", "");
  for (const gcode::Control& target : gcode::controls()) {
    const int mm = place_format(target, gcode::Units::kMillimetre).decimals;
    const int inch = place_format(target, gcode::Units::kInch).decimals;
    listing.text += fmt::format("{:<15} {:>8} {:>8} {:>5}  {:<12} {:<8} {:<12} {}\n", target.name,
                                mm, inch, target.max_line_length, planes_of(target),
                                target.helices ? "yes" : "no", target.machine, target.description);
    listing.json.push_back({{"name", target.name},
                            {"description", target.description},
                            {"decimals_mm", mm},
                            {"decimals_inch", inch},
                            {"max_line_length", target.max_line_length},
                            {"arcs_in", planes_of(target)},
                            {"helices", target.helices},
                            {"default_machine", target.machine}});
  }
  return listing;
}

Listing list_methods() {
  Listing listing;
  for (const auto& method : methods()) {
    listing.text += fmt::format("{:<16} {}\n", method.name, method.text);
    listing.json.push_back({{"name", method.name}, {"description", method.text}});
  }
  return listing;
}

Listing list(BuiltIn what) {
  switch (what) {
    case BuiltIn::kTargets:
      return list_targets();
    case BuiltIn::kMethods:
      break;
  }
  return list_methods();
}

}  // namespace

int run(const ListCommand& command) {
  if (command.show != nullptr) return write_result("-", profile_text(*command.show), false);
  const Listing listing = list(command.what);
  if (command.json_file != "-") {
    if (const int code = write_result("-", listing.text, false); code != 0) return code;
  }
  if (command.json_file.empty()) return static_cast<int>(ExitCode::kDone);
  return write_result(command.json_file, json_text(listing.json), command.force);
}

}  // namespace batten::postproc
