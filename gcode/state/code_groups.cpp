#include "gcode/state/code_groups.h"

#include <algorithm>
#include <initializer_list>

namespace batten::gcode {
namespace {

bool one_of(Code code, std::initializer_list<Code> codes) {
  return std::find(codes.begin(), codes.end(), code) != codes.end();
}

}  // namespace

CodeGroup group_of_g(Code code) {
  switch (code) {
    case 40:    // dwell
    case 90:    // exact stop in this block
    case 110:   // end of data setting
    case 530:   // machine coordinates in this block
    case 1870:  // Haas: how smooth
      return CodeGroup::kNone;
    case 100:  // data setting
    case 280:
    case 281:
    case 300:
    case 301:
    case 520:
    case 920:
    case 921:
    case 922:
    case 923:
    case 650:  // macro call
      return CodeGroup::kAxisUser;
    case 0:
    case 10:
    case 20:
    case 30:
    case 50:  // G5 without P 10000
    case 52:
    case 53:
    case 60:
    case 61:
    case 62:
    case 63:
    case 120:  // circular pockets
    case 130:
    case 310:  // probing
    case 382:
    case 383:
    case 384:
    case 385:
    case 320:  // threading
    case 330:
    case 331:
    case 340:
    case 730:  // cycles
    case 740:
    case 760:
    case 810:
    case 820:
    case 830:
    case 840:
    case 841:
    case 842:
    case 843:
    case 850:
    case 860:
    case 870:
    case 880:
    case 890:
      return CodeGroup::kMotion;
    case 800:
      return CodeGroup::kCycleEnd;
    case 170:
    case 180:
    case 190:
      return CodeGroup::kPlane;
    case 900:
    case 910:
      return CodeGroup::kDistance;
    case 901:
    case 911:
      return CodeGroup::kArcDistance;
    case 930:
    case 940:
    case 950:
      return CodeGroup::kFeedMode;
    case 200:
    case 210:
    case 700:  // units on old controls, cycles on lathes
    case 710:
      return CodeGroup::kUnits;
    case 400:
    case 410:
    case 411:
    case 420:
    case 421:
      return CodeGroup::kCutter;
    case 430:
    case 431:
    case 432:
    case 434:
    case 435:
    case 440:
    case 490:
      return CodeGroup::kToolLength;
    case 980:
    case 990:
      return CodeGroup::kCycleReturn;
    case 540:
    case 541:
    case 550:
    case 560:
    case 570:
    case 580:
    case 590:
    case 591:
    case 592:
    case 593:
      return CodeGroup::kWorkOffset;
    case 600:
    case 610:
    case 611:
    case 620:
    case 630:
    case 640:
      return CodeGroup::kPath;
    case 960:
    case 970:
      return CodeGroup::kSpindleMode;
    case 70:
    case 80:
      return CodeGroup::kDiameter;
    case 500:
    case 510:
      return CodeGroup::kScaling;
    case 680:
    case 682:
    case 683:
    case 684:
    case 690:
      return CodeGroup::kRotation;
    case 501:
    case 511:
      return CodeGroup::kMirror;
    case 150:
    case 160:
    case 121:
    case 131:
    case 1120:
    case 1130:
      return CodeGroup::kPolar;
    case 71:
    case 1070:
      return CodeGroup::kCylindrical;
    case 51:
    case 1300:
    case 1310:
      return CodeGroup::kSmoothing;
    case 660:
    case 661:
    case 670:
      return CodeGroup::kModalMacro;
    default:
      return CodeGroup::kUnknown;
  }
}

bool excludes_m(Code a, Code b) {
  const auto both_in = [a, b](std::initializer_list<Code> codes) {
    return one_of(a, codes) && one_of(b, codes);
  };
  return both_in({0, 10, 20, 300, 600}) || both_in({30, 40, 50});
}

}  // namespace batten::gcode
