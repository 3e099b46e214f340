#include "gcode/controls/built_in.h"

#include <algorithm>
#include <vector>

namespace batten::gcode {

std::span<const Dialect* const> dialects() {
  static const std::vector<const Dialect*> kAll = [] {
    std::vector<const Dialect*> all = {&linuxcnc_dialect()};
    for (const auto family :
         {grbl_family(), printer_family(), pc_family(), machining_center_family(), fanuc_family(),
          plc_family(), siemens_family(), heidenhain_family()}) {
      all.insert(all.end(), family.begin(), family.end());
    }
    return all;
  }();
  return kAll;
}

const Dialect* find_dialect(std::string_view name) {
  const auto all = dialects();
  const auto found = std::ranges::find(all, name, &Dialect::name);
  return found == all.end() ? nullptr : *found;
}

}  // namespace batten::gcode
