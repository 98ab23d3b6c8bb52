#include "io/bare_sentence.h"

#include <sstream>

namespace anatomesh {

std::string bare_sentence(const std::string& message) {
  const std::size_t address = message.rfind("(0x");
  const std::size_t colon = address == std::string::npos ? address : message.find("):", address);
  std::istringstream words(colon == std::string::npos ? message : message.substr(colon + 2));
  std::string sentence;
  for (std::string word; words >> word;) sentence.append(sentence.empty() ? "" : " ").append(word);
  while (sentence.ends_with('.')) sentence.pop_back();
  return sentence;
}

}  // namespace anatomesh
