#include "gcode/controls/built_in.h"

#include <algorithm>

namespace batten::gcode {

std::span<const Control> controls() {
  static const std::vector<Control> kAll = [] {
    std::vector<Control> all;
    for (const auto family :
         {linuxcnc_family, grbl_family, printer_family, pc_family, machining_center_family,
          fanuc_family, plc_family, siemens_family, heidenhain_family}) {
      std::ranges::move(family(), std::back_inserter(all));
    }
    return all;
  }();
  return kAll;
}

const Control* find_control(std::string_view name) {
  const auto found = std::ranges::find(controls(), name, &Control::name);
  return found == controls().end() ? nullptr : &*found;
}

}  // namespace batten::gcode
