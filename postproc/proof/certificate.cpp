#include "postproc/proof/certificate.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cstdint>
#include <functional>
#include <limits>
#include <optional>
#include <span>
#include <string>
#include <unordered_map>
#include <utility>
#include <vector>

#include "geometry/distance/sparse_matching.h"
#include "postproc/proof/section_comparison.h"

namespace batten::postproc {
namespace {

using geometry::PathPlace;
using geometry::Point3;
using geometry::SparsePair;

constexpr std::size_t kLineLength = 100;  // of the certificate, about

std::vector<std::string_view> lines_of(std::string_view text) {
  std::vector<std::string_view> lines;
  while (!text.empty()) {
    const std::size_t end = std::min(text.find('\n'), text.size() - 1) + 1;
    lines.push_back(text.substr(0, end));
    text.remove_prefix(end);
  }
  return lines;
}

// One of the two programs by lines, which count from 0 here.
class LinedProgram {
 public:
  LinedProgram(const ReadProgram& read, std::string_view text)
      : lines(lines_of(text)), read_(read), events_(list_events(read)) {
    const auto& motions = read.interpretation->motions;
    first_cut_.assign(lines.size() + 1, 0);
    starts_.resize(lines.size() + 1);
    std::size_t cut = 0;
    std::size_t motion = 0;
    std::optional<Point3> place;
    for (std::size_t line = 0; line <= lines.size(); ++line) {
      for (; cut < events_.cuts.size() && line_of_motion(events_.cuts[cut].motion) < line; ++cut) {
      }
      for (; motion < motions.size() && line_of_motion(motion) < line; ++motion) {
        place = motions[motion].end_known ? std::optional(motions[motion].piece.end()) : place;
      }
      first_cut_[line] = cut;
      starts_[line] = place;
    }
  }

  [[nodiscard]] std::size_t events() const { return events_.events.size(); }
  [[nodiscard]] std::size_t line_of_event(std::size_t k) const {
    return line_of_block(events_.events[k].block);
  }
  [[nodiscard]] bool cuts_at(std::size_t line) const {
    return first_cut_[line] < first_cut_[line + 1];
  }
  [[nodiscard]] SectionSide side(std::size_t begin, std::size_t end) const {
    const std::size_t first = first_cut_[begin];
    return {&read_,
            {events_.cuts.data() + first, first_cut_[end] - first},
            starts_[begin],
            static_cast<std::uint32_t>(begin)};
  }
  // Of a line that cuts: two with equal text, start and feed are the same.
  [[nodiscard]] bool same_start(std::size_t line, const LinedProgram& other,
                                std::size_t other_line) const {
    return starts_[line] == other.starts_[other_line] &&
           is_one_feed(events_.cuts[first_cut_[line]],
                       other.events_.cuts[other.first_cut_[other_line]]);
  }

  std::vector<std::string_view> lines;

 private:
  [[nodiscard]] std::size_t line_of_block(std::uint32_t block) const {
    return read_.program->blocks[block].line - 1;
  }
  [[nodiscard]] std::size_t line_of_motion(std::size_t motion) const {
    return line_of_block(read_.interpretation->motions[motion].block);
  }

  const ReadProgram& read_;
  ProgramEvents events_;
  std::vector<std::size_t> first_cut_;         // of each line
  std::vector<std::optional<Point3>> starts_;  // where the tool stands before each line
};

struct Range {  // lines
  std::size_t begin = 0;
  std::size_t end = 0;
};

class CertificateWriter {
 public:
  CertificateWriter(const ReadProgram& before, const ReadProgram& after, std::string_view new_text,
                    double tolerance_mm)
      : old_(before, before.program->source.text()),
        new_(after, new_text),
        tolerance_(tolerance_mm) {
    text_ = fmt::format("Batten certificate 1\ntolerance {} mm\n", tolerance_mm);
  }

  Certificate run() {
    if (old_.events() != new_.events()) return failed(0, "the programs do not act alike");
    std::size_t i = 0;
    std::size_t j = 0;
    for (std::size_t k = 0; k < old_.events(); ++k) {
      const std::size_t old_line = old_.line_of_event(k);
      const std::size_t new_line = new_.line_of_event(k);
      if (old_line < i && new_line < j) continue;  // the second event of a line
      const bool copied =
          old_line >= i && new_line >= j && old_.lines[old_line] == new_.lines[new_line];
      if (!copied) return failed(old_line, "a line that acts is not copied byte for byte");
      if (!write_gap({i, old_line}, {j, new_line})) {
        return failed(i, "the evidence is not enough");
      }
      i = old_line + 1;
      j = new_line + 1;
    }
    if (!write_gap({i, old_.lines.size()}, {j, new_.lines.size()})) {
      return failed(i, "the evidence is not enough");
    }
    return {std::move(text_), ""};
  }

 private:
  static Certificate failed(std::size_t line, std::string_view why) {
    return {"", fmt::format("near line {} of the old program: {}", line + 1, why)};
  }

  // --- which lines differ ------------------------------------------------------------------------

  // Lines between two events.
  bool write_gap(const Range& of_old, const Range& of_new) {
    const std::size_t written = text_.size();
    if (write_differences(of_old, of_new, true)) return true;
    text_.resize(written);
    return write_differences(of_old, of_new, false);
  }

  // `apart`: those with copied lines between them each for itself.
  bool write_differences(const Range& of_old, const Range& of_new, bool apart) {
    std::size_t i = of_old.begin;
    std::size_t j = of_new.begin;
    LinesByText by_text;
    while (true) {
      for (; i < of_old.end && j < of_new.end && old_.lines[i] == new_.lines[j]; ++i, ++j) {
        if (old_.cuts_at(i) != new_.cuts_at(j)) break;
        if (apart && old_.cuts_at(i) && !old_.same_start(i, new_, j)) break;
      }
      if (i == of_old.end && j == of_new.end) return true;
      if (apart && by_text.empty()) by_text = lines_by_text(i, of_old.end);
      auto [old_end, new_end] = next_copied(by_text, {i, of_old.end}, {j, of_new.end});
      while (old_end > i && new_end > j && is_silent(old_end - 1, new_end - 1)) {
        --old_end;
        --new_end;
      }
      if (!write_run({i, old_end}, {j, new_end})) return false;
      i = old_end;
      j = new_end;
      if (!apart && (i < of_old.end || j < of_new.end)) {
        // What is left is silent, and copied.
        return true;
      }
    }
  }

  using LinesByText = std::unordered_map<std::string_view, std::vector<std::size_t>>;

  [[nodiscard]] LinesByText lines_by_text(std::size_t begin, std::size_t end) const {
    LinesByText lines;
    for (std::size_t i = begin; i < end; ++i) {
      if (old_.cuts_at(i)) lines[old_.lines[i]].push_back(i);
    }
    return lines;
  }

  [[nodiscard]] std::pair<std::size_t, std::size_t> next_copied(const LinesByText& by_text,
                                                                const Range& of_old,
                                                                const Range& of_new) const {
    for (std::size_t j = of_new.begin; j < of_new.end; ++j) {
      if (!new_.cuts_at(j)) continue;
      const auto found = by_text.find(new_.lines[j]);
      if (found == by_text.end()) continue;
      for (auto i = std::ranges::lower_bound(found->second, of_old.begin); i != found->second.end();
           ++i) {
        if (old_.same_start(*i, new_, j)) return {*i, j};
      }
    }
    return {of_old.end, of_new.end};
  }

  [[nodiscard]] bool is_silent(std::size_t i, std::size_t j) const {
    return old_.lines[i] == new_.lines[j] && !old_.cuts_at(i) && !new_.cuts_at(j);
  }

  // --- the evidence for them
  // -----------------------------------------------------------------------

  bool write_run(const Range& of_old, const Range& of_new) {
    const auto parts = match_section(old_.side(of_old.begin, of_old.end),
                                     new_.side(of_new.begin, of_new.end), tolerance_);
    if (!parts) return false;
    text_ += fmt::format("run {} {} {} {}\n", of_old.begin + 1, of_old.end - of_old.begin,
                         of_new.begin + 1, of_new.end - of_new.begin);
    line_begin_ = text_.size();
    for (std::size_t k = 0; k < parts->size(); ++k) {
      const MatchedPart& part = (*parts)[k];
      const auto pairs =
          geometry::thin_matching(part.before, part.after, part.matching, tolerance_);
      if (!pairs) return false;
      if (k > 0) write_word("/");
      write_pairs(*pairs);
    }
    if (text_.size() > line_begin_) text_ += '\n';
    return true;
  }

  void write_pairs(const std::vector<SparsePair>& pairs) {
    SparsePair last;
    std::string waiting;
    std::size_t times = 0;
    const auto flush = [&] {
      if (times > 0) write_word(times > 1 ? fmt::format("{}*{}", waiting, times) : waiting);
    };
    for (const SparsePair& pair : pairs) {
      std::string word = step_text(last.a, pair.a);
      if (pair.b.piece != last.b.piece + 1 || pair.b.billionths > 0) {
        word += ':' + step_text(last.b, pair.b);
      }
      last = pair;
      if (word == waiting) {
        ++times;
        continue;
      }
      flush();
      waiting = std::move(word);
      times = 1;
    }
    flush();
  }

  // Pieces onward, and the place in the piece.
  static std::string step_text(const PathPlace& from, const PathPlace& to) {
    std::string text = fmt::format("{}", to.piece - from.piece);
    if (to.billionths == 0) return text;
    text += fmt::format(".{:09}", to.billionths);
    text.resize(text.find_last_not_of('0') + 1);
    return text;
  }

  void write_word(std::string_view word) {
    if (text_.size() > line_begin_) {
      const bool full = text_.size() + word.size() > line_begin_ + kLineLength;
      text_ += full ? '\n' : ' ';
      if (full) line_begin_ = text_.size();
    }
    text_ += word;
  }

  LinedProgram old_;
  LinedProgram new_;
  double tolerance_;
  std::string text_;
  std::size_t line_begin_ = 0;
};

}  // namespace

Certificate certificate_of(const ReadProgram& before, const ReadProgram& after,
                           std::string_view new_text, double tolerance_mm) {
  if (before.program->language != after.program->language) {
    return {"", "a program in another language has no certificate: nothing of it is copied"};
  }
  return CertificateWriter(before, after, new_text, tolerance_mm).run();
}

}  // namespace batten::postproc
