// What an import ignored or repaired, each sentence once, with how often it applied.
#pragma once

#include <cstddef>
#include <string>
#include <utility>
#include <vector>

namespace macula::scene {

class Warnings {
 public:
  void add(const std::string& sentence) {
    for (auto& [text, count] : entries_) {
      if (text == sentence) {
        ++count;
        return;
      }
    }
    if (entries_.size() < kMaxSentences) entries_.emplace_back(sentence, std::size_t{1});
  }
  std::vector<std::string> sentences() const {
    std::vector<std::string> result;
    for (const auto& [text, count] : entries_) {
      result.push_back(count == 1 ? text : text + " (" + std::to_string(count) + " times)");
    }
    return result;
  }

 private:
  static constexpr std::size_t kMaxSentences = 64;
  std::vector<std::pair<std::string, std::size_t>> entries_;
};

}  // namespace macula::scene
