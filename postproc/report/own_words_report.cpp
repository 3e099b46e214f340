#include "postproc/report/own_words_report.h"

#include <nlohmann/json.hpp>
#include <string_view>
#include <utility>

#include "postproc/options/own_words.h"
#include "postproc/text/words.h"

namespace batten::postproc {

Json own_words_json(const std::shared_ptr<const gcode::OwnWords>& words) {
  if (!words) return Json::array();
  return json_list(words->all(), [](const gcode::OwnWord& word) -> Json {
    return {{"word", word.name}, {"effect", word.effects}};
  });
}

Json called_json(const std::vector<CalledFile>& files) {
  return json_list(files, [](const CalledFile& called) -> Json {
    return {{"call", called.call}, {"file", called.file}, {"why_not", called.why_not}};
  });
}

std::string own_words_text(const std::shared_ptr<const gcode::OwnWords>& words) {
  if (!words) return "";
  std::string lines;
  std::string_view title = "vouched for";
  for (const gcode::OwnWord& word : words->all()) {
    lines += titled(std::exchange(title, ""), text_of(word));
  }
  return lines + titled("", "that these words do so is the user's word, and no part of the proof");
}

}  // namespace batten::postproc
