// Runs a fuzz target without libFuzzer: its seeds, any files given, and a number of mutations of
// them that depend on the seed alone.
//   fuzz_X [--runs N] [--seed N] [--write-seeds DIR] [--write-slowest FILE] [FILE|FOLDER...]
// An input that ends the process lies in fuzz-failed-input beside it. One that takes longer than
// ten seconds counts as a hang.
#include <fcntl.h>

#include <chrono>
#include <csignal>
#include <cstring>
#include <iterator>
#include <random>
#include <set>

#include "tests/fuzz/fuzz_target.h"

namespace macula::fuzz {
namespace {

constexpr unsigned kHang_s = 10;
constexpr std::size_t kLongest = 65536;

std::string current;  // what a failure writes out

extern "C" void write_failed_input(int signal) {
  const int file = ::open("fuzz-failed-input", O_CREAT | O_TRUNC | O_WRONLY, 0600);
  if (file >= 0) {
    [[maybe_unused]] const auto written = ::write(file, current.data(), current.size());
    ::close(file);
  }
  std::signal(signal, SIG_DFL);
  std::raise(signal);
}

/// Changes one thing: a bit, a byte, a number, a run of bytes.
class Mutator {
 public:
  Mutator(std::uint64_t seed, const std::vector<std::string>& corpus)
      : random_(seed), corpus_(corpus) {}

  std::string next() {
    std::string input = corpus_[below(corpus_.size())];
    const std::size_t changes = 1 + below(below(4) == 0 ? 16 : 3);
    for (std::size_t i = 0; i < changes; ++i) change(input);
    if (input.size() > kLongest) input.resize(kLongest);
    return input;
  }

 private:
  std::size_t below(std::size_t end) { return end == 0 ? 0 : random_() % end; }

  void change(std::string& input) {
    constexpr std::uint64_t kEdges[] = {0,          1,          0x7F,       0x80,
                                        0xFF,       0x7FFF,     0xFFFF,     0x7FFFFFFF,
                                        0x80000000, 0xFFFFFFFF, 1ULL << 62, ~0ULL};
    constexpr const char* kWords[] = {"-1", "1e999", "nan", "4294967296", "\"\"", "[", "{", "null"};
    const std::size_t at = below(input.size());
    switch (below(8)) {
      case 0:
        if (!input.empty()) input[at] = static_cast<char>(input[at] ^ (1 << below(8)));
        break;
      case 1:
        if (!input.empty()) input[at] = static_cast<char>(random_());
        break;
      case 2: {
        const std::uint64_t value = kEdges[below(std::size(kEdges))];
        const std::size_t size =
            std::min<std::size_t>(std::size_t{1} << below(4), input.size() - at);
        std::memcpy(input.data() + at, &value, size);
        break;
      }
      case 3:
        input.erase(at, 1 + below(below(4) == 0 ? input.size() : 8));
        break;
      case 4:
        input.insert(at, std::string(1 + below(8), static_cast<char>(random_())));
        break;
      case 5: {
        const std::string& other = corpus_[below(corpus_.size())];
        const std::size_t from = below(other.size());
        input.replace(at, below(32), other.substr(from, 1 + below(64)));
        break;
      }
      case 6:
        input.insert(at, input.substr(below(input.size()), 1 + below(32)));
        break;
      case 7:
        input.replace(at, below(6), kWords[below(std::size(kWords))]);
        break;
    }
  }

  std::mt19937_64 random_;
  const std::vector<std::string>& corpus_;
};

using Clock = std::chrono::steady_clock;

struct Slowest {
  std::chrono::duration<double> time{0};
  std::string input;
};

void try_one(std::string input, Slowest& slowest) {
  current = std::move(input);
  const auto begin = Clock::now();
  ::alarm(kHang_s);
  try_input({reinterpret_cast<const std::uint8_t*>(current.data()), current.size()});
  ::alarm(0);
  const std::chrono::duration<double> taken = Clock::now() - begin;
  if (taken > slowest.time) slowest = {taken, current};
}

struct Arguments {
  std::uint64_t runs = 100'000, seed = 1;
  std::string seed_folder, slowest;
  std::vector<std::string> paths;
};

Arguments parse(int argc, char** argv) {
  Arguments arguments;
  for (int i = 1; i < argc; ++i) {
    const std::string word = argv[i];
    const bool has_value = i + 1 < argc;
    if (word == "--runs" && has_value)
      arguments.runs = std::stoull(argv[++i]);
    else if (word == "--seed" && has_value)
      arguments.seed = std::stoull(argv[++i]);
    else if (word == "--write-seeds" && has_value)
      arguments.seed_folder = argv[++i];
    else if (word == "--write-slowest" && has_value)
      arguments.slowest = argv[++i];
    else
      arguments.paths.push_back(word);
  }
  return arguments;
}

std::string contents_of(const std::string& file) {
  std::ifstream in(file, std::ios::binary);
  return {std::istreambuf_iterator<char>(in), {}};
}

/// A file, or every file of a folder by name; nothing where there is neither.
void add_files(const std::string& path, std::vector<std::string>& corpus) {
  namespace fs = std::filesystem;
  if (fs::is_regular_file(path)) corpus.push_back(contents_of(path));
  if (!fs::is_directory(path)) return;
  std::set<std::string> files;
  for (const auto& entry : fs::directory_iterator(path)) files.insert(entry.path().string());
  for (const std::string& file : files) corpus.push_back(contents_of(file));
}

int run(const Arguments& arguments) {
  if (!arguments.seed_folder.empty()) {
    write_seeds(arguments.seed_folder);
    return 0;
  }
  std::vector<std::string> corpus = seeds();
  for (const std::string& path : arguments.paths) add_files(path, corpus);
  for (const int signal : {SIGSEGV, SIGABRT, SIGBUS, SIGFPE, SIGILL, SIGALRM})
    std::signal(signal, write_failed_input);
  const auto begin = Clock::now();
  Slowest slowest;
  for (const std::string& input : corpus) try_one(input, slowest);
  Mutator mutator(arguments.seed, corpus);
  for (std::uint64_t i = 0; i < arguments.runs; ++i) try_one(mutator.next(), slowest);
  const std::chrono::duration<double> taken = Clock::now() - begin;
  std::cout << corpus.size() << " seeds and " << arguments.runs << " mutations in " << taken.count()
            << " s without a finding, the slowest took " << slowest.time.count() << " s"
            << std::endl;
  if (!arguments.slowest.empty())
    std::ofstream(arguments.slowest, std::ios::binary) << slowest.input;
  return 0;
}

}  // namespace
}  // namespace macula::fuzz

int main(int argc, char** argv) {
  return macula::fuzz::run(macula::fuzz::parse(argc, argv));
}
