// One fuzz target: a function from bytes, and inputs to begin with. Linked either with libFuzzer
// (preset fuzz) or with driver.cpp, which mutates from a seed and needs no special compiler.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <iostream>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include <unistd.h>

namespace macula::fuzz {

using Input = std::span<const std::uint8_t>;

/// Whatever the bytes are, this returns: no crash, no hang, no sanitizer report.
void try_input(Input input);

/// Good inputs, made by the code that writes them, so that they follow the formats.
std::vector<std::string> seeds();

inline void write_seeds(const std::string& folder) {
  std::filesystem::create_directories(folder);
  std::size_t count = 0;
  for (const std::string& seed : seeds())
    std::ofstream(folder + "/seed-" + std::to_string(count++), std::ios::binary) << seed;
}

inline std::span<const std::byte> as_bytes(Input input) {
  return std::as_bytes(input);
}
inline std::string_view as_text(Input input) {
  return {reinterpret_cast<const char*>(input.data()), input.size()};
}

/// What must hold whatever the input was.
inline void require(bool holds, const char* what) {
  if (holds) return;
  std::cerr << "fuzz: " << what << std::endl;
  std::abort();
}

/// A file in memory for readers that take a path; the name decides the reader.
class InputFile {
 public:
  explicit InputFile(const std::string& name) {
    const std::filesystem::path base = std::filesystem::exists("/dev/shm") ? "/dev/shm" : "/tmp";
    folder_ = base / ("macula-fuzz-" + std::to_string(::getpid()));
    std::filesystem::create_directories(folder_);
    path_ = folder_ / name;
  }
  ~InputFile() { std::filesystem::remove_all(folder_); }
  const std::string& write(std::string_view contents) {
    text_ = path_.string();
    std::ofstream(path_, std::ios::binary) << contents;
    return text_;
  }
  std::filesystem::path folder() const { return folder_; }

 private:
  std::filesystem::path folder_, path_;
  std::string text_;
};

/// An input whose first byte chooses what the rest is a file of.
struct NamedContents {
  std::string name;
  std::string_view contents;
};
inline NamedContents choose_name(Input input, std::span<const char* const> names) {
  return {names[input[0] % names.size()], as_text(input).substr(1)};
}
/// The input that choose_name() takes for a file called `name`, one of `names`.
inline std::string input_named(std::string_view name, std::span<const char* const> names,
                               const std::string& contents) {
  const auto place = std::find(names.begin(), names.end(), name);
  require(place != names.end(), "a seed of an unknown name");
  return static_cast<char>(place - names.begin()) + contents;
}

}  // namespace macula::fuzz
