// Changes programs as people and post-processors do: by blocks and words, not by bytes. For the
// fuzzers (as libFuzzer's own mutator) and for the seeded test of the pipeline.
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <random>
#include <string>
#include <string_view>
#include <vector>

namespace batten::fuzz {

class ProgramMutator {
 public:
  explicit ProgramMutator(std::uint32_t seed) : random_(seed) {}

  // One to four changes. Blocks that are put in come from `text` itself and from `other`.
  std::string mutated(std::string_view text, std::string_view other) {
    lines_ = split(text);
    others_ = split(other);
    const int changes = 1 + below(4);
    for (int i = 0; i < changes; ++i) change();
    std::string result;
    for (const std::string& line : lines_) result += line;
    return result;
  }

  // Blocks of the one up to somewhere, blocks of the other from somewhere on.
  std::string crossed(std::string_view one, std::string_view other) {
    const auto first = split(one);
    const auto second = split(other);
    std::string result;
    const std::size_t to = first.empty() ? 0 : index(first.size());
    for (std::size_t i = 0; i < to; ++i) result += first[i];
    for (std::size_t i = second.empty() ? 0 : index(second.size()); i < second.size(); ++i) {
      result += second[i];
    }
    return result;
  }

 private:
  using Lines = std::vector<std::string>;  // with their line ends

  // What changes the meaning of blocks, or is none.
  static constexpr std::array<std::string_view, 101> kWords = {
      "G0", "G1", "G2 I1 J0", "G3 I0 J1", "G2 R5", "G3 R-5", "G4 P1", "G17", "G18", "G19", "G20",
      "G21", "G28", "G40", "G41 D1", "G43 H1", "G49", "G52 X1", "G54", "G61", "G64", "G64 P0.01",
      "G68 R30", "G69", "G80", "G81 R1", "G90", "G91", "G90.1", "G91.1", "G92 X0", "G93", "G94",
      "G95", "G5.1 Q1", "G6.2 P4", "M0", "M1", "M2", "M3 S1000", "M5", "M6 T1", "M8", "M30",
      "M98 P1", "M99", "F0", "F-1", "F1000", "N10", "/", "(x)", "(MSG,x)", "; x", "%", "#1=2",
      "X[1+2]", "X#1", "O100 sub", "Xnan", "X1e3", "A90", "Z", "GOTO 10", "(TOLERANCE 0.005)",
      "(TOL: 0.002 MM)", "; TOLERANCE = 0.02",
      // Sinumerik
      "X=5", "X=AC(5)", "Y=IC(-1)", "CR=10", "R1=5", "X=R1*2", "MSG(\"x\")", "CYCLE832(0.01,1,1)",
      "CYCLE832()", "COMPCAD", "COMPOF", "TRAORI", "DEF REAL A", "GOTOF L1", "L1:", "T=\"D5\"",
      "%_N_P_MPF",
      // Klartext
      "0 BEGIN PGM P MM", "9 END PGM P MM", "L X+1 Y-2 F500", "L IX+1 FMAX", "L Z+5 R0 F AUTO",
      "CC X+0 Y+0", "C X+5 Y+0 DR-", "CR X+1 Y+1 R+5 DR+", "CT X+1 Y+2", "TOOL CALL 3 Z S1000",
      "CYCL DEF 32.0 TOLERANCE", "CYCL DEF 32.1 T0.005", "LBL 1", "CALL LBL 1 REP 2",
      "FN 0: Q1 = +2", "L X+Q1", "R0 M3"};

  static constexpr std::array<std::string_view, 14> kNumbers = {
      "0",       "-0",      "0.0001", "-0.0001",      "0.00001",   "1",          "999.999",
      "1000000", "-999999", ".5",     "12345.678901", "0.0000001", "1000000000", "1."};

  int below(int n) { return static_cast<int>(random_() % static_cast<unsigned>(n)); }
  std::size_t index(std::size_t size) { return random_() % size; }

  static Lines split(std::string_view text) {
    Lines lines;
    std::size_t begin = 0;
    while (begin < text.size()) {
      const std::size_t end = text.find('\n', begin);
      const std::size_t next = end == std::string_view::npos ? text.size() : end + 1;
      lines.emplace_back(text.substr(begin, next - begin));
      begin = next;
    }
    return lines;
  }

  void change() {
    if (lines_.empty()) lines_.emplace_back("G21 G90 G1 X1 F100\n");
    switch (below(12)) {
      case 0:
        return drop_blocks();
      case 1:
        return repeat_blocks();
      case 2:
        return turn_blocks_around();
      case 3:
        return std::swap(lines_[index(lines_.size())], lines_[index(lines_.size())]);
      case 4:
        return take_blocks_of(lines_);
      case 5:
        return take_blocks_of(others_);
      case 6:
        return put_in_word();
      case 7:
        return put_in_block();
      case 8:
      case 9:
        return change_number();
      case 10:
        return change_digit();
      default:
        return change_character();
    }
  }

  // A few blocks that follow each other, mostly.
  std::pair<std::size_t, std::size_t> range_of(const Lines& lines) {
    const std::size_t from = index(lines.size());
    const std::size_t most = below(8) == 0 ? lines.size() : 12;
    return {from, std::min(lines.size(), from + 1 + index(most))};
  }
  static Lines::iterator at(Lines& lines, std::size_t i) {
    return lines.begin() + static_cast<std::ptrdiff_t>(i);
  }

  void drop_blocks() {
    const auto [from, to] = range_of(lines_);
    lines_.erase(at(lines_, from), at(lines_, to));
  }

  void repeat_blocks() {
    const auto [from, to] = range_of(lines_);
    const Lines part(at(lines_, from), at(lines_, to));
    const int times = 1 + below(below(4) == 0 ? 20 : 2);
    for (int i = 0; i < times; ++i) lines_.insert(at(lines_, to), part.begin(), part.end());
  }

  void turn_blocks_around() {
    const auto [from, to] = range_of(lines_);
    std::reverse(at(lines_, from), at(lines_, to));
  }

  void take_blocks_of(Lines& source) {
    if (source.empty()) return;
    const auto [from, to] = range_of(source);
    const Lines part(at(source, from), at(source, to));
    lines_.insert(at(lines_, index(lines_.size() + 1)), part.begin(), part.end());
  }

  void put_in_word() {
    std::string& line = lines_[index(lines_.size())];
    line.insert(index(line.size() + 1), " " + std::string(kWords[index(kWords.size())]) + " ");
  }

  void put_in_block() {
    lines_.insert(at(lines_, index(lines_.size() + 1)),
                  std::string(kWords[index(kWords.size())]) + "\n");
  }

  static bool is_of_number(char c) { return (c >= '0' && c <= '9') || c == '.' || c == '-'; }

  // The number at or behind a random place of a random line becomes another one.
  void change_number() {
    std::string& line = lines_[index(lines_.size())];
    std::size_t begin = index(line.size());
    while (begin < line.size() && !is_of_number(line[begin])) ++begin;
    std::size_t end = begin;
    while (end < line.size() && is_of_number(line[end])) ++end;
    if (begin == end) return;
    const bool other_sign = below(3) == 0;
    if (other_sign && line[begin] == '-') {
      line.erase(begin, 1);
    } else if (other_sign) {
      line.insert(begin, "-");
    } else {
      line.replace(begin, end - begin, kNumbers[index(kNumbers.size())]);
    }
  }

  void change_digit() {
    std::string& line = lines_[index(lines_.size())];
    std::size_t digit = index(line.size());
    while (digit < line.size() && (line[digit] < '0' || line[digit] > '9')) ++digit;
    if (digit < line.size()) line[digit] = static_cast<char>('0' + below(10));
  }

  void change_character() {
    constexpr std::string_view kCharacters = "XYZIJKRFGMNABPQ+-.,/()[]#%*=:; \t\r\n0159\x7f\xff";
    std::string& line = lines_[index(lines_.size())];
    line[index(line.size())] = kCharacters[index(kCharacters.size())];
  }

  std::mt19937 random_;
  Lines lines_;
  Lines others_;
};

}  // namespace batten::fuzz
