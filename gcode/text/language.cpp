#include "gcode/text/language.h"

namespace batten::gcode {

std::string_view describe(Language language) {
  switch (language) {
    case Language::kRs274:
      return "the RS-274 family";
    case Language::kSiemens:
      return "Siemens Sinumerik";
    case Language::kKlartext:
      break;
  }
  return "Heidenhain Klartext";
}

}  // namespace batten::gcode
