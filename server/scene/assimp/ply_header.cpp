#include "server/scene/assimp/ply_header.h"

#include <algorithm>
#include <array>
#include <charconv>

#include "shared/base/text.h"

namespace macula::scene::assimp {
namespace {

constexpr std::array<std::string_view, 5> kKeywords{"format", "comment", "obj_info", "element",
                                                    "property"};

/// Up to the next blank, which is taken off `line` with it.
std::string_view take_word(std::string_view& line) {
  const std::size_t begin = std::min(line.find_first_not_of(" \t"), line.size());
  const std::size_t end = std::min(line.find_first_of(" \t", begin), line.size());
  const std::string_view word = line.substr(begin, end - begin);
  line.remove_prefix(end);
  return word;
}

/// The lines of a text, without their ends: LF, CR LF or CR.
class Lines {
 public:
  explicit Lines(std::string_view text) : rest_(text) {}
  bool has_more() const { return !rest_.empty(); }
  std::string_view take() {
    const std::size_t end = std::min(rest_.find_first_of("\r\n"), rest_.size());
    const std::string_view line = rest_.substr(0, end);
    const bool is_pair = rest_.substr(end, 2) == "\r\n";
    rest_.remove_prefix(std::min(end + (is_pair ? 2 : 1), rest_.size()));
    ++count_;
    return line;
  }
  int count() const { return count_; }

 private:
  std::string_view rest_;
  int count_ = 0;
};

/// Of "NAME COUNT", what follows the word "element".
Result<std::uint64_t> element_count(std::string_view line, const std::string& place) {
  take_word(line);
  const std::string_view number = take_word(line);
  std::uint64_t count = 0;
  const auto [end, error] = std::from_chars(number.data(), number.data() + number.size(), count);
  if (error == std::errc{} && end == number.data() + number.size() && !number.empty()) return count;
  return base::bad_input("no number of elements", place, "element NAME COUNT");
}

}  // namespace

Result<void> check_ply_header(std::string_view begin, std::uint64_t file_bytes,
                              const std::string& path) {
  Lines lines(begin);
  std::string_view first = lines.take();
  if (take_word(first) != "ply")
    return base::bad_input("no PLY file", path, "its first line is 'ply'");
  std::uint64_t elements = 0;
  while (lines.has_more()) {
    std::string_view line = lines.take();
    const std::string place = base::concat(path, ": line ", lines.count());
    const std::string_view keyword = take_word(line);
    if (keyword == "end_header") return {};
    if (keyword.empty()) continue;
    if (std::find(kKeywords.begin(), kKeywords.end(), keyword) == kKeywords.end())
      return base::bad_input(base::concat("unknown word '", keyword.substr(0, 32), "'"), place,
                             "format, comment, obj_info, element, property or end_header");
    if (keyword != "element") continue;
    const auto count = element_count(line, place);
    if (!count) return base::forward(count);
    // Every element takes a byte at least.
    if (*count > file_bytes || (elements += *count) > file_bytes)
      return base::bad_input(base::concat(*count, " elements are more than the file holds"), place,
                             base::concat("at most one a byte, ", file_bytes, " in all"));
  }
  return base::bad_input(
      "the header has no end", path,
      base::concat("a line 'end_header' within the first ", kMostPlyHeaderBytes, " bytes"));
}

}  // namespace macula::scene::assimp
