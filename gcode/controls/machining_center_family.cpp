// Controls of machining centres that read ISO programs: Haas, Mazak (EIA), Okuma OSP, Brother,
// Hurco (ISNC), Fagor, NUM, Philips (Maho). Facts: docs/controllers/machining_centers.md.
#include "gcode/controls/built_in.h"

namespace batten::gcode {
namespace {

constexpr SourceMarks kMacro = mark(SourceMark::kMacroFlow);
constexpr SourceMarks kFanucLike = kMacro | mark(SourceMark::kHighSpeedMode);

constexpr std::string_view kElsewhere = "position unknown";
constexpr std::string_view kAsBefore = "keeps state";

// Work offsets, and those that follow the table (G254); how many blocks are read ahead.
std::vector<ControlWord> words_of_haas() {
  std::vector<ControlWord> words = {{"G103", kAsBefore}, {"G29", "moves"}};
  for (const std::string_view name :
       {"G110", "G111", "G114", "G115", "G116", "G117", "G118", "G119", "G120", "G121", "G122",
        "G123", "G124", "G125", "G126", "G127", "G128", "G129", "G154", "G254", "G255"}) {
    words.push_back({name, kElsewhere});
  }
  return words;
}

// Tool lengths come with D.
constexpr std::string_view kLengthByD = "G43 G49 H";

// Least increments of 0.001 mm and 0.0001 in: more digits are cut off or an alarm. The point is
// always written, since X5 may be 5 increments. Half turns at the most, as posts write them.
Control machining_center(std::string_view name, std::string_view description, SourceMarks marks,
                         std::vector<std::string_view> smoothing_words = {}) {
  Control control;
  control.name = name;
  control.description = description;
  control.decimal_point = true;
  control.has_increments = true;
  control.max_line_length = 80;  // unknown for all of them; no line of ours needs more
  control.known_marks = marks;
  // G90.1 and G91.1 are no words for the centres of arcs there, G7 and G8 none for diameters.
  control.lacks = mode::kArcDistance + mode::kLatheDiameter;
  control.smoothing_words = std::move(smoothing_words);
  return control;
}

// Words of Philips controls that act otherwise than the reader takes them: programs that have one
// are refused.
std::vector<OtherMeaning> other_words_of_philips() {
  std::vector<OtherMeaning> words = {
      {200, "no inch word there, whose units are G70 and G71"},
      {210, "no millimetre word there, whose units are G70 and G71"}};
  for (const int code :
       {110, 120, 130, 140, 220, 230, 250, 260, 270, 280, 290, 310, 430, 440, 500, 530,
        600, 610, 620, 630, 640, 720, 730, 740, 770, 780, 790, 920, 930, 980, 990}) {
    words.push_back({code,
                     "it may repeat or call blocks, switch their geometry or move the "
                     "coordinates there"});
  }
  return words;
}

// I J K are no offsets there, or not certainly: R says the same.
void write_arcs_by_radius(Control& control) {
  control.arc_form = ArcForm::kRadius;
  control.max_sweep_deg = 90;
}

}  // namespace

std::vector<Control> machining_center_family() {
  Control haas = machining_center(
      "haas", "Haas: arcs and helices in G17, G18, G19; decimal point always",
      kMacro | mark(SourceMark::kHaasSmoothness),
      {"before-run = [\"G187 P3 E{tolerance}\"]  # P1 to P3: which is rough and which fine is told "
       "in",
       "after-run = [\"G187\"]                    # both orders; E: corner rounding. Ask your "
       "manual",
       "(bare G187: back to setting 191 and 85)"});
  haas.dwell_form = DwellForm::kSecondsByPoint;
  haas.lacks += mode::kControlSmoothing;  // G187 says how smooth, G5.1 is unknown to it
  haas.own_words = words_of_haas();

  Control mazak = machining_center(
      "mazak", "Mazak EIA: arcs and helices in G17, G18, G19; decimal point always", kFanucLike,
      {"before-run = [\"G61.1\"]  # geometry compensation; from memory, ask your manual",
       "after-run = [\"G64\"]"});
  // The tool turns into the tilted plane; to a reference point, and back.
  mazak.own_words = {{"G53.1", kElsewhere}, {"G27", "moves"}, {"G29", "moves"}};

  Control okuma = machining_center(
      "okuma", "Okuma OSP: arcs and helices in G17, G18, G19; decimal point always",
      mark(SourceMark::kSuperNurbs) | mark(SourceMark::kHaasSmoothness),  // G187: a tolerance, too
      {"before-run = [\"G131 F5000 J1 E{tolerance}\"]  # its numbers are the machine builder's",
       "after-run = [\"G130\"]"});
  okuma.smoothing_off = "G130";
  okuma.names_blocks = true;
  // G54 to G59 are tool lengths there, work offsets are G15 H.
  okuma.refused = "G43 G49 G54 G55 G56 G57 G58 G59 H";
  // G53 ends them, for all blocks behind it. Limits of travel, and the end of G187.
  okuma.own_words = {
      {"G53", kElsewhere}, {"G22", kAsBefore}, {"G23", kAsBefore}, {"G186", kAsBefore}};

  Control brother = machining_center(
      "brother", "Brother Speedio: arcs and helices in G17, G18, G19; decimal point always",
      kFanucLike,
      {"before-run = [\"M262\"]  # M260 series, high accuracy; from memory, ask your manual",
       "after-run = [\"M269\"]"});
  // The tool changes on the way to X, Y and Z; to a reference point, and back.
  brother.own_words = {{"G100", "moves"}, {"G27", "moves"}, {"G29", "moves"}};

  // ISNC takes I J K as offsets, BNC as places.
  Control hurco = machining_center(
      "hurco", "Hurco: arcs by R and helices in G17, G18, G19; decimal point always", kMacro,
      {"before-run = [\"G5.3 P10\"]  # quality, P10 fine to P35; seen in posts alone",
       "after-run = [\"G5.3 P35\"]"});
  hurco.smoothing_off = "";
  write_arcs_by_radius(hurco);

  Control fagor = machining_center(
      "fagor", "Fagor 8055 to 8070: arcs and helices in G17, G18, G19; G70 and G71",
      mark(SourceMark::kHashCommand));
  fagor.smoothing_off = "";
  fagor.decimal_point = false;
  fagor.own_words = {{"#MSG", kAsBefore}};  // shown to people
  fagor.refused = kLengthByD;
  fagor.other_meanings = {{200, "no inch word on Fagor, whose units are G70 and G71"},
                          {210, "no millimetre word on Fagor, whose units are G70 and G71"}};

  // I J K are places under G90 there, offsets to the reader.
  Control num =
      machining_center("num", "NUM: arcs by R and helices in G17, G18, G19; G70 and G71", 0);
  num.smoothing_off = "";
  num.decimal_point = false;
  write_arcs_by_radius(num);
  num.centers_follow_distance = true;
  num.refused = kLengthByD;
  num.other_meanings = {
      {200, "no inch word on NUM (polar programming), whose units are G70 and G71"},
      {210, "no millimetre word on NUM (axes of programming), whose units are G70 and G71"}};

  Control philips = machining_center(
      "philips", "Philips 432, 532 (Maho): arcs by R in G17, G18, G19; G70 and G71", 0);
  philips.smoothing_off = "";
  philips.decimal_point = false;
  philips.helices = false;
  write_arcs_by_radius(philips);
  philips.centers_follow_distance = true;
  philips.own_words = {{"G51", kElsewhere}, {"G52", kElsewhere}};  // they choose zero points
  philips.refused = "G43 G49 G64 H";
  philips.other_meanings = other_words_of_philips();

  return {haas, mazak, okuma, brother, hurco, fagor, num, philips};
}

}  // namespace batten::gcode
