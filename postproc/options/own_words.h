// What a user says that words of the shop do (--word, own-words of a profile), checked.
#pragma once

#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "gcode/state/own_words.h"

namespace batten::postproc {

// Collects words from a profile and from the command line.
class OwnWordList {
 public:
  // "M501" and "keeps state, returns". `problems` gets a sentence, without its beginning, for
  // everything that is wrong: a name that is none, a word whose effect Batten knows, an effect that
  // is none, effects that contradict each other or what was said of the word before.
  void add(std::string_view name, std::string_view effects, std::vector<std::string>& problems);

  // "M501 = keeps state"
  void add(std::string_view text, std::vector<std::string>& problems);

  // nullptr: nothing was said.
  [[nodiscard]] std::shared_ptr<const gcode::OwnWords> words() const;

 private:
  std::vector<gcode::OwnWord> words_;
};

// "M501: keeps state"
[[nodiscard]] std::string text_of(const gcode::OwnWord& word);

}  // namespace batten::postproc
