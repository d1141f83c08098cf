// Distance fields in JSON.
#include "server/sdf/read.h"
#include "tests/fuzz/fuzz_target.h"

namespace macula::fuzz {

void try_input(Input input) {
  (void)sdf::parse_field(as_text(input), "input");
}

std::vector<std::string> seeds() {
  std::vector<std::string> seeds;
  for (const auto& entry :
       std::filesystem::recursive_directory_iterator(MACULA_SOURCE_DIR "/server/sdf")) {
    if (entry.path().string().find(".sdf.json") == std::string::npos) continue;
    std::ifstream in(entry.path());
    seeds.emplace_back(std::istreambuf_iterator<char>(in), std::istreambuf_iterator<char>());
  }
  seeds.push_back(R"({"scene": {"type": "sphere", "radius": 1}})");
  seeds.push_back(R"({"far": 10, "scene": {"type": "union", "of": [)"
                  R"({"type": "sphere", "radius": {"keys": [[1, 1], [2, 2]]}},)"
                  R"({"type": "sphere", "radius": 0.5}]}})");
  return seeds;
}

}  // namespace macula::fuzz
